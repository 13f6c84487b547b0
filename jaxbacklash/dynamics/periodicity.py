"""After how many periods of the drive a motion repeats: 1, 2, 3, ... or not at all."""

from __future__ import annotations

from typing import Any

import numpy as np

Array = Any

CHAOTIC, UNRESOLVED = 0, -1
SIGMAS = 3.0
"""An exponent counts as positive from so many of its error bars."""


def periodicity(
    p: Array, v: Array, lyapunov: Array, stderr: Array, *, scale: Array = 1.0, speed: Array = 1.0, tolerance: float = 1e-5
) -> np.ndarray:
    """How many periods of the drive make one period of the motion.

    Parameters
    ----------
    p, v : (S, N) position and speed once a period of the drive, in time order
    lyapunov, stderr : (N,) exponents and their error bars
    scale, speed : the size of a motion and of its speed, against which the tolerance counts
    tolerance : largest difference, as a share of ``scale`` and ``speed``, that counts as a return

    Returns
    -------
    (N,) of int: T, if every kept sample returns after T periods and T is the smallest such number up to S / 2; `CHAOTIC` (0)
    if it does not return and the exponent is positive by three error bars; else `UNRESOLVED` (-1): quasiperiodic, of a
    longer period, or still settling. A period of a slowly settling motion is found once it has settled to the tolerance.
    """
    p, v = np.asarray(p) / scale, np.asarray(v) / speed
    samples, cells = p.shape
    answer = np.full(cells, UNRESOLVED, dtype=np.int32)
    open_ = np.isfinite(p).all(axis=0)
    for T in range(1, samples // 2 + 1):
        away = np.maximum(np.abs(p[T:] - p[:-T]).max(axis=0), np.abs(v[T:] - v[:-T]).max(axis=0))
        here = open_ & (away <= tolerance)
        answer[here] = T
        open_ &= ~here
    lyapunov, stderr = np.asarray(lyapunov), np.asarray(stderr)
    answer[open_ & np.isfinite(lyapunov) & (lyapunov > SIGMAS * stderr)] = CHAOTIC
    return answer


def sizes(system: Any) -> tuple[Array, Array]:
    """A length and a speed against which a return is judged: the half play, and that times the contact's frequency.

    1 rad and 1 rad/s where there is no play; numbers, or arrays over the cells.
    """
    if not system.has_play:
        return 1.0, 1.0
    half = 0.5 * np.asarray(system.contact.backlash)
    return half, half * np.sqrt(np.asarray(system.contact.stiffness) / np.asarray(system.inertia))
