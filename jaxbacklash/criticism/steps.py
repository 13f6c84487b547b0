"""The path of a search, model by model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

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


def leading(steps: Sequence[Step], trial: Trial) -> list[Step]:
    """The beginning of a path that leads to another model too: as far as that holds all the effects, and more."""
    kept = [steps[0]]
    for step in steps[1:]:
        if not step.trial.names < trial.names:
            break
        kept.append(step)
    return kept
