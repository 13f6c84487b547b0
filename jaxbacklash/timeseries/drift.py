"""Does the series drift? Looked at before anything else: a trend, a change of level or of size, or a wandering level.

All later tools suppose a steady motion. Surrogates of a series with a trend carry the trend's power at random places, local maps
look for neighbours of a state among states at another level, and a random walk foretells itself well without any dynamics.
A trend, a polynomial of low degree over the whole record, is taken off; a level that steps or wanders ends in the
verdict "undecided because of drift".
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.polynomial.legendre import legfit, legval, legvander

from .scales import correlation_time

BLOCKS = 24  # stretches of the record whose means and sizes are compared
DEGREES = 4  # largest polynomial that is tried as a trend: a slower change than any of 24 stretches
SURE = 1e-3  # chance of a change as large as the one found, had the stretches been drawn from one motion
LEAST_TREND = 0.05  # a trend whose standard deviation is a smaller share of the motion's changes nothing that follows
LEAST_STEP = 0.5  # a smaller step, in standard deviations of the motion beside it, is left to the tests that follow
LEAST_WAVE = 0.3  # a slow wave counts where the means of stretches have this share of the motion's standard deviation, or more
ALIKE = 0.6  # correlation of 24 neighbouring means from which on they make a wave; of independent ones it is 0 +- 0.2
# A random walk's means of stretches have more than this share of its standard deviation (99 % of 2000 walks have more than 0.67).
# The unit-root test alone takes one steady motion in sixteen for a walk, among them most of a forced pendulum's of 32 swings.
MOSTLY_SLOW = 0.6
SIZE_CHANGE = 2.0  # factor between the sizes of the motion in its largest and smallest fitted stretch that counts
FEWEST = 200  # samples that the unit-root test keeps, at least
# 1 % quantiles of the augmented Dickey-Fuller statistic with a polynomial of degree 0 ... 4: MacKinnon (2010) for 0 and 1; for 2
# to 4 from 20000 random walks of 500 steps, which give -3.42 and -3.89 for the first two.
UNIT_ROOT_1_PERCENT = (-3.43, -3.96, -4.31, -4.70, -4.99)


@dataclass(frozen=True, eq=False)
class Drift:
    """What changes slowly in a series.

    ``kind``: "none", "trend", "level" (one step), "wanders" (as a random walk does) or "size" (the size of the motion changes).
    ``steady`` (N,) the series that the analysis goes on with: without its trend where ``removed``, else as it came; ``trend``
    (N,) what was taken off, with polynomial ``degree``; ``change`` of the level from the record's beginning to its end, or across
    the step at sample ``at`` [unit of the series]; ``factor`` by which the size of the motion changes from the record's first
    stretch to its last; ``unit_root`` the Dickey-Fuller statistic beside its 1 % ``bound``. ``text`` a sentence for a person.
    """

    kind: str
    steady: np.ndarray
    trend: np.ndarray | None = None
    degree: int = 0
    change: float = 0.0
    at: int | None = None
    factor: float = 1.0
    unit_root: float | None = None
    bound: float | None = None
    text: str = ""

    @property
    def removed(self) -> bool:
        """Whether a trend was taken off."""
        return self.trend is not None

    @property
    def forbids(self) -> bool:
        """Whether no verdict can be given at all because of the drift."""
        return self.kind in ("level", "wanders")


def find_drift(series: np.ndarray) -> Drift:
    """Look for a drift, and take off a slow trend.

    Means of 24 stretches of the record are compared: polynomials up to degree 4 and a single step compete by Schwarz's criterion,
    and the winner counts where chance explains it with less than 0.1 %; a polynomial is taken off. Then the augmented
    Dickey-Fuller test (Said and Dickey, 1984) asks whether the level of what is left returns. The series wanders where a random
    walk is not rejected at 1 % and the means of stretches make up most of the motion, as a walk's do; and also where means of
    neighbouring stretches are alike and make up a third of it. At last the size of the motion in the stretches is compared in the
    same way as their means.

    A steady motion of fewer than about 25 swings may be said to wander too: in so short a record a walk is not excluded.

    Parameters
    ----------
    series : (N,) any unit, at least `BLOCKS` * 8 samples

    Returns
    -------
    Drift

    Example
    -------
    ``find_drift(np.cumsum(np.random.default_rng(1).standard_normal(2000))).kind`` is "wanders".
    """
    means = _means(series)
    degree, step = _change(means)
    at, trend = 0, None
    if step is not None:
        at = _step_at(series, step)
        rest = np.concatenate([series[:at] - series[:at].mean(), series[at:] - series[at:].mean()])
    elif degree:
        trend = legval(np.linspace(-1.0, 1.0, series.size), legfit(np.linspace(-1.0, 1.0, series.size), series, degree))
        trend -= trend.mean()
        rest = series - trend
    else:
        rest = series
    told, bound = unit_root(rest, correlation_time(rest), degree)
    if np.all(series > 0.0):
        # Prices multiply: their logarithm is what walks.
        told = max(told, unit_root(np.log(series), correlation_time(np.log(series)), degree)[0])
    plain = Drift("none", series, unit_root=told, bound=bound, change=float(means[-1] - means[0]), degree=degree)
    left = _means(rest) - rest.mean()
    slow = float(left.std() / rest.std())
    if told > bound and slow > MOSTLY_SLOW:
        text = (
            "The level wanders: that it is a random walk's, which never comes back, is not excluded "
            f"(Dickey-Fuller {told:.1f}, excluded at 1 % below {bound:.2f})"
        )
        return replace(plain, kind="wanders", text=text)
    if step is not None:
        change = float(series[at:].mean() - series[:at].mean())
        if abs(change) > LEAST_STEP * rest.std():
            text = f"The level steps by {change:.3g} near sample {at} of {series.size}: take the part before or after it"
            return replace(plain, kind="level", at=at, text=text, change=change)
    alike = float(np.sum(left[1:] * left[:-1]) / max(float(np.sum(left**2)), 1e-300))
    if alike > ALIKE and slow > LEAST_WAVE:
        text = (
            "The level goes slowly up and down, faster than a trend that could be taken off (means of neighbouring "
            f"twenty-fourths of the record are correlated by {alike:.2f})"
        )
        return replace(plain, kind="wanders", text=text)
    size = _size(rest)
    changes = "" if size == 1.0 else f"the size of the motion changes {size:.2g} times over the record"
    if trend is None or trend.std() < LEAST_TREND * rest.std():
        return replace(plain, kind="none" if size == 1.0 else "size", factor=size, text=changes.capitalize())
    text = (
        f"A slow trend was taken off first: a polynomial of degree {degree} over the whole record, which spans "
        f"{np.ptp(trend) / rest.std():.2g} standard deviations of what is left"
    )
    return replace(
        plain, kind="trend" if size == 1.0 else "size", steady=rest, trend=trend, factor=size,
        text="; ".join(filter(None, (text, changes))), change=float(trend[-1] - trend[0]),
    )  # fmt: skip


def unit_root(series: np.ndarray, memory: int, degree: int) -> tuple[float, float]:
    """Augmented Dickey-Fuller statistic with a polynomial of the given degree, and the value below which a random walk is
    excluded at 1 %.

    Every few samples one is used, two in a correlation time of ``memory`` samples, so that a flow that is sampled finely is not
    taken for a walk; `FEWEST` are kept at least. The number of lags is the one that Schwarz's criterion takes, up to that of
    Schwert's rule, 12 (n / 100)^(1/4): always as many as the rule allows misses the return of a Lorenz series of 1500 samples in
    two cases of three.
    """
    stride = max(1, min(memory // 2, series.size // FEWEST))
    y = series[::stride]
    y = (y - y.mean()) / max(float(y.std()), 1e-300)
    step = np.diff(y)
    most = int(12.0 * (y.size / 100.0) ** 0.25)
    rows = step.size - most
    fixed = np.linalg.qr(legvander(np.linspace(-1.0, 1.0, rows), degree))[0]
    past = [step[most - k : most - k + rows] for k in range(1, most + 1)]
    # Without the polynomial, as the regressions below would find it themselves.
    *past, level, now = (one - fixed @ (fixed.T @ one) for one in (*past, y[most : most + rows], step[most:]))
    best = (np.inf, 0.0)
    for lags in range(most + 1):
        q, r = np.linalg.qr(np.column_stack([*past[:lags], level]))  # the level is last: R's last entry is what is new in it
        slopes = q.T @ now
        missed = max(float(now @ now - slopes @ slopes), 1e-20 * rows)
        free = rows - lags - degree - 2
        score = np.log(missed) + lags * np.log(rows) / rows
        best = min(best, (score, float(slopes[-1] * np.sign(r[-1, -1]) / np.sqrt(missed / free))))
    return best[1], UNIT_ROOT_1_PERCENT[degree]


def _means(values: np.ndarray) -> np.ndarray:
    return np.array([part.mean() for part in np.array_split(values, BLOCKS)])


def _change(values: np.ndarray) -> tuple[int, int | None]:
    """The slow change that explains ``values`` of the stretches: degree of a polynomial (0: none), or the stretch after which
    they step."""
    from scipy.special import fdtrc

    n = values.size
    time = np.linspace(-1.0, 1.0, n)
    left = [float(np.sum((values - legval(time, legfit(time, values, d))) ** 2))
            for d in range(DEGREES + 1)]  # fmt: skip
    steps = [float(n_ * (n - n_) / n * (values[:n_].mean() - values[n_:].mean()) ** 2) for n_ in range(2, n - 1)]
    after = int(np.argmax(steps)) + 2
    left_by_step = max(left[0] - max(steps), 1e-300)
    total = max(left[0], 1e-300)
    # Schwarz: a step has a height and a place.
    scores = [n * np.log(max(one, 1e-300) / total) + d * np.log(n) for d, one in enumerate(left)]
    step_score = n * np.log(left_by_step / total) + 2.0 * np.log(n)
    degree = int(np.argmin(scores))
    if step_score < scores[degree]:
        ratio = (total - left_by_step) / 2.0 / (left_by_step / (n - 3))
        return (0, after) if fdtrc(2, n - 3, ratio) * n < SURE else (0, None)
    if not degree:
        return 0, None
    ratio = (total - left[degree]) / degree / (max(left[degree], 1e-300) / (n - degree - 1))
    return (degree, None) if fdtrc(degree, n - degree - 1, ratio) < SURE else (0, None)


def _step_at(series: np.ndarray, after: int) -> int:
    """The sample of the step, near the end of stretch ``after``."""
    edges = np.linspace(0, series.size, BLOCKS + 1).astype(int)
    low, high = edges[max(after - 1, 1)], edges[min(after + 1, BLOCKS - 1)]
    sums = np.cumsum(series - series.mean())
    at = np.arange(low, high)
    return int(at[np.argmax(np.abs(sums[at - 1]) / np.sqrt(at * (series.size - at)))])


def _size(rest: np.ndarray) -> float:
    """Factor from the first stretch to the last by which the fitted size of the motion changes; 1 where it does not."""
    logs = np.log(np.maximum(np.array([part.std() for part in np.array_split(rest, BLOCKS)]), 1e-12 * rest.std()))
    degree, step = _change(logs)
    if not degree and step is None:
        return 1.0
    time = np.linspace(-1.0, 1.0, BLOCKS)
    if step is not None:
        fitted = np.where(np.arange(BLOCKS) < step, logs[:step].mean(), logs[step:].mean())
    else:
        fitted = legval(time, legfit(time, logs, degree))
    if np.ptp(fitted) < np.log(SIZE_CHANGE):
        return 1.0
    # A polynomial that comes back to where it began still changes: its whole span counts.
    change = fitted[-1] - fitted[0]
    return float(np.exp(change if abs(change) > 0.5 * np.ptp(fitted) else np.ptp(fitted)))
