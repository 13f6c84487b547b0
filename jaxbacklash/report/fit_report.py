"""The page of a fit or a comparison: which pictures, in which order, with which sentence."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ..fitting import Comparison, Fit, Score, error_in_words
from ..fitting.loop import NOTHING, read_plateau, sliding_level
from ..parameters import channel_unit, unit_text
from ..pointwise import along
from ..records import Record
from ..signals import choose_intervals, fit_spline, span
from ..system import System
from .figures import error_by_stage, force_loop, measured_against_model, phase_plane, residual_in_time, restoring_force, to_svg
from .html import Panel, write_report
from .style import short

INSIDE = slice(10, -10)
"""Samples that are drawn where derivatives count: at its two ends a spline's curvature is little more than noise."""


def fit_report(fit: Fit, result: dict[str, Any], path: Path) -> None:
    """Write the page of a fit."""
    panels = [
        *pictures(fit.system, fit.records[0], fit.score, fit.noise[0], fit.translational, fit.per_inertia),
    ]
    if len(result["stages"]) > 1 or fit.heldout is not None:
        held = "" if fit.heldout is None else ", on this record and on the held-out one"
        sentence = f"1 means that noise alone is left{held}."
        panels.append(Panel("Prediction error", sentence, to_svg(error_by_stage(result["stages"])), "error"))
    write_report(path, result, panels, series(fit.records[0], fit.score, fit.translational))


def compare_report(found: Comparison, result: dict[str, Any], path: Path) -> None:
    """Write the page of a comparison."""
    panels = pictures(found.system, found.record, found.score, found.noise, found.translational, False)
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


def pictures(
    system: System, record: Record, score: Score, noise: float, translational: bool, per_inertia: bool
) -> list[Panel]:
    """The four pictures of a model beside a record."""
    name, unit = record.observed_name, _length(translational)
    own = channel_unit(name, translational=translational)
    worst = score.window_times[int(np.nanargmax(score.window_rms))]
    panels = [
        Panel(
            "Measured against model",
            f"Each window is predicted from its own start; the model is off by {error_in_words(score)}, over all windows, "
            f"by {score.median:.3g} times in the median one.",
            to_svg(
                measured_against_model(
                    score.t, score.measured, score.predicted, window_starts=score.window_times, label=name, unit=own, noise=noise
                )
            ),
            "model",
        ),
        Panel(
            "What the model leaves",
            f"Where noise alone is left the residual stays within two noises; the worst window begins at {worst:.2f} s.",
            to_svg(
                residual_in_time(
                    score.t, score.residual, window_edges=score.window_times, window_rms=score.window_rms
                )
            ),
            "residual",
        ),
    ]
    if name == "T":
        return [_loop_panel(record, score, unit, own), *panels]
    motion = Motion(record, name)
    edges = tuple(float(e) for e in system.edges(0.0)) if system.has_play else None
    where = "The play lies between the two lines: no contact there. " if edges else ""
    panels.append(
        Panel(
            "Phase plane",
            f"{where}Relative position against relative speed, measured.",
            to_svg(phase_plane(motion.z[INSIDE], motion.dz[INSIDE], edges=edges, unit=unit)),
            "phase",
        )
    )
    if system.contact is not None:
        torque_unit = unit_text("N m", translational=translational, per_inertia=per_inertia)
        at = np.linspace(motion.z.min(), motion.z.max(), 801)
        panels.append(
            Panel(
                "Restoring force",
                "What the joint returns when inertia, damping and loads are taken off the measured motion, beside the model.",
                to_svg(
                    restoring_force(
                        motion.z[INSIDE], motion.restoring_torque(system)[INSIDE], model_z=at, model_torque=_law(system, at),
                        edges=edges, unit=torque_unit, length_unit=unit,
                    )
                ),
                "force",
            )
        )  # fmt: skip
    return panels


def _loop_panel(record: Record, score: Score, unit: str, own: str) -> Panel:
    """The force loop: the first picture of a record of transmitted force."""
    x, force = record.channels["x"], record.channels["T"]
    known, told = read_plateau(x, force), read_plateau(x, score.predicted)
    words = "Transmitted force against the base motion, measured and as the model predicts it window by window."
    if known.median is not None:
        words += f" Less than a tenth of the sliding force is carried over {short(known.median, 3)} {unit} of travel"
        words += f", in the model over {short(told.median, 3)} {unit}." if told.median is not None else "."
    drawn = force_loop(x, force, score.predicted, level=NOTHING * sliding_level(force), unit=own, length_unit=unit)
    return Panel("Force loop", words, to_svg(drawn), "loop")


class Motion:
    """A record's motion with speeds and acceleration from smoothing splines; ``z``, ``dz``, ... have shape (N,)."""

    def __init__(self, record: Record, observed: str) -> None:
        t, window = record.t, span(record.dt)
        zero = np.zeros(record.samples)
        measured = record.channels[observed]
        self.x, self.dx = zero, zero
        if "x" in record.channels:
            spline = fit_spline(t, record.channels["x"], t[0], window / choose_intervals(t, record.channels["x"], window))
            self.x, self.dx = spline(t), spline(t, 1)
        y = measured + self.x if observed == "z" else measured
        link = fit_spline(t, y, t[0], window / choose_intervals(t, y, window))
        self.t, self.force = t, record.channels.get("F", zero)
        self.y, self.dy, self.ddy = link(t), link(t, 1), link(t, 2)
        self.z = measured if observed == "z" else measured - self.x
        self.dz = self.dy - self.dx

    def restoring_torque(self, system: System) -> np.ndarray:
        """Torque that brings the link back to the play's middle, -joint torque at rest [N m], shape (N,)."""
        said = along(system, self.t, self.y, self.dy, self.x, self.dx, self.force)
        return said.torque - said.joint + self.force - float(system.inertia) * self.ddy - float(system.damper.damping) * self.dz


def _law(system: System, z: np.ndarray) -> np.ndarray:
    return -along(system, 0.0, z, 0.0, 0.0, 0.0).joint


def _length(translational: bool) -> str:
    return "m" if translational else "rad"
