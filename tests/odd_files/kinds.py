"""The register of kinds: a kind is a function that makes a draft odd in one way, with variants drawn from a generator."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from tests.odd_files.draft import Draft

Dress = Callable[[Draft, np.random.Generator], None]


@dataclass(frozen=True)
class Kind:
    """One way of being odd: its name, what of the file it changes (two kinds of one file share nothing), and how.

    ``rate`` [Hz] and ``offset`` [rad, of the base] are those of the record that it needs; ``library`` writes its file.
    """

    name: str
    touches: frozenset[str]
    dress: Dress
    rate: float = 500.0
    offset: float = 0.0
    library: str = ""


KINDS: dict[str, Kind] = {}


def kind(touches: str, **needs: Any) -> Callable[[Dress], Dress]:
    """Register a function as a kind of its own name; ``touches`` are words such as "head names bytes time x z container"."""

    def register(dress: Dress) -> Dress:
        name = dress.__name__
        if name in KINDS:
            raise ValueError(f"two kinds are called {name}")
        KINDS[name] = Kind(name, frozenset(touches.split()), dress, **needs)
        return dress

    return register


def pick(rng: np.random.Generator, *choices):
    """One of the choices."""
    return choices[int(rng.integers(len(choices)))]
