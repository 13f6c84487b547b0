"""Windowed prediction error: how far a model, its parameters frozen, misses the record, in units of the noise.

Each score window (0.2 s unless said otherwise) is simulated from its own estimated start. The residual is whitened by what noise
alone would give: the noise of the measured channel, and the noise of the base motion carried through the model, by letting
the base-motion spline move as far as its own samples allow. A perfect model scores 1.
"""

from __future__ import annotations

from typing import Any

import equinox as eqx
import numpy as np

from ..compiled import kept_jit
from ..frames import dataset
from ..one_encoder import one_side
from ..parameters import values, with_values
from ..shooting.information import freedom
from ..shooting.lengths import SCORE_WINDOW
from ..shooting.levenberg import Levenberg, Minimum, minimise
from ..shooting.multiple_shooting import residuals
from ..shooting.problem import Problem, Unknowns, changed
from ..shooting.windows import Layout
from ..showing import Shown
from .continuation import tied, with_friction_width
from .friction_homotopy import sliding_speeds
from .settings import BETWEEN, CLEARLY, EXPLAINED, FURTHER, JOINED, LAST, LOOSE, NEAR
from .setup import first_guess

kept_residuals = kept_jit(residuals)


class Score(Shown, eqx.Module):
    """The misfit of one record in units of the noise.

    Attributes: ``rms`` over all windows; ``median`` window; ``window_rms`` (K,) per score window, NaN where too short;
    ``window_times`` (K,) their start times [s]; ``t`` (N,), ``measured`` and ``predicted`` (N,) the observed channel,
    ``residual`` (N,) their difference over the noise; ``length`` [s] of a score window; ``observed`` name of the channel.
    """

    rms: float
    median: float
    window_rms: np.ndarray
    window_times: np.ndarray
    t: np.ndarray
    measured: np.ndarray
    predicted: np.ndarray
    residual: np.ndarray
    length: float = SCORE_WINDOW
    observed: str = eqx.field(static=True, default="z")

    @property
    def nrmse(self) -> float:
        """The error as a share of what was measured, see `nrmse`."""
        return nrmse(self.measured, self.predicted)

    def __str__(self) -> str:
        return f"prediction error over windows of {self.length:.3g} s: {error_in_words(self)} (median window {self.median:.3g})"

    def to_dataset(self, unit: str = "") -> Any:
        """What was measured and predicted as an `xarray.Dataset`.

        ``measured``, ``predicted`` [``unit``] and ``residual`` over the noise stand along ``t`` [s]; ``window_rms`` over the
        noise along ``window``, the windows' starts [s].

        Examples
        --------
        >>> record, heldout = jb.demo_records()
        >>> fit = jb.fit(record.between(0.0, 2.0), inertia=3.16, starts=1)
        >>> seen = fit.score.to_dataset("rad")
        >>> seen.sizes["t"], seen.measured.attrs["units"]
        (1001, 'rad')
        """
        return dataset(
            {
                "measured": ("t", self.measured, unit), "predicted": ("t", self.predicted, unit),
                "residual": ("t", self.residual, "1"), "window_rms": ("window", self.window_rms, "1"),
            },
            {"t": (self.t, "s"), "window": (self.window_times, "s")},
            observed=self.observed, rms_over_noise=self.rms, median_over_noise=self.median,
        )  # fmt: skip


def nrmse(measured: np.ndarray, predicted: np.ndarray) -> float:
    """Normalised root-mean-square error: rms of the prediction error over the standard deviation of the measured channel [1].

    Both arrays have the shape (N,) and the channel's unit. NaN for a channel that never moves.
    """
    spread = float(np.std(measured))
    with np.errstate(over="ignore"):  # of a trajectory that ran away
        return float(np.sqrt(np.mean((measured - predicted) ** 2))) / spread if spread > 0.0 else float("nan")


def percent(share: float) -> str:
    """A share (1 is the whole) as a person reads it, with two digits: ``12 %``."""
    told = 100.0 * share
    return f"{told:.0f} %" if 99.5 <= told < 1e5 else f"{told:.2g} %"


def error_in_words(score: Score) -> str:
    """The error of all windows over the noise, and what share of the measured channel it is: with a quiet sensor, many times the
    noise may be a small share."""
    noise = f"{score.rms:.3g} times the noise"
    share = score.nrmse
    return f"{noise}, {percent(share)} of the {measures(score.observed)}" if np.isfinite(share) else noise


def measures(observed: str) -> str:
    """What a channel measures, in a word."""
    return "force" if observed == "T" else "motion"


def frozen(problem: Problem, theta: Any) -> Problem:
    """The same problem with its parameters fixed at ``theta`` (shapes unchanged, so nothing is compiled anew)."""
    q = problem.directions.shape[1]
    return changed(
        problem, base=problem.parameters(theta), directions=np.zeros(problem.directions.shape), shrink=np.zeros(q, dtype=bool),
        active=np.asarray(0),
    )  # fmt: skip


def begin_anew(problem: Problem, theta: Any) -> Unknowns:
    """Unknowns with starts from the data, as those of a record of which nothing else is known: where a score begins, so that a
    model's error is the same whoever asks for it, whatever its fit has made of the windows."""
    still = frozen(problem, theta)
    system = with_values(problem.system, dict(zip(values(problem.system), np.asarray(still.base))))
    guess = first_guess(changed(still, system=system))
    return Unknowns(np.asarray(theta), guess.starts, guess.coefficients)


def score(
    problem: Problem, unknowns: Unknowns, layout: Layout, *, group: int = 2, through: bool | None = None, may_explain: bool = True
) -> tuple[tuple[Score, ...], Unknowns]:  # fmt: skip
    """Score the parameters of ``unknowns`` on all windows.

    Parameters
    ----------
    problem : windows and system
    unknowns : parameters to judge, and starts near the right ones
    layout : where each record sits
    group : shooting windows per score window
    through : a record is one trajectory, not one anew in every score window; default for a link that is not seen, whose free
        start would hide what the model lacks
    may_explain : whether the model may leave noise alone, so that a side that is not seen is worth looking for further where it
        does not

    Returns
    -------
    one score per record, and the unknowns with the window starts re-estimated
    """
    through = problem.system.observed == "T" if through is None else through
    still = frozen(problem, unknowns.theta)
    tie = np.asarray(problem.windows.tie).copy()
    for first, count in zip(layout.first, layout.windows):
        index = np.arange(count)
        tie[first : first + count] *= through | (index % group != group - 1)
    still = changed(still, windows=changed(still.windows, tie=tie))
    begin = Unknowns(np.zeros(unknowns.theta.shape), unknowns.starts, unknowns.coefficients)
    near = NEAR * max(1, int(problem.windows.used))
    # An error of a model that is clearly wrong is quoted to three digits: its starts need not creep on for a fourth.
    how = Levenberg(atol=near, rtol=CLEARLY, damping=1e-6, limit=BETWEEN if begin.starts.shape[0] == 2 else LAST)
    still = tied(still, JOINED)
    if one_side(problem.system) and may_explain:
        solution = _on_the_right_side(still, begin, how)
    else:
        solution = minimise(still, begin, how)
        if float(solution.stats["promise"]) > FURTHER * float(solution.stats["cost"]):
            solution = minimise(still, minimise(tied(still, LOOSE), begin, how).value, how)
    found, predicted = solution.value, solution.stats["predicted"]
    scores = tuple(_summarise(still, found, predicted, layout, group, i) for i in range(len(layout.first)))
    return scores, Unknowns(unknowns.theta, found.starts, found.coefficients)


def _on_the_right_side(still: Problem, begin: Unknowns, how: Levenberg) -> Minimum:
    """Where ties that grow step by step lead, dry friction as it is or ever harder: where one side is not seen, a window may end
    on the wrong side of an edge, or of a moment at which friction holds. The second way is gone where the first leaves more than
    noise; the better of both is what comes back."""
    slides = sliding_speeds(still)
    found: list[Minimum] = []
    for speeds in ({}, slides) if slides else ({},):
        at = begin
        for tie in np.geomspace(LOOSE, JOINED, 5):
            ended = minimise(with_friction_width(tied(still, tie), speeds, at), at, how)
            at = ended.value
        found.append(ended)
        if 2.0 * float(ended.stats["cost"]) < EXPLAINED * freedom(still, tied=True):
            break
    return min(found, key=lambda m: float(np.nan_to_num(m.stats["cost"], nan=np.inf)))


def _summarise(problem: Problem, found: Unknowns, predicted: Any, layout: Layout, group: int, record: int) -> Score:
    w = problem.windows
    motion, base, tie = (np.asarray(r) for r in kept_residuals(problem, found, predicted))
    at_rest = _spline_residual(w)
    with np.errstate(over="ignore"):  # of a trajectory that ran away
        energy = np.sum(motion**2, axis=1) + np.sum(base**2 - at_rest**2, axis=1) + np.sum(tie**2, axis=1)
    present = np.sum(np.asarray(w.weight) > 0.0, axis=1)

    first, count = layout.first[record], layout.windows[record]
    groups = -(-count // group)
    sums = np.zeros((2, groups))
    np.add.at(sums[0], np.arange(count) // group, energy[first : first + count])
    np.add.at(sums[1], np.arange(count) // group, present[first : first + count])
    states = found.starts.shape[0]
    freedom = sums[1] - states
    usable = freedom >= 4 * states
    if not np.any(usable):
        usable = freedom > 0
    ratio = np.full(groups, np.nan)
    ratio[usable] = np.sqrt(np.maximum(sums[0, usable], 0.0) / freedom[usable])
    samples = layout.samples[record]
    channels = problem.system.channels
    main = len(channels) - 1  # of a drive with two encoders the link's
    flat = lambda a: np.asarray(a)[first : first + count].ravel()[main :: len(channels)][:samples]  # noqa: E731
    t = float(np.asarray(w.t0)[first]) + layout.dt * np.arange(samples)
    return Score(
        rms=float(np.sqrt(np.sum(np.maximum(sums[0, usable], 0.0)) / np.sum(freedom[usable]))),
        median=float(np.median(ratio[usable])),
        window_rms=ratio,
        window_times=t[0] + layout.dt * layout.length * group * np.arange(groups),
        t=t,
        measured=flat(w.measured),
        predicted=flat(predicted.motion),
        residual=-flat(motion),
        length=layout.dt * layout.length * group,
        observed=channels[main],
    )


def _spline_residual(w: Any) -> np.ndarray:
    if not w.intervals:
        return np.asarray(w.input_weight)
    own = np.asarray(w.coefficients)
    following = np.concatenate([own[1:], np.zeros_like(own[:1])])
    local = np.concatenate([own, following[:, : w.basis.shape[2] - w.intervals]], axis=1)
    base = local @ np.asarray(w.shown).T
    return (base - np.asarray(w.input)) * np.asarray(w.input_weight)
