"""The fit on records whose truth is known: what it finds, and what it says it cannot find."""

import json

import numpy as np
import pytest

import jaxbacklash as jb
from jaxbacklash.effects import CoulombGround, Preload
from jaxbacklash.excitation import Multisine
from jaxbacklash.models import linear_oscillator
from jaxbacklash.shooting.levenberg import _minimise
from jaxbacklash.simulation import as_record

TRUTH = {"backlash": 0.02618, "stiffness": 13000.0, "damping": 12.0}


def measured(system, amplitudes, *, force=False, seed=0, noise=3e-5, duration=12.0, rate=500.0, **start):
    """A noisy record of a system under a multisine at 1.1, 2.9 and 5.3 Hz."""
    rng = np.random.default_rng(seed)
    omegas = 2 * np.pi * np.array([1.1, 2.9, 5.3])
    drive = Multisine(np.asarray(amplitudes), omegas, np.array([0.0, 1.0, 2.0]), as_force=force)
    clean = as_record(jb.simulate(system, drive, duration=duration, rate=rate, **start), system)
    motions = {n: v + noise * rng.standard_normal(v.size) for n, v in clean.channels.items() if n != "F"}
    return clean.replace(**motions)


def joint(**changes):
    return jb.base_motion_joint(3.16, *(changes.get(name, value) for name, value in TRUTH.items()))


def assert_holds(found, truth, sigmas=4.5):
    for name, value in truth.items():
        estimate = found.parameters[name]
        assert estimate.verdict == "found"
        assert abs(estimate.value - value) < sigmas * estimate.stderr, f"{name}: {estimate}"


def test_base_motion():
    found = jb.fit(measured(joint(), [0.05, 0.02, 0.01]), inertia=3.16)
    assert_holds(found, TRUTH)
    assert found.score.rms == pytest.approx(1.0, abs=0.05)
    assert found.tied
    assert found.agreeing == found.tried == 4
    text = str(found)
    assert "backlash (total play)" in text
    assert "4 of 4 starts" in text


def test_absolute_motion_instead_of_relative():
    record = measured(joint(), [0.05, 0.02, 0.01])
    x, z = record.channels["x"], record.channels["z"]
    rng = np.random.default_rng(8)
    clean = jb.Record(record.t, {"x": x + 3e-5 * rng.standard_normal(x.size), "y": x + z})
    found = jb.fit(clean, inertia=3.16, starts=1)
    for name, value in TRUTH.items():
        assert found.parameters[name].value == pytest.approx(value, rel=3e-3)


def test_force_driven_with_and_without_inertia():
    system = jb.System(3.16, joint().contact, joint().damper, observed="y")
    record = measured(system, [80.0, 60.0, 50.0], force=True)
    assert_holds(jb.fit(record, inertia=3.16, starts=1), TRUTH)
    assert_holds(jb.fit(record, starts=1), TRUTH | {"inertia": 3.16})


def test_free_decay():
    clean = jb.simulate(joint(), duration=6.0, rate=500.0, y0=0.06, dy0=0.0)
    rng = np.random.default_rng(4)
    record = jb.Record(np.asarray(clean.t), {"z": np.asarray(clean.y) + 3e-5 * rng.standard_normal(clean.t.size)})
    assert_holds(jb.fit(record, inertia=3.16, starts=1), TRUTH)


def test_several_records_share_parameters():
    one = measured(joint(), [0.05, 0.02, 0.01], seed=1, duration=6.0)
    two = measured(joint(), [0.03, 0.03, 0.02], seed=2, duration=6.0)
    both = jb.fit([one, two], inertia=3.16, starts=1)
    assert_holds(both, TRUTH)
    assert len(both.scores) == 2
    alone = [jb.fit(r, inertia=3.16, starts=1) for r in (one, two)]
    for name in TRUTH:
        information = sum(a.parameters[name].stderr ** -2 for a in alone)
        assert both.parameters[name].stderr < 1.3 * information**-0.5


def test_records_of_different_rates_are_refused():
    one = measured(joint(), [0.05, 0.02, 0.01], duration=4.0)
    two = measured(joint(), [0.05, 0.02, 0.01], duration=4.0, rate=400.0)
    with pytest.raises(jb.BadInput, match="--resample-rate 500"):
        jb.fit([one, two], inertia=3.16)


def test_an_effect_added_by_hand():
    system = joint().with_effects(CoulombGround(3.0))
    record = measured(system, [0.05, 0.02, 0.01])
    base = jb.fit(record, inertia=3.16, starts=1)
    assert base.score.median > 1.5
    assert "misses something" in str(base)
    full = jb.fit(record, inertia=3.16, effects=["coulomb_ground"], starts=1)
    assert_holds(full, TRUTH | {"coulomb_ground.Tc": 3.0})
    assert full.score.median < 1.1


def test_linear_model():
    record = measured(linear_oscillator(3.16, 13000.0, 12.0), [0.02, 0.01, 0.01])
    found = jb.fit(record, model="linear", inertia=3.16, starts=1)
    assert_holds(found, {"stiffness": 13000.0, "damping": 12.0})
    assert "backlash" not in found.parameters


def test_a_record_that_never_leaves_the_play():
    found = jb.fit(measured(joint(), [0.002, 0.001, 0.001]), inertia=3.16, starts=1)
    for name in ("backlash", "stiffness"):
        estimate = found.parameters[name]
        assert estimate.verdict == "not determined"
        assert estimate.value is None
        # A play that is fitted beside a stiffness of nothing may lie within the motion.
        assert "never leaves the play" in estimate.why or "is not clear of zero" in estimate.why
    assert found.parameters["damping"].value == pytest.approx(12.0, rel=0.02)
    assert found.parameters["backlash"].why in str(found)


def test_a_record_that_touches_one_side_only():
    system = joint().with_effects(Preload(40.0))
    record = measured(system, [0.004, 0.003, 0.002], y0=0.0162)
    assert record.channels["z"].min() > -0.013
    found = jb.fit(record, inertia=3.16, effects=["preload"], starts=1)
    estimate = found.parameters["backlash"]
    assert estimate.verdict == "one-sided"
    assert estimate.value is None
    assert "only the upper edge" in estimate.why
    assert found.parameters["stiffness"].value == pytest.approx(13000.0, rel=0.01)


def test_profile_likelihood_agrees_with_the_curvature():
    found = jb.fit(measured(joint(), [0.05, 0.02, 0.01], duration=4.0), inertia=3.16, starts=1, profile=True)
    for estimate in found.parameters.values():
        low, high = estimate.ci95
        assert high - low == pytest.approx(2 * 1.96 * estimate.stderr, rel=0.15)
        assert low < estimate.value < high


def test_a_record_four_times_as_long_compiles_nothing():
    counts = []
    for duration in (5.0, 20.0):
        jb.fit(measured(joint(), [0.05, 0.02, 0.01], duration=duration), inertia=3.16, starts=1)
        counts.append(len(_minimise.programs))
    assert counts[0] == counts[1] > 0


@pytest.mark.shared
@pytest.mark.parametrize("name", ["p01", "p02", "p03"])
def test_practice_records_without_anything_missing(shared, name):
    folder = shared / "records" / name
    answer = json.loads((folder / "answer.json").read_text())
    truth = {key: answer["truth"][key] for key in TRUTH}
    found = jb.fit(
        jb.read_record(folder / "train.csv"), inertia=answer["truth"]["J"], heldout=jb.read_record(folder / "heldout.csv")
    )
    assert_holds(found, truth, 3.5)
    for key, within in (("backlash", 1e-3), ("stiffness", 1e-3), ("damping", 5e-3)):
        assert found.parameters[key].value == pytest.approx(truth[key], rel=within)
    assert 0.95 < found.score.median < 1.05
    assert 0.95 < found.heldout.median < 1.05


@pytest.mark.slow
@pytest.mark.shared
def test_motor_driven_axis(shared):
    """EMPS, published values of PROVENANCE: M 95.1089 kg, Fv 203.5034 N s/m, Fc 20.3935 N."""
    record = jb.read_record(
        shared / "real" / "EMPS" / "DATA_EMPS.mat", columns={"t": "t", "F": "vir", "y": "qm"}, scales={"F": 35.15065}
    )
    for effects, within in ((["coulomb_ground"], 0.015), (["coulomb_ground", "preload"], 0.005)):
        found = jb.fit(record, model="free", effects=effects, translational=True, starts=1)
        inertia = found.parameters["inertia"]
        assert inertia.value == pytest.approx(95.1089, rel=within)
        assert abs(inertia.value - 95.1089) < 2.0 * inertia.stderr
        assert found.parameters["damping"].value == pytest.approx(203.5034, rel=0.03)
        assert found.parameters["coulomb_ground.Tc"].value == pytest.approx(20.3935, rel=0.03)
    without = jb.fit(record, model="free", translational=True, starts=1)
    assert without.score.rms > 2 * found.score.rms


@pytest.mark.slow
def test_an_axis_without_a_joint_rubs_on_the_ground():
    """Dry friction and an offset of a driven mass, by name and by value; there is no joint whose friction it could be."""
    pytest.importorskip("numba", reason="the generator needs numba")
    from tests.independent.generator import simulate_truth
    from tests.independent.motions import Multisine
    from tests.independent.rigs import Excitation, Rig

    rng = np.random.default_rng(1)
    drive = Multisine(np.array([250.0, 200.0, 150.0]), np.array([0.4, 0.9, 1.7]), rng.uniform(-np.pi, np.pi, 3))
    hides = {"coulomb_ground": {"Tc": 20.0}, "preload": {"T0": 3.0}}
    truth = simulate_truth(Rig(95.0, 0.0, 0.0, 200.0), hides, Excitation("multisine", force=drive), 500.0, 8.0)
    record = jb.Record(truth["t"], {"F": truth["F"], "y": truth["y"] + 1e-5 * rng.standard_normal(truth["t"].size)})
    found = jb.refine(record, model="free", translational=True)
    assert found.effects == ("coulomb_ground", "preload")
    assert found.verdict.complete
    wanted = {"inertia": 95.0, "damping": 200.0, "coulomb_ground.Tc": 20.0, "preload.T0": 3.0}
    for name, value in wanted.items():
        assert found.fit.parameters[name].value == pytest.approx(value, abs=4.0 * found.fit.parameters[name].stderr)


@pytest.mark.slow
@pytest.mark.parametrize("sigma", [0.0, 3e-5])
def test_an_input_as_good_as_exact_has_no_samples_to_count(sigma):
    """Its rows leave nothing: counted as samples they made a right model look better than its noise, and the noise too large."""
    pytest.importorskip("numba", reason="the generator needs numba")
    from jaxbacklash.criticism.model_fitter import ModelFitter
    from jaxbacklash.fitting.setup import base_system
    from tests.independent.generator import make_excitation, make_rig, measure, simulate_truth

    rng = np.random.default_rng(3)
    rig = make_rig(rng)
    truth = simulate_truth(rig, {}, make_excitation(rng, "stepped", 8.0), 500.0, 8.0)
    seen = measure(truth, rng, sigma, 3e-5)
    record = jb.Record(seen["t"], {"x": seen["x"], "z": seen["z"]})
    base, free, _ = base_system(record, "joint", rig.inertia)
    model = ModelFitter(record, base, free, 0.2).fit_model({})
    assert model.tied
    assert model.misfit == pytest.approx(1.0, abs=0.03)
