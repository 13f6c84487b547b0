"""Laws say for what they make sense: none of a turning link is proposed, or taken, for a mass that slides."""

import numpy as np
import pytest

import jaxbacklash as jb
from jaxbacklash.criticism.laws_for import laws_for
from jaxbacklash.fitting.setup import base_system
from jaxbacklash.mechanics import Drive
from website import catalogue

from .in_process import call
from .laws import LAWS

JOINT = jb.base_motion_joint(inertia=2.0, backlash=0.02, stiffness=9000.0, damping=10.0)


def pushed(seed=3, seconds=3.0, rate=200.0):
    """A mass on a spring under a sum of sines, begun at rest."""
    rng = np.random.default_rng(seed)
    t = np.arange(round(seconds * rate)) / rate
    force = sum(8.0 * np.sin(2.0 * np.pi * f * t + p) for f, p in zip((0.7, 1.9, 3.1), rng.uniform(0.0, 6.28, 3)))
    y, v, places = 0.0, 0.0, []
    for push in force:
        places.append(y)
        for _ in range(20):
            v += (push - 600.0 * y - 4.0 * v) / 2.0 / (20.0 * rate)
            y += v / (20.0 * rate)
    return jb.Record(t, {"F": force, "y": np.array(places) + 1e-5 * rng.standard_normal(t.size)})


def test_every_law_makes_sense_for_something():
    for name, law in jb.catalogue().items():
        assert law.joints, name
        assert set(law.joints) <= {"play", "spring", "free"}, name
        assert law.motions, name
        assert set(law.motions) <= {"turning", "sliding"}, name


def test_a_search_on_a_sliding_mass_does_not_propose_weight():
    turning, sliding = laws_for(JOINT, translational=False), laws_for(JOINT, translational=True)
    assert turning == laws_for(JOINT)
    assert turning.keys() - sliding.keys() == {"gravity"}
    assert sliding.keys() <= turning.keys()


def test_a_law_of_ones_own_can_be_of_a_sliding_mass_only():
    class Ploughing(jb.AbstractEffect):
        motions = ("sliding",)
        s: float = jb.param(unit="N", null=0.0)

    try:
        assert "ploughing" in laws_for(JOINT, translational=True)
        assert "ploughing" not in laws_for(JOINT, translational=False)
    finally:
        Ploughing.__name__ = "AbstractPloughing"  # out of the catalogue again


def test_laws_that_do_nothing_in_a_joint_are_left_out_too():
    """Along any motion each law of a joint without play exerts a torque, shifts what is seen, or has states that will."""
    record = pushed()
    for model, gone in (("free", {"coulomb_joint", "gap_drift", "cubic_stiffness"}), ("linear", {"gap_drift", "gap_spring"})):
        base, *_ = base_system(record, model, 2.0)
        laws = laws_for(base, translational=True)
        assert not laws.keys() & (gone | {"gravity"})
        assert {"coulomb_ground", "preload", "sensor_delay", "dahl"} <= laws.keys()
        for name, law in laws.items():
            system = base.with_effects(LAWS[name])
            now = system.instant(1.0, (0.01, 0.3, *(0.01 for _ in law.states)), Drive(force=1.0))
            acts = float(LAWS[name].torque(now.seen_by(tuple(0.01 for _ in law.states)))) != 0.0
            silent = all(getattr(law, name) is getattr(jb.AbstractEffect, name) for name in ("lag", "observe", "rubs"))
            assert acts or not silent, name


def test_laws_are_alike_to_laws_of_the_catalogue():
    for name, law in jb.catalogue().items():
        assert set(law.alike) <= set(jb.catalogue()) - {name}, name
        assert all(apart and apart[0].islower() for apart in law.alike.values()), name


@pytest.mark.slow
def test_diagnosing_a_sliding_mass_does_not_rank_weight():
    record = pushed()
    ranked = {
        slides: {one.name for one in jb.rank_effects(jb.fit(record, model="linear", translational=slides, starts=1))}
        for slides in (True, False)
    }
    assert ranked[False] - ranked[True] == {"gravity"}


@pytest.mark.parametrize("effect", ["gravity", jb.LinearGravity(2.0)])
def test_weight_of_a_sliding_mass_is_refused_where_it_is_asked_for(effect):
    with pytest.raises(jb.BadInput, match=r"--effects (linear_)?gravity: .*turning.*--translation"):
        jb.fit(pushed(), model="linear", translational=True, effects=[effect])


def test_the_command_line_says_it_in_one_sentence(tmp_path):
    record = pushed()
    columns = np.column_stack([record.t, record.channels["F"], record.channels["y"]])
    np.savetxt(tmp_path / "r.csv", columns, delimiter=",", header="t,F,y", comments="", fmt="%.8f")
    for command in ("fit", "diagnose"):
        told = call([command, "r.csv", "--model", "linear", "--translation", "--effects", "gravity"], tmp_path)
        assert told.code == 2
        assert told.err.strip().count("\n") == 0
        assert "gravity: is a law of a turning link" in told.err
    (tmp_path / "m.toml").write_text(jb.dump_model(JOINT.with_effects(jb.Gravity(-3.0))))
    told = call(["fit", "r.csv", "--model", "m.toml", "--translation"], tmp_path)
    assert told.code == 2
    assert "gravity" in told.err


def test_the_page_of_effects_says_for_which_link_a_law_is():
    page = catalogue.page()
    assert page.count("Only for a turning link") == 2
