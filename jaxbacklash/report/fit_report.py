"""The page of a fit or a comparison: which pictures, in which order, with which sentence."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from .. import plot
from ..fitting import Comparison, Fit, Score, error_in_words
from ..parameters import channel_unit
from ..plot.drawing import svg_of
from ..plot.fits import beside
from ..plot.style import short
from ..records import Record
from ..regression.force_loop import read_plateau
from .html import Panel, write_report


def fit_report(fit: Fit, result: dict[str, Any], path: Path) -> None:
    """Write the page of a fit."""
    panels = pictures(fit)
    if len(result["stages"]) > 1 or fit.heldout is not None:
        held = "" if fit.heldout is None else ", on this record and on the held-out one"
        sentence = f"1 means that noise alone is left{held}."
        panels.append(Panel("Prediction error", sentence, svg_of(plot.stages, fit), "error"))
    write_report(path, result, panels, series(fit.records[0], fit.score, fit.translational))


def compare_report(found: Comparison, result: dict[str, Any], path: Path) -> None:
    """Write the page of a comparison."""
    panels = pictures(found)
    write_report(path, result, panels, series(found.record, found.score, found.translational))


def series(record: Record, score: Score, translational: bool) -> dict[str, Any]:
    """What the zoomable view shows."""
    return {
        "t": score.t,
        "measured": score.measured,
        "model": score.predicted,
        "residual_over_noise": score.residual,
        "window_starts": score.window_times,
        "label": record.observed_name,
        "unit": channel_unit(record.observed_name, translational=translational),
    }


def pictures(found: Fit | Comparison) -> list[Panel]:
    """The four pictures of a model beside a record."""
    one = beside(found)
    score = one.score
    worst = score.window_times[int(np.nanargmax(score.window_rms))]
    panels = [
        Panel(
            "Measured against model",
            f"Each window is predicted from its own start; the model is off by {error_in_words(score)}, over all windows, "
            f"by {score.median:.3g} times in the median one.",
            svg_of(plot.fit, found),
            "model",
        ),
        Panel(
            "What the model leaves",
            f"Where noise alone is left the residual stays within two noises; the worst window begins at {worst:.2f} s.",
            svg_of(plot.residuals, found),
            "residual",
        ),
    ]
    if one.record.observed_name == "T":
        return [_loop_panel(found), *panels]
    if one.record.relative is None:
        return panels
    where = "The play lies between the two lines: no contact there. " if one.edges else ""
    said = f"{where}Relative position against relative speed, measured."
    panels.append(Panel("Phase plane", said, svg_of(plot.phase_plane, found), "phase"))
    if one.system.contact is not None:
        said = "What the joint returns when inertia, damping and loads are taken off the measured motion, beside the model."
        panels.append(Panel("Restoring force", said, svg_of(plot.restoring_force, found), "force"))
    return panels


def _loop_panel(found: Fit | Comparison) -> Panel:
    """The force loop: the first picture of a record of transmitted force."""
    one = beside(found)
    x, force = one.record.channels["x"], one.record.channels["T"]
    known, told = read_plateau(x, force), read_plateau(x, one.score.predicted)
    words = "Transmitted force against the base motion, measured and as the model predicts it window by window."
    if known.median is not None:
        words += f" Less than a tenth of the sliding force is carried over {short(known.median, 3)} {one.length} of travel"
        words += f", in the model over {short(told.median, 3)} {one.length}." if told.median is not None else "."
    return Panel("Force loop", words, svg_of(plot.force_loop, found), "loop")
