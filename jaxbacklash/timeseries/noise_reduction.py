"""Noise taken off a series from a deterministic system: what neighbours in phase space share is kept."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array
from scipy.spatial import cKDTree

from ..program import cores
from ..side_by_side import side_by_side
from .embedding import embed
from .planes import widest

BLOCK = 1024  # vectors at once
NEIGHBOURS = 40
ITERATIONS = 3
ABOVE_FLOOR = 4.0  # a direction belongs to the motion if its local variance exceeds so many times the smallest one's
GAIN_SAMPLES = 4000  # samples that the number of directions is chosen on, and the gain estimated
NEGLIGIBLE = 1e-3  # share of the standard deviation below which exponents are the same with and without it
MOSTLY_NOISE = 0.3  # share of the standard deviation from which on neighbours share by chance what is kept of them
ENOUGH = 6  # vectors whose corrections of a sample are averaged
END_WEIGHT = 1e3  # the first and last coordinate of a vector are hardly corrected: errors grow towards them


@dataclass(frozen=True, eq=False)
class Cleaned:
    """A series with noise taken off.

    ``series`` (N,); ``removed`` root mean square of what was taken off [unit of the series]; ``noise`` estimated standard
    deviation of the noise it came with [unit of the series]; ``gain_db`` estimated gain in the signal-to-noise ratio of the
    projective method, None where it cannot be told; ``window`` coordinates of the vectors, ``delay`` samples between them,
    ``kept`` directions that count as motion; ``method`` "projective" or "simple"; ``why_untouched`` None, or why the series came
    back as it was: too little noise to matter, or so much that what neighbours have in common is chance, and to keep that alone
    would make a motion that nobody measured.
    """

    series: np.ndarray
    removed: float
    noise: float
    gain_db: float | None
    window: int
    delay: int
    kept: int
    method: str
    why_untouched: str | None = None


@dataclass(frozen=True, eq=False)
class Neighbourhoods:
    """Vectors that are projected, ``taken`` (R,) of (M,), the neighbours ``near`` (R, q) of each, itself first, and two averages
    over them: ``mean`` (R, M) over all, ``mean_of_taken`` (R, R) over those that are taken."""

    taken: np.ndarray
    near: np.ndarray
    mean: csr_array
    mean_of_taken: csr_array


def simple(
    series: np.ndarray, *, window: int, delay: int = 1, radius: float | None = None, iterations: int = ITERATIONS
) -> Cleaned:
    """Replace each sample by its mean over all similar stretches (Schreiber, 1993; the paper's 2.2.1).

    The middle coordinate of each vector becomes the average of the middle coordinates in its neighbourhood, in the maximum
    norm, since the middle is held from both sides, by the past and by the future.

    Parameters
    ----------
    series : (N,)
    window, delay : coordinates of the vectors (made odd), samples between them
    radius : of the neighbourhoods [unit of the series]; None: three times the noise found, then less with each round
    iterations : rounds

    Returns
    -------
    Cleaned
    """
    window += 1 - window % 2
    middle = (window - 1) // 2 * delay
    present = series.copy()
    noise = _floor(series, window, delay)[0]
    why = None if radius is not None else _why_untouched(noise, series)
    if why:
        return Cleaned(present, 0.0, noise, None, window, delay, 0, "simple", why)
    size = 3.0 * noise if radius is None else radius
    for _ in range(iterations):
        points = embed(present, window, delay)
        tree = cKDTree(points)
        means = np.empty(len(points))
        for begin in range(0, len(points), BLOCK):
            rows = slice(begin, min(begin + BLOCK, len(points)))
            # Enough for an average; more would only cost memory.
            found, where = tree.query(points[rows], k=min(4 * NEIGHBOURS, len(points)), p=np.inf, distance_upper_bound=size)
            near = np.isfinite(found)
            values = present[np.minimum(where, len(points) - 1) + middle]
            means[rows] = np.where(near, values, 0.0).sum(axis=1) / near.sum(axis=1)
        present[middle : middle + len(points)] = means
        size *= 0.7  # what is left of the noise is smaller, so the neighbourhood may be too
    return Cleaned(present, _rms(series - present), noise, None, window, delay, 0, "simple")


def projective(
    series: np.ndarray, *, window: int, delay: int = 1, kept: int | None = None, iterations: int = ITERATIONS,
    progress: Callable[[str, float], None] | None = None,
) -> Cleaned:  # fmt: skip
    """Project each stretch onto the plane its neighbours lie in (Grassberger et al., 1993; Kantz and Schreiber, chapter 10).

    Motion of few degrees of freedom fills few of the ``window`` directions of a delay vector; noise fills all. Around each
    vector the plane is found from its nearest neighbours, and what sticks out of it is taken off. Each sample belongs to
    ``window`` vectors, of which all or every second one are projected, and gets the mean of their corrections.

    Parameters
    ----------
    series : (N,)
    window, delay : coordinates of the vectors, samples between them
    kept : directions of the plane; None: as many as stand out from the noise floor of the local variances, or one more
    iterations : rounds
    progress : told (stage, share done)

    Returns
    -------
    Cleaned
    """
    noise, found_kept = _floor(series, window, delay)
    why = None if kept is not None else _why_untouched(noise, series)
    if why:
        return Cleaned(series.copy(), 0.0, noise, None, window, delay, 0, "projective", why)
    # The floor hides the weakest direction of the motion, so one more is tried too, and what gains more on a part is taken.
    part = series[:GAIN_SAMPLES]
    around = _neighbourhoods(embed(part, window, delay), delay)

    def tried(directions: int) -> tuple[np.ndarray, float | None]:
        done = _rounds(part, window, delay, directions, iterations, around)
        return done, _gain(done, noise, window, delay, directions, iterations)

    if progress is not None:
        progress("taking noise off", 0.0)
    directions = (found_kept, found_kept + 1) if kept is None else (kept,)
    cleaned, gains = (dict(zip(directions, found)) for found in zip(*side_by_side(tried, directions)))
    best = max(gains, key=lambda number: gains[number] or 0.0)
    if progress is not None:
        progress("taking noise off", 0.5)
    present = cleaned[best] if part.size == series.size else _rounds(series, window, delay, best, iterations)
    return Cleaned(present, _rms(series - present), noise, gains[best], window, delay, best, "projective")


def _why_untouched(noise: float, series: np.ndarray) -> str | None:
    share = noise / series.std()
    if share < NEGLIGIBLE:
        return "too little to matter, so none is taken off"
    return "too much to be told from motion, so none is taken off" if share > MOSTLY_NOISE else None


def _rounds(
    series: np.ndarray, window: int, delay: int, kept: int, iterations: int, around: Neighbourhoods | None = None
) -> np.ndarray:
    """Some rounds of projection. Who is near whom is asked once: neighbours of the noisy vectors remain neighbours, and the gain
    is the same as with a search in each round, to a tenth of a dB."""
    around = around or _neighbourhoods(embed(series, window, delay), delay)
    present, planes = series, None
    for _ in range(iterations):
        present, planes = _projected(present, window, delay, kept, around, planes)
    return present


def _gain(cleaned: np.ndarray, noise: float, window: int, delay: int, kept: int, iterations: int) -> float | None:
    """Gain in dB, by doing it again: the cleaned series with fresh noise of the size that was found, cleaned once more.

    What a cleaning leaves cannot be read off its own result, which looks clean by construction. Here the truth is known,
    and it bends and folds as the measured one does.
    """
    if not noise > 0.0:
        return None
    again = cleaned + noise * np.random.default_rng(0).standard_normal(cleaned.size)
    left = _rms(_rounds(again, window, delay, kept, iterations) - cleaned)
    return float(20.0 * np.log10(noise / left)) if left > 0.0 else None


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _projected(
    series: np.ndarray, window: int, delay: int, kept: int, around: Neighbourhoods, planes: np.ndarray | None
) -> tuple[np.ndarray, np.ndarray]:
    """One round of projection, with the planes (R, window, kept) of the round before; also tells the planes."""
    points, near = embed(series, window, delay), around.near
    vectors, count = points[around.taken], near.shape[1]
    centres = around.mean @ points
    # The mean of the neighbours' centres, for the curvature of the surface (Kantz and Schreiber, 10.3).
    middles = 2.0 * centres - around.mean_of_taken @ centres
    weights = np.ones(window)
    weights[[0, -1]] = END_WEIGHT
    root = np.sqrt(weights)

    def step(begin: int) -> tuple[np.ndarray, np.ndarray]:
        rows = slice(begin, begin + BLOCK)
        neighbours, centre = points[near[rows]], centres[rows]
        spread = neighbours.transpose(0, 2, 1) @ neighbours - count * centre[:, :, None] * centre[:, None, :]
        plane = widest(spread * root * root[:, None], kept, None if planes is None else planes[rows])
        off = ((middles[rows] - vectors[rows]) * root)[:, :, None]
        return (off - plane @ (plane.transpose(0, 2, 1) @ off))[:, :, 0] / root, plane

    steps, found = (np.concatenate(parts) for parts in zip(*side_by_side(step, range(0, len(near), BLOCK))))
    correction, times = np.zeros(series.size), np.zeros(series.size)
    for place in range(window):
        at = around.taken + place * delay
        correction[at] += steps[:, place] / weights[place]
        times[at] += 1.0 / weights[place]
    return series + correction / np.maximum(times, 1e-300), found


def _neighbourhoods(points: np.ndarray, delay: int) -> Neighbourhoods:
    """Who is near whom among the points (M, window).

    Every second vector is taken where each sample still belongs to `ENOUGH` of them, which halves the time and costs a quarter of
    a dB; else all are.
    """
    number, count = np.arange(len(points)), min(NEIGHBOURS + 1, len(points))
    taken = number[number // delay % 2 == 0] if points.shape[1] >= 2 * ENOUGH else number
    near = cKDTree(points).query(points[taken], k=count, workers=cores())[1].astype(np.int32)
    near[:, 0] = taken  # of more equal vectors than are asked for, as from an encoder at rest, any could have come first
    row = np.full(len(points), -1)
    row[taken] = np.arange(taken.size)
    among, ends = row[near], np.arange(0, near.size + 1, count)
    share = (among >= 0) / np.sum(among >= 0, axis=1, keepdims=True)
    return Neighbourhoods(
        taken, near, csr_array((np.full(near.size, 1.0 / count), near.ravel(), ends), (taken.size, number.size)),
        csr_array((share.ravel(), np.maximum(among, 0).ravel(), ends), (taken.size, taken.size)),
    )  # fmt: skip


def _floor(series: np.ndarray, window: int, delay: int, looked_at: int = 1500) -> tuple[float, int]:
    """Noise level and number of directions of the motion, from the variances of neighbourhoods.

    The median neighbourhood's variances, sorted, fall to a floor where only noise is left; its height is the noise.
    """
    points = embed(series, window, delay)
    tree = cKDTree(points)
    chosen = np.linspace(0, len(points) - 1, min(looked_at, len(points))).astype(int)
    near = points[tree.query(points[chosen], k=min(NEIGHBOURS + 1, len(points)), workers=cores())[1]]
    spread = near - near.mean(axis=1, keepdims=True)
    values = np.linalg.eigvalsh(spread.transpose(0, 2, 1) @ spread / NEIGHBOURS)
    typical = np.median(values, axis=0)[::-1]
    floor = float(np.median(typical[window // 2 :]))
    found = int(np.sum(typical > ABOVE_FLOOR * floor))
    found = min(max(found, 1), window // 2)
    return float(np.sqrt(max(np.mean(typical[found:]), 0.0))), found
