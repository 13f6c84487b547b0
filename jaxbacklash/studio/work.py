"""What is computed for the page, each a call of the public library: the same calls stand in the Python that repeats the work.

These functions run in the process of `worker`; what they take and return can be pickled.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import jaxbacklash as jb

from ..errors import BadInput

Told = Callable[[str, float], None]
MODELS = {"joint": "play, contact stiffness, damping", "linear": "a spring without play", "free": "damping alone"}


@dataclass(frozen=True)
class Setup:
    """What every fit of a tree begins with; as the arguments of `jaxbacklash.fit` that are called alike."""

    model: str = "joint"
    inertia: float | None = None
    translational: bool = False

    def __post_init__(self) -> None:
        if self.model not in MODELS:
            raise BadInput(f"model {self.model}: wanted one of {', '.join(MODELS)}")
        if self.inertia is not None and not 0.0 < self.inertia < float("inf"):
            raise BadInput(f"inertia {self.inertia:g}: wanted a positive number")

    def words(self) -> dict[str, Any]:
        """What is said of it in a call: nothing that is the default."""
        usual = Setup()
        return {name: value for name, value in vars(self).items() if value != getattr(usual, name)}


def fit_model(record: Any, heldout: Any, setup: Setup, effects: tuple[str, ...], tell: Told) -> Any:
    """The `jaxbacklash.Fit` of a model with these effects."""
    return jb.fit(record, heldout=heldout, effects=list(effects), progress=tell, **setup.words())


def fails(fit: Any, tell: Told) -> Any:
    """The `jaxbacklash.Findings` of a fit."""
    tell("looking for the missing torque", 0.1)
    return jb.where_it_fails(fit)


def rank(fit: Any, tell: Told) -> Any:
    """The `jaxbacklash.Ranking` of what a fit lacks."""
    tell("judging absent effects", 0.1)
    return jb.rank_effects(fit)


def causes(fit: Any, tell: Told) -> Any:
    """The causes of misfit that lie in the record."""
    return tuple(jb.find_causes(fit, tell))


def refine(record: Any, heldout: Any, setup: Setup, tell: Told) -> Any:
    """The `jaxbacklash.Refinement` of a record."""
    return jb.refine(record, heldout=heldout, progress=tell, **setup.words())


def addable(have: tuple[str, ...]) -> list[str]:
    """Names of the effects that a model lacks and that a fit can begin without further data."""
    return [name for name in jb.catalogue() if name not in have and name != "learned_torque"]
