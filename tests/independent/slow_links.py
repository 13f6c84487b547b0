"""Links that dry friction carries through a play, many at once, by a time-stepping scheme of their own: no code of the package.

Moreau's scheme: in each step the contact acts implicitly, and Coulomb friction takes as much of the momentum as it can. The
drive's motion is prescribed, or the link is pulled by a force.
"""

from __future__ import annotations

import numpy as np


def carried(
    x: np.ndarray, step: float, *, inertia: np.ndarray, friction: np.ndarray, play: np.ndarray, stiffness: np.ndarray,
    damping: np.ndarray, force: np.ndarray | None = None, keep: int = 1,
) -> np.ndarray:  # fmt: skip
    """The link's position.

    Parameters
    ----------
    x : (K, R) positions of the drives of R rigs at K moments
    step : time between them [s]
    inertia, friction, play, stiffness, damping : (R,) of each; the damper acts in contact
    force : (K, R) on the links, None for none
    keep : every so many moments are kept

    Returns
    -------
    (K / keep, R)
    """
    y, v = x[0].copy(), np.zeros(x.shape[1])
    half = 0.5 * play
    kept = np.empty((-(-x.shape[0] // keep), x.shape[1]))
    before = x[0]
    for moment in range(x.shape[0]):
        now = x[moment]
        base = (now - before) / step
        before = now
        z = y - now
        beyond = np.where(z > half, z - half, np.where(z < -half, z + half, 0.0))
        touching = beyond != 0.0
        pull = 0.0 if force is None else force[moment]
        implicit = touching * step * (damping + step * stiffness)
        heavier = inertia + implicit
        momentum = inertia * v + step * (pull - stiffness * beyond) + implicit * base
        rubbed = np.sign(momentum) * np.maximum(np.abs(momentum) - step * friction, 0.0)
        v = rubbed / heavier
        y = y + step * v
        if moment % keep == 0:
            kept[moment // keep] = y
    return kept


def played(x: np.ndarray, half: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """The slow limit, by the definition of the play operator: a sum of links of ``weights`` (M,), each held within ``half``
    (M,) of the drive at x (N,); several make contact that begins little by little, as in a tendon."""
    at = np.full(half.size, x[0])
    y = np.empty(x.size)
    for index, now in enumerate(x):
        at = np.minimum(np.maximum(at, now - half), now + half)
        y[index] = weights @ at
    return y


def loop(z: np.ndarray, play: float, stiffness: tuple[float, float], friction: float, hardening: float = 0.0) -> np.ndarray:
    """The torque of a joint whose angle z (N,) is moved slowly: contact beyond the play, stiff dry friction (a stop operator)."""
    beyond = np.where(z > 0.5 * play, z - 0.5 * play, np.where(z < -0.5 * play, z + 0.5 * play, 0.0))
    contact = np.where(beyond > 0.0, stiffness[0], stiffness[1]) * beyond * (1.0 + hardening * np.abs(beyond))
    held, rub = 0.0, np.empty(z.size)
    give = 40.0 * max(stiffness)
    for index, step in enumerate(np.diff(z, prepend=z[0])):
        held = min(max(held + give * step, -friction), friction)
        rub[index] = held
    return contact + rub
