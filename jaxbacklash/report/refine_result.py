"""The loop's findings as result.json, and a ranking of absent effects as its entry ``candidates``."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..criticism import Refinement
from ..criticism.experiment import Experiment
from ..criticism.ranking import Ranking, of_stage
from ..criticism.refinement import Moved, alternatives_sentence, doubted, steps
from ..effects import Contact
from ..errors import BadInput, NoAnswer
from ..fitting import Fit
from ..regression.equation_error import estimate
from ..residuals import Findings
from .result import as_json as fit_json
from .result import cross_check, finite
from .result import stage as stage_json


def candidates_json(ranking: Ranking) -> list[dict[str, Any]]:
    """The entry ``candidates`` of a stage, best first."""
    return [
        {
            "name": entry.name,
            "predicted_rms_over_noise": finite(entry.predicted_rms_over_noise),
            "refitted_rms_over_noise": finite(entry.refitted_rms_over_noise),
            "evidence": finite(entry.evidence),
            "refitted": entry.refitted,
            "why": entry.why,
        }
        for entry in ranking
    ]


def refinement_json(
    refinement: Refinement, findings: Findings | None = None, *, command_line: str = "", version: str = "",
    checked: dict[str, Any] | None = None,
) -> dict[str, Any]:  # fmt: skip
    """The whole result of ``refine``.

    Parameters
    ----------
    refinement : what the loop found
    findings : where the last model still fails, told of a model that is incomplete
    command_line, version : for the record
    checked : what `other_methods` say of the model kept, where that is known already
    """
    fit, stages = refinement.fit, refinement.stages
    checked = other_methods(fit) if checked is None else checked
    result = fit_json(
        fit, command="refine", command_line=command_line, version=version, checked=checked, causes=refinement.causes
    )
    result.pop("starts")  # the loop fits from one start, which its quick look has chosen
    followed = [*stages[1:], None]
    result["stages"] = [
        stage_json(stage.fit, stage.added)
        | {
            "dropped": list(stage.dropped),
            "moved": {name: _moved_json(step) for name, step in step_of.items()},
            "candidates": candidates_json(of_stage(stage, following)),
        }
        for stage, following, step_of in zip(stages, followed, steps(stages))
    ]
    result["intervals_note"] = doubted(refinement)
    result["stages"][-1]["intervals_hold"] = not result["intervals_note"]
    result["model"] = stages[0].fit.model
    result["alternatives"] = [list(names) for names in refinement.alternatives]
    result["alternatives_text"] = alternatives_sentence(refinement)
    result["experiments"] = [_experiment(e) for e in refinement.experiments]
    result["verdict"] = refinement.verdict.word
    result["verdict_text"] = refinement.verdict.text
    result["seconds"] = {name: round(float(value), 4) for name, value in refinement.seconds.items()}
    if findings is not None:
        result |= findings.as_json()
    return result


def _experiment(found: Experiment) -> dict[str, Any]:
    tried = [{"amplitude": s.amplitude, "frequency_hz": s.frequency, "rms_over_noise": finite(s.misfit)} for s in found.tried]
    return {
        "rival": list(found.rival), "drive": found.drive, "unit": found.unit, "seconds": found.seconds,
        "separates": found.parts, "best": tried[found.tried.index(found.best)], "tried": tried, "text": str(found),
    }  # fmt: skip


def _moved_json(step: Moved) -> dict[str, float | None]:
    return {"percent": finite(step.percent), "stderrs": finite(step.stderrs)}


def other_methods(fit: Fit) -> dict[str, Any]:
    """The entry ``cross_check``: other methods beside a fit, the regression of its equation of motion with the effects found."""
    # Where the link's motion is not in the record there is nothing to regress on; a motor's laws are none of its joint.
    if fit.start is None or not fit.system.effects or fit.records[0].kind in ("transmitted", "drive"):
        return cross_check(fit)
    inertia = None if "inertia" in fit.free else float(fit.system.inertia)
    play, spring = isinstance(fit.system.contact, Contact), fit.system.contact is not None
    try:
        with np.errstate(all="ignore"):
            start = estimate(fit.records[0], inertia=inertia, play=play, spring=spring, effects=list(fit.system.effects.values()))
    except (BadInput, NoAnswer, np.linalg.LinAlgError, ValueError) as error:
        return cross_check(fit) | {"equation_error": {"agrees": None, "why": f"the regression failed: {error}"}}
    return cross_check(fit, start)
