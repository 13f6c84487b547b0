"""The page of the loop: the error falling, the ranking with evidence, where the first and the last model fail, the joint."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from ..criticism import Refinement
from ..fitting import error_in_words
from ..plot.drawing import svg_of
from ..plot.models import candidate_ranking, error_by_stage
from ..residuals import Findings
from .diagnose_report import failure_panels
from .fit_report import pictures, series
from .html import Panel, write_report

STRONG = 10.0
"""Evidence from which an effect would be added to a model that leaves little else."""
TELLING = 0.1
"""Share of the missing torque that coordinates must explain before its picture over them is worth looking at."""


def refine_report(
    refinement: Refinement, result: dict[str, Any], path: Path, *, first: Callable[[], Findings | None],
    last: Findings | None = None,
) -> None:  # fmt: skip
    """Write the page of a refinement.

    Parameters
    ----------
    refinement, result : what the loop found, and the same as result.json
    path : the file to write
    first : asked last, since it may still be looked for: where the first model fails, None where that cannot be told
    last : where the last model fails; None of a model that explains the record
    """
    fit = refinement.fit
    joint = {panel.anchor: panel for panel in pictures(fit)}
    panels = [_errors(result), *_rankings(result["stages"], refinement.verdict.complete)]
    base = first()
    if base is not None:
        panels += _failures(base, "the base model", "base")
    if len(refinement.stages) > 1 or base is None:
        have = " + ".join(["the base model", *refinement.effects])
        rest = joint["residual"]
        panels += [_rest(refinement, have, rest)] if last is None else _failures(last, have, "last")
    panels += [joint[name] for name in ("loop", "model", "force", "phase") if name in joint]
    write_report(path, result, panels, series(fit.records[0], fit.score, fit.translational))


def _errors(result: dict[str, Any]) -> Panel:
    held = any(stage.get("heldout_rms_over_noise") is not None for stage in result["stages"])
    where = ", on this record and on the held-out one, which no parameter was fitted to" if held else ""
    return Panel(
        "Prediction error, stage by stage",
        f"Each stage adds the effect that the record speaks for most; 1 means that noise alone is left{where}.",
        svg_of(error_by_stage, result["stages"]),
        "error",
    )


def _rankings(stages: list[dict[str, Any]], complete: bool) -> list[Panel]:
    """The first ranking, and the last of a model that still misses something; all of them stand in the tables."""
    panels = []
    for number in sorted({0, len(stages) - 1} if not complete else {0}):
        stage = stages[number]
        if not stage["candidates"]:
            continue
        have = " + ".join(["the base model", *stage["effects"]])
        if number + 1 < len(stages):
            sentence = (
                f"What the error would become with one effect added to {have}; the first bar is the effect that was added. "
                "Evidence allows for the parameters an effect brings: above 10, odds of 150 to 1, it is strong, below 0 it "
                "speaks against the effect."
            )
        else:
            why = "no evidence is strong enough to add any"
            if max(c["evidence"] or 0.0 for c in stage["candidates"]) > STRONG:
                why = "none takes away enough of what is left to explain it"
            sentence = f"What one more effect would bring to {have}: {why}."
        drawn = svg_of(candidate_ranking, stage["candidates"], current=stage["rms_over_noise"])
        panels.append(ranking_panel(f"What is missing in {have}?", sentence, drawn, number))
    return panels


def ranking_panel(title: str, sentence: str, drawn: str, number: int = 0) -> Panel:
    """The picture of a ranking."""
    return Panel(
        title, sentence, drawn, f"ranking-{number}",
        "Bars show the prediction error that the sensitivities of the fitted model predict, at the best strength and shape of "
        "each effect. The most telling ones are then fitted for real, and error and evidence of those are what that fit found; "
        "a predicted evidence can be too high, since predictions are linear.",
    )  # fmt: skip


def _failures(found: Findings, have: str, anchor: str) -> list[Panel]:
    """The pictures of what one model misses, told apart from another model's by their titles."""
    empty = set() if found.significant or found.surface is None else {"fails"}
    if found.surface is not None and found.surface.share < TELLING:
        empty.add("depends")
    panels = [panel for panel in failure_panels(found) if panel.anchor not in empty]
    told = " ".join(found.sentences)
    return [
        Panel(
            f"{panel.title}: {have}", told if number == 0 else panel.sentence, panel.figure_svg, f"{anchor}-{panel.anchor}",
            panel.detail if number else f"{panel.sentence} {panel.detail or ''}",
        )
        for number, panel in enumerate(panels)
    ]  # fmt: skip


def _rest(refinement: Refinement, have: str, picture: Panel) -> Panel:
    """What a model leaves that explains the record."""
    score = refinement.fit.score
    sentence = (
        f"All windows are off by {error_in_words(score)}, the median one by {score.median:.3g} times; noise alone would "
        "rarely exceed three times the noise, and depend on no position, speed or time."
    )
    return replace(picture, title=f"What is left: {have}", sentence=sentence, anchor="last-residual")
