"""The fit: from records and a model to parameters with intervals, and how well the model predicts."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise

import equinox as eqx
import numpy as np

from ..effects import Servo
from ..errors import BadInput, NoAnswer
from ..mechanics import AbstractEffect
from ..one_encoder import one_side
from ..parameters import values, with_values
from ..precision import require_double_precision
from ..records import Record, oriented
from ..records.force import tell_way
from ..records.relative_motion import check_answers
from ..records.size import check_size
from ..regression.equation_error import Start
from ..shooting.lengths import HELD_WINDOW, PANELS, longest_panel, score_window, shooting_window
from ..shooting.windows import Layout, Windows, crossing_time, cut
from ..system import System
from .chance import explains, joined
from .estimates import UNDETERMINED, Estimate, inflation, judge
from .hard import contact_samples, harder, most_play, travel_in_contact
from .left_over import predict, settle_noise, why_open
from .profile import with_profiles
from .result import Fit
from .score import Score, begin_anew, score
from .search import Found, search, silent
from .settings import EXPLAINED, SHORTEST
from .setup import as_stiff_as_can_be, base_system, check_motion, free_names, make_problem
from .stick_slip import sticks_and_slips

ABSOLUTE = ("force", "transmitted", "drive")
"""Kinds of record with a measured force, which need no inertia to tell a stiffness."""


def fit(
    records: Record | Sequence[Record],
    *,
    model: str = "joint",
    inertia: float | None = None,
    effects: Sequence[AbstractEffect | str] = (),
    system: System | None = None,
    free: Sequence[str] | None = None,
    heldout: Record | None = None,
    window: float | None = None,
    starts: int = 4,
    spare_starts: bool = False,
    seed: int = 0,
    translational: bool = False,
    profile: bool = False,
    progress: Callable[[str, float], None] = silent,
) -> Fit:
    """Fit a model to one or more records: play, stiffness and damping, with what else is asked for, and how well it predicts.

    Parameters
    ----------
    records : records of one kind and rate; parameters are shared
    model : ``"joint"``, ``"linear"`` or ``"free"``; ignored when ``system`` is given
    inertia : J [kg m^2]; None: fitted to force-driven records, else values are per unit inertia, of a servo's command the motor's
    effects : effects added to the base model, as they are or by canonical name
    system : a system to start from instead of an estimate from the data
    free : names of the free parameters; default all but the inertia and numerical settings
    heldout : a record to predict with the fitted parameters frozen
    window : length of the windows whose error is quoted [s]; default 0.2 s, or 32 samples where that is longer
    starts : how many starting points are tried (the first is the equation-error estimate)
    spare_starts : try the others only where the first does not lead to one trajectory that leaves noise alone
    seed : seed of the further starting points
    translational : units of a translating mass
    profile : intervals from the profile likelihood instead of the curvature at the minimum
    progress : told the stage in words and the share of the work done

    Returns
    -------
    Fit
        It prints itself, and shows a table and a picture in a notebook. What a program reads:

        * ``parameters["backlash"]``, by name, are `Estimate`: ``value``, ``stderr`` and ``ci95`` in ``unit``. ``value`` is None,
          with ``why``, where the record does not determine it. ``backlash`` is the total play.
        * ``score.rms`` is the prediction error over the noise, 1.00 where noise alone is left; ``score.median`` that of the
          median window; ``score.t``, ``measured``, ``predicted`` and ``residual`` (N,) are the record beside the model.
        * ``heldout.rms`` is the same on the held-out record, ``heldout`` None without one.
        * ``adequate`` tells whether noise would leave as much: if it does not, something is missing (`where_it_fails`,
          `rank_effects`, `refine`), and standard errors hold only if the model were right.
        * ``system`` is the fitted model, for `compare`, `simulate` and `dump_model`; ``noise`` what the sensors add, per record.
        * ``to_dataframe()`` and ``to_dataset()`` are parameters and record as pandas and xarray have them; ``jb.plot.fit(fit)``,
          ``jb.plot.residuals(fit)`` and ``jb.plot.restoring_force(fit)`` its pictures.

    Raises
    ------
    BadInput
        Records that cannot carry the model.
    NoAnswer
        No start led to a finite minimum.
    RuntimeError
        JAX is in single precision.

    Examples
    --------
    >>> record, heldout = jb.demo_records()
    >>> fit = jb.fit(record, inertia=3.16, effects=["gravity"], heldout=heldout, starts=1)
    >>> play = fit.parameters["backlash"]
    >>> round(play.value, 4), play.unit, bool(play.stderr < 1e-5)
    (0.0262, 'rad', True)
    >>> fit.adequate, round(fit.score.rms, 1), round(fit.heldout.rms, 1)
    (True, 1.0, 1.0)
    """
    require_double_precision("fit")
    chosen = tuple(oriented(r) for r in ((records,) if isinstance(records, Record) else records))
    check_size(chosen)
    check_answers(chosen)
    tell_way(chosen)
    clock = {"start": time.perf_counter()}
    progress("reading noise and a first estimate", 0.02)
    start: Start | None = None
    if system is None:
        system, names, start = base_system(chosen[0], model, inertia, effects)
    else:
        names, model = free_names(system), "given"
    check_motion(system, translational=translational)
    names = tuple(free) if free is not None else names
    windows, layout, group = prepare(system, chosen, window)
    alone = layout.noise
    clock["cut"] = time.perf_counter()

    found = search(system, windows, names, starts=starts, spare=spare_starts, seed=seed, rough=start is None, progress=progress)
    if not found.tied and system.has_play and system.motor is None and not sticks_and_slips(system):
        begun = system, windows, layout, group
        found, (system, windows, layout, group) = _harder(found, begun, chosen, names, window, seed, progress)
    clock["search"] = time.perf_counter()
    progress("scoring predictions", 0.85)
    problem, unknowns = found.problem, found.unknowns
    fitted = with_values(system, dict(zip(values(system), np.asarray(problem.parameters(unknowns.theta)))))

    scored, at = score(problem, begin_anew(problem, unknowns.theta), layout, group=group)
    if not sticks_and_slips(system):
        settled = settle_noise(found, layout, scored, at, chosen, group)
        if settled.found is not found:
            found, layout, scored = settled.found, settled.layout, settled.scored
            problem, unknowns = found.problem, found.unknowns
            fitted = with_values(system, dict(zip(values(system), np.asarray(problem.parameters(unknowns.theta)))))
    if one_side(system) and found.tied:
        # A motion that the fit has found is one, whether a score from nothing finds it or not.
        scored = min(scored, score(problem, unknowns, layout, group=group)[0], key=lambda told: told[0].rms)
    unknown_noise = tuple(why_open(*own) for own in zip(chosen, layout.noise, scored))
    known = (layout.noise[0] / alone[0], layout.noise[0])
    held = predict_record(fitted, heldout, window=window, free=names, known=known) if heldout is not None else None
    clock["score"] = time.perf_counter()

    excess = inflation(found.misfit, scored[0], tied=found.tied, one_run=sticks_and_slips(system))
    covariance = excess * found.covariance
    stderr = dict(zip(names, np.sqrt(np.diag(covariance))))
    per_inertia = inertia is None and scale_open(chosen[0], fitted)
    estimates = judge(
        fitted, names, stderr, chosen, per_inertia=per_inertia, translational=translational, covariance=covariance,
        explained=explains(scored, fitted) and joined(found.tied, fitted),
        stiffest=as_stiff_as_can_be(problem, fitted, names),
    )  # fmt: skip
    if not sticks_and_slips(system) and contact_samples(fitted, chosen[0].dt) < SHORTEST:
        estimates |= _between_samples(estimates, fitted, chosen, missed=scored[0].rms > EXPLAINED)
    if profile:
        estimates = with_profiles(problem, unknowns, estimates, names, stderr, progress)
    marks = list(clock.items())
    return Fit(
        fitted, names, estimates, scored, held, chosen, layout.noise, layout.input_noise, covariance,
        found.agreeing, found.tried, found.tied, found.cost, found.steps, start, model, per_inertia, translational,
        {name: at - before for (_, before), (name, at) in pairwise(marks)}, problem, unknowns,
        unknown_noise, alone,
    )  # fmt: skip


def scale_open(record: Record, system: System) -> bool:
    """Whether nothing in a record sets the scale of torques, where no inertia was given: it has no force, or it is of a servo's
    command and the motor's inertia stands at 1."""
    unscaled = record.input_name == "command" and math.isclose(system.motor.motor_inertia, 1.0)  # type: ignore[union-attr]
    return record.kind not in ABSOLUTE or unscaled


def _harder(
    found: Found, begun: tuple[System, Windows, Layout, int], records: Sequence[Record], names: Sequence[str],
    window: float | None, seed: int, progress: Callable[[str, float], None],
) -> tuple[Found, tuple[System, Windows, Layout, int]]:  # fmt: skip
    """A search that has ended short of the noise, or another from contacts of less than a sample where that ends nearer."""
    system = begun[0]
    ended = with_values(system, dict(zip(values(system), np.asarray(found.problem.parameters(found.unknowns.theta)))))
    if contact_samples(ended, records[0].dt) > 2.0 * SHORTEST:
        return found, begun
    progress("fitting again, from a hard contact", 0.7)
    begin = harder(ended, records)
    again = prepare(begin, records, window)
    try:
        other = search(begin, again[0], names, starts=1, seed=seed, rough=False, progress=progress)
    except NoAnswer:
        return found, begun
    return (other, (begin, *again)) if other.misfit < found.misfit else (found, begun)


def _between_samples(
    estimates: dict[str, Estimate], system: System, records: Sequence[Record], *, missed: bool
) -> dict[str, Estimate]:
    """What is not told where contacts lie between the samples: the play by the travel in one, and where they are ``missed`` not
    at all; and the damping, for which is taken what contacts lose."""
    where = "contacts lie between the samples"
    why = {}
    open_play = 0.5 * max(travel_in_contact(system, r) for r in records)
    wider = {
        name: replace(one, stderr=float(np.hypot(one.stderr, open_play)))
        for name, one in estimates.items()
        if name == "backlash" and one.stderr is not None
    }
    if (damping := estimates.get("damping")) and damping.value is not None:
        why["damping"] = f"{where}, and what they lose is taken for it, which comes to {damping.value:.2g} {damping.unit}"
    if missed and (play := estimates.get("backlash")):
        most = max(most_play(r) for r in records)
        why["backlash"] = f"{where}, and the model misses them: at most {most:.3g} {play.unit}, the range of z"
    return wider | {
        name: replace(estimates[name], value=None, stderr=None, verdict=UNDETERMINED, why=said) for name, said in why.items()
    }


def prepare(
    system: System, records: Sequence[Record], window: float | None, *, intervals: int = 0
) -> tuple[Windows, Layout, int]:
    """Shooting windows for a system like this one, and how many of them make a score window of the wished length.

    ``intervals`` asks for at least so many spline intervals a window, so that two records may share a compiled program.
    """
    dt, driver, servo = records[0].dt, records[0].input_name, isinstance(system.motor, Servo)
    if records[0].kind == "drive" and servo != (driver == "command"):
        told = "of a motor with a servo, which is told a command" if servo else "not of a motor with a servo (Kp, Kd)"
        raise BadInput(f"{records[0].path or 'the record'}: drives by {driver}, and the model is {told}; wanted one of a kind")
    window = score_window(dt, window)
    # Without the noise of a base motion a record says ten times more: its panels have to be finer.
    noisy = driver == "torque" or records[0].kind == "base_motion"
    finer = 1.0 if noisy else 2.0
    longest = longest_panel(dt) / finer
    if system.contact is not None:
        # Thirty-two panels a period of the contact resonance keep the integration error a thousandth of an encoder's noise.
        period = 2.0 * np.pi / max(float(system.pace), 1e-9)
        # A first guess of the play may be far too small, so that there is an end to what it may ask for.
        play = float(getattr(system.contact, "backlash", 0.0))  # a plain spring has none
        crossing = min(crossing_time(r, play, period / 16.0) for r in records)
        longest = min(longest, max(min(period / (32.0 * finer), max(crossing, period / 256.0)), dt / PANELS))
    # Each sample of a held torque is an unknown of its window: the shorter windows are, the less work.
    length = HELD_WINDOW * dt if driver == "torque" else shooting_window(window)
    windows, layout = cut(records, length, longest_panel=longest, least=intervals)
    if system.observed == "T" and system.contact is not None:
        # Ties are of motion: the noise of a force counts as the motion that would make it in contact.
        windows = eqx.tree_at(lambda w: w.drop, windows, windows.drop * float(system.contact.stiffness))
    return windows, layout, max(1, round(window / (layout.length * layout.dt)))


def predict_record(
    system: System, record: Record, *, window: float | None = None, free: Sequence[str] | None = None,
    known: tuple[float, float] = (1.0, 0.0),
) -> Score:  # fmt: skip
    """Score a system with frozen parameters on a record it may never have seen, window starts re-estimated.

    ``free`` only sets how many directions the problem carries, so that the program compiled for a fit serves again.
    ``known`` is what a fit to another record of the joint has told of the noise: by which factor it was below what the samples
    alone said, and its standard deviation.

    Returns
    -------
    `Score`: its ``rms`` is the error of all windows over the noise, ``predicted`` (N,) the prediction

    Examples
    --------
    >>> record, heldout = jb.demo_records()
    >>> fit = jb.fit(record.between(0.0, 2.0), inertia=3.16, starts=1)
    >>> score = jb.predict_record(fit.system, heldout.between(0.0, 2.0))
    >>> score.predicted.shape
    (1001,)
    """
    return predict_with_noise(system, record, window=window, free=free, known=known)[0]


def predict_with_noise(
    system: System, record: Record, *, window: float | None = None, free: Sequence[str] | None = None,
    known: tuple[float, float] = (1.0, 0.0),
) -> tuple[Score, float]:  # fmt: skip
    """`predict_record`, and the standard deviation of the noise that the record is taken to have, in its unit."""
    require_double_precision("predict_record")
    record = oriented(record)
    names = free_names(system) if free is None else free
    return predict(lambda windows: make_problem(system, windows, names), prepare(system, [record], window), record, known)
