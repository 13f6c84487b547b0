"""The page of a diagnosis: where the model fails, the torque it misses, and what that torque depends on."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from .. import plot
from ..fitting import Fit
from ..plot.drawing import svg_of
from ..plot.models import candidate_ranking
from ..residuals import Findings, Surface
from .fit_report import pictures, series
from .html import Panel, write_report


def diagnose_report(fit: Fit, found: Findings, result: dict[str, Any], path: Path) -> None:
    """Write the page of a diagnosis."""
    panels = [
        *failure_panels(found),
        *_ranking(result["stages"][0], found.adequate),
        *pictures(fit),
    ]
    write_report(path, result, panels, series(fit.records[0], fit.score, fit.translational))


def _ranking(stage: dict[str, Any], adequate: bool) -> list[Panel]:
    """What each absent effect would bring; nothing beside a model that lacks none."""
    if adequate or not stage["candidates"]:
        return []
    drawn = svg_of(candidate_ranking, stage["candidates"], current=stage["rms_over_noise"])
    sentence = (
        "What the error would become with one effect added. Evidence allows for the parameters an effect brings: above 10, odds "
        "of 150 to 1, it is strong, below 0 it speaks against the effect."
    )
    detail = (
        "Predicted from the sensitivities of the fitted model, at the best strength and shape of each effect; nothing was "
        "fitted anew. Adding one by name (fit --effects) or letting refine do it shows what is true of it."
    )
    return [Panel("Which effect is missing?", sentence, drawn, "ranking", detail)]


def failure_panels(found: Findings) -> list[Panel]:
    """The pictures of what is missing; of a model that explains the record, the torque in time alone."""
    surface, missing = found.surface, svg_of(plot.missing_torque, found)
    if surface is None:
        title = "Missing torque" if found.adequate else "Missing torque at the motor"
        return [Panel(title, found.sentences[0], missing, "missing")]
    return [
        Panel(
            "Where the model fails",
            "Up to three of the coordinates that tell most; a misfit of 1 would be noise alone. Numbers over bars are shares "
            "of the missing torque's mean square.",
            svg_of(plot.where_it_fails, found),
            "fails",
            "Above, the residual of the windowed prediction over the noise (1 would be noise alone), with each place's share of "
            "the missing torque's mean square; below, the missing torque itself in the same bins.",
        ),
        Panel(
            "The missing torque in time",
            "The torque that would have to be added to the model for it to follow the record, estimated inside the prediction "
            "windows together with their starts and the model's parameters.",
            missing,
            "missing",
        ),
        Panel("What the missing torque depends on", _explained(surface), svg_of(plot.torque_over, surface), "depends"),
    ]


def _explained(surface: Surface) -> str:
    moved = ", ".join(
        f"{name} by {100 * (b / a - 1):+.2g} %" for name, (a, b) in surface.moved.items() if a and abs(b - a) > 1e-3 * abs(a)
    )
    text = f"{surface} The share is told out of sample: stretches of the record are predicted from the others."
    return text + (f" With this torque in place the fit's own values move: {moved}." if moved else "")
