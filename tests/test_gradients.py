"""Every derivative the fit uses, against central differences."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxbacklash import base_motion_joint, catalogue, simulate
from jaxbacklash.excitation import Multisine
from jaxbacklash.fitting.setup import first_guess, make_problem
from jaxbacklash.mechanics import Drive
from jaxbacklash.parameters import ravel, specs, unravel
from jaxbacklash.shooting.multiple_shooting import linearise, predictions, residuals, shoot
from jaxbacklash.shooting.problem import Unknowns
from jaxbacklash.shooting.windows import cut
from jaxbacklash.simulation import as_record

from .laws import FORMS, LAWS, MOTOR_LAWS

EVERY = LAWS | FORMS
USUAL = ("gravity", "gap_drift", "dahl", "sensor_delay", "clock_drift")
"""Laws whose residual the default suite looks at: one by place, one that moves the edges, one with a state, two that measure."""
HALF = 0.012
# (z, dz): in the gap, in contact on each side, and close to each edge from both sides.
POINTS = {
    "gap": (0.004, 0.7),
    "contact above": (0.02, -0.5),
    "contact below": (-0.02, 0.6),
    "inside upper edge": (HALF - 1e-4, 0.9),
    "outside upper edge": (HALF + 1e-4, 0.9),
    "inside lower edge": (-HALF + 1e-4, -0.9),
    "outside lower edge": (-HALF - 1e-4, -0.9),
    "slow": (0.02, 0.02),
}


def joint(name, width=0.0):
    system = base_motion_joint(3.2, 2 * HALF, 12000.0, 20.0, width=width)
    return system.with_effects(EVERY[name])


def central(function, point, rel=1e-6):
    """Central difference with a step that suits the size of each coordinate, extrapolated once."""
    columns = []
    for i in range(point.size):
        step = rel * max(abs(point[i]), 1e-2)
        both = [
            (function(point + s * step * np.eye(point.size)[i]) - function(point - s * step * np.eye(point.size)[i]))
            / (2 * s * step)
            for s in (1.0, 2.0)
        ]
        columns.append((4 * both[0] - both[1]) / 3)
    return np.stack(columns, axis=-1)


def test_table_covers_the_catalogue():
    known = {name for name, cls in catalogue().items() if cls.__module__.startswith("jaxbacklash")}
    assert set(LAWS) | set(MOTOR_LAWS) == known


@pytest.mark.parametrize("width", [0.0, 5e-4], ids=["sharp", "smoothed"])
@pytest.mark.parametrize("name", EVERY)
def test_rates_in_parameters_and_state(name, width):
    system = joint(name, width)
    scale = np.maximum(np.abs(ravel(system)), 1e-3)
    hidden = np.full(len(system.state_names) - 2, 0.013)

    def rates(vector, z, dz):
        theta, state = vector[: scale.size] * scale, vector[scale.size :]
        x, dx = 0.3 * z, 0.2 * dz
        found = unravel(system, theta)
        full = (state[0] + x, state[1] + dx, *(state[2 + i] for i in range(hidden.size)))
        drive = Drive(x, dx, 1.3)
        return jnp.stack([*found.rates(0.4, full, drive), found.output(0.4, full, drive)])

    def vector(z, dz):
        return np.concatenate([ravel(system) / scale, [z, dz], hidden])

    keep = [i for i, n in enumerate(specs(system)) if not (n == "width" and width == 0.0)]
    keep += list(range(scale.size, scale.size + 2 + hidden.size))
    exact = jax.jit(jax.jacfwd(rates))
    values = jax.jit(rates)
    for label, (z, dz) in POINTS.items():
        at = vector(z, dz)
        difference = central(lambda v, z=z, dz=dz: np.asarray(values(v, z, dz)), at)
        error = np.abs(np.asarray(exact(at, z, dz)) - difference)[:, keep]
        size = np.abs(difference[:, keep]).max(axis=1, keepdims=True) + 1e-3
        assert np.max(error / size) < 1e-6, f"{name} {label}"
    zs, dzs = (jnp.array(c) for c in zip(*POINTS.values()))
    stacked = jnp.stack([vector(z, dz) for z, dz in POINTS.values()])
    together = jax.vmap(jax.jacfwd(rates))(stacked, zs, dzs)
    for row, (z, dz) in zip(together, POINTS.values()):
        np.testing.assert_allclose(row, exact(vector(z, dz), z, dz), rtol=1e-12, atol=1e-9)


@pytest.fixture(scope="module")
def record():
    system = base_motion_joint(3.2, 2 * HALF, 12000.0, 20.0)
    omegas = 2 * np.pi * np.array([1.3, 3.7, 7.9])
    drive = Multisine(np.array([0.05, 0.02, 0.01]), omegas, np.array([0.3, 1.0, 2.0]))
    rng = np.random.default_rng(5)
    clean = as_record(simulate(system, drive, duration=0.8, rate=500.0), system)
    noisy = {name: values + 3e-5 * rng.standard_normal(values.size) for name, values in clean.channels.items()}
    return clean.replace(**noisy)


@pytest.mark.parametrize("name", [n if n in USUAL else pytest.param(n, marks=pytest.mark.slow) for n in EVERY])
def test_shooting_residual(name, record):
    """The Jacobian blocks of the multiple-shooting residual, every parameter, windows that cross both edges."""
    windows, _ = cut([record], 0.1)
    system = joint(name)
    free = [n for n, spec in specs(system).items() if not spec.fixed]
    problem = make_problem(system, windows, free, tie=1.0)
    start = first_guess(problem)
    starts = jnp.asarray(start.starts).at[2:].add(0.01)
    start = Unknowns(start.theta, starts, start.coefficients)

    @jax.jit
    def stacked(theta):
        parts = residuals(problem, Unknowns(theta, start.starts, start.coefficients))
        return jnp.concatenate([p.ravel() for p in parts])

    exact = np.asarray(jax.jit(jax.jacfwd(stacked))(start.theta))
    difference = central(lambda v: np.asarray(stacked(v)), np.asarray(start.theta), rel=3e-4)
    size = np.abs(difference).max(axis=0) + 1e-9
    # A step across which one of the 400 panels gains or loses a split moves the rounding, not the slope.
    error = np.sort(np.abs(exact - difference) / size, axis=0)
    assert np.max(error[: int(0.995 * error.shape[0])]) < 1e-6

    if name not in ("gravity", "dahl", "sensor_delay"):
        return  # the blocks are assembled alike whatever the law: one of each kind is enough
    z = np.asarray(predictions(problem, start).motion)[np.asarray(windows.weight) > 0]
    assert z.max() > HALF
    assert z.min() < -HALF

    blocks = jax.jit(lambda p, u: linearise(p, u, shoot(p, u)))(problem, start)
    np.testing.assert_allclose(blocks.corner, exact.T @ exact, rtol=1e-8, atol=1e-8 * np.abs(exact.T @ exact).max())
    np.testing.assert_allclose(
        blocks.slope_theta, exact.T @ np.asarray(stacked(start.theta)), rtol=1e-7, atol=1e-7 * np.abs(blocks.slope_theta).max()
    )
