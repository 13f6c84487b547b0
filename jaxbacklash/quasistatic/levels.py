"""The distance between the two levels of z, one for each side of the play, from rows in groups, with its interval."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .angle import Curve
from .cells import Cells
from .clustered import Clustered, clustered, leaning, quantile


@dataclass(frozen=True)
class Levels:
    """What `levels` finds.

    Attributes
    ----------
    width : from the level of side -1 to that of side +1, in z's unit; negative where z is lower on side +1
    stderr, freedom : its standard error and how many groups stand behind it
    lag : time by which the link is seen late [s], with ``lag_stderr``; None where nothing moves
    lag_open : whether only a bound of a sample holds it
    beside_lag : the least distance of the levels, by its 95 % interval, if z may lag by any time; -inf where that is open
    influence : (R,) of the rows on half the width
    fit : the least squares; the first coefficient is half the width
    curve : family of the angle that was chosen
    columns : names of the first columns, beside the curve's
    """

    width: float
    stderr: float
    freedom: float
    lag: float | None
    lag_stderr: float
    lag_open: bool
    beside_lag: float
    influence: np.ndarray
    fit: Clustered
    curve: Curve
    names: tuple[str, ...]

    @property
    def interval(self) -> tuple[float, float]:
        """95 %, of the width."""
        reach = quantile(self.freedom) * self.stderr
        return self.width - reach, self.width + reach

    def coefficient(self, name: str) -> tuple[float, float]:
        """A named column's coefficient and its standard error."""
        index = self.names.index(name)
        return float(self.fit.values[index]), self.fit.stderr(index)

    def of_curve(self) -> np.ndarray:
        """The curve's coefficients."""
        return self.fit.values[-self.curve.rows(np.zeros(1)).shape[1] :]


def levels(
    answer: np.ndarray, side: np.ndarray, angle: np.ndarray, drift: np.ndarray, parts: Cells, families: list[Curve], *,
    speed: np.ndarray | None, step: float, others: dict[str, np.ndarray] | None = None,
) -> Levels:  # fmt: skip
    """Fit two levels, a curve over the angle and a drift.

    Parameters
    ----------
    answer, side, angle : (N,) z, -1 or +1, and the angle, at every sample
    drift : (N, D) slow functions of time
    parts : the samples that count, in cells
    families : curves to choose from; the one counts that predicts groups best that were left out
    speed : (N,) of the drive, where z may lag; None where nothing moves
    step : time between samples [s]: a lag of as much is allowed for also where the motion does not tell it from play
    others : further columns (N,), whose coefficients are wanted
    """
    extra = others or {}
    first = np.stack([parts.mean(side), *(parts.mean(values) for values in extra.values())], axis=1)
    z, slow, group, weights = parts.mean(answer), parts.mean(drift), parts.group, parts.weights
    names = ("half", *extra)
    best: tuple[Clustered, Curve] | None = None
    for curve in families:
        basis = parts.mean_of(curve.rows, angle)
        if 3 * (basis.shape[1] + first.shape[1] + slow.shape[1]) > z.size:
            continue
        tried = clustered(np.concatenate([first, slow, basis], axis=1), z, weights, group)
        if best is None or tried.missed < 0.97 * best[0].missed:
            best = tried, curve
    assert best is not None
    fit, curve = best
    freedom = max(1.0, fit.groups - 1.0 - first.shape[1] - slow.shape[1])
    if speed is None:
        return Levels(
            2.0 * float(fit.values[0]), 2.0 * fit.stderr(), freedom, None, 0.0, False, np.inf, fit.influence(), fit, curve, names
        )
    basis = parts.mean_of(curve.rows, angle)
    lagged = np.concatenate([first, -parts.mean(speed)[:, None], slow, basis], axis=1)
    with_lag = clustered(lagged, z, weights, group)
    at = first.shape[1]
    lag, lag_error = float(with_lag.values[at]), with_lag.stderr(at)
    far = 2.0 * quantile(max(1.0, freedom - 1.0)) * with_lag.stderr()
    beside = 2.0 * float(with_lag.values[0]) - far if np.isfinite(far) else -np.inf
    if np.isfinite(lag_error) and abs(lag) > 3.0 * np.hypot(lag_error, step):
        return Levels(2.0 * float(with_lag.values[0]), 2.0 * with_lag.stderr(), max(1.0, freedom - 1.0), lag, lag_error, False,
                      beside, with_lag.influence(), with_lag, curve, (*names, "lag"))  # fmt: skip
    # The lag is known by the motion, and by one clock for both encoders.
    known = leaning(fit, with_lag, at, step)
    return Levels(2.0 * known.value, 2.0 * known.stderr, freedom, known.other, known.other_stderr, bool(lag_error > step), beside,
                  known.influence, fit, curve, names)  # fmt: skip
