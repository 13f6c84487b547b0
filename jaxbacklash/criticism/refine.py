"""The loop: fit the joint, see what it leaves, add what explains it, check again, and say when to stop."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import equinox as eqx
import numpy as np

from ..errors import BadInput
from ..fitting.chance import explains
from ..fitting.continuation import tied
from ..fitting.counts import few_counts
from ..fitting.estimates import inflation, judge
from ..fitting.fit import prepare, scale_open
from ..fitting.left_over import predict, why_open
from ..fitting.result import Fit
from ..fitting.score import Score
from ..fitting.search import silent
from ..fitting.settings import EXPLAINED
from ..fitting.setup import as_stiff_as_can_be, base_system, free_names
from ..precision import require_double_precision
from ..records import Record, oriented
from ..records.findings.wide_play import wide_play
from ..records.force import tell_way
from ..records.relative_motion import check_answers
from ..records.size import check_size
from ..regression.equation_error import Start
from ..shooting.information import inverse_information
from ..shooting.problem import Problem, Unknowns
from ..system import System
from .evidence_search import EvidenceSearch
from .experiment import separate
from .fitted_model import FittedModel
from .laws_for import laws_for
from .model_averaging import averaged
from .model_fitter import ModelFitter
from .refinement import Refinement
from .steps import Stage
from .unnamed import unnamed
from .verdict import borne_out, judge_rest, not_added


def refine(
    record: Record,
    *,
    heldout: Record | None = None,
    model: str = "joint",
    inertia: float | None = None,
    system: System | None = None,
    window: float | None = None,
    translational: bool = False,
    seed: int = 0,
    progress: Callable[[str, float], None] = silent,
    settled: Callable[[Fit], object] = lambda fit: None,
) -> Refinement:
    """Find the effects that a record needs beyond its base model.

    Parameters
    ----------
    record : what was measured
    heldout : a record of the same joint that is only predicted
    model : ``"joint"``, ``"linear"`` or ``"free"``; ignored when ``system`` is given
    inertia : J [kg m^2]; None: fitted to force-driven records, else values are per unit inertia
    system : a system to start from instead of an estimate from the data
    window : length of the windows whose error is quoted [s]; default 0.2 s, or 32 samples where that is longer
    translational : units of a translating mass
    seed : changes nothing, and is taken as `fit` takes it: the search draws nothing at random, and the noise under which it tries
        an experiment out is the same in every run
    progress : told the stage in words and the share of the work done
    settled : told the model kept as soon as it is scored; that once more, if others do as well, with intervals that allow for
        them

    Returns
    -------
    `Refinement`: prints itself; ``effects`` that were missing, ``alternatives``, ``verdict``, and ``fit``, the model kept

    Raises
    ------
    BadInput
        Records that cannot carry the model.
    RuntimeError
        JAX is in single precision.

    Examples
    --------
    >>> record, heldout = jb.demo_records()
    >>> found = jb.refine(record, heldout=heldout, inertia=3.16)
    >>> found.effects, found.verdict.word
    (('gravity',), 'complete')
    """
    require_double_precision("refine")
    record = oriented(record)
    heldout = None if heldout is None else oriented(heldout)
    check_size([record] if heldout is None else [record, heldout])
    check_answers([record])
    tell_way([record] if heldout is None else [record, heldout])
    if heldout is not None and (heldout.kind, heldout.input_name) != (record.kind, record.input_name):
        raise BadInput(f"{heldout.path}: is a {heldout.kind} record, {record.path} a {record.kind} record; wanted two of a kind")
    clock = {"start": time.perf_counter()}
    progress("reading noise and a first estimate", 0.02)
    start = None
    if system is None:
        system, names, start = base_system(record, model, inertia)
    else:
        names, model = free_names(system), "given"
    fitter = ModelFitter(record, system, names, window, beside=heldout)
    fitter.take_laws(laws_for(system, translational=translational))
    told = model == "given" and record.input_name != "command"
    per_inertia = inertia is None and not told and scale_open(record, system)
    judged = _Judge(fitter, heldout, model, per_inertia, translational, start)
    clock["prepare"] = time.perf_counter()
    search = EvidenceSearch(fitter, progress)
    steps = search.run()
    clock["search"] = time.perf_counter()

    progress("scoring predictions", 0.85)
    fits = [judged(step.model) for step in steps]
    against = ""
    if (count := borne_out(fits)) < len(fits):
        refused = sorted(steps[-1].model.names - steps[count - 1].model.names)
        against = not_added(fits[count - 1], fits[-1], refused)
        search.level, steps, fits = {}, steps[:count], fits[:count]
    kept = steps[-1].model
    settled(fits[-1])
    last = averaged(fits[-1], kept, tuple(search.level.values()))
    if last is not fits[-1]:
        settled(last)
    fits[-1] = last
    stages = tuple(Stage(s.added, s.dropped, fit, s.ranking, s.evidence, s.refits) for s, fit in zip(steps, fits))
    clock["score"] = time.perf_counter()
    others = tuple(sorted(search.level, key=lambda names: search.level[names].criterion))
    verdict = judge_rest(kept, [s.fit for s in stages], unnamed(fitter, kept))
    said = (verdict.text, against, few_counts(last), wide_play(last))
    verdict = replace(verdict, text=" ".join(part for part in said if part))
    experiments = []
    for names in others[:2]:
        progress(f"looking for an experiment that separates {' + '.join(names)}", 0.88)
        experiments.append(separate(fitter, kept, search.level[names], translational=translational))
    clock["experiment"] = time.perf_counter()
    marks = list(clock.items())
    seconds = {name: at - before for (_, before), (name, at) in pairwise(marks)}
    return Refinement(stages, others, verdict, seconds, tuple(e for e in experiments if e is not None))


class _Judge:
    """Makes a `Fit`, with scores and intervals, of every model kept."""

    def __init__(
        self, fitter: ModelFitter, heldout: Record | None, base: str, per_inertia: bool, translational: bool, start: Start | None
    ) -> None:
        self.fitter, self.heldout, self.base = fitter, heldout, base
        self.per_inertia, self.translational, self.start = per_inertia, translational, start

    def __call__(self, model: FittedModel) -> Fit:
        fitter = self.fitter
        problem, free = fitter.problem(fitter.effects(model), model.system)
        still = Unknowns(np.zeros(problem.directions.shape[1]), model.unknowns.starts, model.unknowns.coefficients)
        scored = (fitter.scored(model),)
        held = None if self.heldout is None else self._predict(problem, may_explain=model.misfit < EXPLAINED)
        q = len(free)
        scales = model.scales[:q]
        excess = inflation(model.misfit, scored[0], tied=model.tied, one_run=fitter.grips(model.names))
        covariance = excess * inverse_information(model.information[:q, :q]) * np.outer(scales, scales)
        stderr = dict(zip(free, np.sqrt(np.maximum(np.diag(covariance), 0.0))))
        system = model.pruned
        records = (fitter.record,)
        estimates = judge(
            system,
            free,
            stderr,
            records,
            per_inertia=self.per_inertia,
            translational=self.translational,
            covariance=covariance,
            explained=explains(scored, system),
            stiffest=as_stiff_as_can_be(problem if model.found is None else model.found.problem, system, free),
        )
        joined = tied(problem, model.tie if model.tied else 0.0)
        noise = fitter.layout.noise
        return Fit(
            system, free, estimates, scored, held, records, noise, fitter.layout.input_noise, covariance, 0, 0, model.tied,
            model.cost, model.steps, self.start, self.base, self.per_inertia, self.translational, {}, joined, still,
            (why_open(fitter.record, noise[0], scored[0]),), (noise[0] / fitter.noise_factor,),
        )  # fmt: skip

    def _predict(self, problem: Problem, *, may_explain: bool) -> Score:
        assert self.heldout is not None
        fitter = self.fitter
        prepared = prepare(fitter.pace, [self.heldout], fitter.window, intervals=fitter.quoted[0].intervals)
        known = fitter.noise_factor, fitter.layout.noise[0]
        make = lambda windows: eqx.tree_at(lambda p: p.windows, problem, windows)  # noqa: E731
        return predict(make, prepared, self.heldout, known, may_explain=may_explain)[0]
