"""The page of a chaos analysis: which pictures, in which order, with which sentence."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from .. import plot
from ..plot.drawing import svg_of
from ..records import MeasuredSeries
from ..timeseries import ChaosReport
from .html import Panel, write_report


def chaos_report(found: ChaosReport, source: MeasuredSeries, result: dict[str, Any], path: Path) -> None:
    """Write the page."""
    write_report(path, result, chaos_panels(found, source))


def chaos_panels(found: ChaosReport, source: MeasuredSeries) -> list[Panel]:
    """The pictures of a chaos report with a sentence each."""
    return [
        Panel("The series", "The grey stretch above is what is drawn below.",
              svg_of(plot.series, found, source.name, _unit(source)), "series"),
        *_driven(found, source),
        Panel("The state, one delay apart",
              "A thin, folded sheet is a sign of few degrees of freedom; a cloud is a sign of noise.",
              svg_of(plot.attractor, found, _unit(source)), "phase"),
        Panel("How neighbours part", _parting(found), svg_of(plot.stretching, found), "stretching",
              "The mean logarithm of the distance between states that were near. Exponential growth is a straight "
              "line. It begins where noise no longer hides it and ends where neighbours are as far apart as any two states. The "
              "exponent itself comes from maps fitted to neighbourhoods, whose product does not saturate."),
        Panel("Surrogates and 0-1 test", _surrogates(found), svg_of(plot.surrogates, found), "surrogates",
              "Surrogates have the values and the spectrum of the series and are otherwise random. If the series is no better "
              "predicted than they are, linear noise explains it. In the 0-1 test a walk driven by the series wanders for chaos "
              "and noise, and circles for regular motion."),
        Panel("Delay", f"The delay taken is {found.delay.samples} samples: {found.delay.why}.",
              svg_of(plot.delay, found), "delay"),
        Panel("Embedding dimension", _dimension(found), svg_of(plot.dimension, found), "dimension"),
        Panel("Correlation dimension", _correlation(found), svg_of(plot.correlation, found), "correlation"),
    ]  # fmt: skip


def _driven(found: ChaosReport, source: MeasuredSeries) -> list[Panel]:
    one = found.driven
    if one is None or one.value is None or one.error is None:
        return []
    word = {"separate": "grows", "meet": "dies away"}.get(one.word, "neither clearly grows nor clearly dies away")
    said = f"Under the drive as it was measured, a small difference {word}."
    if found.conditional:
        said += " The verdict rests on this picture; the ones below look at the series as if nothing had driven it."
    name = "z" if source.name == "y" else source.name
    return [
        Panel("Under the measured drive", said, svg_of(plot.driven_growth, found, name, _unit(source)), "driven",
              "The acceleration of the motion is fitted by tables of position and velocity and by the drive, all over the "
              "record, so no states need recur. On stretches it was not fitted to, the law misses the acceleration by "
              f"{100 * one.error:.2g} %. Its slope tells how a small difference changes from moment to moment; the drive is the "
              "same for both motions and drops out. Flat in the play and steep in contact is what parts them."),
    ]  # fmt: skip


def _unit(source: MeasuredSeries) -> str:
    """The unit of the series; a file need not state any, since a verdict on chaos asks for none."""
    return source.unit or "unit of the file"


def _parting(found: ChaosReport) -> str:
    if found.conditional:
        return "Under a drive that does not repeat these curves also hold how the drive changed; they decide nothing here."
    if found.lyapunov is None:
        return f"No exponent is given: {found.why_no_number}."
    if found.curve.region is None:
        return "The curves are too short for a straight part of their own; the dotted line is the growth the local maps give."
    return "The thick line is the straight part that was chosen; the dotted one is the growth the local maps give."


def _surrogates(found: ChaosReport) -> str:
    p = found.surrogates.p_value
    if p <= 0.05:
        return f"The series predicts itself better than all but a few surrogates do (p = {p:.3g})."
    return f"Linear noise is predicted as well as the series (p = {p:.3g})."


def _dimension(found: ChaosReport) -> str:
    raw, cleaned = found.raw_dimension.cao, found.cleaned_dimension
    words = "E1 does not settle" if raw is None else f"E1 settles at {raw} coordinates"
    if cleaned is not None and cleaned.cao is not None:
        words += f", and at {cleaned.cao} once noise is taken off"
    return words + "; rings mark where. E2 near 1 everywhere would be noise."


def _correlation(found: ChaosReport) -> str:
    one = found.correlation
    if one.dimension is None:
        return f"No dimension is given: {one.why}."
    return f"Straight parts of the sums agree on a correlation dimension of {one.dimension:.2f}."
