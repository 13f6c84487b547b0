"""The compiled runs of maps insist on no device: they are lowered for a GPU here, without one, and call nothing on the host."""

import re
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxbacklash.dynamics import located
from jaxbacklash.dynamics.courses import course
from jaxbacklash.dynamics.follow import follow_course, follow_exact
from jaxbacklash.dynamics.normal_form import bare_joint, normal_form
from jaxbacklash.dynamics.plan import Plan
from jaxbacklash.effects import CoulombJoint, CubicStiffness
from jaxbacklash.models import case_1

PLAN, LANES = Plan(22, 2, 4), 8
HOST = ("callback", "infeed", "outfeed", "send", "recv")


def runs():
    system, force = case_1()
    one = jnp.ones(LANES)
    form = normal_form(system, force)
    pieces = jax.tree.map(lambda leaf: leaf * one, form.pieces)
    yield "harmonic", follow_exact, (pieces, 0.0 * one, 0.0 * one, 0.0 * one, PLAN.stops)
    joint = jax.tree.map(lambda leaf: leaf * one, bare_joint(system)[0])
    path = course(force, 1.0)
    yield "polynomials", follow_course, (joint, path, 0.1 * one, 0.0 * one, 0.0 * one, PLAN.stops)
    rough = system.with_effects(CubicStiffness(1e6), CoulombJoint(1.0))

    def general(y0):
        return located.follow_located(rough, force, 0.15 * one, y0, 0.0 * one, PLAN, 128)

    yield "located", general, (0.0 * one,)


def static(name):
    return () if name == "located" else (PLAN,)


@pytest.mark.parametrize("name", ["harmonic", "polynomials", "located"])
def test_the_run_is_lowered_for_a_gpu(name):
    run, given = next((run, given) for found, run, given in runs() if found == name)
    traced = jax.jit(run, static_argnums=len(given) if name != "located" else ()).trace(*given, *static(name))
    for platform in ("cuda", "cpu"):
        text = traced.lower(lowering_platforms=(platform,)).as_text()
        assert "stablehlo.while" in text  # one program, with its loops inside
        calls = set(re.findall(r"custom_call @(\w+)", text))
        assert not [call for call in calls if any(word in call.lower() for word in HOST)]
        assert not calls, f"{calls} would have to be there on {platform}"
    primitives = str(traced.jaxpr)
    assert "callback" not in primitives
    assert "device_put" not in primitives


def test_no_line_of_the_path_names_a_device():
    package = Path(located.__file__).parents[1]
    for file in [*package.joinpath("dynamics").glob("*.py"), *package.joinpath("solvers").glob("*.py")]:
        text = file.read_text(encoding="utf-8")
        found = re.findall(r"""["']cpu["']|jax\.devices|device_put|pure_callback|io_callback|debug\.print""", text)
        assert not found, f"{file.name}: {found}"


def test_arrays_stay_where_they_are():
    """What comes out of a run is on the device that was in use when it went in, and nothing else is asked of jax."""
    device = jnp.zeros(1).devices()
    found = follow_exact(*next(given for name, _, given in runs() if name == "harmonic"), PLAN)
    assert found.lyapunov.devices() == device
    assert np.isfinite(found.lyapunov).all()
