"""The path of a search, model by model: as the search has each, and as a fit with scores and intervals."""

from __future__ import annotations

from dataclasses import dataclass, field

from ..fitting import Fit
from .candidates import Candidate
from .fitted_model import FittedModel


@dataclass(frozen=True)
class SearchStep:
    """One model kept on the way: the ``model``, the effect ``added`` (None for the base), those ``dropped``, ``ranking`` of
    what was absent, and of the candidates that were fitted, by name, their ``evidence`` and ``refits``, the share of what the
    model left that each took away."""

    model: FittedModel
    added: str | None
    dropped: tuple[str, ...]
    ranking: tuple[Candidate, ...]
    evidence: dict[str, float] = field(default_factory=dict)
    refits: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Stage:
    """One model kept, as a `Fit` with scores and intervals; all else as in `SearchStep`."""

    added: str | None
    dropped: tuple[str, ...]
    fit: Fit
    ranking: tuple[Candidate, ...]
    evidence: dict[str, float]
    refits: dict[str, float] = field(default_factory=dict)
