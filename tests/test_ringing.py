"""Frequencies at which a residual rings: a narrow band is heard, noise is not, and a link between two guesses is found."""

import numpy as np
import pytest

import jaxbacklash as jb
from jaxbacklash.criticism import under_noise
from jaxbacklash.criticism.evidence import demanded
from jaxbacklash.criticism.ringing import ringing
from jaxbacklash.criticism.under_noise import promises
from jaxbacklash.criticism.unseen import GLIMPSED
from jaxbacklash.criticism.workbench import Workbench
from jaxbacklash.fitting.setup import base_system
from jaxbacklash.records import Record
from tests.hidden import hidden, noisier

RATE, SECONDS = 500.0, 20.0
T = np.arange(0.0, SECONDS, 1.0 / RATE)
DRIVE = {"x": 0.05 * np.sin(9.0 * T), "z": 0.03 * np.sin(9.0 * T)}


def residual(rng, **more):
    """A record, and the motion of a model that leaves white noise and what ``more`` adds."""
    left = {name: 3e-5 * rng.standard_normal(T.size) + more.get(name, 0.0) for name in "xz"}
    return Record(T, {name: DRIVE[name] + left[name] for name in "xz"}), Record(T, DRIVE)


@pytest.mark.parametrize("channel", ["x", "z"])
def test_a_band_is_heard_in_either_channel(channel):
    rng = np.random.default_rng(1)
    hertz, decay = 31.7, 2.0  # a damping of one percent
    kicks = np.where(rng.random(T.size) < 0.005, rng.standard_normal(T.size), 0.0)
    past = np.arange(0.0, 3.0, 1.0 / RATE)
    swings = np.convolve(kicks, np.exp(-decay * past) * np.sin(2.0 * np.pi * hertz * past))[: T.size]
    found = ringing(*residual(rng, **{channel: 1.2e-5 * swings / np.std(swings)}))
    assert len(found) == 1
    assert found[0] == pytest.approx(2.0 * np.pi * hertz, rel=0.02)


def test_noise_seldom_rings():
    """Of 400 records 8 may be expected to, with a standard deviation of 3."""
    heard = [bool(ringing(*residual(np.random.default_rng(seed)))) for seed in range(400)]
    assert sum(heard) <= 8 + 4 * 3


def test_an_exact_channel_is_silent():
    record, own = residual(np.random.default_rng(2))
    exact = record.replace(x=own.channels["x"])
    assert ringing(exact, own) == []
    assert ringing(own, own) == []


def test_a_link_is_proposed_at_a_frequency():
    joint = jb.base_motion_joint(inertia=3.0, backlash=0.02, stiffness=1e4, damping=20.0)
    link = jb.FlexibleLink.ringing(joint, 190.0)
    assert float(link.k2 / link.J2) == pytest.approx(190.0**2)
    assert jb.Gravity.ringing(joint, 190.0) is None


@pytest.mark.slow
def test_a_link_of_little_damping_between_two_guesses_is_promised(monkeypatch):
    record, rig, _, _ = hidden("flexible_link", "chirp", 5, J2=0.12, k2=0.12 * 200.0**2, c2=2 * 0.008 * 0.12 * 200.0)
    record = noisier(record, 4.0, 6)
    base, free, _ = base_system(record, "joint", rig.inertia)
    bench = Workbench(record, base, free, 0.2)
    alone = bench.fit({}, bench.fit({}, patience=60), tied=True, patience=60)
    law, needed = bench.laws["flexible_link"], GLIMPSED * demanded(bench)
    fall, start = promises(bench, alone, law)[0]
    found = bench.fit({"flexible_link": start}, alone, tied=True, patience=60, followed=True)
    assert 2.0 * (alone.cost - found.cost) > 0.5 * fall > 0.5 * needed
    assert found.value["flexible_link.k2"] / found.value["flexible_link.J2"] == pytest.approx(200.0**2, rel=0.05)
    monkeypatch.setattr(under_noise, "ringing", lambda record, own: [])
    assert fall > 2.0 * max((one for one, _ in promises(bench, alone, law)), default=0.0)
