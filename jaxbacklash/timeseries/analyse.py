"""From a measured series to a verdict: is it chaos, and how much?"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..errors import BadInput
from .correlation import correlation
from .dimension import embedding_dimension
from .drift import find_drift
from .driven import driven_exponent
from .exponent import Exponent, largest_exponent
from .mutual_information import choose_delay
from .noise_reduction import Cleaned, projective, simple
from .result import ChaosReport
from .scales import mean_period
from .stationarity import kept_company
from .stretching import Stretching, stretching
from .surrogates import KINDS, surrogate_test
from .verdict import STEADY, Verdict, judge, judge_driven
from .zero_one import zero_one

SHORTEST = 500
LONGEST = 50000  # of a longer series every few samples are taken where it is sampled finely, and then its middle
STRAIGHT = 1e-3  # share of its step by which a time that is rounded in the file may differ from a straight line
PLENTY = 60.0  # samples a swing that are left where only every few are taken
LARGEST, SMALLEST = 1e100, 1e-100  # sizes whose squares and products are still numbers
CLEANED_SAMPLES = 20000  # of a longer series the middle is cleaned
WORTH_IT_DB = 2.0  # the gain is estimated to 2.5 dB (benchmarks.chaos_noise_reduction)
FINE = 8.0  # samples a swing from which on a series counts as a flow's
SWING_SHARE = 0.35  # of a swing that the noise reduction's vectors span
COARSE = 40.0  # samples a swing below which the fifteen coordinates that noise is taken off with span more than that share

Tell = Callable[[str, float], None]


def chaos(
    series: np.ndarray, dt: float = 1.0, *, drive: np.ndarray | None = None, motion: np.ndarray | None = None,
    drive_name: str = "drive", surrogates: str = "iaaft", count: int = 39, clean: bool = True, seed: int = 0,
    progress: Tell | None = None,
) -> ChaosReport:  # fmt: skip
    """Is a measured series chaotic, and how fast do small differences grow?

    Parameters
    ----------
    series : (N,) evenly sampled, at least 500 samples, any unit
    dt : time between samples [s]
    drive : (N,) what drives the system, if that was measured. Where it repeats, its period gives the exponent per period; where
        it does not, states never recur with the drive where it was, and verdict and exponent are conditional on the drive: do two
        motions that start apart under the same drive part or meet? See `driven_exponent`
    motion : (N,) what the force depends on, where that is not the series: z = y - x for a link's own motion y over a base x
    drive_name : what the drive is called in sentences
    surrogates : "iaaft", "aaft" or "fourier"
    count : how many; with 39 the least p-value is 0.025
    clean : take noise off too, for the dimension and a less biased exponent; the verdict never rests on it alone
    seed : of everything random: surrogates, reference points; 0 or more
    progress : told (stage, share done)

    Returns
    -------
    ChaosReport

    Raises
    ------
    BadInput
        The series is too short, constant, a straight line such as the time, not finite, or too large to be squared.

    Examples
    --------
    >>> x = [0.3]
    >>> for _ in range(999):
    ...     x.append(3.9 * x[-1] * (1.0 - x[-1]))
    >>> found = jb.chaos(np.array(x), 0.01, clean=False)
    >>> found.verdict.word
    'chaotic'
    >>> bool(found.interval[0] < found.lyapunov < found.interval[1])
    True
    """
    series, dt = _checked(series, dt, count, surrogates, seed)
    tell = progress or (lambda stage, share: None)
    rng = np.random.default_rng(seed)
    measured = series
    tell("looking for a drift", 0.0)
    drift = find_drift(series)
    series, stride, shortened = _shortened(drift.steady, drive is not None)
    dt_measured, dt = dt, dt * stride
    mean, deviation = float(series.mean()), float(series.std())
    series = (series - mean) / deviation

    tell("choosing the delay", 0.02)
    period = mean_period(series)
    delay = choose_delay(series, rng)
    theiler = int(np.clip(max(np.ceil(period), 3 * delay.samples), 3, series.size // 20))
    tell("choosing the dimension", 0.08)
    raw_dimension = embedding_dimension(series, delay.samples, theiler, rng)

    tell("fitting local maps", 0.15)
    raw_exponent = largest_exponent(series, delay.samples, theiler, rng)
    m = min(max(raw_dimension.cao or 4, 2), 6)
    tell("surrogates", 0.30)
    tested = surrogate_test(series, m, delay.samples, theiler, rng, kind=surrogates, count=count)
    tell("following neighbours", 0.50)
    walk = zero_one(series, max(1, delay.samples), rng)
    raw_curve = stretching(series, m, delay.samples, theiler, period, rng)
    company = kept_company(series, m, delay.samples, theiler, rng)
    drive_period, why = _drive_period(drive, measured.size, dt_measured)
    driven = None
    if drive is not None:
        tell("fitting the law of motion", 0.56)
        across = measured if motion is None else np.asarray(motion, dtype=float)
        driven = driven_exponent(across, np.asarray(drive, dtype=float), period, rng)
    verdict = judge(raw_exponent, tested, raw_curve, walk, series.size, period, company, drift)
    recurs = drive_period is not None and company <= STEADY and verdict.word != "undecided"
    conditional = driven is not None and driven.value is not None and not recurs
    if conditional and driven is not None:
        verdict = judge_driven(driven, dt, drive_name)

    cleaned = by_average = cleaned_dimension = None
    working, exponent, curve = series, raw_exponent, raw_curve
    uses_cleaned = False
    if clean:
        tell("taking noise off", 0.60)
        cleaned, by_average = clean_series(series, period)
        uses_cleaned = cleaned.gain_db is not None and cleaned.gain_db >= WORTH_IT_DB
        tell("choosing the dimension", 0.80)
        of_cleaned = embedding_dimension(cleaned.series, delay.samples, theiler, rng)
        cleaned_dimension = of_cleaned if cleaned.why_untouched is None else None  # of the same series once more
        if uses_cleaned and not conditional and verdict.word in ("chaotic", "undecided"):
            working = (cleaned.series - cleaned.series.mean()) / cleaned.series.std()
            tell("fitting local maps", 0.84)
            exponent = largest_exponent(working, delay.samples, theiler, rng) or raw_exponent
            if period < COARSE and exponent is not None and raw_exponent is not None:
                exponent = exponent.with_shift(exponent.value - raw_exponent.value)
            curve = stretching(working, m, delay.samples, theiler, period, rng)
    tell("correlation sums", 0.92)
    highest = range(2, min(m + 3, 8) + 1)
    raw_correlation = correlation(series, highest, delay.samples, theiler, rng)
    found = correlation(working, highest, delay.samples, theiler, rng) if uses_cleaned else raw_correlation
    none = None if conditional else _why_none(verdict, exponent, curve)
    if none and driven is not None and driven.why and drive_period is None:
        none += f"; nor is there one under the measured {drive_name}: {driven.why}"
    return ChaosReport(
        series, dt, mean, deviation, period, delay, theiler, raw_dimension, cleaned_dimension, cleaned, by_average, uses_cleaned,
        raw_exponent, exponent, curve, found, raw_correlation, tested, walk, verdict, none,
        drive_period, why, driven, conditional, seed, drift, shortened,
    )  # fmt: skip


def _checked(series: np.ndarray, dt: float, count: int, surrogates: str, seed: int) -> tuple[np.ndarray, float]:
    series = np.asarray(series, dtype=float)
    if series.ndim != 1:
        raise BadInput(f"the series: found an array of shape {series.shape}, wanted one value per sample")
    if series.size < SHORTEST:
        raise BadInput(f"the series: found {series.size} samples, wanted at least {SHORTEST} to tell chaos from anything")
    if not np.all(np.isfinite(series)):
        raise BadInput(f"the series: found {series[~np.isfinite(series)][0]}, wanted a finite number in every row")
    largest = float(np.abs(series).max())
    if largest > LARGEST or 0.0 < largest < SMALLEST:
        raise BadInput(
            f"the series: found values up to {largest:.3g}, wanted at most {LARGEST:g} and at least {SMALLEST:g}: convert them"
        )
    if not series.std() > 1e-12 * largest:
        raise BadInput("the series: found a constant, wanted a motion")
    steps = np.diff(series)
    if np.abs(steps - steps.mean()).max() < STRAIGHT * abs(steps.mean()):
        raise BadInput(
            f"the series: found a straight line that changes by {steps.mean():.6g} from row to row, as a time or a counter does, "
            "wanted a motion"
        )
    if seed < 0:
        raise BadInput(f"the seed: found {seed}, wanted 0 or a larger whole number")
    if not (np.isfinite(dt) and dt > 0.0):
        raise BadInput(f"the time between samples: found {dt}, wanted a positive number of seconds")
    if surrogates not in KINDS:
        raise BadInput(f"surrogates: found {surrogates!r}, wanted one of {', '.join(KINDS)}")
    if count < 19:
        raise BadInput(f"surrogates: found a count of {count}, wanted at least 19, or no p-value can reach 0.05")
    return series, float(dt)


def _shortened(series: np.ndarray, driven: bool) -> tuple[np.ndarray, int, str | None]:
    """What is used of a series with more than `LONGEST` samples: the samples, every how many, and a sentence that says so.

    A driven one keeps its steps, since its drive is looked at beside it.
    """
    if series.size <= LONGEST:
        return series, 1, None
    stride = 1 if driven else max(1, min(int(mean_period(series[: 4 * LONGEST]) / PLENTY), -(-series.size // LONGEST)))
    used = series[::stride]
    first = (used.size - min(used.size, LONGEST)) // 2
    used = used[first : first + LONGEST]
    every = "all samples" if stride == 1 else f"every {stride}th sample"
    where = f"from sample {first * stride} to {(first + used.size - 1) * stride}"
    return used, stride, f"of {series.size} samples {every} {where} are used, {used.size} in all; drift was sought in all"


def clean_series(series: np.ndarray, period: float) -> tuple[Cleaned, Cleaned]:
    """The projective noise reduction and the simple one of the source paper; of a long series, of its middle."""
    if series.size > CLEANED_SAMPLES:
        begin = (series.size - CLEANED_SAMPLES) // 2
        series = series[begin : begin + CLEANED_SAMPLES]
    window, delay = vectors(period)
    return projective(series, window=window, delay=delay), simple(series, window=window, delay=delay)


def vectors(period: float) -> tuple[int, int]:
    """Coordinates of the vectors that noise is taken off with, and samples between them.

    They span 35 % of a swing of ``period`` samples for a flow, six samples for a map.
    """
    return (15, max(1, round(SWING_SHARE * period / 14))) if period > FINE else (6, 1)


def _drive_period(drive: np.ndarray | None, samples: int, dt: float) -> tuple[float | None, str | None]:
    """Period of a drive that repeats [s]: the one line that carries nearly all its power."""
    if drive is None:
        return None, "the record has no drive"
    drive = np.asarray(drive, dtype=float) - np.mean(drive)
    if drive.size != samples or not drive.std() > 0.0:
        return None, "the drive does not move"
    power = np.abs(np.fft.rfft(drive * np.hanning(samples))) ** 2
    top = int(np.argmax(power))
    near = power[max(top - 3, 0) : top + 4]
    if top < 4 or near.sum() < 0.8 * power.sum():
        return None, "the drive is not periodic: no single line carries its power"
    middle = float(np.sum(np.arange(max(top - 3, 0), max(top - 3, 0) + near.size) * near) / near.sum())
    return samples * dt / middle, None


def _why_none(verdict: Verdict, exponent: Exponent | None, curve: Stretching) -> str | None:
    """Why no exponent is given; None where one is."""
    if exponent is None:
        return "the series is too short"
    if verdict.word == "stochastic":
        return "the motion is not deterministic enough to have an exponent"
    if verdict.word == "chaotic":
        if exponent.interval[0] <= 0.0:
            return "with the noise taken off the interval reaches zero"
        return None
    return "small differences show no stretch of exponential growth"
