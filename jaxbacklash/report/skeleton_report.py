"""The page of the skeletons: envelopes, frequency, ridge, then the curves that tell play, stiffness and damping."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ..skeletons import Skeletons
from ..skeletons.fundamental import WaveletFundamental
from .figures import backbone_and_damping, envelopes, instantaneous_frequency, ridge_over_scalogram, skeleton_force, to_svg
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
            f"Both methods' envelopes over the record; grey stretches are masked, {share:.0f} % of the record counts.",
            to_svg(envelopes(found)),
            "envelopes",
            "\n".join(found.warnings) or None,
        ),
        Panel(
            "Instantaneous frequency",
            "Lines: the frequency of the motion. Marks: the natural frequency that the joint shows at that moment; with play it "
            "rises with the amplitude.",
            to_svg(instantaneous_frequency(found)),
            "frequency",
        ),
    ]
    along = found.wavelet.along
    if isinstance(along, WaveletFundamental):
        whole = along.t[along.whole] if np.any(along.whole) else along.t
        name = found.record.input_name or found.record.observed_name
        drawn = ridge_over_scalogram(along.picture, along.path, whole=(float(whole[0]), float(whole[-1])), name=name)
        sentence = "The ridge is one path through the whole picture, finer than its grid, not the maximum of each column."
        panels.append(Panel("Ridge of the wavelet transform", sentence, to_svg(drawn), "ridge"))
    if any(np.any(method.kept) for method in found.methods):
        panels += [
            Panel(
                "Restoring force",
                "A dead zone returns less than a straight line promises: the play comes from inverting its describing function "
                "on the motion that was measured, not from where a line cuts the axis.",
                to_svg(skeleton_force(found)),
                "force",
                "f_s = A omega_0^2(A), equation (3.7) of the source paper, per unit inertia. Points are moments; bars two "
                "standard errors of a bin's mean. The describing function of a sine assumes that z has no harmonics; near the "
                "edges of the play it has, and the one of the measured motion allows for them.",
            ),
            Panel(
                "Backbone and damping",
                "Left, the natural frequency over amplitude; right, the modal damping, constant for a viscous damper where the "
                "motion is close to a sine.",
                to_svg(backbone_and_damping(found)),
                "backbone",
            ),
        ]
    return panels
