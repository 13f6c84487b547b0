r"""Linear screening: what each absent law promises beside a fitted model, without fitting it.

Two tests, both of a linear model, so that the whole catalogue costs less than one fit:

* the score test of laws that remember nothing, along the fitted trajectory and with the torque left out that the model was fitted
  with: with the information S and the score g of all columns, windows marginalised, a law is predicted to lower twice the cost by
  :math:`g^T S^{-1} g` more than the model's own parameters would (Rao 1948);
* weak-form regression on the measured motion of laws that remember: they have no sensitivity at strength zero, so they are
  followed along the measured motion and tuned there (`tuning`), and compared with the others by the same regression.

`evidence_search` fits those that promise most.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from ..mechanics import AbstractEffect
from ..parameters import free_specs
from .candidates import Candidate, score_test
from .fitted_model import FittedModel
from .model_fitter import ModelFitter
from .quick_look import QuickLook, whitener
from .tuning import Tuned, tune

CLEARLY = 0.02
"""Share of the best other law's gain in the weak form by which a law that remembers has to be ahead: that regression is biased by
noise in the motion, and a law that remembers nothing is often the limit of one that does."""
SEEN = 10.0
"""Fall of the weak form's sum of squares, in units of its rows' variance, from which on a law that remembers is tuned."""


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
        ``gain`` is the predicted fall of minus twice the log evidence, deflated where the model's residual is no noise. Laws
        that remember are there only where the weak form puts them ahead of all others.
    """
    absent = [n for n in fitter.laws if n not in model.names and n not in set(barred)]
    static = score_test(fitter, model, [n for n in absent if n in fitter.static], tie=model.tie, deflation=model.deflation)
    return sorted([*static, *_remembering(fitter, model, absent, static)], key=lambda c: -worth(c, fitter))


def worth(candidate: Candidate, fitter: ModelFitter) -> float:
    """The predicted fall of the criterion by a candidate: its gain less ln N for each of its parameters."""
    return candidate.gain - candidate.parameters * float(np.log(fitter.record.samples))


def _remembering(
    fitter: ModelFitter, model: FittedModel, absent: Sequence[str], static: Sequence[Candidate]
) -> list[Candidate]:
    look, system = fitter.quick, model.system
    if look.blind:
        return []
    names = [n for n in absent if fitter.laws[n].states]
    # What promises nothing at any of the shapes it is begun with is not tuned.
    names = [n for n in names if look.evidence(system, model.free, fitter.laws[n].guesses(system, look.motion)) > SEEN]
    if not names:
        return []
    tuned = {n: tune(look, system, model.free, fitter.laws[n].guesses(system, look.motion)) for n in names}
    gains = weak_form_gains(look, model, tuned, [c.effect for c in static])
    sample = float(np.log(fitter.record.samples))
    against = [gain - c.parameters * sample for c, gain in zip(static, gains[len(names) :])]
    least = max([0.0, *against]) * (1.0 + CLEARLY)
    found = []
    for name, gain in zip(names, gains):
        if gain - len(free_specs(tuned[name].effect)) * sample > least:
            found.append(Candidate(name, tuned[name].effect, gain, model.misfit, {}))
    return found


def weak_form_gains(
    look: QuickLook, model: FittedModel, tuned: dict[str, Tuned], others: Sequence[AbstractEffect]
) -> list[float]:
    """Fall of minus twice the log likelihood of the weak form by each tuned law, then by each of the ``others``.

    All by one regression, whitened by what the best of the tuned laws leaves.
    """
    left, by = look.missing(model.system, model.free)
    white = whitener(min((t.left for t in tuned.values()), key=lambda rest: float(rest @ rest)))
    target, own = white(left), white(by)
    rows = target.size

    def rest(design: np.ndarray) -> float:
        remaining = target - design @ np.linalg.lstsq(design, target, rcond=None)[0]
        return rows * float(np.log(remaining @ remaining + 1e-300))

    none = rest(own)
    columns = [*(look.column(t.effect, t.system) for t in tuned.values()), *(look.column(e, model.system) for e in others)]
    return [none - rest(np.column_stack([own, white(column)])) for column in columns]
