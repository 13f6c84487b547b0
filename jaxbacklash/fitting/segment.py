"""A segment of a long record on which starting points are compared: the parameters hardly need more, at a fraction of the cost.

`jaxbacklash.fitting.search` fits every starting point to it, with windows nearly free, and the whole record only from where
the best have arrived.
"""

from __future__ import annotations

import equinox as eqx
import numpy as np

from ..shooting.levenberg import Minimum
from ..shooting.multiple_shooting import per_window
from ..shooting.problem import Problem, Unknowns
from .settings import TIMES, WELL_KNOWN, WINDOWS


def segment(problem: Problem, guess: Unknowns, another: int = 0) -> tuple[Problem, Unknowns] | None:
    """The problem and the first guess on the segment with the most motion, None where the record is short.

    Consecutive windows are taken, those over which the measured channel strays farthest from its mean, because a link that
    moves much meets both edges; ``another`` 1, 2, ... takes the next best that shares no window with those before. All arrays
    keep their shapes, so the program compiled for the record serves.
    """
    w = problem.windows
    used = int(w.used)
    if used < TIMES * WINDOWS:
        return None
    weight = np.asarray(w.weight)[:used] > 0.0
    measured = np.where(weight, np.asarray(w.measured)[:used], 0.0)
    mean = np.sum(measured) / max(1, np.sum(weight))
    strayed = np.cumsum(np.sum(np.where(weight, (measured - mean) ** 2, 0.0), axis=1))
    over = strayed[WINDOWS - 2 :] - np.concatenate([[0.0], strayed[: 1 - WINDOWS]])
    over = np.array(over[: used - WINDOWS + 1])
    for _ in range(another):
        taken = int(np.argmax(over))
        over[max(taken - WINDOWS + 1, 0) : taken + WINDOWS] = -np.inf
    first = int(np.argmax(over))

    def own(values: np.ndarray, samples: int = WINDOWS) -> np.ndarray:
        values = np.asarray(values)
        taken = np.zeros_like(values)
        taken[:samples] = values[first : first + samples]
        return taken

    # The last window only holds the spline coefficients that the one before it shares with it.
    t0, measured, weight, tie, input, input_weight, force = per_window(problem)
    lead = (
        own(t0), own(measured), own(weight, WINDOWS - 1), own(tie, WINDOWS - 2), own(input),
        own(input_weight, WINDOWS - 1), own(force),
    )  # fmt: skip
    part = eqx.tree_at(per_window, problem, lead)
    part = eqx.tree_at(
        lambda p: (p.windows.coefficients, p.windows.used),
        part,
        (own(w.coefficients), np.asarray(WINDOWS, dtype=np.asarray(w.used).dtype)),
    )
    return part, Unknowns(guess.theta, own(np.asarray(guess.starts).T).T, own(guess.coefficients))


def determines(found: Minimum, part: Problem) -> bool:
    """Whether a segment determines every parameter: each error small beside its scale, and no value at its bound."""
    theta, schur = np.asarray(found.value.theta), np.asarray(found.stats["schur"])
    inside = np.all((theta > np.asarray(part.lower)) & (theta < np.asarray(part.upper)))
    if not inside or not np.all(np.isfinite(schur)):
        return False
    try:
        variance = np.diag(np.linalg.inv(schur)) * variance_ratio(found, part)
    except np.linalg.LinAlgError:
        return False
    return bool(np.all((variance > 0.0) & (variance < WELL_KNOWN**2)))


def variance_ratio(found: Minimum, problem: Problem) -> float:
    """By how much the squared misfit exceeds the noise's, at least 1."""
    rows = float(np.sum(np.asarray(problem.windows.weight) > 0.0))
    return max(1.0, 2.0 * float(found.stats["cost"]) / rows)
