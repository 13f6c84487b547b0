"""Which causes of misfit lie in the record: proposed by the weak form and a linearisation, settled by a fit, told if decisive."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from ..errors import BadInput
from ..fitting.chance import beyond_chance, misses
from ..fitting.estimates import judge
from ..fitting.fit import ABSOLUTE
from ..fitting.result import Fit
from ..fitting.search import silent
from ..parameters import values, with_values
from ..quasistatic import said_of, slow_reading
from ..records import Record
from ..regression.equation_error import Start
from ..shooting.information import inverse_information
from ..system import System
from .bench import Bench, Point
from .cause import Cause
from .kinds import Clock, Delay, Inertia, Kind, Scale, Turned
from .screen import misfit, part_of
from .shown import HeldSamples, HeldStart, Limit, StepChange, stepped
from .words import told

LARGE = 3.0
"""Misfit in noises from which large sizes are looked for: a turned sign, another gear, a lag of many samples miss by more."""
HALVED = 0.5
"""Share of what the weak form leaves that must fall away for a large cause to be worth a search."""
DECISIVE = 10.0
"""Fall of the Bayesian information criterion that is very strong evidence (Kass and Raftery 1995)."""
MOST = 0.995
"""Share of the sum of squares beyond noise that a cause must take away where something else is left beside it: what a gear or a
turned sign does to a fit; a wrong inertia took away 0.97 of a missing resonance."""
PLAIN = 0.03
"""Share of what the weak form leaves from which on a large cause is so plain that no other is looked for."""
WORTH, ASTRAY, UNEVEN = 0.6, 0.95, 1.3
"""Share of the sum of squares that the linearisation may leave; the same where a few windows that have gone astray hold most of
it, as they do where all windows together miss by so many times what the median window does."""
LOOKED, TRIED = 2, 10
"""Causes of a sort that are settled by a search, the likeliest; and how many kinds had their chance to fool us."""


@dataclass(frozen=True)
class Guess:
    """A cause that is likely: its ``size``, the ``system`` to search from if that is far from the fit's, and the share of the
    misfit that it is expected to leave."""

    kind: Kind
    size: float
    system: System | None
    left: float


def find_causes(fit: Fit, progress: Callable[[str, float], None] = silent) -> list[Cause]:
    """What about the record explains that a fit misses it, the most telling first; nothing where that is no more than chance.

    Parameters
    ----------
    fit : a fit, as `jaxbacklash.fit` returns it
    progress : told the stage in words and the share of the work done

    Returns
    -------
    a `Cause` or none; it prints a sentence, and ``remedy`` is what to add to a command

    Examples
    --------
    >>> record, heldout = jb.demo_records()
    >>> late = record.replace(z=np.interp(record.t - 0.004, record.t, record.channels["z"])).between(0.0, 6.0)
    >>> for cause in jb.find_causes(jb.fit(late, inertia=3.16, effects=["gravity"], starts=1)):
    ...     print(cause.sentence)
    z is late by ... ms against x: with that the model misses ... times the noise instead of ...
    """
    if fit.problem is None or fit.unknowns is None or not beyond_chance(fit) or fit.records[0].kind in ("transmitted", "drive"):
        return []
    progress("looking for causes in the record", 0.87)
    slow = slow_reading(fit.records[0], translational=fit.translational) if len(fit.records) == 1 else None
    if slow is not None:
        return [Cause("slow", fit.records[0].observed_name, None, None, "1", fit.score.rms, float("nan"), 0.0, said_of(slow),
                      f"jaxbacklash lost-motion {shlex.quote(fit.records[0].path or 'RECORD')}", certain=False)]  # fmt: skip
    bench = Bench(fit)
    found: list[Cause] = []
    # The surest first: what shows in the samples, then what is large, then what takes the fitted trajectory to see.
    for propose in (_shown, _large, _small):
        guesses = sorted(propose(bench), key=lambda guess: guess.left)
        for guess in guesses[:LOOKED]:
            point = bench.settle(guess.kind, guess.size, guess.system)
            if point is None or abs(point.size - guess.kind.null) < guess.kind.least(fit.records[0]):
                continue
            cause = _judged(bench, guess.kind, point, TRIED)
            if cause is not None:
                found.append(cause)
        if any(cause.certain for cause in found):
            break
    return sorted(found, key=lambda cause: cause.left)[:1]


def _shown(bench: Bench) -> Iterator[Guess]:
    """Causes that can be read off the samples; the weak form tells where to search from."""
    record = bench.fit.records[0]
    if len(bench.fit.records) > 1:  # what shows in one need not be in the others
        return
    for kind in shown_kinds(record):
        for size in kind.coarse(record):
            try:
                start = _screened(bench.fit, kind.corrected(record, size).record)
            except BadInput:  # too little of it is left to be a record
                continue
            yield Guess(kind, float(size), None if start is None else started(bench.fit.system, start), 0.0)


def _large(bench: Bench) -> Iterator[Guess]:
    """Causes so large that the fit went astray: the weak form holds far better on the record without them."""
    fit = bench.fit
    part = part_of(fit.records[0])
    before = _screened(fit, part) if fit.score.rms > LARGE else None
    if before is None:
        return
    for kind in kinds_for(fit):
        tried = []
        for size in kind.coarse(part):
            try:
                start = _screened(fit, kind.corrected(part, size).record)
            except BadInput:  # not even a record any more
                continue
            if start is not None:
                tried.append((start.misfit, float(size), start))
        if not tried:
            continue
        left, size, start = min(tried, key=lambda one: one[0])
        share = left / max(before.misfit, 1e-300)
        if share < HALVED:
            yield Guess(kind, size, started(fit.system, start), share)
        if share < PLAIN:
            return


def _small(bench: Bench) -> Iterator[Guess]:
    """Causes so small that the fit is near its place: by the linearisation."""
    uneven = bench.fit.score.rms > UNEVEN * bench.fit.score.median
    for kind in kinds_for(bench.fit):
        if kind.measured_only and kind.step(bench.fit.records[0]) > 0.0:
            fall, size, _ = bench.parabola(kind, kind.null, bench.problem, bench.unknowns)
            left = max(1.0 - fall / (2.0 * bench.fit.cost), 0.0)
            if fall > DECISIVE and left < (ASTRAY if uneven else WORTH):
                yield Guess(kind, size, None, left)


def _screened(fit: Fit, record: Record) -> Start | None:
    known = None if "inertia" in fit.free else float(fit.system.inertia)
    return misfit(record, known, fit.system.has_play, fit.system.contact is not None, list(fit.system.effects.values()))


def shown_kinds(record: Record) -> list[Kind]:
    """Kinds of cause that can be seen in the samples."""
    own = record.observed_name
    found: list[Kind] = [HeldSamples(own), HeldStart(own)]
    for channel in (own, *(c for c in ("x",) if c in record.channels)):
        at = stepped(record, channel)
        if at is not None:
            found.append(StepChange(channel, at=at))
    return found


def kinds_for(fit: Fit) -> list[Kind]:
    """Kinds of cause whose size is searched for, the quickest first."""
    record = fit.records[0]
    own = record.observed_name
    if record.kind == "free_decay":
        return []
    found: list[Kind] = []
    if record.kind == "base_motion":
        found += [Turned(own)]
    elif record.kind == "force":
        found += [Turned("F"), *([Inertia("F", given=float(fit.system.inertia))] if "inertia" not in fit.free else [])]
    found += [Delay(own), Clock(own)]
    if record.kind == "base_motion":
        found += [Delay("y", mixed=True), Clock("y", mixed=True)] if own == "z" else []
        found += [Scale("x")]
    return found if record.kind == "base_motion" else [*found, Limit("F")]


def started(system: System, start: Start) -> System:
    """A system at the values of a weak-form estimate."""
    present = values(system)
    own = {"inertia": start.inertia, "backlash": start.backlash, "stiffness": start.stiffness, "damping": start.damping}
    moved = with_values(system, {n: v for n, v in own.items() if v is not None and n in present})
    return moved.with_effects(*start.effects) if start.effects else moved


def _judged(bench: Bench, kind: Kind, point: Point, tried: int) -> Cause | None:
    """The cause, if it is decisive: the criterion falls clearly, and what is left is noise, or a small part of what there was."""
    fit = bench.fit
    scores = bench.score(point)
    left, before = max(s.rms for s in scores), max(s.rms for s in fit.scores)
    noise = kind.noise(fit.records[0], int(point.size)) if isinstance(kind, HeldSamples) else fit.noise[0]
    before = before * fit.noise[0] / noise
    explained = not any(misses(s, len(fit.system.state_names)) for s in scores)
    fall = (before**2 / max(left, 1.0) ** 2 - 1.0) * point.freedom
    demanded = np.log(point.freedom) + 2.0 * np.log(max(tried, 1)) + DECISIVE
    taken = 1.0 - max(left**2 - 1.0, 0.0) / max(before**2 - 1.0, 1e-12)
    if not (fall > demanded and (explained or taken > MOST)):
        return None
    excess = max(1.0, left**2)
    scale = np.sum(np.asarray(point.problem.directions), axis=0)
    covariance = excess * inverse_information(point.schur) * np.outer(scale, scale)
    stderr = dict(zip(fit.free, np.sqrt(np.maximum(np.diag(covariance), 0.0))))
    records = [one.record for one in bench.corrected(kind, point.size)]
    per_inertia = fit.per_inertia and fit.records[0].kind not in ABSOLUTE
    estimates = judge(point.system(), fit.free, stderr, records, per_inertia=per_inertia, translational=fit.translational)
    return told(kind, point, np.sqrt(excess) * point.stderr, before, left, fall, explained, estimates, records[0], fit)
