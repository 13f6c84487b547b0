"""The loop: fit the joint, see what it leaves, add what explains it, check again, and say when to stop."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import equinox as eqx
import numpy as np

from ..errors import BadInput
from ..fitting.answers import check_answers
from ..fitting.chance import explains
from ..fitting.counts import few_counts
from ..fitting.equation_error import Start
from ..fitting.estimates import inflation, judge
from ..fitting.fit import ABSOLUTE, prepare
from ..fitting.left_over import predict, why_open
from ..fitting.problem import Problem, Unknowns
from ..fitting.result import Fit
from ..fitting.score import Score
from ..fitting.search import TIES, inverse_information, silent
from ..fitting.setup import base_system, free_names
from ..fitting.size import check_size
from ..fitting.stick_slip import correlation
from ..fitting.windows import Windows
from ..precision import require_double_precision
from ..records import Record, oriented
from ..records.force import tell_way
from ..system import System
from .bounded import bounded
from .either import either
from .evidence_search import EvidenceSearch
from .experiment import separate
from .foresight import Foresight
from .laws_for import laws_for
from .model_fitter import ModelFitter
from .refinement import Refinement
from .search import Search
from .steps import Stage
from .unnamed import unnamed
from .verdict import judge_rest
from .workbench import Trial, Workbench, adequate, pruned

ENGINES = ("windows", "evidence")
SEPARATED = 2
"""Alternatives for which an experiment is looked for."""


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
    engine: str = "windows",
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
    seed : changes nothing, and is taken as `fit` takes it: the search draws nothing at random. It begins at one estimate, and the
        noise under which it tries a promise or an experiment out is the same in every run
    progress : told the stage in words and the share of the work done
    settled : told a model that leaves but noise as soon as it is scored, while the search still looks for more, and at last the
        model kept, unless that was the last it was told; that once more, if others do as well, with intervals that allow for them
    engine : ``"windows"``, or ``"evidence"``, which fits each model together with the size of the torque it leaves out
        (`criticism.evidence_search`) and is to replace the other

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
    if heldout is not None and heldout.kind != record.kind:
        raise BadInput(f"{heldout.path}: is a {heldout.kind} record, {record.path} a {record.kind} record; wanted two of a kind")
    clock = {"start": time.perf_counter()}
    progress("reading noise and a first estimate", 0.02)
    start = None
    if system is None:
        system, names, start = base_system(record, model, inertia)
    else:
        names, model = free_names(system), "given"
    if engine not in ENGINES:
        raise BadInput(f"engine {engine!r}: wanted one of {', '.join(ENGINES)}")
    bench = (ModelFitter if engine == "evidence" else Workbench)(record, system, names, window, beside=heldout)
    bench.take_laws(laws_for(system, translational=translational))
    per_inertia = inertia is None and record.kind not in ABSOLUTE and model != "given"
    judged = _Judge(bench, heldout, model, per_inertia, translational, start, settled)
    clock["prepare"] = time.perf_counter()
    search: Search | EvidenceSearch
    if isinstance(bench, ModelFitter):
        search = EvidenceSearch(bench, progress)
        steps = bounded(search)
    else:
        with Foresight(bench) as ahead:
            search = Search(bench, progress, ahead.member, judged.tell)
            steps = bounded(search)
    clock["search"] = time.perf_counter()

    progress("scoring predictions", 0.85)
    last = judged.tell(steps[-1].trial)
    told, last = last, either(last, steps[-1].trial, tuple(search.level.values()))
    if last is not told:
        settled(last)
    fits = [*(judged(s.trial) for s in steps[:-1]), last]
    stages = tuple(Stage(s.added, s.dropped, fit, s.ranking, s.evidence, s.refits) for s, fit in zip(steps, fits))
    clock["score"] = time.perf_counter()
    others = tuple(sorted(search.level, key=lambda names: search.level[names].criterion))
    verdict = judge_rest(steps[-1].trial, [s.fit for s in stages], unnamed(bench, steps[-1].trial))
    verdict = replace(verdict, text=f"{verdict.text} {few_counts(last)}".rstrip())
    experiments = []
    for names in others[:SEPARATED]:
        progress(f"looking for an experiment that separates {' + '.join(names)}", 0.88)
        experiments.append(separate(bench, steps[-1].trial, search.level[names], translational=translational))
    clock["experiment"] = time.perf_counter()
    marks = list(clock.items())
    seconds = {name: at - before for (_, before), (name, at) in pairwise(marks)}
    return Refinement(stages, others, verdict, seconds, tuple(e for e in experiments if e is not None))


class _Judge:
    """Makes a `Fit`, with scores and intervals, of every model kept."""

    def __init__(
        self, bench: Workbench, heldout: Record | None, model: str, per_inertia: bool, translational: bool, start: Start | None,
        settled: Callable[[Fit], object],
    ) -> None:  # fmt: skip
        self.bench, self.heldout, self.model = bench, heldout, model
        self.per_inertia, self.translational, self.start = per_inertia, translational, start
        self.settled = settled
        self.told: tuple[Trial, Windows, Fit] | None = None

    def tell(self, trial: Trial) -> Fit:
        """The fit of a model that is likely the last, told at once, or that is the last: told unless it was the last one told."""
        # Windows that were cut or weighed anew make another fit of the same model.
        if self.told is None or self.told[0] is not trial or self.told[1] is not self.bench.windows:
            fit = self(trial)
            self.told = trial, self.bench.windows, fit
            self.settled(fit)
        return self.told[2]

    def __call__(self, trial: Trial) -> Fit:
        bench = self.bench
        problem, free = bench.problem(bench.effects(trial), trial.system)
        still = Unknowns(np.zeros(problem.directions.shape[1]), trial.unknowns.starts, trial.unknowns.coefficients)
        scored = (bench.scored(trial),)
        held = None if self.heldout is None else self._predict(problem)
        q = len(free)
        scales = trial.scales[:q]
        runs = bench.grips(trial.names) and not adequate(trial)
        left = scored[0].residual
        pieces = correlation(left, np.ones(left.size)) if runs else 1.0
        excess = inflation(trial.misfit, scored[0].rms, tied=trial.tied, correlation=pieces)
        covariance = excess * inverse_information(trial.schur[:q, :q]) * np.outer(scales, scales)
        stderr = dict(zip(free, np.sqrt(np.maximum(np.diag(covariance), 0.0))))
        plain = pruned(trial)
        records = (bench.record,)
        estimates = judge(
            plain, free, stderr, records, per_inertia=self.per_inertia, translational=self.translational,
            covariance=covariance, explained=explains(scored, plain),
        )
        joined = eqx.tree_at(lambda p: p.tie, problem, np.asarray(TIES[0][-1] if trial.tied else 0.0))
        return Fit(
            plain, free, estimates, scored, held, records, bench.layout.noise, bench.layout.input_noise, covariance, 0, 0,
            trial.tied, trial.cost, trial.steps, self.start, self.model, self.per_inertia, self.translational, {}, joined, still,
            (why_open(bench.record, bench.layout.noise[0], scored[0]),), (bench.layout.noise[0] / bench.noise_factor,),
        )  # fmt: skip

    def _predict(self, problem: Problem) -> Score:
        assert self.heldout is not None
        bench = self.bench
        prepared = prepare(
            bench.pace, [self.heldout], bench.window, intervals=bench.windows.intervals, shooting=bench.shooting
        )
        known = bench.noise_factor, bench.layout.noise[0]
        return predict(lambda windows: eqx.tree_at(lambda p: p.windows, problem, windows), prepared, self.heldout, known)[0]
