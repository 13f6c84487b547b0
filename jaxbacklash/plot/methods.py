"""What pictures of skeletons share: how both methods look, and which of them is believed."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..skeletons import Skeleton, Skeletons
from .style import HELDOUT, MODEL

COLOURS = {"hilbert": MODEL, "wavelet": HELDOUT}
NAMES = {"hilbert": "Hilbert", "wavelet": "wavelet"}
MARKS = {"hilbert": "o", "wavelet": "x"}


def surest(found: Skeletons) -> Skeleton:
    """The method with the smaller error of the play; the wavelet where neither tells one."""
    told = [m for m in found.methods if m.parameters["backlash"].stderr is not None]
    return min(told, key=lambda m: m.parameters["backlash"].stderr or np.inf) if told else found.wavelet


def half_play(found: Skeletons) -> float | None:
    """Half the play that the surer method tells, None where it tells none."""
    value = surest(found).parameters["backlash"].value
    return None if value is None else 0.5 * value


def once(axes: Any) -> tuple[list[Any], list[str]]:
    """Marks and names of the legend, each name once."""
    named: dict[str, Any] = {}
    for ax in axes:
        for mark, label in zip(*ax.get_legend_handles_labels()):
            named.setdefault(label, mark)
    return list(named.values()), list(named)
