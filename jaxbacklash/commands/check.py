"""``jaxbacklash check``: does this installation compute what it should? Four known answers, and what else is installed."""

from __future__ import annotations

import importlib.metadata
import json
import platform
import re
import sys
import time
from collections.abc import Callable
from importlib import resources
from typing import Any

import numpy as np

from .. import __version__
from ..dynamics import lyapunov_spectrum
from ..errors import NoAnswer
from ..fitting import fit
from ..models import base_motion_joint, case_1
from ..program import cache_folder
from ..shipped import demo_records
from ..simulation import simulate
from .common import json_text

NEAR = 5.0
"""Standard errors within which a fitted value must lie of the truth that made the shipped record."""
EXTRAS = ("io", "sweep", "frames", "notebooks", "studio", "mujoco")
"""What a user may have installed beside the package."""


def run(*, as_json: bool) -> None:
    """Ask for every known answer, tell, and end with an error where one is wrong."""
    found = []
    for name, ask in KNOWN.items():
        begun = time.perf_counter()
        right, told = ask()
        spent = time.perf_counter() - begun
        found.append({"check": name, "right": right, "told": told, "seconds": round(spent, 1)})
        if not as_json:
            print(f"{'ok   ' if right else 'WRONG'} {name}: {told} ({spent:.1f} s)", flush=True)
    extras = {name: missing(name) for name in EXTRAS}
    if as_json:
        about = {"version": __version__, "python": platform.python_version(), "cache": str(cache_folder() or "")}
        sys.stdout.write(json_text({"schema": 1, "command": "check", **about, "checks": found, "missing": extras}))
    else:
        print(f"jaxbacklash {__version__}, Python {platform.python_version()}; compiled programs are kept in {cache_folder()}")
        for name, gone in extras.items():
            cure = f'without {", ".join(gone)}: pip install "jaxbacklash[{name}]" where you need them'
            print(f"extra {name}: {cure if gone else 'installed'}")
    if wrong := [str(one["check"]) for one in found if not one["right"]]:
        raise NoAnswer(f"this installation does not compute what it should: {', '.join(wrong)}; please report what stands above")


def precision() -> tuple[bool, str]:
    """Numbers have 53 binary digits, in the package's own arrays too."""
    import jax.numpy as jnp

    kind = jnp.zeros(1).dtype
    return kind == np.float64, f"arrays are {kind}"


def free_swing() -> tuple[bool, str]:
    """The period of a free swing through the play, 2 pi / omega + 4 h / (omega (A - h)), for half play h and amplitude A."""
    half, omega, amplitude = 0.013, 60.0, 0.03
    joint = base_motion_joint(3.0, 2.0 * half, 3.0 * omega**2, 0.0)
    period = 2.0 * np.pi / omega + 4.0 * half / (omega * (amplitude - half))
    motion = simulate(joint, duration=10.0 * period, rate=50.0 / period, y0=amplitude)
    off = abs(float(motion.z[-1]) / amplitude - 1.0)
    return off < 1e-6, f"after ten swings within {off:.0e} of where it began"


def exponents() -> tuple[bool, str]:
    """Both Lyapunov exponents of CASE 1 sum to -c/m, and the larger is above zero."""
    found = lyapunov_spectrum(*case_1(), periods=120, skip=40)
    off = abs(float(found.values.sum()) / -8.0 - 1.0)
    largest = float(found.values[0])
    return bool(off < 1e-6 and largest > 0.0), f"their sum within {off:.0e} of -c/m, the larger {largest:.2g} 1/s, chaotic"


def shipped_fit() -> tuple[bool, str]:
    """The shipped record, with the effect that made it, gives the values that made it, and leaves but noise."""
    told = json.loads((resources.files("jaxbacklash") / "data" / "demo.json").read_text(encoding="utf-8"))
    found = fit(demo_records()[0], inertia=told["told"]["inertia"], effects=["gravity"], starts=1)
    wanted: dict[str, float] = {name: told["truth"][name] for name in ("backlash", "stiffness", "damping")}
    wanted["gravity.G"] = told["truth"]["effects"]["gravity"]["G"]
    off = []
    for name, true in wanted.items():
        one = found.parameters[name]
        off.append(abs(one.value - true) / one.stderr if one.value is not None and one.stderr else np.inf)
    right, error = max(off) < NEAR and 0.9 < found.score.rms < 1.1, f"error {found.score.rms:.3f} times the noise"
    return bool(right), f"values within {max(off):.1f} standard errors of the true ones, {error}"


KNOWN: dict[str, Callable[[], tuple[bool, Any]]] = {
    "double precision": precision, "a free swing": free_swing, "Lyapunov exponents of CASE 1": exponents,
    "a fit of the shipped record": shipped_fit,
}  # fmt: skip


def missing(extra: str) -> list[str]:
    """Libraries of an extra that are not installed."""
    wanted = importlib.metadata.requires("jaxbacklash") or []
    names = [re.split(r"[\s<>=!;\[]", line)[0] for line in wanted if re.search(rf"""extra == ["']{extra}["']""", line)]
    return [name for name in names if name != "jaxbacklash" and not _there(name)]


def _there(name: str) -> bool:
    try:
        importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:
        return False
    return True
