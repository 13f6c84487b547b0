"""Where a model of a record of transmitted force fails: the force itself is measured, so what is missing of it is seen directly.

A torque on a link that friction holds would not show, so nothing is sought behind the measurement as in `latent`: the missing
force is what the model's own run through the record leaves, averaged over short stretches.
"""

from __future__ import annotations

from typing import Any, cast

import equinox as eqx
import jax
import numpy as np
from scipy import linalg

from ..fitting import Fit
from ..mechanics import Drive
from ..parameters import unit_text
from ..pointwise import along
from ..shooting.input_spline import local_coefficients
from ..shooting.multiple_shooting import trajectory
from ..shooting.problem import Problem, Unknowns
from .latent import MOTION, NODES, Latent, record_rows
from .shares import out_of_sample, weights
from .surface import SETS, Surface
from .tables import basis_along, choose_knots, smoothness, varies

CLEARLY = 0.7
"""Two coordinates instead of one only if they leave less than this share of what one leaves unexplained."""


def missing_force(fit: Fit) -> Latent:
    """The force missing from the transmitted one along the fit's own run, in stretches of a hundredth of a second or more."""
    assert fit.problem is not None
    assert fit.unknowns is not None
    w = fit.problem.windows
    times, motion, predicted = (np.asarray(v) for v in _along(fit.problem, fit.unknowns))
    group = max(1, round(w.samples / NODES))
    columns: dict[str, list[np.ndarray]] = {}
    for number, (record, rows) in enumerate(zip(fit.records, record_rows(fit.records, w.samples))):
        count = record.samples // group

        def mean(values: np.ndarray, rows: slice = rows, count: int = count) -> np.ndarray:
            return np.asarray(values[rows].ravel()[: count * group].reshape(count, group).mean(axis=1))

        t = mean(times)
        y, dy, x, dx = (mean(v) for v in motion)
        # A force sought as an effect's torque on the link: the transmitted force is the opposite of that.
        left = mean(predicted - np.asarray(w.measured))
        now = along(fit.system, t, y, dy, x, dx).now
        part = {
            "t": t, "record": np.full(t.size, number), "torque": left,
            "stderr": np.full(t.size, fit.noise[number] / np.sqrt(group)),
            **{name: np.broadcast_to(np.asarray(getattr(now, name)), t.shape) for name in MOTION},
            "side": np.sign(np.broadcast_to(np.asarray(now.deflection), t.shape)),
        }  # fmt: skip
        for name, values in part.items():
            columns.setdefault(name, []).append(values)
    found = {name: np.concatenate(parts) for name, parts in columns.items()}
    surplus = 0.5 * float(np.sum((found["torque"] / found["stderr"]) ** 2 - 1.0))
    return Latent(
        **found, evidence=0.0 if fit.adequate else surplus, converged=True, system=fit.system, moved={},
        unit=unit_text("N m", translational=fit.translational), records=fit.records,
        inside=cast(Any, None),  # nothing was smoothed
        port="link",
    )  # fmt: skip


@eqx.filter_jit
def _along(problem: Problem, unknowns: Unknowns) -> tuple[Any, tuple[Any, ...], Any]:
    """Times (W, M), the motion y, y', x, x' there, and the predicted force."""
    w, system = problem.windows, problem.rebuild(unknowns.theta)
    local = local_coefficients(w, unknowns.coefficients)
    each = jax.vmap(trajectory, in_axes=(None, None, 0, 0, 0, 0))
    path = each(problem, unknowns.theta, unknowns.starts.T, local, w.t0, w.force)
    force = jax.vmap(jax.vmap(system.output))(path.times, path.states, Drive(path.drive.x, path.drive.dx, path.drive.force))
    return path.times, (path.states[0], path.states[1], path.drive.x, path.drive.dx), force


def explain_force(latent: Latent, sets: tuple[tuple[str, ...], ...] = SETS) -> Surface:
    """The coordinates that explain a missing force best, or a torque at the motor: tables over one or two of them, by least
    squares, judged on stretches that they were not made from."""
    now = along(latent.system.on_its_base(), latent.t, latent.y, latent.dy, latent.x, latent.dx).now
    weight = weights(latent, latent.torque)
    size = 3.0 * latent.rms
    tried = []
    for names in [n for n in sets if varies(latent, n)] or [("t",)]:
        knots = tuple(choose_knots(latent, name, len(names)) for name in names)
        phi = basis_along(names, knots, now)
        penalty = smoothness(tuple(len(row) for row in knots)) / size**2
        rows = phi.T * weight
        gram = rows @ phi + penalty
        table = linalg.solve(gram, rows @ latent.torque, assume_a="pos")
        spread = np.sqrt(np.maximum(np.diag(linalg.inv(gram)), 0.0))
        left, whole = out_of_sample(latent, phi, latent.torque, penalty)
        gain = 0.5 * latent.t.size * float(np.log(whole / max(left, 1e-12 * whole))) - 0.5 * table.size
        tried.append((max(0.0, 1.0 - left / whole), gain, names, knots, table, spread, phi @ table))
    tried.sort(key=lambda entry: -entry[0])
    best = next(entry for entry in tried if len(entry[2]) == 1)
    if 1.0 - tried[0][0] < CLEARLY * (1.0 - best[0]):
        best = tried[0]
    share, _, names, knots, table, spread, fitted = best
    return Surface(
        names, knots, table, spread, share, tuple((entry[2], entry[0], entry[1]) for entry in tried),
        {name: (before, here) for name, (before, here, _) in latent.moved.items()}, latent.torque, fitted,
        np.stack([getattr(latent, name) for name in names], axis=1), latent.system, latent.unit,
    )  # fmt: skip
