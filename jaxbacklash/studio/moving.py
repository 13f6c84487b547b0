"""Parameters moved by hand: the model with other values beside the record, window by window, as fast as a slider is drawn.

Nothing is fitted: each window begins where the record says, and the parameters are those that were asked for.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

import jaxbacklash as jb

from ..parameters import free_specs, values, with_values
from .tree import Model

REACH = 0.5
"""Share of a value by which it may be moved to either side."""
STDERRS = 8.0
"""The same in standard errors, where that is further."""
LONGEST = 4.0
"""Seconds of a record that are shown while a parameter is moved."""


@dataclass(frozen=True)
class Range:
    """What a parameter may be moved over: ``low`` to ``high`` by ``step``, from ``value``, in ``unit``."""

    name: str
    value: float
    low: float
    high: float
    step: float
    unit: str


def ranges(model: Model) -> list[Range]:
    """The fitted parameters of a model that can be moved.

    Examples
    --------
    >>> record, heldout = jb.demo_records()
    >>> fit = jb.fit(record.between(0.0, 2.0), inertia=3.16, starts=1)
    >>> [one.name for one in ranges(Model(0, None, (), fit))]
    ['backlash', 'stiffness', 'damping']
    """
    found, known = [], values(model.fit.system)
    described = free_specs(model.fit.system)
    for name, estimate in model.fit.parameters.items():
        value, spec = known[name], described.get(name)
        if spec is None:
            continue
        reach = max(REACH * abs(value), STDERRS * (estimate.stderr or 0.0)) or (spec.scale or 1.0)
        low, high = max(value - reach, spec.lower), min(value + reach, spec.upper)
        if high > low:
            found.append(Range(name, value, low, high, (high - low) / 200.0, estimate.unit))
    return found


def moved(model: Model, changes: Mapping[str, float], between: tuple[float, float]) -> Any:
    """The `jaxbacklash.Comparison` of the model with these values and a stretch of its record [s].

    Raises
    ------
    NoAnswer
        With these values the model's motion grows without bound.
    """
    fit = model.fit
    record = fit.records[0].between(*between)
    system = with_values(fit.system, {name: float(value) for name, value in changes.items()})
    return jb.compare(system, record, translational=fit.translational, known=fit.known_noise)


def shown_part(model: Model) -> tuple[float, float]:
    """The stretch of the record that is shown: around the window that the model misses most [s]."""
    score, t = model.fit.score, model.fit.records[0].t
    worst = float(score.window_times[int(np.nanargmax(score.window_rms))])
    first = float(np.clip(worst - 0.5 * LONGEST, t[0], max(t[0], t[-1] - LONGEST)))
    return first, min(first + LONGEST, float(t[-1]))
