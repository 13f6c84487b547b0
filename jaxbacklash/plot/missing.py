"""Pictures of what a model misses: where it fails, the torque that is missing in time, and what that torque depends on."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..effects.learned import UNITS
from ..errors import BadInput
from ..residuals import Findings, Latent, Surface
from ..residuals.at_motor import MOSTLY
from ..residuals.surface import LABELS
from .drawing import Drawn, Where, empty, picture
from .failures import misfit_and_torque, missing_torque_curve, missing_torque_in_time, missing_torque_surface

SYMBOLS = {"dz": "z′", "dy": "y′", "dx": "x′"}
TELLING = 0.1
"""Share of the ranks' variance that must lie between the bins of a coordinate before it is drawn."""


def where_it_fails(found: Findings, *, ax: Where = None) -> Drawn:
    """Misfit above and missing torque below, against up to three of the coordinates that tell most.

    Parameters
    ----------
    found : from `jaxbacklash.where_it_fails`
    ax : two axes for each coordinate, row by row, or one for the first one's misfit; a figure or part of one; None: a new figure

    Returns
    -------
    the axes, or an array of them

    Examples
    --------
    >>> record, heldout = jb.demo_records()
    >>> fit = jb.fit(record.between(0.0, 2.0), inertia=3.16, starts=1)
    >>> found = jb.where_it_fails(fit)
    >>> jb.plot.where_it_fails(found)[0].get_ylabel()
    'misfit over noise'
    """
    telling = list({entry.coordinate: entry for entry in reversed(found.significant)}.values())[::-1]
    place = [entry for entry in telling if entry.coordinate == "place"]
    first = [*place, *(entry for entry in telling if entry.coordinate != "place" and entry.strength > TELLING)]
    return misfit_and_torque(first, unit=found.latent.unit, ax=ax)


def missing_torque(found: Findings | Latent, *, record: int = 0, ax: Where = None) -> Drawn:
    """The torque that would have to be added to the model for it to follow the record, with its 95 % band.

    Of `Findings` it is the torque beside which its best coordinates stand, with the part that goes with them; where one is
    missing at the motor of a drive and none on its link, that at the motor.

    Parameters
    ----------
    found : from `jaxbacklash.where_it_fails` or `jaxbacklash.missing_torque`
    record : which of a fit's records
    ax : two axes, the whole record and a stretch where the torque is large, or one for the stretch; a figure or part of one;
        None: a new figure

    Returns
    -------
    the axes, or an array of them

    Examples
    --------
    >>> record, heldout = jb.demo_records()
    >>> fit = jb.fit(record.between(0.0, 2.0), inertia=3.16, starts=1)
    >>> found = jb.where_it_fails(fit)
    >>> whole, stretch = jb.plot.missing_torque(found)
    >>> stretch.get_xlabel()
    'time [s]'
    """
    latent = found.latent if isinstance(found, Findings) else found
    surface = found.surface if isinstance(found, Findings) else None
    here = latent.record == record
    if not here.any():
        raise BadInput(f"record {record}: the missing torque was found in {int(latent.record.max()) + 1}, counted from 0")
    motor = found.at_motor if isinstance(found, Findings) else None
    if surface is None and motor is not None and motor.t is not None:
        goes, name = (motor.goes, "the motor's direction") if motor.by_direction > MOSTLY else (None, "")
        band = np.full(motor.t.size, motor.noise)
        return missing_torque_in_time(motor.t, motor.torque, band, unit=motor.unit, explained=goes, name=name, ax=ax)
    if surface is None:
        return missing_torque_in_time(latent.t[here], latent.torque[here], latent.stderr[here], unit=latent.unit, ax=ax)
    names = " and ".join(LABELS[name] for name in surface.coordinates)
    return missing_torque_in_time(
        latent.t[here], surface.torque[here], latent.stderr[here], unit=latent.unit, explained=surface.fitted[here], name=names,
        ax=ax,
    )  # fmt: skip


def torque_over(found: Findings | Surface, *, ax: Where = None) -> Drawn:
    """The missing torque over the one or two coordinates that explain it best, with the band of the table.

    Parameters
    ----------
    found : from `jaxbacklash.where_it_fails` or `jaxbacklash.explain_torque`
    ax : one axes; two, or three, for a torque of two coordinates; a figure or part of one; None: a new figure

    Returns
    -------
    the axes, or an array of them

    Examples
    --------
    >>> record, heldout = jb.demo_records()
    >>> fit = jb.fit(record.between(0.0, 2.0), inertia=3.16, starts=1)
    >>> found = jb.where_it_fails(fit)
    >>> jb.plot.torque_over(found).get_xlabel()
    'y [rad]'
    """
    surface = found.surface if isinstance(found, Findings) else found
    if surface is None:
        return _nothing(ax=ax)
    length = "m" if surface.unit in ("N", "m/s^2") else "rad"
    units = [UNITS.get(name, "rad").replace("rad", length) for name in surface.coordinates]
    labels = [SYMBOLS.get(name, name) for name in surface.coordinates]
    if len(labels) == 1:
        edges: Any = None
        if surface.coordinates == ("z",) and surface.system.has_play:
            edges = tuple(float(edge) for edge in surface.system.edges(0.0))
        return missing_torque_curve(
            surface.coordinate_values[:, 0], surface.torque, surface.knots[0], surface.table, surface.stderr, label=labels[0],
            unit=surface.unit, coordinate_unit=units[0], edges=edges, ax=ax,
        )  # fmt: skip
    return missing_torque_surface(
        surface.coordinate_values, surface.torque, surface.knots, surface.table, surface.stderr, labels=labels, units=units,
        unit=surface.unit, ax=ax,
    )  # fmt: skip


@picture
def _nothing(*, ax: Where = None) -> Any:
    return empty(ax, "No torque is missing.")
