"""Draw one picture a law for the catalogue, and measure what its absence leaves: ``python -m website.pictures [NAME ...]``.

A joint with the law is shaken as the demo's was, its motion measured with the demo's noise, and the base model of play, contact
stiffness and damping fitted to that. Left, the restoring torque with and without the law; right, the torque that the fitted base
model misses along the motion. Pictures and numbers go to `website/laws`, small enough to be kept.
"""

from __future__ import annotations

import io
import json
import re
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import matplotlib
import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch
from matplotlib.path import Path as Outline
from scipy.interpolate import CubicSpline

import jaxbacklash as jb
from jaxbacklash.mechanics import Drive
from jaxbacklash.plot.style import GAP, HELDOUT, MODEL
from jaxbacklash.pointwise import along
from tests.laws import LAWS

SHOWN = sorted(set(LAWS) - {"learned_torque"})  # that one has the shape which a record gives it

FOLDER = Path(__file__).with_name("laws")
JOINT = {"inertia": 3.16, "backlash": 0.026, "stiffness": 13000.0, "damping": 12.0}
NOISE, SECONDS, POINTS = 3e-5, 8.0, 180  # rad, s, dots in a picture
INK = "#010203"  # replaced by the colour of the page's text
SETTINGS = {"svg.fonttype": "none", "font.family": "sans-serif", "font.size": 9.0, "axes.spines.top": False,
            "axes.spines.right": False, "axes.edgecolor": INK, "axes.labelcolor": INK, "text.color": INK,
            "xtick.color": INK, "ytick.color": INK}  # fmt: skip


@dataclass(frozen=True)
class View:
    """Over what the missing torque of a law is drawn, and the cycle [deg, Hz] through which its restoring torque is taken."""

    over: str = "z"
    swing: float = 1.0
    hertz: float = 5.0


VIEWS = {
    "asymmetric_stiffness": View(swing=1.4), "bouc_wen": View("dz"), "clock_drift": View("t", 1.2), "contact_damping": View("dz"),
    "contact_exponent": View(swing=1.8), "damping_drift": View("t"), "disturbance": View("t"), "friction_drift": View("t"),
    "load_friction": View("dz", 1.4), "relaxation": View("dz"), "sensor_filter": View("dz", 1.2), "transmission_error": View("x"),
    "coulomb_ground": View("dy", 4.0, 3.0), "coulomb_joint": View("dz"), "cubic_stiffness": View(swing=1.8), "dahl": View("dz"),
    "flexible_link": View("y", 4.0, 1.0), "gap_drift": View("t"),
    "gravity": View("y", 4.0), "hunt_crossley": View("dz", 1.4), "linear_gravity": View("y", 4.0),
    "lugre": View("dz"), "preload": View("y", 4.0), "quadratic_drag": View("dy", 4.0, 3.0), "second_play": View("y", 4.0, 1.0),
    "sensor_delay": View("dz", 1.2), "sensor_gain": View(swing=1.4), "stiffness_drift": View("t", 1.4), "stribeck": View("dz"),
    "torque_ripple": View("y", 6.0),
}  # fmt: skip
BESIDE = {"friction_drift": {"coulomb_joint": LAWS["coulomb_joint"]}}
"""Laws without which one does nothing."""
AXES = {"z": "z [deg]", "x": "x [deg]", "y": "y [deg]", "dz": "rate of z [rad/s]", "dy": "rate of y [rad/s]", "t": "time [s]"}


def main(names: Sequence[str] = ()) -> None:
    """Draw the laws of these names, or all, and write what was measured beside them."""
    jb.start()
    FOLDER.mkdir(exist_ok=True)
    listed = FOLDER / "numbers.json"
    numbers = json.loads(listed.read_text()) if listed.exists() and names else {}
    for name in names or SHOWN:
        numbers[name], figure = shown(name, LAWS[name])
        (FOLDER / f"{name}.svg").write_text(as_svg(figure, name), encoding="utf-8")
        print(f"{name}: {numbers[name]['rms_over_noise']:.3g} times the noise without it")
    listed.write_text(json.dumps(dict(sorted(numbers.items())), indent=1) + "\n")


def shown(name: str, law: jb.AbstractEffect) -> tuple[dict[str, Any], Figure]:
    """What the base model makes of a joint with this law, and the picture of it."""
    view, joint = VIEWS.get(name, View()), jb.base_motion_joint(**JOINT).with_effects(*BESIDE.get(name, {}).values())
    system = joint.with_effects(law)
    motion, record = measured(system)
    fit = jb.fit(record, inertia=JOINT["inertia"], effects=list(joint.effects), starts=1)
    told = {one: fit.parameters[one].value for one in ("backlash", "stiffness", "damping")}
    figure = Figure(figsize=(7.2, 2.5), layout="constrained")
    left, right = figure.subplots(1, 2)
    draw_restoring(left, joint, system, law, view)
    draw_missing(right, system, fit.system, motion, record, view)
    left_over = {"rms_over_noise": float(f"{fit.score.rms:.3g}")}
    return left_over | {one: shift(value, JOINT[one]) for one, value in told.items()}, figure


def shift(value: float | None, true: float) -> float | None:
    """How far an estimate is from the truth, in per cent of it, to two digits; None where there is none."""
    return None if value is None else float(f"{100.0 * (value / true - 1.0):.2g}")


def measured(system: jb.System) -> tuple[jb.Trajectory, jb.Record]:
    """The motion of the joint under the demo's base motion, and what encoders would make of it."""
    motion = jb.simulate(system, jb.measured_base(jb.demo_records()[0]), duration=SECONDS)
    t, x, z = (np.asarray(row) for row in (motion.t, motion.x, motion.observed))
    if (lag := system.lag(t)) is not None:
        z = CubicSpline(t, z)(np.maximum(t - np.asarray(lag), t[0]))
    rng = np.random.default_rng(0)
    channels = {name: row + NOISE * rng.standard_normal(t.size) for name, row in (("x", x), ("z", z))}
    return motion, jb.Record(t, channels, confirmed=frozenset({"t", "x", "z"}))


def draw_restoring(ax: Any, joint: jb.System, system: jb.System, law: jb.AbstractEffect, view: View) -> None:
    """Restoring torque, damper left out, through cycles of one size, grey without the law.

    Over z as it is measured, at a base at rest; of a law between link and ground over y, the joint in the middle of its play.
    """
    drifts, ground = view.over == "t", law.port == "ground"
    hertz = 0.5 if drifts else view.hertz
    t = np.linspace(0.0, 10 / hertz, 20001)
    omega, amplitude = 2.0 * np.pi * hertz, np.radians(view.swing)
    angle, speed = amplitude * np.sin(omega * t), amplitude * omega * np.cos(omega * t)
    cycles = [slice(2000 * n, 2000 * n + 2001, 20) for n in ((0, 4, 9) if drifts else (9,))]
    for of, look in ((joint, {"color": GAP, "lw": 2.6}), (system, {"color": MODEL, "lw": 1.3})):
        torque, over = held(of, t, angle, speed, ground)
        if (lag := of.lag(t)) is not None:
            over = amplitude * np.sin(omega * (t - np.asarray(lag)))
        for number, rows in enumerate(cycles):
            label = None if number else "with it" if of is system else "without"
            ax.plot(np.degrees(over)[rows], torque[rows], label=label, **look)
    ax.set(xlabel="y [deg], z in the middle of the play" if ground else "z [deg]", ylabel="torque [N m]")
    ax.set_title("restoring torque", loc="left", fontsize=9)
    low, high = ax.get_ylim()
    ax.set_ylim(low, high + 0.28 * (high - low))  # room for the names of the lines
    ax.legend(frameon=False, fontsize=8, loc="upper left", handlelength=1.2, ncols=2)


def held(system: jb.System, t: np.ndarray, angle: np.ndarray, speed: np.ndarray, ground: bool) -> tuple[np.ndarray, np.ndarray]:
    """Restoring torque, damper left out, of a link that is led, hidden states followed, (N,) [N m], and the angle as measured.

    It follows ``angle`` and ``speed`` [rad, rad/s] at a base at rest, or, for ``ground``, together with the base.
    """
    step = float(t[1] - t[0])

    def drive(at: Any, rate: Any) -> Drive:
        return Drive(at, rate) if ground else Drive(0.0 * at, 0.0 * rate)

    def advance(hidden: Any, row: Any) -> Any:
        time, at, rate = row
        state, driven = (at, rate, *hidden), drive(at, rate)
        total, _ = system.torques(system.instant(time, state, driven), state)
        rates = system.rates(time, state, driven)[2:]
        return tuple(s + step * change for s, change in zip(hidden, rates)), (-total, system.observe(at, hidden))

    rows = tuple(jnp.asarray(row) for row in (t, angle, speed))
    begin = system.rest(*(row[0] for row in rows), drive(rows[1][0], rows[2][0]))[2:]
    torque, shown = (np.asarray(row) for row in jax.lax.scan(advance, tuple(begin), rows)[1])
    return torque if ground else torque - JOINT["damping"] * speed, shown


def draw_missing(ax: Any, true: jb.System, fitted: jb.System, motion: jb.Trajectory, record: jb.Record, view: View) -> None:
    """The torque that the fitted model misses along the motion, as dots over what it depends on."""
    t, x, y, dy = (np.asarray(row) for row in (motion.t, motion.x, motion.y, motion.dy))
    dx = CubicSpline(t, x)(t, 1)
    lag = true.lag(t)
    seen = np.asarray(motion.observed) if lag is None else CubicSpline(t, y - x)(np.maximum(t - np.asarray(lag), 0.0))
    exact = JOINT["inertia"] * CubicSpline(t, dy)(t, 1)
    model = along(fitted, t, x + seen, dx + CubicSpline(t, seen)(t, 1), x, dx).torque
    over = {"z": np.degrees(seen), "y": np.degrees(y), "dz": dy - dx, "dy": dy, "t": t, "x": np.degrees(x)}[view.over]
    rows = np.linspace(20, t.size - 20, POINTS).astype(int)
    missing = (exact - model)[rows]
    ax.axhline(0.0, color=GAP, lw=0.8)
    reach = 1.15 * float(np.quantile(np.abs(missing), 0.985))
    inside = np.abs(missing) <= reach
    dots(ax, over[rows][inside], missing[inside])
    ax.set(xlabel=AXES[view.over], ylabel="torque [N m]", ylim=(-reach, reach))
    ax.set_title("torque that the base model misses", loc="left", fontsize=9)


def dots(ax: Any, across: np.ndarray, up: np.ndarray) -> None:
    """Points as one outline of lines without length, a tenth of the size that markers take in a file."""
    at = np.repeat(np.column_stack([across, up]), 2, axis=0)
    ax.add_patch(PathPatch(Outline(at, [Outline.MOVETO, Outline.LINETO] * across.size), color=HELDOUT, lw=2.6, capstyle="round"))
    ax.set_xlim(*(np.array([across.min(), across.max()]) * 1.0 + 0.04 * np.ptp(across) * np.array([-1.0, 1.0])))


def as_svg(figure: Figure, name: str) -> str:
    """The figure as SVG that takes the colour of the text around it, numbers rounded to a tenth of a point."""
    with matplotlib.rc_context(SETTINGS | {"svg.hashsalt": name}):
        page = io.StringIO()
        figure.savefig(page, format="svg", transparent=True, metadata=dict.fromkeys(("Date", "Creator", "Format", "Type")))
    text = re.sub(r"^.*?(?=<svg)", "", page.getvalue(), flags=re.DOTALL)
    text = re.sub(r"<metadata>.*?</metadata>", "", text, flags=re.DOTALL).replace(INK, "currentColor")
    text = re.sub(r"font-family: [^;]*; ?", "", text)
    text = re.sub(r"(?<=[\d ,(-])(\d+\.\d)\d+", r"\1", text)
    label = f'role="img" aria-label="Restoring torque with and without {name}, and the torque that the base model misses"'
    text = re.sub(r'<svg [^>]*?viewBox="([^"]*)"[^>]*>', rf'<svg {label} viewBox="\1" xmlns="http://www.w3.org/2000/svg" '
                  r'xmlns:xlink="http://www.w3.org/1999/xlink" class="law">', text, count=1)  # fmt: skip
    shorter = {
        r' style="fill: none"/>': ' fill="none"/>', r"\s+": " ", r"M (\S+ \S+) L \1(?= )": r"M\1h0",
        r' transform="rotate\(-0 [^"]*"': "", r'<g id="[^"]*">': "<g>",
        r'fill: currentColor; stroke: currentColor; stroke-width: 0.8"/>': 'stroke: currentColor"/>',
        r"(?<=[a-z]) (?=/?>)": "", r"> <": ">\n<",
    }  # fmt: skip
    for long, short in shorter.items():
        text = re.sub(long, short, text)
    return text.strip() + "\n"


if __name__ == "__main__":
    with matplotlib.rc_context(SETTINGS):
        main(sys.argv[1:])
