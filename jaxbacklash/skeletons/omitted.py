r"""Is there a torque that the skeleton was not told of? The one that would be missed most often is the weight of the link.

The equation of motion of `invert` gets one more term, the amplitude of a torque of a given shape, and is solved again with
the same stretches left out in turn. A sweep tells the shapes apart: seen from the base, the inertia's
torque grows with the square of the frequency, that of a weight or a spring does not. What the joint's own three numbers would
become is told as well, since that is how far the answer is off. Constant torques have no fundamental, and are not seen here.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from .inversion import Inversion, Terms, invert, jackknife, linearised

CERTAIN = 5.0
"""Standard errors from which a torque counts as seen. Twenty stretches and four shapes make chance ones reach 3."""
MATTERS = 0.5
"""Standard errors of play, stiffness or damping by which it must move one of them to be told."""
TAKES = 0.95
"""Share of the sum of squares that it may leave at most: a column of chance takes one part in twenty, as there are stretches, and
what explains less is an error of the method, however alike the stretches tell it."""
RIVAL = 1.5
"""Torques that leave at most so many times the least misfit are named beside the best."""


@dataclass(frozen=True)
class Omitted:
    """A torque ``strength`` times a shape that was left out: ``name`` of the effect with the nearest law, ``shift`` of the
    values of the inversion with it, ``worst`` index and ``errors`` how many standard errors that is, ``rivals`` other names."""

    name: str
    strength: float
    stderr: float
    shift: np.ndarray
    worst: int
    errors: float
    rivals: tuple[str, ...]


def omitted(
    terms: Terms, keep: np.ndarray, found: Inversion, y: np.ndarray, *, inertia: float | None, stderr: np.ndarray
) -> Omitted | None:
    """The torque that would explain most of what the fitted joint leaves; None where none is certain, or none matters.

    Parameters
    ----------
    terms, keep, found, inertia : as of `invert` and what it gave
    y : motion of the link at the samples of ``terms`` (N,)
    stderr : of the values as they will be told
    """
    speed_z, speed_y = (np.gradient(values, terms.t) for values in (terms.z, y))
    shapes = {
        "gravity": terms.along.of(y),
        "gap_spring": -terms.position,
        "coulomb_joint": -terms.along.of(np.sign(speed_z)),
        "coulomb_ground": -terms.along.of(np.sign(speed_y)),
    }
    tried = {name: _with(terms, keep, found, inertia, shape) for name, shape in shapes.items()}
    best = min(tried, key=lambda name: tried[name].left)
    first = tried[best]
    moved = np.abs(first.step[:3]) / np.maximum(stderr[:3], 1e-300)
    worst = int(np.argmax(moved))
    _, before, _ = linearised(terms, keep, found, inertia)
    if first.left > TAKES * float(before @ before):
        return None
    either_sign = best in ("gravity", "gap_spring")
    if abs(first.strength) < CERTAIN * first.stderr or moved[worst] < MATTERS or not (first.strength > 0.0 or either_sign):
        return None
    strength, shift = first.strength, first.step[:-1]
    told = replace(terms, torque=terms.torque + strength * shapes[best])
    again = invert(told, keep, inertia=inertia)
    if again is not None:  # one step from an answer that is percents off is not the last
        rest = _with(told, keep, again, inertia, shapes[best])
        strength, shift = strength + rest.strength, again.values + rest.step[:-1] - found.values
    moved = np.abs(shift[:3]) / np.maximum(stderr[:3], 1e-300)
    worst = int(np.argmax(moved))
    rivals = tuple(name for name in tried if name != best and tried[name].left < RIVAL * first.left)
    return Omitted(best, strength, first.stderr, shift, worst, float(moved[worst]), rivals)


@dataclass(frozen=True)
class _Refined:
    """One step with one torque more: ``left`` sum of squares, ``step`` of the values and, last, the ``strength``."""

    left: float
    step: np.ndarray
    stderr: float

    @property
    def strength(self) -> float:
        return float(self.step[-1])


def _with(terms: Terms, keep: np.ndarray, found: Inversion, inertia: float | None, shape: np.ndarray) -> _Refined:
    jacobian, residual, real = linearised(terms, keep, found, inertia)
    columns = np.concatenate([jacobian, -real(shape)[:, None]], axis=1)
    covariance, step = jackknife(columns, residual, found.blocks)
    left = residual - columns @ step
    return _Refined(float(left @ left), step, float(np.sqrt(covariance[-1, -1])))


WORDS = {
    "gravity": "the weight of the link",
    "gap_spring": "a spring across the joint that acts in the play as well",
    "coulomb_joint": "dry friction in the joint",
    "coulomb_ground": "dry friction against the ground",
}


def sentence(missed: Omitted, names: tuple[str, ...], values: np.ndarray, mass: float) -> str:
    """What is missing, what it does to the answer, and what to do about it; ``mass`` is the inertia, 1 where unknown."""
    name, percent = names[missed.worst], 100.0 * missed.shift[missed.worst] / max(abs(values[missed.worst]), 1e-300)
    other = f" (or {' or '.join(WORDS[rival] for rival in missed.rivals)})" if missed.rivals else ""
    remedy = "fit --effects and refine can take it along"
    if missed.name == "gravity":
        remedy = f"if it is the weight, say --gravity {missed.strength / mass:.4g} (in 1/s^2)"
    return (
        f"a torque like {WORDS[missed.name]}{other} was left out, with which the {name} would change by {percent:+.2g} %, "
        f"{missed.errors:.2g} of its standard errors; {remedy}"
    )
