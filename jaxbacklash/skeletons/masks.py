"""Where a skeleton may not be read: stretches that break one of its assumptions, each with its rule and its sentence."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..signals import CycleSpline
from .fundamental import Fundamental

FAST = 0.2
"""Change of the logarithm of the amplitude in one cycle from which an amplitude passes too fast to belong to one moment."""
MIXED_DRIVE = 0.1
"""Share of the drive's local energy outside its fundamental from which the drive is not one frequency at a time."""
APERIODIC, HARMONICS, REPEATS = 0.1, 7, 4.0
"""Share of z's local energy outside the first harmonics of the drive from which the motion does not repeat with it; how many
harmonics; and over how many cycles their amplitudes must hold: a chaotic motion has harmonics too, other ones each cycle."""
SHORTEST = 2
"""Points, half a cycle each, that a stretch must last to be told."""


@dataclass(frozen=True)
class Mask:
    """One reason: ``points`` (M,) True where it applies; ``spans`` in s; ``sentence`` for a person, empty if it never applies."""

    name: str
    points: np.ndarray
    spans: tuple[tuple[float, float], ...]
    sentence: str


def make_mask(name: str, along: Fundamental, points: np.ndarray, words: str, consequence: str = "") -> Mask:
    """A mask with its sentence: ``words`` say what happens ("z stays inside the play"), the spans say when."""
    spans = spans_of(along.t, points)
    if not spans:
        return Mask(name, points, spans, "")
    text = f"{words} {when(spans, float(along.t[0]), float(along.t[-1]))}"
    return Mask(name, points, spans, text + (f": {consequence}" if consequence else ""))


def spans_of(t: np.ndarray, points: np.ndarray) -> tuple[tuple[float, float], ...]:
    """Stretches [s] of at least two points; those nearer than a few points to each other are told as one."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], points.astype(int), [0]])))
    runs: list[list[int]] = []
    for begin, end in zip(edges[::2], edges[1::2]):
        if runs and begin - runs[-1][1] <= 6:
            runs[-1][1] = int(end)
        else:
            runs.append([int(begin), int(end)])
    return tuple((float(t[a]), float(t[b - 1])) for a, b in runs if b - a >= SHORTEST)


def when(spans: tuple[tuple[float, float], ...], first: float, last: float) -> str:
    """Stretches in words: ``after 16.3 s``, ``from 3.1 to 4.0 s and from 7.2 to 9.9 s``."""
    if len(spans) > 3:
        total = sum(b - a for a, b in spans)
        return f"in {len(spans)} stretches, {total:.3g} s in all, between {spans[0][0]:.1f} and {spans[-1][1]:.1f} s"
    edge = 0.03 * (last - first)
    said = []
    for a, b in spans:
        if a - first < edge and last - b < edge:
            return "throughout"
        if last - b < edge:
            said.append(f"after {a:.1f} s")
        elif a - first < edge:
            said.append(f"before {b:.1f} s")
        else:
            said.append(f"from {a:.1f} to {b:.1f} s")
    return " and ".join(said)


def passes_fast(along: Fundamental, position: np.ndarray) -> np.ndarray:
    """True where the amplitude (M,) changes by more than `FAST` a cycle, and within the window's length of there.

    A steady decay is no passage: what counts is the change beyond the median one.
    """
    level = np.log(np.abs(position) + 1e-12 * float(np.max(np.abs(position))))
    rate = np.gradient(level, along.t) * 2.0 * np.pi / along.omega
    so_far = np.concatenate([[0], np.cumsum(np.abs(rate - np.median(rate)) > FAST)])
    at, reach = np.arange(rate.size), round(2.0 * along.windowed)
    return so_far[np.minimum(at + reach + 1, rate.size)] > so_far[np.maximum(at - reach, 0)]


def outside(along: Fundamental, t: np.ndarray, values: np.ndarray, harmonics: int, *, cycles: float = 1.0) -> np.ndarray:
    """Share of the signal's local energy about its local mean that the first harmonics of the carrier leave, (M,), 0 to 1.

    ``cycles`` is the distance of the knots along which the harmonics' amplitudes may change.
    """
    spline = along.cycles if cycles == 1.0 else CycleSpline(t, along.phase, cycles)
    rest = values - spline.smoothed(values)
    energy = _over_a_cycle(along, t, rest**2)
    for n in range(1, harmonics + 1):
        turn = np.exp(1j * n * along.phase)
        rest = rest - 2.0 * (spline.smoothed(values / turn) * turn).real
    left = _over_a_cycle(along, t, rest**2)
    return left / np.maximum(energy, np.maximum(left, 1e-300))


def _over_a_cycle(along: Fundamental, t: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Sum of the samples within half a cycle of each point, (M,)."""
    total = np.concatenate([[0.0], np.cumsum(values)])
    middle = np.interp(along.t, t, along.phase)
    begin, end = (np.searchsorted(along.phase, middle + side * np.pi) for side in (-1.0, 1.0))
    return total[end] - total[begin]


def peaks(along: Fundamental, t: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Congruent envelope at the points, (M,): the largest value between two changes of sign, by a parabola through three samples.

    Between the extrema it runs along their logarithm. Where the signal keeps its sign its one largest value stands.
    """
    size = np.abs(values)
    starts = np.concatenate([[0], np.flatnonzero(np.diff(np.signbit(values))) + 1])
    ends = np.append(starts[1:], size.size)
    where = np.array([a + int(np.argmax(size[a:b])) for a, b in zip(starts, ends)])
    inner = where[(where > 0) & (where < size.size - 1)]
    if inner.size < 2:
        return np.full(along.t.size, float(np.max(size)))
    below, here, above = size[inner - 1], size[inner], size[inner + 1]
    bend = np.minimum(below - 2.0 * here + above, -1e-300)
    top = here - 0.125 * (above - below) ** 2 / bend
    real = top > 0.3 * np.interp(t[inner], along.t, np.maximum.reduceat(size, _cells(along.t, t)))
    if np.sum(real) < 2:
        real = np.ones(inner.size, bool)
    return np.exp(np.interp(along.t, t[inner[real]], np.log(top[real])))


def _cells(points: np.ndarray, t: np.ndarray) -> np.ndarray:
    """First sample of the stretch around each point, (M,), rising."""
    first = np.searchsorted(t, np.concatenate([[t[0]], 0.5 * (points[1:] + points[:-1])]))
    return np.minimum(first, t.size - 1)
