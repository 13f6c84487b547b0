"""What ends at the end of its shapes stands in for something, which a search asks for."""

from types import SimpleNamespace

import numpy as np
import pytest

import jaxbacklash as jb
from jaxbacklash.criticism.search import Search
from jaxbacklash.criticism.steps import Step
from jaxbacklash.criticism.within_bounds import within_bounds
from jaxbacklash.criticism.workbench import Workbench
from jaxbacklash.fitting.setup import base_system

from .number_models import Model

JOINT = Model(frozenset(), cost=5000.0, tied=False, misfit=5.0)
FREE = ("backlash", "torque_ripple.A", "torque_ripple.N", "torque_ripple.phi")


@pytest.mark.parametrize(
    ("order", "preloaded", "ends", "looked", "taken"),
    [
        (4.0, 4000.0, 900.0, 1, True),
        (5.0, 4000.0, 900.0, 0, False),  # inside its bounds it stands for itself
        (4.0, 4999.0, 900.0, 0, False),  # nothing else had helped where it came in
        (4.0, 4000.0, 1014.0, 1, False),  # as good, less what so many candidates gain by chance
    ],
)
def test_the_other_path_is_taken_where_it_ends_clearly_better(monkeypatch, order, preloaded, ends, looked, taken):
    laws = {"torque_ripple": jb.effects.TorqueRipple, "preload": jb.effects.Preload}
    laws |= {name: jb.Gravity for name in ("gravity", *"abcdefghijklmnopqrst")}
    effects = {"torque_ripple": jb.effects.TorqueRipple(3.0, order, 2.0)}
    ripple = Model(frozenset(effects), cost=1000.0, free=FREE, system=SimpleNamespace(effects=effects))
    preload = Model(frozenset({"preload"}), cost=preloaded, tied=False, misfit=4.0, free=FREE[:2])
    pair = Model(frozenset({"preload", "gravity"}), cost=ends, free=FREE[:3])
    search, begun = Search(SimpleNamespace(laws=laws, outright=())), []
    search.known = {(m.names, m.tied): m for m in (ripple, preload)}
    monkeypatch.setattr(search, "best", lambda current, tried, least: next(iter(tried)))
    monkeypatch.setattr(search, "settle", lambda trial: trial)

    def forward(start, steps, least):
        begun.append((start, steps))
        return [*steps, Step(pair, "gravity", (), ())]

    monkeypatch.setattr(search, "forward", forward)
    evidence = {"torque_ripple": 100.0, "preload": 50.0, "gravity": 40.0}
    steps = [Step(JOINT, None, (), (), evidence), Step(ripple, "torque_ripple", (), ())]
    path = within_bounds(search, steps)
    assert len(begun) == looked
    for start, before in begun:
        assert start is preload
        assert [s.added for s in before] == [None, "preload"]
    assert [s.added for s in path[1:]] == (["preload", "gravity"] if taken else ["torque_ripple"])
    assert taken or path is steps


def test_a_load_and_gravity_are_not_left_to_a_ripple_of_the_lowest_order():
    pytest.importorskip("numba", reason="the generator needs numba")
    from tests.independent.generator import make_excitation, make_rig, measure, simulate_truth

    rng = np.random.default_rng(3)
    rig, excitation = make_rig(rng), make_excitation(rng, "multisine", 12.0)
    effects = {"preload": {"T0": 2.0}, "gravity": {"G": -3.0}}
    seen = measure(simulate_truth(rig, effects, excitation, 500.0, 12.0), rng, 3e-5, 3e-5)
    record = jb.Record(seen["t"], {"x": seen["x"], "z": seen["z"]})
    base, free, _ = base_system(record, "joint", rig.inertia)
    bench = Workbench(record, base, free, 0.2)
    search = Search(bench)
    alone = search.base()
    guess = jb.effects.TorqueRipple(2.4, 4.0, 2.1)
    loose = search.keep(bench.fit({"torque_ripple": guess}, alone, patience=60))
    ripple = search.keep(bench.fit(bench.effects(loose), loose, tied=True, patience=60))
    search.keep(bench.fit({"preload": jb.effects.Preload(1.0)}, alone))
    assert ripple.value["torque_ripple.N"] == 4.0
    steps = [Step(alone, None, (), (), {"torque_ripple": 1.0, "preload": 1.0}), Step(ripple, "torque_ripple", (), ())]
    assert set(within_bounds(search, steps)[-1].trial.names) == {"preload", "gravity"}
