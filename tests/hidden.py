"""Records with one hidden effect, from the generator that shares nothing with the package, and what their fits miss."""

import numpy as np
import pytest

import jaxbacklash as jb
from jaxbacklash.criticism.model_fitter import ModelFitter
from jaxbacklash.fitting.setup import base_system

NOISE, RATE = 3e-5, 500.0


def hidden(name, kind, seed, seconds=12.0, **values):
    """A record of a random rig with a hidden effect (None: nothing hidden), the rig, the effect's values and the truth."""
    pytest.importorskip("numba", reason="the generator needs numba")
    from tests.independent.generator import make_effects, make_excitation, make_rig, measure, simulate_truth

    rng = np.random.default_rng(seed)
    rig, excitation = make_rig(rng), make_excitation(rng, kind, seconds)
    effects = {} if name is None else {name: values} if values else make_effects(rng, name)
    truth = simulate_truth(rig, effects, excitation, RATE, seconds)
    seen = measure(truth, rng, NOISE, NOISE)
    record = jb.Record(seen["t"], {"x": seen["x"], "z": seen["z"]})
    return record, rig, effects, truth


def noisier(record, times, seed):
    """The same record with so many times its noise."""
    rng, more = np.random.default_rng(seed), NOISE * np.sqrt(times**2 - 1.0)
    return jb.Record(record.t, {n: v + more * rng.standard_normal(v.size) for n, v in record.channels.items()})


def missing_from(system, rig, truth, torque):
    """The torque that a system lacks along the true motion (N,), when a rig's own law and ``torque`` (N,) acted."""
    z, dz = truth["z"], truth["v"] - truth["dx"]

    def joint(b, k, c):
        return -k * (z - np.clip(z, -0.5 * b, 0.5 * b)) - c * dz

    given = joint(float(system.contact.backlash), float(system.contact.stiffness), float(system.damper.damping))
    return joint(rig.backlash, rig.stiffness, rig.damping) + torque - given


def fitter(record, inertia, model="joint", beside=None, window=0.2):
    """What fits models of a record: the joint of ``inertia`` with any set of laws."""
    base, free, _ = base_system(record, model, inertia)
    return ModelFitter(record, base, free, window, beside=beside)
