"""The largest exponent of a driven motion, whatever the drive does: do two motions under the same drive part or meet?

The tangent of the measured law of motion (`force_surface`) is carried along the measured motion. The drive is the same for both
motions and drops out of their difference, so it may sweep or never repeat. The exponent is conditional on that drive and of
this record's length: under another drive it differs.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from .force_surface import CELLS, PARTS, Law, Surface, WeakForm, find_drift, laws, length_at

SHORTEST = 2000  # samples
LONGEST = 60000  # of a longer record the middle is used
REACH = 0.3  # half-width of the bumps, of a swing
PREDICTS = 0.2  # rms error of the acceleration above which the drive and the state do not tell the motion
AS_GOOD = 1.25  # laws whose error is within this factor of the best also count
TABLE = 34  # cells of the table by which a drift is found
RESAMPLES = 12
SUBSTEPS = 4
GROUP = 8  # samples between two orthogonalisations
GROWS = 10.0  # a difference must change by e to this over the record
NORMAL_95 = 1.96


@dataclass(frozen=True, eq=False)
class Driven:
    """Growth of small differences under the measured drive, per sample.

    ``value`` largest exponent with ``stderr`` and 95 % ``interval`` (of the growth over this very record: errors of the law, not
    of another record), ``second`` the other exponent; None, with ``why``, where there is none. ``rates`` (G,) growth in groups
    of `GROUP` samples; ``samples`` used, from ``first`` on; ``middle`` and ``deviation`` of the motion, in units of which
    ``surface``, the best law, is; ``error`` its out-of-sample error; ``used`` laws (cells, friction, error), ``values`` of each;
    ``drift`` the share by which the lengths of the law grow over the record.
    """

    value: float | None
    stderr: float | None
    interval: tuple[float, float] | None
    second: float | None
    why: str | None
    rates: np.ndarray
    first: int
    samples: int
    middle: float
    deviation: float
    surface: Surface | None
    error: float | None
    used: tuple[tuple[int, str, float], ...]
    values: tuple[float, ...]
    drift: float = 0.0

    @property
    def word(self) -> str:
        """ "separate", "meet", "undecided", or "none" where there is no exponent."""
        if self.value is None or self.interval is None:
            return "none"
        if abs(self.value) * self.samples > GROWS:
            if self.interval[0] > 0.0:
                return "separate"
            if self.interval[1] < 0.0:
                return "meet"
        return "undecided"


def driven_exponent(series: np.ndarray, drive: np.ndarray, period: float, rng: np.random.Generator) -> Driven:
    """The exponent conditional on the drive.

    Lengths of the law may grow steadily over the record, as a wearing play does, where that predicts clearly better. Tables
    of every size in `force_surface.CELLS`, with and without friction, are fitted; those whose out-of-sample error is within 25 %
    of the best count, weighted by its inverse square, and their scatter is the error of the choice. Stretches of the record
    drawn anew give the error of the fit.

    Parameters
    ----------
    series, drive : (N,) the motion across the joint (or a link's own under a force), and the base motion or force
    period : samples of a swing
    rng : draws the stretches
    """
    first = max(0, (series.size - LONGEST) // 2)
    series, drive = series[first : first + LONGEST], drive[first : first + LONGEST]
    middle, deviation = float(series.mean()), float(series.std())
    series, drive = (series - middle) / deviation, _standard(drive)
    n = series.size
    reach = int(np.clip(round(REACH * period), 5, n // 50))
    if n < SHORTEST:
        return _none(f"the drive is measured, but {n} samples are too few for the law of motion", first, n)
    if not np.any(drive):
        return _none("the drive does not move", first, n)
    weak = WeakForm(series, drive, reach)
    most = weak.acceleration.size // 20  # cells of a table, at twenty bumps each
    if most < CELLS[0]:
        return _none(f"the drive is measured, but {n / period:.0f} swings are too few for the law of motion", first, n)
    drift = find_drift(weak, min(TABLE, most))
    weak = WeakForm(series, drive, reach, drift) if drift else weak
    tried = laws(weak, most)
    best = tried[0]
    if best.error > PREDICTS:
        return _none(
            f"the state and the drive do not tell the motion: its acceleration is missed by {100 * best.error:.0f} %", first, n,
            best,
        )  # fmt: skip
    used = [one for one in tried if one.error <= AS_GOOD * best.error]
    whole = np.ones(PARTS)
    drawn = [np.bincount(rng.integers(0, PARTS, PARTS), minlength=PARTS).astype(float) for _ in range(RESAMPLES)]
    surfaces = [one.of(whole) for one in used] + [best.of(weights) for weights in drawn]
    rates = _growth(weak, surfaces)
    exponents = rates.mean(axis=1) / GROUP
    own, resampled = exponents[: len(used), 0], exponents[len(used) :, 0]
    weights = np.array([one.error**-2.0 for one in used])
    weights /= weights.sum()
    value = float(weights @ own)
    stderr = float(np.hypot(np.sqrt(weights @ (own - value) ** 2), resampled.std(ddof=1)))
    return Driven(
        value, stderr, (value - NORMAL_95 * stderr, value + NORMAL_95 * stderr), float(weights @ exponents[: len(used), 1]),
        None, np.tensordot(weights, rates[: len(used), :, 0], 1), first, n, middle, deviation, surfaces[0], best.error,
        tuple((one.edges.size - 1, one.against, one.error) for one in used), tuple(float(v) for v in own),
        weak.drift,
    )  # fmt: skip


def _none(why: str, first: int, samples: int, best: Law | None = None) -> Driven:
    error = None if best is None else best.error
    return Driven(None, None, None, None, why, np.empty(0), first, samples, 0.0, 1.0, None, error, (), ())


def _standard(values: np.ndarray) -> np.ndarray:
    spread = float(values.std())
    return (values - values.mean()) / spread if spread > 0.0 else np.zeros(values.size)


def _growth(weak: WeakForm, surfaces: list[Surface]) -> np.ndarray:
    """Logarithms of the growth of two orthogonal differences under each law, (L, G, 2), in groups of `GROUP` samples."""
    n, weight = weak.series.size, float(weak.series.std() / weak.velocity.std())
    at = (np.arange(n * SUBSTEPS) + 0.5) / SUBSTEPS
    at = at[at < n - 1]
    at = at[: at.size // (GROUP * SUBSTEPS) * GROUP * SUBSTEPS]
    s, v = (CubicSpline(np.arange(n), one)(at) for one in (weak.series, weak.velocity))
    u, scale = np.interp(at, np.arange(n), weak.drive_velocity), length_at(at, n, weak.drift)
    steps = []
    for one in surfaces:
        maps = _step(*one.slopes(s, v, v - one.input[2] * u, scale), 1.0 / SUBSTEPS, weight).reshape(-1, GROUP * SUBSTEPS, 2, 2)
        while maps.shape[1] > 1:
            maps = maps[:, 1::2] @ maps[:, 0::2]
        steps.append(maps[:, 0])
    chain = np.stack(steps, axis=1)
    grown = np.empty((len(surfaces), len(chain), 2))
    a, b = (np.tile(axis, (len(surfaces), 1)) for axis in np.eye(2))
    for k, maps in enumerate(chain):
        a, b = np.einsum("lij,lj->li", maps, a), np.einsum("lij,lj->li", maps, b)
        size = np.sqrt(np.sum(a * a, axis=1))
        area = np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
        grown[:, k, 0], grown[:, k, 1] = np.log(size), np.log(area / size)
        a /= size[:, None]
        b = np.stack([-a[:, 1], a[:, 0]], axis=1)
    return grown


def _step(by_s: np.ndarray, by_v: np.ndarray, h: float, weight: float) -> np.ndarray:
    """exp of [[0, 1], [by_s, by_v]] h for each step, (N, 2, 2), the velocity counted in units of 1/``weight``."""
    half = 0.5 * by_v * h
    root = np.sqrt((half**2 + by_s * h**2).astype(complex))
    even = np.cosh(root).real
    odd = np.where(np.abs(root) > 1e-6, np.sinh(root) / np.where(root == 0.0, 1.0, root), 1.0).real
    out = np.empty((by_s.size, 2, 2))
    out[:, 0, 0], out[:, 1, 1] = even - half * odd, even + half * odd
    out[:, 0, 1], out[:, 1, 0] = h * odd / weight, by_s * h * odd * weight
    return out * np.exp(half)[:, None, None]
