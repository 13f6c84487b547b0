"""The page of a diagnosis: where the model fails, the torque it misses, and what that torque depends on."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from ..criticism import Findings, Surface
from ..criticism.surface import LABELS
from ..effects.learned import UNITS
from ..fitting import Fit
from .figures import (
    candidate_ranking,
    missing_torque_curve,
    missing_torque_in_time,
    missing_torque_surface,
    to_svg,
    where_it_fails,
)
from .fit_report import pictures, series
from .html import Panel, write_report

SYMBOLS = {"dz": "z′", "dy": "y′"}


def diagnose_report(fit: Fit, found: Findings, result: dict[str, Any], path: Path) -> None:
    """Write the page of a diagnosis."""
    panels = [
        *failure_panels(found, fit.translational),
        *_ranking(result["stages"][0], found.adequate),
        *pictures(fit.system, fit.records[0], fit.score, fit.noise[0], fit.translational, fit.per_inertia),
    ]
    write_report(path, result, panels, series(fit.records[0], fit.score, fit.translational))


def _ranking(stage: dict[str, Any], adequate: bool) -> list[Panel]:
    """What each absent effect would bring; nothing beside a model that lacks none."""
    if adequate or not stage["candidates"]:
        return []
    drawn = candidate_ranking(stage["candidates"], current=stage["rms_over_noise"])
    sentence = "What the error would become with one effect added; evidence allows for the parameters an effect brings."
    detail = (
        "Predicted from the sensitivities of the fitted model, at the best strength and shape of each effect; nothing was "
        "fitted anew. Adding one by name (fit --effects) or letting refine do it shows what is true of it."
    )
    return [Panel("Which effect is missing?", sentence, to_svg(drawn), "ranking", detail)]


def failure_panels(found: Findings, translational: bool = False) -> list[Panel]:
    """The pictures of what is missing; of a model that explains the record, the torque in time alone."""
    latent, surface = found.latent, found.surface
    here = latent.record == 0
    if surface is None:
        drawn = missing_torque_in_time(latent.t[here], latent.torque[here], latent.stderr[here], unit=latent.unit)
        return [Panel("Missing torque", found.sentences[0], to_svg(drawn), "missing")]
    telling = list({entry.coordinate: entry for entry in reversed(found.significant)}.values())[::-1]
    place = [entry for entry in telling if entry.coordinate == "place"]
    first = [*place, *(entry for entry in telling if entry.coordinate != "place" and entry.strength > 0.1)]
    fails = where_it_fails(first, unit=latent.unit)
    names = " and ".join(LABELS[name] for name in surface.coordinates)
    drawn = missing_torque_in_time(
        latent.t[here], surface.torque[here], latent.stderr[here], unit=latent.unit, explained=surface.fitted[here],
        name=names,
    )  # fmt: skip
    return [
        Panel(
            "Where the model fails",
            "Up to three of the coordinates that tell most; a misfit of 1 would be noise alone.",
            to_svg(fails),
            "fails",
            "Above, the residual of the windowed prediction over the noise (1 would be noise alone), with each place's share of "
            "the missing torque's mean square; below, the missing torque itself in the same bins.",
        ),
        Panel(
            "The missing torque in time",
            "The torque that would have to be added to the model for it to follow the record, estimated inside the prediction "
            "windows together with their starts and the model's parameters.",
            to_svg(drawn),
            "missing",
        ),
        Panel("What the missing torque depends on", _explained(surface), to_svg(_over(surface, translational)), "depends"),
    ]


def _explained(surface: Surface) -> str:
    moved = ", ".join(f"{name} from {a:.5g} to {b:.5g}" for name, (a, b) in surface.moved.items() if abs(b - a) > 1e-3 * abs(a))
    text = f"{surface} The share is told out of sample: stretches of the record are predicted from the others."
    return text + (f" With this torque in place the fit's own values move: {moved}." if moved else "")


def _over(surface: Surface, translational: bool) -> Any:
    length = "m" if translational else "rad"
    units = [UNITS.get(name, "rad").replace("rad", length) for name in surface.coordinates]
    labels = [SYMBOLS.get(name, name) for name in surface.coordinates]
    if len(labels) == 1:
        edges = None
        if surface.coordinates == ("z",) and surface.system.has_play:
            edges = tuple(float(edge) for edge in surface.system.edges(0.0))
        return missing_torque_curve(
            surface.coordinate_values[:, 0], surface.torque, surface.knots[0], surface.table, surface.stderr, label=labels[0],
            unit=surface.unit, coordinate_unit=units[0], edges=edges,
        )  # fmt: skip
    return missing_torque_surface(
        surface.coordinate_values, surface.torque, surface.knots, surface.table, surface.stderr, labels=labels, units=units,
        unit=surface.unit,
    )  # fmt: skip
