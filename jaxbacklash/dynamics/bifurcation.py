"""Bifurcation diagrams: what a motion settles on as a parameter moves, swept up, swept down, and from many starts.

A sweep goes on from where the motion was at the last value, as an experiment does, and so stays on its attractor until that
ends; sweeping both ways shows hysteresis. Many starts at every value show what no sweep reaches.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from ..errors import BadInput
from ..excitation import AbstractExcitation, Chirp, Harmonic, Rest, Sampled
from ..precision import require_double_precision
from ..system import System
from .family import Family
from .follow import follow, follow_exact
from .labels import need_xarray
from .located import default_panels, over_cells, own_and_shared, sweep_located
from .normal_form import normal_form, why_not
from .periodicity import periodicity, sizes
from .plan import Plan

Array = Any
Sweeps = tuple[Array, Array, Array, Array]
STARTS = ((0.0, 0.0), (1.0, 0.5), (-1.0, 0.5), (2.0, 0.0), (-2.0, 0.0), (0.5, -1.0), (0.0, 1.5), (0.0, -1.5))
"""Starts in half plays, and half plays times the contact's natural frequency."""


def bifurcation(
    family: Family, name: str, values: Any, *, settle: int = 100, samples: int = 60, start: tuple[float, float] = (0.0, 0.0),
    starts: Sequence[tuple[float, float]] | None = None, start_periods: int = 400, period: float | None = None,
    exact: bool | None = None, panels: int | None = None, progress: Callable[[str, float], None] | None = None,
) -> Any:  # fmt: skip
    """Stroboscopic samples and exponents against one parameter, in three ways.

    Parameters
    ----------
    family, name, values : whose parameter takes which values, in rising order
    settle, samples : periods that a sweep lets pass and keeps at every value
    start : (z, dz) where both sweeps begin, relative to the base [rad, rad/s, or the family's own units]
    starts, start_periods : starts (y, dy) from which every value is followed for so many periods, the last ``samples`` kept;
        default: `STARTS`, in half plays of the system
    period, exact, panels : see `follow`; systems that are not linear between the edges are swept by located panels
    progress : called with words and the share done

    Returns
    -------
    `xarray.Dataset` with ``swept_up``, ``swept_down`` (sample, parameter) and ``from_starts`` (start, sample, parameter), and
    the exponents and periods that belong to them; ``attrs["solver"]`` says how

    Raises
    ------
    BadInput
        Unknown parameter, values that do not rise, or a drive that does not repeat, which no sweep can go on under.

    Examples
    --------
    >>> case = jb.dynamics.PaperCase(1)
    >>> found = jb.dynamics.bifurcation(case, "inverse_alpha", [3.8, 4.2], settle=10, samples=8, start_periods=20)
    >>> found.swept_up.dims
    ('sample', 'inverse_alpha')
    """
    require_double_precision("a bifurcation diagram")
    xarray = need_xarray()
    values = np.asarray(values, dtype=float)
    if values.ndim != 1 or values.size < 2 or np.any(np.diff(values) <= 0.0):
        raise BadInput(f"{name}: wanted two or more rising values")
    unit = family.unit(name)
    system, drive = family.build({name: values})
    tell = progress or (lambda words, share: None)
    tell("sweeping", 0.1)
    plan = Plan(settle + max(samples, 20), settle, samples)
    both = sweep(system, drive, start, plan, period=period, exact=exact, panels=panels)
    tell("many starts", 0.6)
    half, speed = (np.broadcast_to(size, values.shape) for size in sizes(system))
    begun = np.asarray(STARTS if starts is None else starts, dtype=float)[:, :, None] * np.ones(values.size)
    if starts is None:
        begun = begun * np.stack([half, speed])
    scaled = family.time_unit == "1/omega_0"
    labels = {"units": "half play" if scaled else "rad"}, {"units": "1/tau" if scaled else "1/s"}
    found: dict[str, Any] = {}
    for k, way in enumerate(("swept_up", "swept_down")):
        z, dz, exponent, error = (np.asarray(part[..., k]).T for part in both)
        order = slice(None) if k == 0 else slice(None, None, -1)
        z, dz, exponent, error = (part[..., order] for part in (z, dz, exponent, error))
        found[way] = (("sample", name), z, labels[0])
        found[f"{way}_lyapunov"] = ((name,), exponent, labels[1])
        found[f"{way}_period"] = ((name,), periodicity(z, dz, exponent, error, scale=half, speed=speed))
    plan = Plan(start_periods, max(0, start_periods - max(100, samples)), samples)
    lanes = family.build({name: np.tile(values, len(begun))})
    many, solver = follow(*lanes, begun[:, 0].ravel(), begun[:, 1].ravel(), plan, period=period, exact=exact, panels=panels)
    shape = (len(begun), values.size)
    repeats = periodicity(
        many.p, many.v, many.lyapunov, many.stderr, scale=np.tile(half, len(begun)), speed=np.tile(speed, len(begun))
    )
    found["from_starts"] = (("sample", "start", name), np.asarray(many.p).reshape(samples, *shape), labels[0])
    found["from_starts_lyapunov"] = (("start", name), np.asarray(many.lyapunov).reshape(shape), labels[1])
    found["from_starts_period"] = (("start", name), repeats.reshape(shape))
    axis = {name: (name, values, {"units": unit, "long_name": family.long_name(name)})}
    return xarray.Dataset(found, axis, {"solver": solver})


def sweep(
    system: System, drive: AbstractExcitation, start: Any, plan: Plan, *, period: float | None = None, exact: bool | None = None,
    panels: int | None = None,
) -> Sweeps:  # fmt: skip
    """Both sweeps at once, one lane up and one down: samples z, dz (V, S, 2) and exponents with error bars (V, 2).

    Parameters
    ----------
    system, drive : their parameters, or some, arrays (V,) over the values of the sweep
    start : (z, dz) at the first value of each sweep, relative to the base

    Raises
    ------
    BadInput
        The drive does not repeat.
    """
    start = np.asarray(start, dtype=float)
    if exact is not False and period is None and why_not(system, drive) is None:
        return _sweep_exact(normal_form(system, drive), start, plan)  # type: ignore[arg-type]
    if isinstance(drive, Chirp | Rest | Sampled) or (period is None and not isinstance(drive, Harmonic)):
        raise BadInput(
            f"a sweep goes on from value to value and wants a drive that repeats, this is a {type(drive).__name__}: "
            "a map follows every value from the start"
        )
    shape = np.broadcast_shapes(*(np.shape(leaf) for leaf in jax.tree.leaves(system)), *_shapes(drive))
    length = (2.0 * np.pi / np.asarray(drive.omega) if period is None else period) * np.ones(shape)  # type: ignore[attr-defined]
    count = panels or default_panels(system, length)
    own, shared = own_and_shared(drive, length)
    system, own, periods = _both_ways((over_cells(system, length), own, jnp.asarray(length)))
    return sweep_located(system, own, shared, periods, start[0] * np.ones(2), start[1] * np.ones(2), plan, count)


def _shapes(drive: AbstractExcitation) -> list[tuple[int, ...]]:
    return [np.shape(leaf) for name, leaf in vars(drive).items() if name not in drive.series and leaf is not None]


def _both_ways(tree: Any) -> Any:
    """Leaves (V,) become (V, 2), as they are and turned round."""
    return jax.tree.map(lambda leaf: jnp.stack([leaf, leaf[::-1]], axis=-1), tree)


def _sweep_exact(form: Any, start: Array, plan: Plan) -> Sweeps:
    pair = _both_ways(form)

    def one(carry: Any, at: Any) -> Any:
        z, dz = carry
        # Every value has its own play, in whose units the motion goes on.
        p0, v0 = (z - at.middle) / at.half_play, dz / at.half_play
        found = follow_exact(at.pieces, at.phase, p0, v0, plan.stops, plan)
        z, dz = at.middle + at.half_play * found.p, at.half_play * found.v
        last = at.middle + at.half_play * found.last[0], at.half_play * found.last[1]
        return last, (z, dz, found.lyapunov, found.stderr)

    return jax.lax.scan(one, (start[0] * jnp.ones(2), start[1] * jnp.ones(2)), pair)[1]
