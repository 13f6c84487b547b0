"""Pictures of labelled datasets: maps over two parameters, lines over one, bifurcation diagrams, and basins of attraction."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..dynamics import Basins
from ..errors import BadInput
from .drawing import Drawn, Where
from .maps import LABELS, basin_picture, bifurcation_diagram, exponent_and_period_map, exponent_curve

HALF_PLAY = "half play"
WAYS = {"swept_up": "swept up", "swept_down": "swept down"}


def map(found: Any, *, degrees: bool = False, ax: Where = None) -> Drawn:
    """Two maps over two parameters: the largest exponent (zero is white), and the period of the motion.

    Parameters
    ----------
    found : `xarray.Dataset` of two axes from `jaxbacklash.dynamics.paper_map` or `run_map`, or read from what the command wrote
    degrees : show axes that are in rad in degrees
    ax : two axes, or one for the exponent; a figure or part of one; None: a new figure

    Returns
    -------
    the axes, or an array of them

    Raises
    ------
    BadInput
        The map has one axis, or more than two: choose among the others' values first, ``found.isel(zeta=0)``.

    Examples
    --------
    >>> found = jb.dynamics.paper_map(1, {"inverse_alpha": [1.5, 2.0, 3.0], "zeta": [0.02, 0.03]}, periods=60, skip=20)
    >>> exponent, period = jb.plot.map(found)
    >>> exponent.get_xlabel(), exponent.get_ylabel()
    ('1/α', 'ζ')
    """
    first, second = _axes(found, 2)
    (x, name, unit), (y, other, other_unit) = (_axis(found, one, degrees) for one in (first, second))
    order = (first, second)
    return exponent_and_period_map(
        x, y, found["lyapunov"].transpose(*order).values, found["period"].transpose(*order).values, names=[name, other],
        units=[unit, other_unit], exponent_unit=_unit(found["lyapunov"]), ax=ax,
    )  # fmt: skip


def exponents(
    found: Any, *, samples: bool = True, degrees: bool = False, play: tuple[float, float] | None = None, ax: Where = None
) -> Drawn:
    """The largest exponent over one parameter with its error bar; below, where the motion is at whole periods of the drive.

    Parameters
    ----------
    found : `xarray.Dataset` of one axis from `jaxbacklash.dynamics.paper_map` or `run_map`
    samples : draw the samples below
    degrees : show an axis that is in rad in degrees
    play : edges of the play in the samples' unit, drawn as a band; None: known where that unit is the half play
    ax : two axes, or one for the exponent; a figure or part of one; None: a new figure

    Returns
    -------
    the axes, or an array of them

    Raises
    ------
    BadInput
        The map has more axes than one: choose among the others' values first, ``found.isel(zeta=0)``.

    Examples
    --------
    >>> found = jb.dynamics.paper_map(1, {"inverse_alpha": [1.5, 2.0, 3.0], "zeta": [0.02, 0.03]}, periods=60, skip=20)
    >>> exponent, motion = jb.plot.exponents(found.isel(zeta=0))
    >>> exponent.get_ylabel()
    'largest exponent [1/tau]'
    """
    (only,) = _axes(found, 1)
    x, name, unit = _axis(found, only, degrees)
    kept = found["poincare"].transpose("sample", only) if samples else None
    length = HALF_PLAY if kept is None else _unit(kept)
    return exponent_curve(
        x, found["lyapunov"].values, found["lyapunov_stderr"].values, name=name, unit=unit,
        exponent_unit=_unit(found["lyapunov"]), samples=None if kept is None else kept.values, play=_band(play, length),
        length="half plays" if length == HALF_PLAY else length, ax=ax,
    )  # fmt: skip


def bifurcation(found: Any, *, degrees: bool = False, play: tuple[float, float] | None = None, ax: Where = None) -> Drawn:
    """Where the motion is at whole periods of the drive, over one parameter: swept up, swept down, and from many starts.

    Parameters
    ----------
    found : `xarray.Dataset` from `jaxbacklash.dynamics.bifurcation`
    degrees : show an axis that is in rad in degrees
    play : edges of the play in the samples' unit, drawn as a band; None: known where that unit is the half play
    ax : three axes, or one for all; a figure or part of one; None: a new figure

    Returns
    -------
    the axes, or an array of them

    Examples
    --------
    >>> case = jb.dynamics.PaperCase(1)
    >>> found = jb.dynamics.bifurcation(case, "inverse_alpha", [3.8, 4.2], settle=10, samples=8, start_periods=20)
    >>> len(jb.plot.bifurcation(found))
    3
    """
    if "swept_up" not in found:
        raise BadInput("the dataset holds no sweep (swept_up), wanted one from jaxbacklash.dynamics.bifurcation")
    (only,) = found["swept_up_lyapunov"].dims
    x, name, unit = _axis(found, only, degrees)
    length = _unit(found["swept_up"])
    count = found.sizes["start"]
    branches = {words: found[way].transpose("sample", only).values for way, words in WAYS.items()}
    many = found["from_starts"].transpose("sample", "start", only).values
    return bifurcation_diagram(
        x, branches | {f"from {count} starts": many}, name=name, unit=unit,
        length="half plays" if length == HALF_PLAY else length, play=_band(play, length), ax=ax,
    )  # fmt: skip


def basins(found: Basins, *, play: tuple[float, float] | None = None, ax: Where = None) -> Drawn:
    """Which attractor each start leads to, and the attractors' own points.

    Parameters
    ----------
    found : from `jaxbacklash.dynamics.basins`
    play : edges of the play in the unit of the starts; None: known where that is the half play
    ax : one axes; a figure or part of one; None: a new figure

    Returns
    -------
    the axes

    Examples
    --------
    >>> case = jb.dynamics.PaperCase(1)
    >>> found = jb.dynamics.basins(case, {"inverse_alpha": 3.0}, [-1.0, 0.0, 1.0], [-1.0, 0.0, 1.0], periods=120)
    >>> jb.plot.basins(found).get_xlabel()
    'p at the start [half plays]'
    """
    return basin_picture(
        found.y, found.dy, found.number, words=[str(one) for one in found.attractors],
        samples=[np.stack([one.p, one.v]) for one in found.attractors],
        length="half plays" if found.unit == HALF_PLAY else found.unit, play=_band(play, found.unit), ax=ax,
    )  # fmt: skip


def _axes(found: Any, wanted: int) -> tuple[str, ...]:
    if "lyapunov" not in found:
        raise BadInput("the dataset holds no exponents (lyapunov), wanted a map from jaxbacklash.dynamics.run_map or paper_map")
    names = tuple(str(name) for name in found["lyapunov"].dims)
    if len(names) != wanted:
        axes = "one axis" if wanted == 1 else f"{wanted} axes"
        raise BadInput(f"the map is over {', '.join(names) or 'nothing'}, wanted {axes}: choose with found.isel or found.sel")
    return names


def _axis(found: Any, name: str, degrees: bool) -> tuple[np.ndarray, str, str]:
    """Values, name and unit of one axis."""
    values, unit = np.asarray(found[name].values, dtype=float), _unit(found[name])
    words = name if name in LABELS else str(found[name].attrs.get("long_name", name))
    return (np.degrees(values), words, "deg") if degrees and unit == "rad" else (values, words, unit)


def _unit(values: Any) -> str:
    return str(values.attrs.get("units", "1"))


def _band(play: tuple[float, float] | None, unit: str) -> tuple[float, float] | None:
    return (-1.0, 1.0) if play is None and unit == HALF_PLAY else play
