"""Causes of misfit that lie in the record: found with their size where there are any, and named nowhere else."""

import json

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import jaxbacklash as jb
from jaxbacklash.causes import find_causes
from jaxbacklash.causes.resampled import read_at
from jaxbacklash.commands.fit import deliver
from jaxbacklash.records.findings.quantities import degrees
from tests.hidden import NOISE, hidden

SECONDS = 6.0


def dressed(record, **channels):
    """The record with other channels, their unit stated where a user is asked for it: a motor's turns exceed a joint's."""
    return jb.Record(record.t, channels, confirmed=frozenset(finding.channel for finding in degrees(channels, ())))


def late(truth, name, samples, rng):
    """A channel that shows at each time what was there so many samples before, with noise of its own."""
    values = truth["z"] + truth["x"] if name == "y" else truth[name]
    places = np.maximum(np.arange(values.size) - samples, 0.0)
    return CubicSpline(np.arange(values.size), values)(places) + NOISE * rng.standard_normal(values.size)


def spoiled(kind, seed):
    """A record with a cause of a kind, drawn with a seed: the record, the inertia to give, the rig, the size."""
    rng = np.random.default_rng(100 + seed)
    if kind in ("inertia", "turned force"):
        record, rig = forced("force_multisine" if seed % 2 else "force_chirp", seed)
    else:
        record, rig, _, clean = hidden(None, "multisine" if seed % 2 or kind == "held" else "modulated", seed, SECONDS)
    c, inertia = dict(record.channels), rig.inertia
    sign = rng.choice((-1.0, 1.0))
    if kind == "delay":
        size = rng.uniform(1.5, 15.0)
        truth = size * record.dt
        return dressed(record, x=c["x"], z=late(clean, "z", size, rng)), inertia, rig, truth
    if kind == "y alone late":
        size = rng.uniform(1.5, 8.0)
        return dressed(record, x=c["x"], y=late(clean, "y", size, rng)), inertia, rig, size * record.dt
    if kind == "y late in z":
        size = rng.uniform(1.5, 8.0)
        return dressed(record, x=c["x"], z=late(clean, "y", size, rng) - c["x"]), inertia, rig, size * record.dt
    if kind == "clock":
        size = 1e-6 * rng.uniform(300.0, 1500.0)
        return dressed(record, x=c["x"], z=late(clean, "z", np.arange(c["z"].size) * size, rng)), inertia, rig, size
    if kind == "gear":
        size = np.exp(rng.uniform(np.log(1.4), np.log(50.0))) ** sign
        return dressed(record, x=size * c["x"], y=c["z"] + c["x"]), inertia, rig, size
    if kind == "sign":
        turned = {"x": c["x"], "z": -c["z"]} if sign > 0 else {"x": -c["x"], "y": c["z"] + c["x"]}
        return dressed(record, **turned), inertia, rig, None
    if kind == "inertia":
        size = rng.uniform(1.5, 12.0) ** sign
        return record, inertia / size, rig, size
    if kind == "turned force":
        return dressed(record, F=-c["F"], y=c["y"]), inertia, rig, None
    if kind == "held":
        every = int(rng.integers(4, 9))
        shown = (np.arange(c["z"].size) // every) * every
        return dressed(record, x=c["x"], z=c["z"][shown]), inertia, rig, every
    if kind == "held start":
        size = int(rng.uniform(0.1, 0.3) * record.samples)
        record, rig, _, clean = hidden(None, "free_decay", seed, SECONDS)
        inertia = rig.inertia
        z = np.concatenate([np.full(size, clean["z"][0]), clean["z"]]) + NOISE * rng.standard_normal(size + clean["z"].size)
        return jb.Record(record.dt * np.arange(z.size), {"z": z}), inertia, rig, size * record.dt
    if kind == "lost counts":
        size = sign * rng.uniform(1e-3, 2e-2)
        after = np.arange(record.samples) >= int(rng.uniform(0.2, 0.8) * record.samples)
        return dressed(record, x=c["x"], z=c["z"] + size * after), inertia, rig, size
    raise ValueError(kind)


def forced(kind, seed):
    pytest.importorskip("numba", reason="the generator needs numba")
    from tests.independent.generator import force_record, make_excitation, make_rig

    rng = np.random.default_rng(seed)
    rig, excitation = make_rig(rng), make_excitation(rng, kind, SECONDS)
    seen = force_record(rig, {}, excitation, 500.0, SECONDS, rng, 0.05, 3e-5)
    return jb.Record(seen["t"], {"F": seen["F"], "y": seen["y"]}), rig


NAMES = {
    "delay": "delay", "y alone late": "delay", "clock": "clock", "gear": "scale", "sign": "sign", "inertia": "inertia",
    "turned force": "sign", "held": "held_samples", "held start": "held_start", "lost counts": "step", "y late in z": "delay",
}  # fmt: skip


def found_right(kind, seed):
    """Whether the one cause named is the true one, of the right size, and the joint without it is the true one."""
    record, inertia, rig, truth = spoiled(kind, seed)
    causes = find_causes(jb.fit(record, inertia=inertia, starts=1))
    if len(causes) != 1 or causes[0].name != NAMES[kind]:
        return False
    cause = causes[0]
    slack = 0.02 if kind == "held start" else 0.0  # let go, it takes a while until that shows
    sized = truth is None or abs(cause.size - truth) < 0.03 * abs(truth) + slack
    return sized and abs(cause.parameters["backlash"] - rig.backlash) < 0.03 * rig.backlash


def test_a_shift_by_whole_samples_changes_no_value():
    values = np.random.default_rng(0).standard_normal(200)
    moved, share = read_at(values, np.arange(200) + 3.0)
    np.testing.assert_array_equal(moved[:197], values[3:])
    assert np.all(share[:197] == 1.0)
    assert np.all(share[197:] == 0.0)


def test_what_is_read_between_samples_is_the_motion_and_its_noise_is_told():
    t = np.arange(4000.0)
    moved, share = read_at(np.sin(0.5 * t), t + 0.37)
    inside = share > 0.0
    np.testing.assert_allclose(moved[inside], np.sin(0.5 * (t + 0.37))[inside], atol=1e-4)
    noise, kept = read_at(np.random.default_rng(1).standard_normal(4000), t + 0.5)
    assert np.std(noise[kept > 0.0]) == pytest.approx(np.median(kept), rel=0.03)


@pytest.mark.slow
def test_a_link_held_for_most_of_a_short_record_is_no_error():
    t = 0.01 * np.arange(200.0)
    swing = 0.05 * np.cos(25.0 * t[:50]) * np.exp(-2.0 * t[:50])
    z = np.concatenate([np.full(150, 0.05), swing]) + 1e-5 * np.random.default_rng(0).standard_normal(t.size)
    assert find_causes(jb.fit(jb.Record(t, {"z": z}), starts=1)) == []


@pytest.mark.slow
def test_a_late_channel_is_named_where_the_intervals_are_printed(tmp_path, capsys):
    record, inertia, _, truth = spoiled("delay", 1)
    fit = jb.fit(record, inertia=inertia, starts=1)
    deliver(fit, tmp_path, False, lambda stage, share: None)
    printed = capsys.readouterr().out
    assert "z is late by" in printed
    parameters = [row for row in printed.splitlines() if row.startswith("  ") and " +- " in row]
    assert len(parameters) == 3
    assert all("it is not" in row for row in parameters)
    told = json.loads((tmp_path / "result.json").read_text())
    assert told["verdict"] == "incomplete"
    assert told["causes"][0]["name"] == "delay"
    assert told["causes"][0]["size"] == pytest.approx(truth, rel=0.03)
    assert "z is late by" in (tmp_path / "report.html").read_text()


@pytest.mark.slow
def test_a_good_record_has_no_cause_and_its_intervals_no_note(tmp_path, capsys):
    record, rig, _, _ = hidden(None, "multisine", 5, SECONDS)
    deliver(jb.fit(record, inertia=rig.inertia, starts=1), tmp_path, False, lambda stage, share: None)
    assert "it is not" not in capsys.readouterr().out
    assert json.loads((tmp_path / "result.json").read_text())["causes"] == []


@pytest.mark.slow
@pytest.mark.parametrize("kind", NAMES)
def test_causes_of_a_kind_are_found_with_their_size(kind):
    found = [found_right(kind, seed) for seed in range(1, 11)]
    assert sum(found) >= 9, found


@pytest.mark.slow
@pytest.mark.shared
def test_clocks_apart_and_a_late_start_are_named_on_the_collected_cases(shared):
    for file, name, size in (("drift200ppm.csv", "clock", -2e-4), ("shift4ms.csv", "delay", 4e-3)):
        record = jb.read_record(shared / "cases" / file)
        (cause,) = find_causes(jb.fit(record, inertia=3.206, effects=["gravity"], starts=1))
        assert cause.name == name
        assert cause.size == pytest.approx(size, rel=0.1)
        assert cause.parameters["damping"] == pytest.approx(24.8, rel=0.01)


@pytest.mark.slow
@pytest.mark.parametrize("drive", ["multisine", "chirp", "modulated"])
def test_no_cause_is_named_where_an_effect_is_missing(drive):
    from tests.independent.rigs import STRENGTHS

    false = {}
    for number, name in enumerate(STRENGTHS):
        record, rig, _, _ = hidden(name, drive, 40 + number, SECONDS)
        causes = find_causes(jb.fit(record, inertia=rig.inertia, starts=1))
        # A lag of the measured channel is one of the catalogue's effects and a cause as well.
        if any(cause.law != name for cause in causes):
            false[name] = causes[0].sentence
    assert not false
