"""What a record may hide is found in records of joints that the independent simulator makes, and is not found where it is not."""

import collections
import importlib.util
import shlex
import time

import numpy as np
import pytest

from jaxbacklash.records.finding import ASK, REFUSE, WARN
from jaxbacklash.records.findings import find, find_in_times, mend
from jaxbacklash.records.findings.local import bridge, level, surprise
from jaxbacklash.records.findings.rules import RULES, silenced
from jaxbacklash.records.options import ReadOptions
from jaxbacklash.records.remedies import applied
from tests.independent.rigs import STRENGTHS
from tests.spoilt import (
    NOISE,
    absolute,
    at_pi,
    below_a_count,
    clipped,
    clipped_force,
    coded,
    contradictory,
    filled_up,
    geared,
    going_back,
    good,
    grown,
    held_at_first,
    in_bursts,
    in_counts,
    in_degrees,
    in_milliseconds,
    late_at_first,
    lost_counts,
    refreshed_seldom,
    some,
    spiked,
    stale,
    three_axes,
    turned,
    turned_z,
    unanswered,
    wrapped,
    wrapped_counts,
    zeroed,
)

needs_numba = pytest.mark.skipif(importlib.util.find_spec("numba") is None, reason="the generator needs numba")
NOTHING_SAID = ReadOptions()
SEEDS = (0, 1, 2)


def looked_at(record: dict, options: ReadOptions = NOTHING_SAID, **more):
    """The findings in a record, mended as the options say, and what is left of it after them."""
    channels = {name: values for name, values in record.items() if name in ("x", "y", "z", "F", "T")}
    extras = {name: channels.pop(name) for name in ("y",) if {"x", "y", "z"} <= channels.keys()}
    t, channels, extras = mend.before(record["t"], channels, extras, options)
    found = [*find_in_times(record["t"], options, **more), *find(t, channels, extras, options, **more)]
    return found, mend.after(t, channels, extras, found)


# (kind, channel, its action, how, the record that it spoils, the command's remedy or None where the record stays as it is)
CASES = [
    ("wrap", "x", REFUSE, wrapped, {}),
    ("wrap", "x", REFUSE, wrapped_counts, {}),
    ("shift", "y", ASK, lost_counts, {"observed": "y"}),
    ("sentinel", "z", ASK, coded, {}),
    ("sentinel", "z", ASK, zeroed, {}),
    ("spike", "y", ASK, spiked, {"observed": "y"}),
    ("held", "z", ASK, refreshed_seldom, {}),
    ("stale", "z", ASK, stale, {}),
    ("held-rows", "", WARN, filled_up, {}),
    ("clipped", "z", WARN, clipped, {}),
    ("clipped", "F", WARN, clipped_force, {"kind": "force_chirp"}),
    ("gear", "y", ASK, geared, {"observed": "y"}),
    ("sign", "y", ASK, turned, {"observed": "y"}),
    ("sign", "z", ASK, turned_z, {}),
    ("absolute", "z", ASK, absolute, {}),
    ("contradiction", "z", WARN, contradictory, {}),
    ("axes", "z", ASK, three_axes, {}),
    ("degrees", "z", ASK, in_degrees, {}),
    ("counts", "x", ASK, in_counts, {}),
    ("no-answer", "z", REFUSE, unanswered, {}),
    ("no-answer", "z", REFUSE, below_a_count, {}),
    ("held-first", "z", WARN, held_at_first, {"kind": "free_decay"}),
    ("driven", "z", ASK, grown, {}),
    ("stale-first", "y", WARN, late_at_first, {"observed": "y"}),
    ("backwards", "t", REFUSE, going_back, {}),
    ("bursts", "t", ASK, in_bursts, {}),
    ("time-unit", "t", ASK, in_milliseconds, {}),
]
BY_NAME_ALONE = {"quantity"}


@needs_numba
@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize(("kind", "channel", "action", "spoil", "how"), CASES, ids=[case[3].__name__ for case in CASES])
def test_what_a_record_hides_is_found_where_it_is(kind, channel, action, spoil, how, seed):
    record, rows = spoil(np.random.default_rng(seed), good(seed, **how))
    found, _ = looked_at(record)
    named = [one for one in found if (one.kind, one.channel) == (kind, channel)]
    assert len(named) == 1, [(one.kind, one.channel) for one in found]
    assert named[0].action == action
    sentence = named[0].sentence("run1.csv")
    assert sentence.startswith("run1.csv")
    assert sentence.endswith(".")
    assert "\n" not in sentence
    assert ". " not in sentence
    if rows is not None:
        assert set(named[0].rows) == set(rows)


@needs_numba
@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize(
    ("kind", "spoil", "how"), [(case[0], case[3], case[4]) for case in CASES if case[2] != WARN],
    ids=[case[3].__name__ for case in CASES if case[2] != WARN],
)  # fmt: skip
def test_both_ways_out_that_a_sentence_names_end_the_question(kind, spoil, how, seed):
    record, _ = spoil(np.random.default_rng(seed), good(seed, **how))
    named = next(one for one in looked_at(record)[0] if one.kind == kind)
    as_it_is = named.sentence("f").rsplit("pass ", 1)[1].split(", or ")[-1].removesuffix(" if it is right as it is.")
    for flags in filter(None, (named.remedy, as_it_is)):
        assert shlex.split(flags)[0].startswith("--")
        options = applied(NOTHING_SAID, flags)
        # What the reader does with units, columns and times is done here.
        asked = {name: values for name, values in record.items() if name not in options.columns.values()}
        asked |= {name: record[column] for name, column in options.columns.items()}
        if options.stop is not None:
            rows = np.arange(record["t"].size) <= np.argmax(record["t"] >= options.stop)
            asked = {name: values[rows] for name, values in asked.items()}
        if options.rate is not None:
            asked["t"] = np.arange(record["t"].size) / options.rate
        left, _ = looked_at(asked, options, units_stated=frozenset(options.units))
        assert not [one for one in left if (one.kind, one.channel) == (kind, named.channel) and one.action != WARN]


@pytest.mark.parametrize("seed", range(20))
def test_what_dies_away_is_no_driven_motion(seed):
    rng = np.random.default_rng(seed)
    t = np.arange(3000) / 250.0
    tones = [(rng.uniform(0.2, 1.0), rng.uniform(1.0, 12.0), rng.uniform(0.2, 1.0), rng.uniform(0.0, 6.3)) for _ in range(2)]
    z = sum(0.02 * a * np.exp(-d * t) * np.cos(2 * np.pi * f * t + phase) for a, f, d, phase in tones)
    z[: int(rng.integers(1, 600))] *= float(rng.integers(2))  # half of them are struck some time after the record begins
    found, _ = looked_at({"t": t, "z": z + rng.normal(0.0, 1e-5, t.size)})
    assert "driven" not in {one.kind for one in found}


@pytest.mark.slow
@needs_numba
def test_a_link_alone_is_asked_about_where_it_is_driven_and_only_there():
    driven = decaying = 0
    for seed in range(30):
        for kind, record in (("driven", good(seed)), ("decaying", good(seed, kind="free_decay"))):
            found, _ = looked_at({"t": record["t"], "z": record["z"]})
            asked = "driven" in {one.kind for one in found}
            driven, decaying = driven + (asked and kind == "driven"), decaying + (asked and kind == "decaying")
    assert driven >= 27
    assert decaying == 0


def test_every_row_of_the_table_is_tried_here():
    of_drives = {"no-ratio", "wrong-ratio", "turned-link", "command"}  # in test_drive_records
    assert {case[0] for case in CASES} | BY_NAME_ALONE | of_drives == RULES.keys()


def test_a_flag_answers_its_own_check_and_no_other():
    flags = {
        "--unwrap": ReadOptions(unwrap=frozenset("x")),
        "--despike": ReadOptions(despike=frozenset("x")),
        "--sign": ReadOptions(sign=frozenset("x")),
        "--ratio": ReadOptions(ratio=3.0),
        "--rate": ReadOptions(rate=100.0),
        "--from": ReadOptions(start=1.0),
    }
    for flag, options in flags.items():
        answered = {kind for kind in RULES if silenced(kind, "x", options, frozenset())}
        assert answered == {kind for kind, rule in RULES.items() if rule.flag == flag}
        if flag in ("--unwrap", "--despike", "--sign"):  # and for its own channel
            assert not any(silenced(kind, "z", options, frozenset()) for kind in RULES)
    assert {kind for kind in RULES if silenced(kind, "x", NOTHING_SAID, frozenset("x"))} == {"counts", "degrees", "time-unit"}
    assert {kind for kind in RULES if silenced(kind, "x", ReadOptions(accept=frozenset({"gear"})), frozenset())} == {"gear"}


@needs_numba
@pytest.mark.parametrize("seed", SEEDS)
def test_a_flag_for_one_fault_leaves_the_other(seed):
    rng = np.random.default_rng(seed)
    record = zeroed(rng, wrapped(rng, good(seed))[0])[0]
    assert {one.kind for one in looked_at(record)[0]} == {"wrap", "sentinel"}
    assert {one.kind for one in looked_at(record, ReadOptions(unwrap=frozenset("x")))[0]} == {"sentinel"}
    assert {one.kind for one in looked_at(record, ReadOptions(despike=frozenset("z")))[0]} == {"wrap"}
    assert {one.kind for one in looked_at(record, ReadOptions(unwrap=frozenset("z"), despike=frozenset("x")))[0]} == {
        "wrap",
        "sentinel",
    }
    assert not looked_at(record, ReadOptions(unwrap=frozenset("x"), despike=frozenset("z")))[0]


# ---- What is mended is what was measured. ----


@needs_numba
@pytest.mark.parametrize("seed", SEEDS)
def test_an_unwrapped_base_is_the_base_counted_from_its_beginning(seed):
    record = good(seed)
    for spoil in (wrapped, at_pi):
        spoilt, _ = spoil(np.random.default_rng(seed), record)
        _, (_, channels, _) = looked_at(spoilt, ReadOptions(unwrap=frozenset("x")))
        np.testing.assert_allclose(channels["x"], record["x"] - record["x"][0], atol=1e-12)
        np.testing.assert_array_equal(channels["z"], record["z"])


@needs_numba
@pytest.mark.parametrize("seed", SEEDS)
def test_lost_counts_come_back(seed):
    record = good(seed, observed="y")
    spoilt, _ = lost_counts(np.random.default_rng(seed), record)
    _, (_, channels, _) = looked_at(spoilt, ReadOptions(unwrap=frozenset("y")))
    assert np.max(np.abs(channels["y"] - record["y"])) < 5 * NOISE


@needs_numba
@pytest.mark.parametrize("spoil", [coded, zeroed, stale])
@pytest.mark.parametrize("seed", SEEDS)
def test_bridged_samples_are_near_what_was_lost_and_the_others_untouched(seed, spoil):
    record = good(seed)
    spoilt, rows = spoil(np.random.default_rng(seed), record)
    _, (_, channels, _) = looked_at(spoilt, ReadOptions(despike=frozenset("z")))
    changed = np.flatnonzero(channels["z"] != spoilt["z"])
    assert set(changed) <= set(rows)
    assert len(changed) >= 0.9 * len(rows)
    # A cubic through four noisy neighbours, and what the contact bends by between them.
    motion = level(surprise(record["z"]))
    assert np.max(np.abs(channels["z"] - record["z"])[changed]) < 12 * max(NOISE, motion)


@needs_numba
@pytest.mark.parametrize("seed", SEEDS)
def test_a_handful_of_spikes_is_bridged_and_named_without_being_asked(seed):
    record = good(seed, observed="y")
    rng = np.random.default_rng(seed)
    rows, y = some(rng, record, 3), record["y"].copy()
    y[rows] += 0.3
    found, (_, channels, _) = looked_at(record | {"y": y})
    assert [(one.kind, one.action, one.bridged) for one in found] == [("spike", WARN, tuple(rows))]
    assert all(str(row + 1) in found[0].found for row in rows)
    assert np.max(np.abs(channels["y"] - record["y"])) < 12 * NOISE


@needs_numba
@pytest.mark.parametrize("seed", SEEDS)
def test_a_channel_refreshed_seldom_keeps_the_rows_at_which_it_is_new(seed):
    record = good(seed)
    spoilt, _ = refreshed_seldom(np.random.default_rng(seed), record)
    every = int(next(one for one in looked_at(spoilt)[0] if one.kind == "held").size)
    found, (t, channels, _) = looked_at(spoilt, ReadOptions(despike=frozenset("z")))
    assert not found
    for name, values in {"t": t, **channels}.items():
        np.testing.assert_array_equal(values, record[name][::every])


@needs_numba
@pytest.mark.parametrize("seed", SEEDS)
def test_a_held_beginning_and_stale_first_rows_are_left_out(seed):
    decay = good(seed, "free_decay")
    spoilt, _ = held_at_first(np.random.default_rng(seed), decay)
    found, (t, _, _) = looked_at(spoilt)
    held = spoilt["t"].size - decay["t"].size
    assert found[0].left_out == pytest.approx(held, abs=12)
    assert t.size == spoilt["t"].size - found[0].left_out
    assert not looked_at(spoilt, ReadOptions(start=0.0))[0]
    assert not looked_at(decay)[0]


def test_a_cubic_is_bridged_exactly():
    rows = np.arange(60.0)
    cubic = 2.0 - 0.3 * rows + 0.02 * rows**2 - 1e-4 * rows**3
    holes = [0, 7, 8, 9, 30, 59]
    spoilt = cubic.copy()
    spoilt[holes] = 1e6
    np.testing.assert_allclose(bridge(spoilt, holes), cubic, atol=1e-9)


# ---- Names and times ----


@pytest.mark.parametrize("name", ["acc_x", "ax", "Accel X [g]", "imu.accel_z", "a_y", "gyro_x"])
def test_a_column_named_as_an_acceleration_is_asked_about(name):
    record = smooth()
    options = ReadOptions(columns={"x": name})
    assert [one.kind for one in looked_at(record, options)[0]] == ["quantity"]


@pytest.mark.parametrize("name", ["x", "Channel A", "max_x", "axis 1", "base angle", "encA", "data", "relaxed"])
def test_other_names_are_not(name):
    assert not looked_at(smooth(), ReadOptions(columns={"x": name}))[0]


def smooth(rate: float = 250.0, samples: int = 1500) -> dict[str, np.ndarray]:
    """Something that moves like a joint, without a simulator."""
    t = np.arange(samples) / rate
    noise = np.random.default_rng(5).normal(0.0, NOISE, (2, samples))
    return {"t": t, "x": 0.05 * np.sin(9 * t) + noise[0], "z": 0.01 * np.sin(31 * t) + 0.004 * np.sin(45 * t) + noise[1]}


# ---- No false alarm ----


def many_good(count: int, seed: int):
    """Good records of many joints, effects, drives, rates, noises and encoders."""
    rng = np.random.default_rng(seed)
    kinds = ("chirp", "multisine", "stepped", "modulated", "free_decay", "force_chirp", "force_multisine")
    names = [name for name in STRENGTHS if not name.startswith("sensor")]
    for number in range(count):
        yield good(
            int(rng.integers(1 << 30)),
            kinds[number % len(kinds)],
            float(rng.choice((60.0, 100.0, 250.0, 500.0))),
            str(rng.choice(("z", "y"))),
            tuple(rng.choice(names, int(rng.integers(0, 3)), replace=False)),
            None if rng.random() < 0.5 else float(10 ** rng.uniform(-5, -2.7)),
        )


@needs_numba
def test_good_records_set_off_no_check():
    assert not [one for record in many_good(14, 11) for one in looked_at(record)[0]]


@needs_numba
@pytest.mark.slow
def test_of_many_good_records_none_is_refused_or_asked_about():
    alarms = collections.Counter(one.kind for record in many_good(175, 12) for one in looked_at(record)[0])
    assert not alarms


@pytest.mark.shared
def test_the_practice_records_set_off_no_check(shared):
    for path in sorted((shared / "records").glob("p*/*.csv")):
        values = np.loadtxt(path, delimiter=",", skiprows=1, unpack=True)
        assert not looked_at(dict(zip("txz", values, strict=True)))[0], path


@needs_numba
@pytest.mark.slow
def test_most_spikes_and_stale_samples_of_many_records_are_found_and_hardly_any_other():
    caught = {"spike": [0, 0, 0], "stale": [0, 0, 0]}
    for seed in range(30):
        record = good(100 + seed, observed="y", effects=("gravity",))
        rng = np.random.default_rng(seed)
        rows, y = some(rng, record, 5), record["y"].copy()
        y[rows] += rng.choice((-1.0, 1.0), 5) * rng.uniform(100.0, 1000.0, 5) * NOISE
        for kind, (spoilt, true) in {"spike": (record | {"y": y}, rows), "stale": stale(rng, good(100 + seed))}.items():
            named = {row for one in looked_at(spoilt)[0] if one.kind == kind for row in one.rows}
            for place, number in enumerate((len(true), len(named & set(true)), len(named - set(true)))):
                caught[kind][place] += number
    for true, right, wrong in caught.values():
        assert right > 0.9 * true
        assert wrong <= 0.01 * true


def test_looking_is_fast():
    record = smooth(500.0, 15001)
    spent = []
    for _ in range(5):
        begin = time.process_time()
        looked_at(record)
        spent.append(time.process_time() - begin)
    assert min(spent) < 0.03
