"""The package's solvers are diffrax's own kind: `diffrax.diffeqsolve` takes the same steps as a map or a simulation does."""

import diffrax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxbacklash.dynamics.courses import course
from jaxbacklash.dynamics.family import PaperCase
from jaxbacklash.dynamics.follow import follow_course, follow_exact
from jaxbacklash.dynamics.normal_form import bare_joint, normal_form
from jaxbacklash.dynamics.plan import Plan
from jaxbacklash.excitation import Chirp
from jaxbacklash.models import base_motion_joint
from jaxbacklash.simulation import Driven, default_panels, simulate
from jaxbacklash.solvers.exact_courses import Along, ExactCourse
from jaxbacklash.solvers.exact_periods import ExactPeriods, Pieces, begin
from jaxbacklash.solvers.panel_solver import DrivenTerm, PanelRK4

PLAN = Plan(40, 10, 8)


def by_diffrax(term, solver, args, lanes):
    """Position and speed at the plan's stops, (stops, lanes) each, stepped by `diffrax.diffeqsolve`."""
    stops = jnp.asarray(PLAN.stops)
    start = begin(jnp.zeros(lanes), jnp.zeros(lanes))
    found = diffrax.diffeqsolve(
        term, solver, stops[0], stops[-1], None, start, args, stepsize_controller=diffrax.StepTo(ts=stops),
        saveat=diffrax.SaveAt(ts=stops), max_steps=stops.size, adjoint=diffrax.ForwardMode(),
    )  # fmt: skip
    return found.ys


def test_periods():
    system, drive = PaperCase(1).build({"inverse_alpha": np.array([0.9, 2.0, 4.4]), "zeta": np.array([0.01, 0.02, 0.03])})
    form = normal_form(system, drive)
    theirs = by_diffrax(Pieces(), ExactPeriods(), (form.pieces, form.phase), 3)
    zero = jnp.zeros(3)
    ours = follow_exact(form.pieces, form.phase, zero, zero, PLAN.stops, PLAN)
    np.testing.assert_allclose(theirs.p[-PLAN.samples :], ours.p, rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(theirs.v[-PLAN.samples :], ours.v, rtol=0.0, atol=1e-9)
    counted = PLAN.periods - PLAN.skip
    growth = theirs.growth[-1] - theirs.growth[np.searchsorted(PLAN.stops, PLAN.skip)]
    np.testing.assert_allclose(growth / counted / (2.0 * np.pi / 0.2), ours.lyapunov, rtol=1e-7, atol=1e-9)


@pytest.mark.parametrize("amplitude", [0.02, 0.05])
def test_a_course(amplitude):
    system = base_motion_joint(inertia=1.0, backlash=0.02, stiffness=900.0, damping=1.5)
    drive = Chirp(amplitude, 2.0, 6.0, 20.0)
    path, (joint, _, _) = course(drive, 10.0), bare_joint(system)
    period = jnp.full(2, 0.25)
    joint = type(joint)(*(number * jnp.ones(2) for number in joint))
    theirs = by_diffrax(Along(), ExactCourse(), (joint, path, period), 2)
    ours = follow_course(joint, path, period, jnp.zeros(2), jnp.zeros(2), PLAN.stops, PLAN)
    np.testing.assert_allclose(theirs.p[-PLAN.samples :], ours.p, rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(theirs.v[-PLAN.samples :], ours.v, rtol=0.0, atol=1e-8)
    assert np.abs(theirs.p).max() > 1.0  # it has met the edges


def test_panels_and_the_motion_between_them():
    system, drive, rate = base_motion_joint(1.0, 0.02, 900.0, 1.5), Chirp(0.05, 2.0, 6.0, 2.0), 200.0
    ours = simulate(system, drive, duration=2.0, rate=rate)
    every, start = default_panels(system, rate), tuple(part[0] for part in ours.states)
    found = diffrax.diffeqsolve(
        DrivenTerm(), PanelRK4(400 * every, 400, True), 0.0, 2.0, 2.0, start, Driven(system, drive, jnp.zeros(())),
        saveat=diffrax.SaveAt(dense=True), max_steps=1, adjoint=diffrax.ForwardMode(),
    )  # fmt: skip
    for k in (0, 57, 400):
        np.testing.assert_allclose(found.evaluate(k / rate)[0], ours.states[0][k], rtol=0.0, atol=1e-12)
    between = found.evaluate(57.5 / rate)[0]
    np.testing.assert_allclose(between, 0.5 * (ours.states[0][57] + ours.states[0][58]), rtol=0.0, atol=1e-12)
