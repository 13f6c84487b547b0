"""A stretch of a record on which a search may begin: the parameters hardly need more, at a fraction of the cost."""

from __future__ import annotations

import equinox as eqx
import numpy as np

from ..shooting.levenberg import Minimum
from ..shooting.multiple_shooting import per_window
from ..shooting.problem import Problem, Unknowns

STRETCH = 64
"""Windows of a stretch, the last of which holds no sample."""
WORTH = 3
"""A record must be so many times longer than a stretch; else all of it is as cheap."""
TOLD = 0.1
"""A stretch tells a parameter where its standard error there is below this part of the parameter's scale."""


def stretch(problem: Problem, guess: Unknowns) -> tuple[Problem | None, Unknowns]:
    """The problem and the first guess on the liveliest stretch of the record, or None for it where the record is short.

    Consecutive windows are taken, those over which the measured channel strays farthest from its mean, because a link that
    moves much meets both edges. All arrays keep their shapes, so the program compiled for the record serves.
    """
    w = problem.windows
    used = int(w.used)
    if used < WORTH * STRETCH:
        return None, guess
    weight = np.asarray(w.weight)[:used] > 0.0
    measured = np.where(weight, np.asarray(w.measured)[:used], 0.0)
    mean = np.sum(measured) / max(1, np.sum(weight))
    strayed = np.cumsum(np.sum(np.where(weight, (measured - mean) ** 2, 0.0), axis=1))
    over = strayed[STRETCH - 2 :] - np.concatenate([[0.0], strayed[: 1 - STRETCH]])
    first = int(np.argmax(over[: used - STRETCH + 1]))

    def own(values: np.ndarray, samples: int = STRETCH) -> np.ndarray:
        values = np.asarray(values)
        taken = np.zeros_like(values)
        taken[:samples] = values[first : first + samples]
        return taken

    # The last window only holds the spline coefficients that the one before it shares with it.
    t0, measured, weight, tie, input, input_weight, force = per_window(problem)
    lead = (
        own(t0), own(measured), own(weight, STRETCH - 1), own(tie, STRETCH - 2), own(input),
        own(input_weight, STRETCH - 1), own(force),
    )  # fmt: skip
    part = eqx.tree_at(per_window, problem, lead)
    part = eqx.tree_at(
        lambda p: (p.windows.coefficients, p.windows.used),
        part,
        (own(w.coefficients), np.asarray(STRETCH, dtype=np.asarray(w.used).dtype)),
    )
    return part, Unknowns(guess.theta, own(np.asarray(guess.starts).T).T, own(guess.coefficients))


def told(found: Minimum, part: Problem) -> bool:
    """Whether a stretch tells every parameter: each error small beside its scale, and no value at its bound."""
    theta, schur = np.asarray(found.value.theta), np.asarray(found.stats["schur"])
    inside = np.all((theta > np.asarray(part.lower)) & (theta < np.asarray(part.upper)))
    if not inside or not np.all(np.isfinite(schur)):
        return False
    try:
        variance = np.diag(np.linalg.inv(schur)) * excess_of(found, part)
    except np.linalg.LinAlgError:
        return False
    return bool(np.all((variance > 0.0) & (variance < TOLD**2)))


def excess_of(found: Minimum, part: Problem) -> float:
    """By how much the squared misfit exceeds the noise's, at least 1."""
    rows = float(np.sum(np.asarray(part.windows.weight) > 0.0))
    return max(1.0, 2.0 * float(found.stats["cost"]) / rows)
