"""The play operator along a measured motion: where the joint is at an edge, and which, without any dynamics.

A link that dry friction carries stays where it is while its drive crosses the play, and follows at one edge from there on. So all
that counts of the drive's motion are its turning points and the travel since the last one. `passes` finds the turning points,
`states` says at every sample whether the play has been crossed, for any travel that is tried.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Passes:
    """Stretches of a motion between turning points.

    Attributes
    ----------
    starts : (G,) sample at which each begins, which is the turning point before it
    signs : (G,) +1 where the motion goes up, -1 where it goes down
    strokes : (G,) travel of each, in the motion's unit
    number : (N,) which pass each sample belongs to
    travel : (N,) travel since the turning point before, never falling within a pass
    """

    starts: np.ndarray
    signs: np.ndarray
    strokes: np.ndarray
    number: np.ndarray
    travel: np.ndarray

    @property
    def count(self) -> int:
        """How many there are, G."""
        return self.starts.size


@dataclass(frozen=True)
class States:
    """Where the joint is, by the play operator of one travel; arrays (N,).

    ``side`` is the direction in which the link was last carried (0 before it is known), ``engaged`` whether it is being carried
    now, ``held_at`` the drive's position when it last was.
    """

    side: np.ndarray
    engaged: np.ndarray
    held_at: np.ndarray


def passes(motion: np.ndarray, least: float) -> Passes:
    """The stretches between turning points of a motion.

    Parameters
    ----------
    motion : (N,) samples
    least : travel back, in the motion's unit, that makes a turning point; less is noise

    Examples
    --------
    >>> found = passes(np.array([0.0, 1.0, 2.0, 1.0, 0.0, 1.0]), 0.5)
    >>> found.signs, found.strokes
    (array([ 1., -1.,  1.]), array([2., 2., 1.]))
    """
    turns = _turns(motion, least)
    starts = np.array(turns[:-1])
    signs = np.sign(motion[turns[1:]] - motion[starts])
    number = np.clip(np.searchsorted(starts, np.arange(motion.size), side="right") - 1, 0, None)
    along = signs[number] * (motion - motion[starts][number])
    travel = np.empty_like(along)
    for first, last in zip(starts, [*starts[1:], motion.size], strict=True):
        travel[first:last] = np.maximum.accumulate(along[first:last])
    return Passes(starts, signs, np.abs(motion[turns[1:]] - motion[starts]), number, np.maximum(travel, 0.0))


def _turns(motion: np.ndarray, least: float) -> list[int]:
    """The first sample, every turning point, and the last sample."""
    values = motion.tolist()
    turns, low, high, going = [0], 0, 0, 0
    for index, value in enumerate(values):
        if value > values[high]:
            high = index
        if value < values[low]:
            low = index
        if going >= 0 and values[high] - value >= least:
            if going > 0 or high > 0:
                turns.append(high)
            going, low = -1, index
            high = index
        elif going <= 0 and value - values[low] >= least:
            if going < 0 or low > 0:
                turns.append(low)
            going, high = 1, index
            low = index
    last = high if going > 0 else low if going < 0 else motion.size - 1
    if last > turns[-1]:
        turns.append(last)
    return turns if len(turns) > 1 else [0, motion.size - 1]


def states(motion: np.ndarray, found: Passes, crossing: float) -> States:
    """Where the joint is at every sample, if it is crossed by a travel of ``crossing``.

    Parameters
    ----------
    motion : (N,) of the drive
    found : its passes
    crossing : travel from one edge to the other, in the motion's unit

    Examples
    --------
    >>> motion = np.array([0.0, 1.0, 2.0, 1.0, 0.0, -1.0])
    >>> where = states(motion, passes(motion, 0.5), 1.5)
    >>> where.side, where.engaged
    (array([ 0.,  0.,  1.,  1., -1., -1.]), array([False, False,  True, False,  True,  True]))
    """
    needed, before, at, place = crossing, 0.0, float(motion[0]), None
    wait = np.empty(found.count)
    side_before, held = np.empty(found.count), np.empty(found.count)
    ends = [*found.starts[1:], motion.size - 1]
    for one in range(found.count):
        sign, stroke = found.signs[one], found.strokes[one]
        if place is not None:  # way to the edge it is carried at on this pass: place is 0 at the lower edge, 1 at the upper
            needed = crossing * (1.0 - place) if sign > 0 else crossing * place
        wait[one], side_before[one], held[one] = needed, before, at
        if stroke >= needed:
            place, before, at = (1.0 if sign > 0 else 0.0), sign, float(motion[ends[one]])
        elif place is not None:
            place += sign * stroke / crossing
    engaged = found.travel >= wait[found.number]
    engaged &= found.strokes[found.number] >= wait[found.number]
    side = np.where(engaged, found.signs[found.number], side_before[found.number])
    return States(side, engaged, np.where(engaged, motion, held[found.number]))
