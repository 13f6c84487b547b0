"""Fitted models that are only numbers, for tests of what a search does with them."""

from dataclasses import dataclass, field


@dataclass(frozen=True)
class Model:
    """As much of a fitted model as the search looks at."""

    names: frozenset[str]
    cost: float
    tied: bool = True
    done: bool = True
    misfit: float = 1.0
    correlation: float = 1.0
    free: tuple[str, ...] = ("backlash",)
    effects: dict[str, object] = field(default_factory=dict)
    system: object = None

    @property
    def criterion(self) -> float:
        return 2.0 * self.cost + 10.0 * len(self.free)
