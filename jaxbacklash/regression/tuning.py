"""Shape and strength of a law with a memory, tuned on the measured motion before any simulation is fitted.

How far friction gives before it slips, or how round its knee is, does not show at zero strength, so no score test can rank such a
law. Weak-form regression can: the law's state is followed along the measured motion, and its
parameters move until its torque explains what the model leaves, the joint's own parameters moving with them. Of a law whose
states go on for long by themselves, where these began is regressed as well: a record need not begin at rest.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from ..mechanics import AbstractEffect
from ..parameters import free_specs, ravel, specs, unravel, values, with_values
from ..system import System
from .along_motion import own_tangents
from .weak_form import RUNAWAY, WeakForm, whitener


@dataclass(frozen=True)
class Tuned:
    """A law as tuned: ``effect``; ``system``, the model with its free parameters moved along; ``left`` (R,) what both leave of
    the weak form; ``count`` free parameters of the law."""

    effect: AbstractEffect
    system: System
    left: np.ndarray
    count: int


def tune(form: WeakForm, system: System, free: tuple[str, ...], variants: list[AbstractEffect], rounds: int = 2) -> Tuned:
    """The likeliest of some variants of a law, tuned beside a model.

    Parameters
    ----------
    form : the record
    system, free : the model without the law, and the parameters in which it can still move
    variants : points to start from, each at any strength
    rounds : how often the joint moves in answer to the law; the second takes up what the first has linearised
    """
    effect = sized(form, system, free, form.choose(system, free, variants)[0])
    left = np.zeros(0)
    for _ in range(rounds):
        effect, system, left = _round(form, system, free, effect)
    return Tuned(effect, system, left, len(free_specs(effect)))


def sized(form: WeakForm, system: System, free: tuple[str, ...], effect: AbstractEffect) -> AbstractEffect:
    """The law at the strength that the record asks for, its shape kept: all of its torques grow together."""
    left, by = form.missing(system, free)
    design = np.column_stack([by, form.column(effect, system), form.rung(effect, system)])
    white = whitener(left - design @ np.linalg.lstsq(design, left, rcond=None)[0])
    factor = float(np.linalg.lstsq(white(design), white(left), rcond=None)[0][by.shape[1]])
    if not np.isfinite(factor) or factor <= 0.0:
        return effect
    return stronger(effect, factor)


def stronger(effect: AbstractEffect, factor: float) -> AbstractEffect:
    """The law with all of its torques ``factor`` times as large: it gives over the same distance, at the same speeds."""
    torques = {n: v * factor for n, v in values(effect).items() if specs(effect)[n].unit.startswith(("N m", "kg m^2"))}
    return with_values(effect, torques)


def _round(
    form: WeakForm, system: System, free: tuple[str, ...], effect: AbstractEffect, factor: float = 30.0, evaluations: int = 8
) -> tuple[AbstractEffect, System, np.ndarray]:
    """Gauss-Newton within a trust region over the law's parameters, the joint's projected out, then a step of the joint's.

    A positive parameter moves by no more than ``factor`` either way, one and a half decades. A round takes at most
    ``evaluations`` of the law: it proposes a shape, which simulation refines, and need not converge.
    """
    reach = np.log(factor)
    left, by = form.missing(system, free)
    design = np.column_stack([by, form.column(effect, system), form.rung(effect, system)])
    white = whitener(left - design @ np.linalg.lstsq(design, left, rcond=None)[0])
    beside = white(by)

    def projection(law: AbstractEffect) -> Callable[[np.ndarray], np.ndarray]:
        # What the model's own parameters make up for, and where the law's states began.
        basis = np.linalg.qr(np.column_stack([beside, white(form.rung(law, system))]))[0]

        def project(rows: np.ndarray) -> np.ndarray:
            rows = white(rows)
            return rows - basis @ (basis.T @ rows)

        return project

    described, present = free_specs(effect), values(effect)
    index = [list(specs(effect)).index(n) for n in described]
    # What is positive and has no upper bound moves by factors.
    factors = np.array([s.lower >= 0.0 and not np.isfinite(s.upper) for s in described.values()])
    low, high = (np.array([getattr(s, side) for s in described.values()]) for side in ("lower", "upper"))
    begin = np.array([present[n] for n in described])
    begin = np.where(factors, np.maximum(begin, np.maximum(low, 1e-9)), begin)
    size = np.where(factors, begin, 1.0)
    nearest = np.maximum(np.where(factors, low, 0.0) / size, np.exp(-reach))
    bounds = np.where(factors, np.log(nearest), low), np.where(factors, reach, high)
    first = np.where(factors, 0.0, np.clip(begin, bounds[0], bounds[1]))
    full = np.array(ravel(effect))

    def at(p: np.ndarray) -> tuple[AbstractEffect, np.ndarray]:
        sizes = np.where(factors, begin * np.exp(np.where(factors, p, 0.0)), p)
        vector = full.copy()
        vector[index] = sizes
        return unravel(effect, [np.asarray(v) for v in vector]), np.where(factors, sizes, 1.0)

    seen: dict[bytes, tuple[np.ndarray, np.ndarray]] = {}

    def both(p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        if p.tobytes() not in seen:
            law, chain = at(p)
            seeds = np.zeros((len(index), full.size))
            seeds[np.arange(len(index)), index] = chain
            # What cannot be followed explains nothing.
            torque, columns = (np.where(np.abs(v) < RUNAWAY, v, 0.0) for v in own_tangents(law, system, seeds, form.motion))
            project = projection(law)
            seen[p.tobytes()] = project(form.average(torque) - left), project(form.average(columns).T)
        return seen[p.tobytes()]

    found = least_squares(lambda p: both(p)[0], first, jac=lambda p: both(p)[1], bounds=bounds, max_nfev=evaluations)
    effect = at(found.x)[0]
    rest = left - form.column(effect, system)
    design = np.column_stack([by, form.rung(effect, system)])
    change = np.linalg.lstsq(white(design), white(rest), rcond=None)[0]
    return effect, _moved(system, free, change[: by.shape[1]]), rest - design @ change


def _moved(system: System, free: tuple[str, ...], change: np.ndarray) -> System:
    present, described = values(system), specs(system)
    moved = {}
    for name, step in zip(free, change):
        value, spec = present[name], described[name]
        wanted = value + float(step)
        if spec.positive and value > 0.0:  # a regression's step is no measure far away
            wanted = float(np.clip(wanted, 0.5 * value, 2.0 * value))
        moved[name] = float(np.clip(wanted, spec.lower, spec.upper))
    return with_values(system, moved)
