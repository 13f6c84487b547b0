"""Cards of fits, comparisons and causes, of what a model misses, and of the loop that adds it."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..causes import Cause
from ..criticism import Ranking, Refinement
from ..criticism.refinement import alternatives_sentence, doubted
from ..fitting import Comparison, Fit, Score, percent
from ..fitting.result import doubt, verdict_text, without_inertia
from ..plot.style import format_evidence, short
from ..plot.words import stage_name
from ..residuals import Findings, Latent, Surface
from ..residuals.surface import LABELS
from .card import Card, Grid, Picture, card_of, grid, name_of
from .result import stage as stage_json
from .summary import parameter_rows

MOST = 12
"""Rows of a ranking, or of the questions that were asked."""


@card_of.register
def of_fit(fit: Fit) -> Card:
    """Parameters with their errors, and the record beside the model."""
    added = f" + {' + '.join(sorted(fit.system.effects))}" if fit.system.effects else ""
    return Card(
        f"Fit of {name_of(fit.records[0].path)}: {fit.model}{added}", (verdict_text(fit), *_per_inertia(fit)),
        (parameters([stage_json(fit)], doubt(fit)), errors(fit)), (Picture("fit", (fit,)),),
    )  # fmt: skip


def parameters(stages: list[dict[str, Any]], note: str) -> Grid:
    """The parameters of the last of some stages, with how far each moved since the first where there are several."""
    moved = len(stages) > 1
    rows = []
    for row in parameter_rows(stages, note):
        value = "\n".join(row["values"]) or "not determined"
        change = [row["moved"]] if moved else []
        interval = "none" if note else row["interval"]  # the sentence above says why
        rows.append([row["label"], value, interval, *change, f"{row['verdict']['mark']} {row['verdict']['text']}"])
    heads = ["parameter", "value ± standard error", "95 % interval", *(["change"] if moved else []), "verdict"]
    return grid(heads, rows)


def errors(fit: Fit) -> Grid:
    """The error on each record, and on the held-out one."""
    named = [(name_of(of.path, f"record {number}"), score) for number, (of, score) in enumerate(zip(fit.records, fit.scores))]
    return _errors([*named, *([("held out", fit.heldout)] if fit.heldout is not None else [])])


def _errors(named: list[tuple[str, Score]]) -> Grid:
    rows = [[name, short(score.rms), short(score.median), _share(score)] for name, score in named]
    return grid(["prediction error", "over noise", "median window", "share of what was measured"], rows)


def _share(score: Score) -> str:
    return percent(score.nrmse) if np.isfinite(score.nrmse) else "–"


def _per_inertia(fit: Fit) -> list[str]:
    return [f"N{without_inertia(fit)[1:]}."] if fit.per_inertia else []


@card_of.register
def of_comparison(found: Comparison) -> Card:
    """The error of a given model, and the record beside it."""
    name = name_of(found.record.path)
    return Card(f"A model beside {name}", (found.sentence(),), (_errors([(name, found.score)]),), (Picture("fit", (found,)),))


@card_of.register
def of_score(score: Score) -> Card:
    """The error of a prediction."""
    return Card("Prediction error", (f"{str(score)[:1].upper()}{str(score)[1:]}.",), (_errors([(score.observed, score)]),))


@card_of.register
def of_cause(cause: Cause) -> Card:
    """A cause of misfit in the record, and what to do about it."""
    rows = [["as it stands", short(cause.before)], ["without the cause", short(cause.left)]]
    beside = (cause.undone + ".",) if cause.undone else ()
    return Card(f"A cause lies in the record: {cause.name}", (str(cause), *beside), (grid(["misfit", "over noise"], rows),))


@card_of.register
def of_refinement(found: Refinement) -> Card:
    """The stages, the last one's parameters and what else would explain the record; the error stage by stage."""
    stages = []
    for number, stage in enumerate(found.stages):
        held = stage.fit.heldout
        name = stage_name({"added": stage.added, "dropped": list(stage.dropped)}, number).replace("_\n", "_").replace("\n", " ")
        stages.append([name, short(stage.fit.score.rms), short(stage.fit.score.median), "–" if held is None else short(held.rms)])
    both = [stage_json(found.stages[0].fit), *([stage_json(found.fit)] if len(found.stages) > 1 else [])]
    return Card(
        f"Refinement of {name_of(found.fit.records[0].path)}: {found.verdict.word}",
        (found.verdict.text, *_per_inertia(found.fit), alternatives_sentence(found)),
        (grid(["stage", "rms over noise", "median window", "held out"], stages), parameters(both, doubted(found))),
        (Picture("stages", (found,)),),
    )


@card_of.register
def of_ranking(found: Ranking) -> Card:
    """What each absent effect would bring, best first."""
    shown = list(found)[:MOST]
    how = ["refitted" if one.refitted else one.why or "predicted" for one in shown]
    rows = [[one.name, short(one.rms_over_noise), format_evidence(one.evidence), words] for one, words in zip(shown, how)]
    told = (
        f"The prediction error is {short(found.current)} times the noise now. Evidence allows for the parameters that an effect "
        "brings: above 10, odds of 150 to 1, it is strong, below 0 it speaks against the effect."
    )
    table = grid(["effect", "rms over noise with it", "evidence", "how"], rows)
    return Card("What one more effect would bring", (told,), (table,), (Picture("ranking", (found,)),))


@card_of.register
def of_findings(found: Findings) -> Card:
    """Where a model fails, what was asked about it, and the torque it misses."""
    rows = [
        [one.label, one.of, f"{one.strength:.2f}", "below 1e-6" if one.p < 1e-6 else f"{one.p:.2g}"]
        for one in found.dependences[:MOST]
    ]
    if found.surface is None:
        where = "nowhere" if found.adequate else "at the motor"
        return Card(f"Where the model fails: {where}", found.sentences, (), (Picture("missing_torque", (found,)),))
    asked = grid(["what the missing torque may depend on", "of it", "strength", "chance"], rows)
    pictures = Picture("where_it_fails", (found,)), Picture("torque_over", (found,))
    return Card("Where the model fails", found.sentences, (asked,), pictures)


@card_of.register
def of_latent(found: Latent) -> Card:
    """The missing torque, and what the parameters are beside it."""
    rows = [[name, f"{a:.6g}", f"{b:.6g} ± {c:.2g}"] for name, (a, b, c) in found.moved.items()]
    table = grid(["parameter", "as fitted", "beside the missing torque"], rows)
    return Card("The missing torque", (str(found),), (table,), (Picture("missing_torque", (found,)),))


@card_of.register
def of_surface(found: Surface) -> Card:
    """What the missing torque depends on."""
    rows = [[" and ".join(LABELS[name] for name in names), f"{100.0 * share:.1f} %"] for names, share, _ in found.tried[:MOST]]
    table = grid(["coordinates", "share explained out of sample"], rows)
    return Card("What the missing torque depends on", (str(found),), (table,), (Picture("torque_over", (found,)),))
