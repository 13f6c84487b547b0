"""What a misfit may depend on, and whether it does: one test for every coordinate, one question each.

The rows tested are values of the missing torque, not residuals of the motion: inside a window a residual carries along
all earlier errors of the torque, so that it says where a window fails but not where the torque was wrong.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import uniform_filter1d
from scipy.special import chdtrc

from ..records import Record
from ..signals import choose_intervals, fit_spline, span
from .latent import Latent

PLACES = ("contact, negative side", "negative edge", "inside the play", "positive edge", "contact, positive side")
EDGE = 0.1
"""A place counts as an edge within this share of the half play of it."""
SIGNIFICANT = 0.01
"""Probability, after Bonferroni's correction for the number of questions, below which a dependence counts."""


@dataclass(frozen=True)
class Dependence:
    """The missing torque and the misfit against one coordinate, in bins.

    Attributes: ``coordinate`` short name; ``label`` and ``unit`` in words; ``of`` what was tested, the torque's ``"size"`` or its
    ``"value"``; ``edges`` (K + 1,) of the bins, or ``names`` (K,) of places; ``misfit`` (K,) rms residual over noise; ``mean``,
    ``error``, ``rms`` (K,) of the torque [its unit], the mean's standard error counting how few values are independent;
    ``share`` (K,) of the torque's mean square beyond its uncertainty, ``time`` (K,) share of the samples; ``strength``
    share of the ranks' variance that lies between bins; ``trend`` rank correlation (0 for places); ``p`` probability
    of as much by chance, corrected for all questions asked.
    """

    coordinate: str
    label: str
    unit: str
    of: str
    edges: np.ndarray
    names: tuple[str, ...]
    misfit: np.ndarray
    mean: np.ndarray
    error: np.ndarray
    rms: np.ndarray
    share: np.ndarray
    time: np.ndarray
    strength: float
    trend: float
    p: float

    @property
    def significant(self) -> bool:
        """True when chance does not explain it."""
        return self.p < SIGNIFICANT


def excitation(record: Record, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Frequency [Hz] and amplitude [unit of the input] of what drives (of the motion, where nothing does), over about 1 s."""
    name = record.input_name or record.observed_name
    signal = record.channels[name]
    window = span(record.dt)
    smooth = fit_spline(record.t, signal, record.t[0], window / choose_intervals(record.t, signal, window))
    value, rate = smooth(record.t), smooth(record.t, 1)
    length = max(3, round(1.0 / record.dt))

    def spread(values: np.ndarray) -> np.ndarray:
        away = values - np.mean(values)
        mean, square = (uniform_filter1d(part, length, mode="mirror") for part in (away, away**2))
        return np.sqrt(np.maximum(square - mean**2, 0.0))

    fast, high = spread(rate), spread(value)
    frequency = fast / np.maximum(2.0 * np.pi * high, 1e-300)
    return np.interp(t, record.t, frequency), np.interp(t, record.t, np.sqrt(2.0) * high)


def places(latent: Latent) -> np.ndarray:
    """Index into `PLACES` of every value, (N,)."""
    low, high = (np.asarray(e, dtype=float) for e in latent.system.edges(latent.t, latent.x))
    near = EDGE * 0.5 * (high - low)
    found = np.where(latent.z > high, 4, np.where(latent.z < low, 0, 2))
    found = np.where(np.abs(latent.z - low) < near, 1, found)
    return np.where(np.abs(latent.z - high) < near, 3, found)


def depends(latent: Latent, torque: np.ndarray, misfit: np.ndarray) -> list[Dependence]:
    """All questions answered, strongest first.

    Parameters
    ----------
    latent : times, motion and uncertainty
    torque : (N,) the missing torque to ask about
    misfit : (N,) residual over noise at the same times
    """
    length = "m" if latent.unit.startswith("N") and "m" not in latent.unit.split() else "rad"
    asked: list[tuple[str, str, str, str, np.ndarray, int]] = []
    frequency, amplitude = np.zeros(latent.t.size), np.zeros(latent.t.size)
    for number, record in enumerate(latent.records):
        rows = latent.record == number
        frequency[rows], amplitude[rows] = excitation(record, latent.t[rows])
    unit = length if latent.records[0].input_name != "F" else latent.unit
    numeric = [
        ("t", "time", "s", latent.t, 10), ("frequency", "excitation frequency", "Hz", frequency, 8),
        ("amplitude", "excitation amplitude", unit, amplitude, 8), ("dz", "relative speed z'", f"{length}/s", latent.dz, 10),
        ("speed", "|z'|", f"{length}/s", np.abs(latent.dz), 8), ("y", "absolute angle y", length, latent.y, 10),
        ("z", "relative angle z", length, latent.z, 10),
    ]  # fmt: skip
    for name, label, unit, values, bins in numeric:
        if name in ("frequency", "amplitude") and np.quantile(values, 0.9) < 1.3 * np.quantile(values, 0.1):
            continue
        if name == "y" and not np.any(latent.x):
            continue
        asked += [(name, label, unit, of, values, bins) for of in _questions(name)]
    asked += [("sign_dz", "sign of z'", "", "value", np.sign(latent.dz), 0)]
    if np.any(latent.x):
        asked += [("sign_dy", "direction of motion, sign of y'", "", "value", np.sign(latent.dy), 0)]
    if latent.system.has_play:
        at = places(latent).astype(float)
        asked += [("place", "position across the play", "", of, at, -1) for of in ("size", "value")]
    tests = [_test(latent, torque, misfit, *question, count=len(asked)) for question in asked]
    return sorted((test for test in tests if test is not None), key=lambda test: -test.strength)


def _questions(name: str) -> tuple[str, ...]:
    if name in ("frequency", "amplitude", "speed"):
        return ("size",)
    return ("size", "value") if name == "t" else ("value",)


def _test(
    latent: Latent, torque: np.ndarray, misfit: np.ndarray, name: str, label: str, unit: str, of: str, values: np.ndarray,
    bins: int, *, count: int,
) -> Dependence | None:  # fmt: skip
    names: tuple[str, ...] = ()
    if bins > 0:
        edges = np.unique(np.quantile(values, np.linspace(0.0, 1.0, bins + 1)))
        if edges.size < 3:  # a link that stands still, or rests nearly always
            return None
        where = np.clip(np.searchsorted(edges, values, side="right") - 1, 0, edges.size - 2)
        size = edges.size - 1
    elif bins == 0:
        edges, names, where, size = np.array([-1.0, 0.0, 1.0]), ("negative", "positive"), (values > 0).astype(int), 2
    else:
        edges, names, where, size = np.arange(6.0) - 0.5, PLACES, values.astype(int), 5
    number = np.bincount(where, minlength=size)
    if np.sum(number > 0) < 2:
        return None
    with np.errstate(invalid="ignore", divide="ignore"):
        average = lambda v: np.where(number > 0, np.bincount(where, v, size) / np.maximum(number, 1), np.nan)  # noqa: E731
        mean, square = average(torque), average(torque**2)
        excess = np.bincount(where, np.maximum(torque**2 - latent.stderr**2, 0.0), size)
        ranks = ranks_of(np.abs(torque) if of == "size" else torque)
        ranks = (ranks - ranks.mean()) / ranks.std()
        level = average(ranks)
        between = float(np.nansum(number * level**2)) / ranks.size
        rest = ranks - level[where]
        independent = ranks.size / _correlated(rest, latent.record)
        spread = np.sqrt(average((torque - mean[where]) ** 2) / np.maximum(number * independent / ranks.size, 1.0))
        # Kruskal and Wallis's statistic, with as many values as are independent.
        p = float(chdtrc(np.sum(number > 0) - 1.0, (independent - 1.0) * between))
    trend = 0.0 if names == PLACES else float(np.corrcoef(ranks_of(values), ranks)[0, 1])
    return Dependence(
        name, label, unit, of, edges, names, np.sqrt(average(misfit**2)), mean, spread, np.sqrt(square),
        excess / max(float(np.sum(excess)), 1e-300), number / number.sum(), between, trend, min(1.0, p * count),
    )  # fmt: skip


def ranks_of(values: np.ndarray) -> np.ndarray:
    """Ranks from 1, (N,); equal values share the mean of theirs. `scipy.stats.rankdata` takes half a second to load."""
    _, where, count = np.unique(values, return_inverse=True, return_counts=True)
    return (np.cumsum(count) - 0.5 * (count - 1))[where]


def _correlated(values: np.ndarray, record: np.ndarray) -> float:
    """How many neighbouring values count as one: twice the sum of the autocorrelation up to its first zero."""
    parts = [values[record == number] for number in np.unique(record)]
    longest = max(parts, key=len)
    size = longest.size
    spectrum = np.abs(np.fft.rfft(longest - longest.mean(), 2 * size)) ** 2
    correlation = np.fft.irfft(spectrum)[:size]
    if not correlation[0] > 0.0:
        return 1.0
    correlation = correlation / correlation[0]
    first = int(np.argmax(correlation < 0.0)) or size
    return float(max(1.0, 2.0 * np.sum(correlation[:first]) - 1.0))
