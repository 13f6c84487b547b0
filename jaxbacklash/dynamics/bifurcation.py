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
from ..precision import require_double_precision
from .family import Family
from .follow import follow, follow_exact
from .labels import need_xarray
from .normal_form import normal_form, why_not
from .periodicity import periodicity
from .plan import Plan

Array = Any
STARTS = ((0.0, 0.0), (1.0, 0.5), (-1.0, 0.5), (2.0, 0.0), (-2.0, 0.0), (0.5, -1.0), (0.0, 1.5), (0.0, -1.5))


def bifurcation(
    family: Family, name: str, values: Any, *, settle: int = 100, samples: int = 60, start: tuple[float, float] = (0.0, 0.0),
    starts: Sequence[tuple[float, float]] = STARTS, start_periods: int = 400,
    progress: Callable[[str, float], None] | None = None,
) -> Any:  # fmt: skip
    """Stroboscopic samples and exponents against one parameter, in three ways.

    Parameters
    ----------
    family, name, values : whose parameter takes which values, in rising order
    settle, samples : periods that a sweep lets pass and keeps at every value
    start : (y, dy) where both sweeps begin
    starts, start_periods : starts from which every value is followed for so many periods, the last ``samples`` kept
    progress : called with words and the share done

    Returns
    -------
    `xarray.Dataset` with ``swept_up``, ``swept_down`` (sample, parameter) and ``from_starts`` (start, sample, parameter), and
    the exponents and periods that belong to them

    Raises
    ------
    BadInput
        Unknown parameter, values that do not rise, or a system that has no exact steps (sweeps of others take minutes each).
    """
    require_double_precision("a bifurcation diagram")
    xarray = need_xarray()
    values = np.asarray(values, dtype=float)
    if values.ndim != 1 or values.size < 2 or np.any(np.diff(values) <= 0.0):
        raise BadInput(f"{name}: wanted two or more rising values")
    unit = family.unit(name)
    system, drive = family.build({name: values})
    why = why_not(system, drive)
    if why is not None:
        raise BadInput(f"a sweep needs exact steps, and {why}; a map over starts does it the long way")
    form = normal_form(system, drive)  # type: ignore[arg-type]
    tell = progress or (lambda words, share: None)
    tell("sweeping", 0.1)
    plan = Plan(settle + max(samples, 20), settle, samples)
    both = sweep(form, np.asarray(start), plan)
    tell("many starts", 0.6)
    many = _from_starts(family, name, values, starts, start_periods, samples)
    half, middle = np.asarray(form.half_play), np.asarray(form.middle)
    unit_z = "half play" if family.time_unit == "1/omega_0" else "rad"
    found: dict[str, Any] = {}
    for k, way in enumerate(("swept_up", "swept_down")):
        p, v, exponent, error = (np.asarray(part[..., k]).T for part in both)
        order = slice(None) if k == 0 else slice(None, None, -1)
        p, v, exponent, error = (part[..., order] for part in (p, v, exponent, error))
        found[way] = (("sample", name), middle + half * p, {"units": unit_z})
        found[f"{way}_lyapunov"] = ((name,), exponent, {"units": "1/tau" if unit_z == "half play" else "1/s"})
        found[f"{way}_period"] = ((name,), periodicity(p, v, exponent, error))
    found |= many
    return xarray.Dataset(found, {name: (name, values, {"units": unit, "long_name": family.long_name(name)})})


def sweep(form: Any, start: Array, plan: Plan) -> tuple[Array, Array, Array, Array]:
    """Both sweeps at once, one lane up and one down; samples p, v (N, S, 2) and exponents with error bars (N, 2)."""
    pair = jax.tree.map(lambda leaf: jnp.stack([leaf, leaf[::-1]], axis=-1), form)
    half, middle = pair.half_play[0], pair.middle[0]
    begun = ((start[0] - middle) / half, start[1] / half)

    def one(carry: Any, at: Any) -> Any:
        found = follow_exact(at.pieces, at.phase, *carry, plan.stops, plan)
        z, dz = at.middle + at.half_play * found.last[0], at.half_play * found.last[1]
        # The next value may have another play, in whose units the motion goes on.
        return (z, dz), (found.p, found.v, found.lyapunov, found.stderr)

    def scaled(carry: Any, at: Any) -> Any:
        return one(((carry[0] - at.middle) / at.half_play, carry[1] / at.half_play), at)

    first = (middle + half * begun[0], half * begun[1])
    return jax.lax.scan(scaled, first, pair)[1]


def _from_starts(
    family: Family, name: str, values: np.ndarray, starts: Sequence[tuple[float, float]], periods: int, samples: int
) -> dict[str, Any]:
    lanes = np.tile(values, len(starts))
    y0, dy0 = (np.repeat([s[k] for s in starts], values.size) for k in (0, 1))
    system, drive = family.build({name: lanes})
    found, _ = follow(system, drive, y0, dy0, Plan(periods, max(0, periods - max(100, samples)), samples))
    shape = (samples, len(starts), values.size)
    period = periodicity(found.p, found.v, found.lyapunov, found.stderr)
    return {
        "from_starts": (("sample", "start", name), np.asarray(found.p).reshape(shape)),
        "from_starts_lyapunov": (("start", name), np.asarray(found.lyapunov).reshape(shape[1:])),
        "from_starts_period": (("start", name), period.reshape(shape[1:])),
    }
