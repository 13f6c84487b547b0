"""Friction that gives, which the quick look puts before dry friction that explains: by chance, or because it is there."""

from types import SimpleNamespace

import numpy as np
import pytest

from jaxbacklash.criticism import unseen
from jaxbacklash.criticism.candidates import may_join, rank
from jaxbacklash.criticism.evidence import demanded
from jaxbacklash.criticism.search import Search
from jaxbacklash.criticism.workbench import Workbench
from jaxbacklash.effects import CoulombGround, CoulombJoint, Gravity, Stribeck
from jaxbacklash.effects.hysteresis import Dahl
from jaxbacklash.fitting.setup import base_system
from jaxbacklash.records import Record

from .number_models import Model

LAWS = {"coulomb_joint": CoulombJoint, "stribeck": Stribeck, "coulomb_ground": CoulombGround, "gravity": Gravity, "dahl": Dahl}


@pytest.mark.parametrize(
    ("ahead", "kin", "misfit", "tried"),
    [(0.9, None, 1.0, False), (1.1, None, 1.0, True), (0.9, "lugre", 1.0, True), (0.9, None, 1.5, True), (None, None, 1.0, True)],
)
def test_it_must_bring_more_than_by_noise(monkeypatch, ahead, kin, misfit, tried):
    """As much as any addition, beside a model that explains; its own kin, and where something is missing, need not."""
    bench = SimpleNamespace(laws=LAWS, quick="measured")
    lead = 70.0
    by_noise = [] if ahead is None else [lead - ahead * demanded(bench)]
    told = []

    def members(bench, current, names, rivals, seen=lambda member: None):
        leads = {"measured": [lead], "silent": [], "speaks": by_noise}[bench.quick]
        found = [SimpleNamespace(name="dahl", lead=k, kin=kin) for k in leads]
        for member in found:
            seen(member)
        return found

    monkeypatch.setattr(unseen, "members", members)
    drawn = [SimpleNamespace(laws=LAWS, quick=quick) for quick in ("silent", "silent", "speaks")]
    monkeypatch.setattr(unseen, "as_if_right", lambda bench, trial, draws: drawn)
    search = Search(bench, seen=told.append)
    monkeypatch.setattr(search, "placed", lambda trial, member, tied: f"{member.name}, {'tied' if tied else 'free'}")
    trial = Model(frozenset({"coulomb_joint"}), 100.0, misfit=misfit)
    assert search.memories(trial, ()) == ({"dahl": "dahl, tied"} if tried else {})
    assert len(told) == tried  # its program is read ahead only if it is asked for


@pytest.mark.slow
@pytest.mark.parametrize(
    ("number", "hidden", "kind", "sigma", "found"),
    [
        (7008, "coulomb_joint", "chirp", 9e-4, []),
        (7013, "dahl", "multisine", 9e-4, ["dahl"]),
        (7148, "dahl", "modulated", 9e-4, ["dahl"]),
    ],
)
def test_it_is_tried_where_it_is_there(monkeypatch, number, hidden, kind, sigma, found):
    pytest.importorskip("numba", reason="the independent simulation needs numba")
    from .independent.generator import make_effects, make_excitation, make_rig, measure, simulate_truth

    rng = np.random.default_rng(number)
    rig, values = make_rig(rng), make_effects(rng, hidden)
    seen = measure(simulate_truth(rig, values, make_excitation(rng, kind, 20.0), 500.0, 20.0), rng, sigma, sigma)
    record = Record(seen["t"], {"x": seen["x"], "z": seen["z"]})
    base, free, _ = base_system(record, "joint", rig.inertia)
    bench = Workbench(record, base, free, 0.2)
    search = Search(bench)
    dry = search.settle(bench.fit({"coulomb_joint": CoulombJoint(3.0)}, search.base()))
    assert dry.tied
    monkeypatch.setattr(search, "placed", lambda trial, member, tied: member)
    assert list(search.memories(dry, tuple(rank(bench, dry, may_join(bench, dry))))) == found


@pytest.mark.parametrize(
    ("there", "others"),
    [
        ({}, {"coulomb_joint", "stribeck", "coulomb_ground", "gravity"}),
        ({"gravity"}, {"coulomb_joint", "stribeck", "coulomb_ground"}),
        ({"coulomb_joint"}, {"stribeck", "coulomb_ground", "gravity"}),
        ({"stribeck"}, {"coulomb_ground", "gravity"}),
        ({"dahl"}, {"coulomb_ground", "gravity"}),
    ],
)
def test_the_joint_has_one_law_of_friction(there, others):
    bench = SimpleNamespace(laws=LAWS, static={n: law for n, law in LAWS.items() if not law.states})
    assert set(may_join(bench, Model(frozenset(there), 1.0))) == others
