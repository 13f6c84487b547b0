"""The page of the skeletons: envelopes, frequency, ridge, then the curves that tell play, stiffness and damping."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from .. import plot
from ..plot.drawing import svg_of
from ..skeletons import Skeletons
from ..skeletons.fundamental import WaveletFundamental
from .html import Panel, write_report


def skeleton_report(found: Skeletons, result: dict[str, Any], path: Path) -> None:
    """Write the page of ``skeleton``."""
    write_report(path, result, skeleton_panels(found))


def skeleton_panels(found: Skeletons) -> list[Panel]:
    """The pictures in reading order, each with its sentence."""
    share = 100.0 * (1.0 - found.masked_fraction)
    panels = [
        Panel(
            "Envelopes",
            f"Both methods' envelopes over the record; grey stretches are masked, {share:.0f} % of the record counts"
            f"{'; the notes under Parameters say why' if found.warnings else ''}.",
            svg_of(plot.envelopes, found),
            "envelopes",
        ),
        Panel(
            "Instantaneous frequency",
            "Lines: the frequency of the motion. Marks: the natural frequency that the joint shows at that moment; with play it "
            "rises with the amplitude.",
            svg_of(plot.instantaneous_frequency, found),
            "frequency",
        ),
    ]
    if isinstance(found.wavelet.along, WaveletFundamental):
        sentence = "The ridge is one path through the whole picture, finer than its grid, not the maximum of each column."
        panels.append(Panel("Ridge of the wavelet transform", sentence, svg_of(plot.ridge, found), "ridge"))
    if any(np.any(method.kept) for method in found.methods):
        panels += [
            Panel(
                "Restoring force",
                "A dead zone returns less than a straight line promises: the play comes from inverting its describing function "
                "on the motion that was measured, not from where a line cuts the axis.",
                svg_of(plot.skeleton, found),
                "force",
                "f_s = A ω₀²(A), equation (3.7) of the source paper, per unit inertia. Points are moments; bars two "
                "standard errors of a bin's mean. The describing function of a sine assumes that z has no harmonics; near the "
                "edges of the play it has, and the one of the measured motion allows for them.",
            ),
            Panel(
                "Backbone and damping",
                "Left, the natural frequency over amplitude; right, the modal damping, constant for a viscous damper where the "
                "motion is close to a sine.",
                svg_of(plot.backbone, found),
                "backbone",
            ),
        ]
    return panels
