r"""Linear screening: what each absent law promises beside a fitted model, without fitting it.

Two tests, both of a linear model at the torque left out that the model was fitted with, so that the whole catalogue costs less
than one fit:

* the score test of laws that remember nothing, along the fitted trajectory: with the information S and the score g of all
  columns, windows marginalised, a law is predicted to lower twice the cost by :math:`g^T S^{-1} g` more than the model's own
  parameters would (Rao 1948);
* laws that remember have no sensitivity at strength zero. Their shapes are tuned by weak-form regression on the measured motion
  (`tuning`), and what they bring is told by their torque along the fitted motion (`force_test`).

`evidence_search` fits those that promise most.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from ..fitting.settings import PROMISING, SEEN
from ..mechanics import canonical_name
from ..parameters import free_specs, values
from ..regression.tuning import tune
from ..system import System
from .candidates import Candidate, score_test, share_of_rest
from .evidence import leaves_noise, measures_only
from .fitted_model import FittedModel
from .force_test import ForceTest
from .model_fitter import ModelFitter
from .moves import give_way


def screen(fitter: ModelFitter, model: FittedModel, barred: Iterable[str] = ()) -> list[Candidate]:
    """Absent laws with their predicted gains, the most promising first.

    Parameters
    ----------
    fitter : of the record
    model : a fitted model
    barred : laws that are not asked

    Returns
    -------
    list of Candidate
        ``gain`` is the predicted fall of minus twice the log evidence, deflated where the model's residual is no noise, and no
        more than a model that leaves something leaves: a linear promise of a law far from null may be larger.
    """
    absent = [n for n in fitter.laws if n not in model.names and n not in set(barred)]
    if (outright := [n for n in fitter.outright if n in absent]) and not fitter.grips(model.names):
        # A link that floats says nothing of one that is held: friction at the ground is fitted, whatever the others promise.
        return [Candidate(n, fitter.laws[n](), np.inf, 1.0, {}) for n in outright]
    static = score_test(fitter, model, [n for n in absent if n in fitter.static])
    most = np.inf if leaves_noise(model) else model.rest / model.deflation
    found = [replace(c, gain=min(c.gain, most)) for c in (*static, *_remembering(fitter, model, absent, static))]
    return sorted(found, key=lambda c: -net_gain(c, fitter))


def net_gain(candidate: Candidate, fitter: ModelFitter) -> float:
    """The predicted fall of the criterion by a candidate: its gain less ln N for each of its parameters."""
    return candidate.gain - candidate.parameters * float(np.log(fitter.record.samples))


def _remembering(fitter: ModelFitter, model: FittedModel, absent: Sequence[str], static: Sequence[Candidate]) -> list[Candidate]:
    """Laws that remember, those left out that bring no more than a simpler law that they come near to.

    Their shapes are tuned on the measured motion beside the model, without what would give way to them; what they bring is told
    by their torque along the fitted motion, in the place of that.
    """
    form, found = fitter.weak_form, []
    test: ForceTest | None = None
    promised = {c.name: net_gain(c, fitter) for c in static}
    asked = {n: _Remembering(fitter, model, n) for n in absent if fitter.laws[n].states and not form.blind}
    # What promises little at all of the shapes it is begun with, beside what another law that remembers does, is not tuned.
    least = max(SEEN, PROMISING * max((one.evidence for one in asked.values()), default=0.0))
    for name, one in asked.items():
        gone, system, free, shapes = one.gone, one.system, one.free, one.shapes
        moved: dict[str, float] = {}
        begun: np.ndarray | None = None
        if measures_only(fitter.laws[name]):
            test = test or ForceTest(fitter, model)
            gain, effect = test.best_shown(shapes)
        elif one.evidence < least:
            continue
        else:
            test = test or ForceTest(fitter, model)
            tuned = tune(form, system, free, shapes)
            others = [tuned.effect] if tuned.effect.simpler() else [*shapes, tuned.effect]
            begun = np.stack([form.begun(e, system, free) for e in others]) if tuned.effect.rings else None
            gain, effect, kept = test.best(others, [model.system.effects[n] for n in gone], begun)
            begun = None if begun is None else begun[kept]
            moved = {n: v for n, v in values(tuned.system).items() if n in free}
        near = [n for law in effect.simpler() if (n := canonical_name(type(law))) in fitter.laws]
        less = sum(len(free_specs(model.system.effects[n])) for n in gone) * float(np.log(fitter.record.samples))
        candidate = Candidate(name, effect, gain / model.deflation + less, share_of_rest(model, gain), moved, begun)
        if net_gain(candidate, fitter) > max((promised[n] for n in near if n in promised), default=-np.inf):
            found.append(candidate)
    return found


class _Remembering:
    """A law that remembers beside a model without what would give way to it: its ``shapes``, and the weak form's ``evidence`` for
    the likeliest of them."""

    def __init__(self, fitter: ModelFitter, model: FittedModel, name: str) -> None:
        law, form = fitter.laws[name], fitter.weak_form
        self.gone = give_way(fitter, model, name)
        self.system, self.free = _without(model, self.gone)
        self.shapes = law.guesses(self.system, form.motion)
        self.evidence = 0.0 if measures_only(law) else form.evidence(self.system, self.free, self.shapes)


def _without(model: FittedModel, names: frozenset[str]) -> tuple[System, tuple[str, ...]]:
    """The fitted system without some of its laws, and its free parameters."""
    if not names:
        return model.system, model.free
    full = model.system
    rest = {n: e for n, e in full.effects.items() if n not in names}
    bare = System(full.inertia, full.contact, full.damper, {}, full.observed, full.smoothed).with_effects(*rest.values())
    return bare, tuple(n for n in model.free if n.partition(".")[0] not in names)
