"""What a case of bad input is, the register of kinds, and the good files that the cases spoil."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from tests.odd_files.good import GRAVITY, INERTIA, NOISE, good_motion

LIMIT = 60.0
"""Seconds after which a command hangs, on a machine that does nothing else."""


@dataclass
class Case:
    """A command to run in a folder whose files are written, and what it may do.

    ``accepts`` says whether exit code 0 can be right, ``silent`` whether a refusal may say nothing (a pipe that closed). A case
    with ``alone`` runs in a process of its own, with ``env`` (None removes a name), behind ``before`` (words such as `env`), with
    stdout to ``stdout``, and is sent SIGINT after each of the seconds in ``interrupts``. ``lost`` names files that the command
    may replace, such as a result of its own from before; ``check`` looks at the folder afterwards and returns a complaint or "".
    """

    words: list[str]
    accepts: bool = True
    silent: bool = False
    alone: bool = False
    env: dict[str, str | None] = field(default_factory=dict)
    before: list[str] = field(default_factory=list)
    stdout: str = ""
    interrupts: list[float] = field(default_factory=list)
    lost: tuple[str, ...] = ()
    check: Callable[[Path], str] | None = None
    twice: bool = False
    note: str = ""


Drawer = Callable[[np.random.Generator, Path], Case]


@dataclass(frozen=True)
class Kind:
    """A kind of bad input, how often it is drawn, and whether its cases run in processes of their own, which takes seconds."""

    name: str
    door: str
    weight: float
    draw: Drawer
    alone: bool


KINDS: list[Kind] = []


def kind(door: str, weight: float = 1.0, alone: bool = False) -> Callable[[Drawer], Drawer]:
    """Register a function (generator, folder) -> Case as a kind of bad input at a door."""

    def register(draw: Drawer) -> Drawer:
        KINDS.append(Kind(draw.__name__, door, weight, draw, alone))
        return draw

    return register


def pick(rng: np.random.Generator, *choices):
    """One of the choices."""
    return choices[int(rng.integers(len(choices)))]


@functools.cache
def good_columns(seed: int = 0) -> dict[str, np.ndarray]:
    """A base-motion record that nothing is wrong with: 4 s at 250 Hz."""
    t, rng, motion = np.arange(1001) / 250.0, np.random.default_rng(seed), good_motion()
    return {"t": t, **{name: each(t) + NOISE * rng.standard_normal(t.size) for name, each in (("x", motion.x), ("z", motion.z))}}


def csv_text(columns: dict[str, np.ndarray]) -> str:
    """Columns as text."""
    rows = (",".join(f"{value:.9g}" for value in row) for row in zip(*columns.values(), strict=True))
    return "\n".join([",".join(columns), *rows]) + "\n"


def good_record(folder: Path, name: str = "r.csv", seed: int = 0) -> Path:
    """Write the good record."""
    path = folder / name
    path.write_text(csv_text(good_columns(seed)))
    return path


MODEL = f"""# the joint of r.csv
[model]
observed = "z"
inertia = {INERTIA}
backlash = 0.0186
stiffness = 13400.0
damping = 21.5

[effects.gravity]
G = {GRAVITY}
"""


def good_model(folder: Path, text: str = MODEL) -> Path:
    """Write the good record's model."""
    path = folder / "m.toml"
    path.write_text(text)
    return path


FIT = ["--inertia", str(INERTIA), "--effects", "gravity"]


def reading_command(rng: np.random.Generator, name: str) -> list[str]:
    """One of the commands that read a record, with what it needs beside it; the cheap ones more often."""
    fit = ["fit", name, *FIT]
    return pick(
        rng, fit, fit, fit, [*fit, "--out", "o"], ["look", name], ["look", name], ["look", name, "--json"], ["chaos", name],
        ["skeleton", name], ["skeleton", name, "--json"], ["compare", "m.toml", name],
        ["diagnose", name, "--inertia", str(INERTIA)], ["refine", name, "--inertia", str(INERTIA), "--out", "o"],
        ["compare", "m.toml", name, "--out", "o"], ["simulate", "m.toml", "--excitation", name, "--out", "s.csv"],
    )  # fmt: skip
