"""The path of a search, model by model: as the search has each, and as a fit with scores and intervals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from ..fitting import Fit
from .candidates import Candidate
from .workbench import Trial


@dataclass(frozen=True)
class Step:
    """One model kept on the way: ``trial``, the effect ``added`` (None for the base), those ``dropped``, ``ranking`` of what was
    absent, and by name ``evidence`` of the candidates that were really refitted, and ``refits``, the misfits before and after."""

    trial: Trial
    added: str | None
    dropped: tuple[str, ...]
    ranking: tuple[Candidate, ...]
    evidence: dict[str, float] = field(default_factory=dict)
    refits: dict[str, tuple[float, float]] = field(default_factory=dict)


@dataclass(frozen=True)
class Stage:
    """One model kept: the effect ``added`` (None at first), those ``dropped`` with it, its `Fit`, the ``ranking`` of what was
    still absent, and the ``evidence`` of the candidates that were really refitted, with their misfits before and after
    (``refits``)."""

    added: str | None
    dropped: tuple[str, ...]
    fit: Fit
    ranking: tuple[Candidate, ...]
    evidence: dict[str, float]
    refits: dict[str, tuple[float, float]] = field(default_factory=dict)


def leading(steps: Sequence[Step], trial: Trial) -> list[Step]:
    """The beginning of a path that leads to another model too: as far as that holds all the effects, and more."""
    kept = [steps[0]]
    for step in steps[1:]:
        if not step.trial.names < trial.names:
            break
        kept.append(step)
    return kept
