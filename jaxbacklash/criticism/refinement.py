"""What the loop found, and how a person reads it."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

from ..causes import Cause
from ..fitting import Fit, Score, measures, percent
from ..fitting.chance import explains
from ..fitting.estimates import line
from ..fitting.result import DOUBTED, at_most, without_inertia
from ..frames import dataframe, known
from ..parameters import channel_unit
from ..showing import Shown
from .experiment import Experiment, needed
from .ranking import of_stage, table
from .steps import Stage
from .verdict import Verdict

JOINT = {"backlash": "play", "stiffness": "stiffness", "damping": "damping"}


@dataclass(frozen=True)
class Refinement(Shown):
    """What the loop found. Prints itself; in a notebook it shows a table and its picture (`jaxbacklash.plot.stages`).

    Attributes: ``stages``, the last one is the model kept; ``alternatives``, other sets of effects that the record cannot
    tell apart from it; ``experiments`` that would separate the first of them; ``verdict``; ``seconds``; ``causes`` of misfit
    that lie in the record, for which no law was looked for.
    """

    stages: tuple[Stage, ...]
    alternatives: tuple[tuple[str, ...], ...]
    verdict: Verdict
    seconds: dict[str, float] = field(default_factory=dict)
    experiments: tuple[Experiment, ...] = ()
    causes: tuple[Cause, ...] = ()

    @property
    def fit(self) -> Fit:
        """The model kept."""
        return self.stages[-1].fit

    @property
    def effects(self) -> tuple[str, ...]:
        """Names of what was missing."""
        return tuple(sorted(self.fit.system.effects))

    @property
    def moved(self) -> tuple[dict[str, Moved], ...]:
        """At each stage how far play, stiffness and damping moved from the stage before; nothing at the first."""
        return tuple(steps(self.stages))

    def __str__(self) -> str:
        return text(self)

    def to_dataframe(self) -> Any:
        """The stages as a `pandas.DataFrame`, a row each.

        Columns: the effect ``added``, those ``dropped``, the errors over the noise on the record and on a held-out one, and every
        parameter's value by its name, NaN where it is not in the model or not found.
        """
        names = dict.fromkeys(name for stage in self.stages for name in stage.fit.parameters)
        fits = [stage.fit for stage in self.stages]
        held = [fit.heldout for fit in fits]
        values = {
            name: known([None if name not in fit.parameters else fit.parameters[name].value for fit in fits]) for name in names
        }
        units = {name: one.unit for fit in fits for name, one in fit.parameters.items()}
        return dataframe(
            {
                "stage": range(len(fits)), "added": [stage.added or "" for stage in self.stages],
                "dropped": [", ".join(stage.dropped) for stage in self.stages], "rms_over_noise": [fit.score.rms for fit in fits],
                "median_over_noise": [fit.score.median for fit in fits],
                "heldout_rms_over_noise": known([None if score is None else score.rms for score in held]), **values,
            },
            "stage", units=units, verdict=self.verdict.word,
        )  # fmt: skip


@dataclass(frozen=True)
class Moved:
    """How far a parameter moved from one model to the next: in percent, and in the standard errors it had before; None where
    there is no number."""

    percent: float | None
    stderrs: float | None


def moved(before: Fit, after: Fit) -> dict[str, Moved]:
    """How far play, stiffness and damping moved when an effect came in."""
    found = {}
    for name in JOINT:
        old, new = before.parameters.get(name), after.parameters.get(name)
        if old is None or new is None or old.value is None or new.value is None:
            continue
        step = new.value - old.value
        percent = 100.0 * step / abs(old.value) if old.value else None
        found[name] = Moved(percent, step / old.stderr if old.stderr else None)
    return found


def text(refinement: Refinement) -> str:
    """The whole report: verdict, stages, parameters, alternatives, the first and the last ranking."""
    stages, fit = refinement.stages, refinement.fit
    lines = [refinement.verdict.text, "", fit.records[0].summary(), *noise_lines(fit), "", *_stages(stages), ""]
    if fit.per_inertia:
        lines.append(without_inertia(fit))
    note = doubted(refinement)
    lines.append("parameters, value +- standard error" + ("" if note else ", and 95 % interval"))
    for estimate in fit.parameters.values():
        ends = None if note else estimate.ci95
        shown = line(estimate, note)
        lines.append(f"{shown:<72} {ends[0]:.6g} to {ends[1]:.6g}" if ends is not None else shown)
    lines += ["", alternatives_sentence(refinement)]
    for number in sorted({0, len(stages) - 1}, reverse=True):
        following = stages[number + 1] if number + 1 < len(stages) else None
        ranking = of_stage(stages[number], following)
        if ranking.entries:
            have = ", ".join(sorted(stages[number].fit.system.effects)) or "the base model"
            lines += ["", f"what one more effect would bring to {have} ({ranking.current:.3g} now)", *table(ranking, 5)]
    return "\n".join(lines)


def doubted(refinement: Refinement) -> str:
    """What is to stand beside the standard errors of the model kept, in place of intervals: nothing where it is complete and
    leaves only noise."""
    fit = refinement.fit
    return "" if refinement.verdict.complete and explains(fit.scores, fit.system) else DOUBTED


def noise_lines(fit: Fit) -> list[str]:
    """The noise found in the record's channels."""
    seen, driver, moved_by = fit.records[0].observed_name, fit.records[0].input_name or "x", fit.input_noise[0]
    more = f", of {driver} {moved_by:.3g} {channel_unit(driver, translational=fit.translational)}" if moved_by else ""
    unit = channel_unit(seen, translational=fit.translational)
    return [f"  noise of {seen} {at_most(fit, seen)}{fit.noise[0]:.3g} {unit}{more}"]


def alternatives_sentence(refinement: Refinement) -> str:
    """Which other explanations the record cannot rule out."""
    if not refinement.effects:
        return "No effect was added."
    if not refinement.verdict.here:
        return "Alternatives were not looked for, since something is missing still."
    if not refinement.alternatives:
        return "No other set of effects as small explains the record as well."
    other = "; or ".join(" + ".join(names) for names in refinement.alternatives)
    allow = "standard errors" if doubted(refinement) else "intervals"
    said = f"This record cannot tell {' + '.join(refinement.effects)} from: {other}; the {allow} allow for either."
    tried = {experiment.rival for experiment in refinement.experiments}
    apart = "".join(needed(refinement.effects, names) for names in refinement.alternatives if names not in tried)
    proposed = [*map(str, refinement.experiments)] or ([] if apart else ["Another excitation may."])
    return " ".join([said, *proposed]) + apart


def _stages(stages: tuple[Stage, ...]) -> list[str]:
    names = [_name(stage) for stage in stages]
    wide = max(map(len, names)) + 2
    held = any(stage.fit.heldout is not None for stage in stages)
    of = f"of {measures(stages[0].fit.score.observed)}"
    head = f"  {'stage':<{wide}} {'rms/noise':>10} {of:>10}" + (f" {'held out':>10} {of:>10}" if held else "")
    lines = [head + "   what play b, stiffness k and damping c did"]
    for name, stage, old in zip(names, stages, (None, *stages[:-1])):
        row = f"  {name:<{wide}} {_errors(stage.fit.score)}"
        if held:
            row += f" {_errors(stage.fit.heldout)}"
        lines.append(row + ("" if old is None else "   " + _moves(moved(old.fit, stage.fit))))
    return lines


def _errors(score: Score | None) -> str:
    """Both errors of a model in two columns, empty where it was not scored."""
    return f"{score.rms:>10.3g} {percent(score.nrmse):>10}" if score is not None else f"{'':>21}"


def _name(stage: Stage) -> str:
    return ("base model" if stage.added is None else f"+ {stage.added}") + "".join(f" - {gone}" for gone in stage.dropped)


def _moves(found: dict[str, Moved]) -> str:
    said: list[str] = []
    for name, step in found.items():
        words = JOINT[name]
        if step.percent is not None:
            words += f" {step.percent:+.2g} %"
        if step.stderrs is not None:
            unit = "" if any("(" in one for one in said) else " standard errors"
            words += f" ({abs(step.stderrs):.2g}{unit})"
        said.append(words)
    return ", ".join(said)


def steps(stages: tuple[Stage, ...]) -> list[dict[str, Moved]]:
    """How far the joint's parameters moved at each stage; nothing at the first."""
    return [{}, *(moved(a.fit, b.fit) for a, b in pairwise(stages))]
