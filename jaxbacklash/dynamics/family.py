"""Families of systems: named parameters in, one system over all cells out. What a map is drawn over."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field, replace
from typing import Any, Protocol

import jax
import numpy as np

from ..errors import BadInput
from ..excitation import AbstractExcitation, Harmonic
from ..models import forced_oscillator
from ..parameters import specs, with_values
from ..system import System

Array = Any

CASES: dict[int, dict[str, float]] = {
    1: {"stiffness_ratio": 0.0, "inverse_alpha": 2.0, "zeta": 0.02, "Omega": 0.2},
    2: {
        "stiffness_ratio": 1.0 / 31.0, "inverse_alpha": 31000.0 * 0.005 / 240.0, "zeta": 4.0 / 31000.0**0.5,
        "Omega": 40.0 / 31000.0**0.5,
    },
}  # fmt: skip
"""The paper's cases in dimensionless form (Table 1, 2.14): time in 1 / omega_0 with omega_0^2 = k_0 / m, ratio is k_1 / k_0."""

LONG_NAMES = {
    "inverse_alpha": "k_0 x_0 / A, backlash over force", "zeta": "damping ratio c / (2 m omega_0)",
    "Omega": "drive frequency over omega_0",
}  # fmt: skip


class Family(Protocol):
    """What a map needs of a family: its system at given values, and words for labels and for telling two families apart."""

    @property
    def time_unit(self) -> str: ...

    def build(self, given: dict[str, Array]) -> tuple[System, AbstractExcitation]: ...

    def unit(self, name: str) -> str: ...

    def long_name(self, name: str) -> str: ...

    def constants(self, names: list[str]) -> dict[str, float]: ...

    def identity(self) -> str: ...


@dataclass(frozen=True)
class PaperCase:
    """CASE 1 or 2 of the paper in dimensionless form; its parameters are ``inverse_alpha``, ``zeta`` and ``Omega``."""

    case: int = 1
    Omega: float | None = None
    zeta: float | None = None
    inverse_alpha: float | None = None
    time_unit: str = field(default="1/omega_0", init=False)

    def build(self, given: dict[str, Array]) -> tuple[System, Harmonic]:
        """The oscillator whose y is p and whose time is tau."""
        value = self._all() | given
        damping: Any = 2.0 * np.asarray(value["zeta"])
        system = forced_oscillator(1.0, 1.0, damping, 1.0, k1=float(value["stiffness_ratio"]))
        return system, Harmonic(1.0 / np.asarray(value["inverse_alpha"]), np.asarray(value["Omega"]), 0.0, as_force=True)

    def unit(self, name: str) -> str:
        if name not in LONG_NAMES:
            raise BadInput(f"no parameter {name!r} in the paper's cases; there are {', '.join(LONG_NAMES)}")
        return "1"

    def long_name(self, name: str) -> str:
        return LONG_NAMES[name]

    def constants(self, names: list[str]) -> dict[str, float]:
        return {name: float(value) for name, value in self._all().items() if name not in names}

    def identity(self) -> str:
        return f"case {self.case} {sorted(self._all().items())}"

    def _all(self) -> dict[str, Any]:
        own = {"Omega": self.Omega, "zeta": self.zeta, "inverse_alpha": self.inverse_alpha}
        return CASES[self.case] | {name: value for name, value in own.items() if value is not None}


@dataclass(frozen=True)
class NamedParameters:
    """Any system under a drive; parameters go by the system's own names, the drive's as ``drive.amplitude`` and so on.

    ``drive.frequency`` stands for ``drive.omega`` / (2 pi), in Hz.
    """

    system: System
    drive: AbstractExcitation
    time_unit: str = "s"

    def build(self, given: dict[str, Array]) -> tuple[System, AbstractExcitation]:
        ours = {name: value for name, value in given.items() if not name.startswith("drive.")}
        theirs = {name[6:]: np.asarray(value) for name, value in given.items() if name.startswith("drive.")}
        if "frequency" in theirs:
            theirs["omega"] = 2.0 * np.pi * theirs.pop("frequency")
        drive = self.drive
        for name, value in theirs.items():
            drive = replace(drive, **{name: value})
        return with_values(self.system, ours), drive

    def unit(self, name: str) -> str:
        if name.startswith("drive."):
            known = {"frequency": "Hz", "omega": "rad/s", "phase": "rad"}
            short = name[6:]
            if short != "frequency" and not hasattr(self.drive, short):
                raise BadInput(f"no parameter {name!r}: the drive is {type(self.drive).__name__}")
            force = getattr(self.drive, "as_force", False)
            return known.get(short, ("N m" if force else "rad") if short == "amplitude" else "1")
        described = specs(self.system)
        if name not in described:
            raise BadInput(f"no parameter {name!r} in the system; there are {', '.join(described)}, and drive.*")
        return described[name].unit

    def long_name(self, name: str) -> str:
        described = specs(self.system)
        return (described[name].label or name) if name in described else name

    def constants(self, names: list[str]) -> dict[str, float]:
        own = dict(zip(specs(self.system), jax.tree.leaves(self.system)))
        kept = {name: float(value) for name, value in own.items() if name not in names}
        amount = {f"drive.{k}": v for k, v in vars(self.drive).items() if v is not None and np.ndim(v) == 0}
        return kept | {k: float(v) for k, v in amount.items() if k not in names and not isinstance(v, bool)}

    def identity(self) -> str:
        leaves = [np.asarray(leaf, dtype=float) for leaf in jax.tree.leaves((self.system, self.drive))]
        digest = hashlib.sha256(b"".join(leaf.tobytes() for leaf in leaves)).hexdigest()
        return f"{jax.tree.structure((self.system, self.drive))} {digest}"
