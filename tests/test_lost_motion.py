"""The play of slow records, against motions whose play is known by construction and a simulation of its own."""

import json

import numpy as np
import pytest

import jaxbacklash as jb
from jaxbacklash.quasistatic import slow_reading
from jaxbacklash.quasistatic.clustered import clustered, leaning
from jaxbacklash.quasistatic.play import passes, states

from .independent.slow_links import carried, loop, played

T = np.arange(0.0, 60.0, 0.01)
ONE = np.ones(1)
PLAY = 0.012


def rig(seed=0, *, play=PLAY, noise=2e-4, period=9.0, lag=0.0):
    """A gear that carries its link: an error once a turn of the motor, an encoder off its centre, a drift; x and y (N,)."""
    draw = np.random.default_rng(seed)
    x = 0.6 * np.sin(2.0 * np.pi * T / period) + 0.1 * np.sin(2.0 * np.pi * T / (2.7 * period))
    y = played(x, 0.5 * play * ONE, ONE) + 0.003 * np.sin(35.0 * x) + 0.004 * np.sin(x + 1.0) + 2e-5 * T
    return x, np.interp(T - lag, T, y) + noise * draw.standard_normal(T.size)


def holds(found, truth, within):
    """The interval holds the truth and is no wider than a share of it."""
    b = found.parameters["backlash"]
    assert found.applies, found
    low, high = b.ci95
    assert low <= truth <= high, (truth, low, high)
    assert high - low < within * truth


def test_states_are_those_of_the_play_operator():
    x = np.sin(T) + 0.6 * np.sin(2.7 * T) + 0.3 * np.sin(7.1 * T + 1.0)
    crossing = 0.8
    link = played(x, 0.5 * crossing * ONE, ONE)
    where = states(x, passes(x, 1e-6), crossing)
    known = where.side != 0.0
    # Once known, the link is where the drive held it, half a crossing behind.
    off = np.abs(link - (where.held_at - 0.5 * crossing * where.side))[known]
    assert known.mean() > 0.9
    assert np.max(off) < 1e-9
    assert 0.2 < where.engaged.mean() < 0.9


def test_turning_points_of_a_noisy_motion():
    x = np.sin(T) + 1e-3 * np.random.default_rng(0).standard_normal(T.size)
    found = passes(x, 0.02)
    assert found.count == 20
    assert np.all(np.abs(found.strokes[1:-1] - 2.0) < 0.01)
    assert np.all(found.signs[1:] == -found.signs[:-1])


def test_least_squares_by_groups_is_the_plain_one_with_the_jackknife_of_a_mean():
    draw = np.random.default_rng(2)
    group = np.arange(12)
    values = draw.standard_normal(12)
    found = clustered(np.ones((12, 1)), values, np.ones(12), group)
    assert found.values[0] == pytest.approx(values.mean())
    assert found.stderr() == pytest.approx(values.std(ddof=1) / np.sqrt(12))
    assert found.groups == pytest.approx(12.0)
    rows = draw.standard_normal((40, 3))
    weights = draw.uniform(0.5, 1.0, 40)
    answer = rows @ [1.0, -2.0, 0.5] + 0.1 * draw.standard_normal(40)
    many = clustered(rows, answer, weights, np.arange(40) // 4)
    root = np.sqrt(weights)
    assert many.values == pytest.approx(np.linalg.lstsq(rows * root[:, None], answer * root, rcond=None)[0])
    moved = clustered(rows, answer + 0.3 * (np.arange(40) == 7), weights, np.arange(40) // 4)
    for index in range(3):
        assert moved.values[index] - many.values[index] == pytest.approx(0.3 * many.influence(index)[7])


def test_what_is_known_beforehand_takes_part_by_its_certainty():
    draw = np.random.default_rng(3)
    rows = draw.standard_normal((60, 2))
    rows[:, 1] += rows[:, 0]
    answer = rows @ [1.0, 0.4] + 0.1 * draw.standard_normal(60)
    group = np.arange(60) // 3
    plain, full = (clustered(rows[:, :count], answer, np.ones(60), group) for count in (1, 2))
    loose, tight = leaning(plain, full, 1, 1e6), leaning(plain, full, 1, 1e-9)
    assert (loose.value, loose.other) == pytest.approx((full.values[0], full.values[1]))
    assert tight.value == pytest.approx(plain.values[0])
    assert tight.stderr == pytest.approx(plain.stderr())


@pytest.mark.parametrize("channel", ["z", "y"])
def test_a_carried_link(channel):
    x, y = rig()
    found = jb.lost_motion(jb.Record(T, {"x": x, channel: y - x if channel == "z" else y}), gear_ratio=35.0)
    holds(found, PLAY, 0.02)
    assert found.way == "carried"
    assert found.includes_wind_up
    motor = next(one for one in found.transmission_error if (one.turn, one.order) == ("motor", 1))
    assert motor.amplitude == pytest.approx(0.003, rel=0.02)
    assert found.over_angle.width == pytest.approx(PLAY, rel=0.05)
    assert "total play" in str(found)


def test_counts_of_the_encoders_are_allowed_for():
    x, y = rig(noise=0.0)
    motor, link = 2.0 * np.pi / 2**12 / 35.0, PLAY / 3.0
    found = jb.lost_motion(jb.Record(T, {"x": np.round(x / motor) * motor, "y": np.round(y / link) * link}), gear_ratio=35.0)
    holds(found, PLAY, 0.15)


def test_z_the_other_way_round_and_a_link_that_drives():
    x, y = rig()
    turned = jb.lost_motion(jb.Record(T, {"x": x, "z": x - y}))
    holds(turned, PLAY, 0.05)
    assert "x - y" in turned.notes[0]
    driven = jb.lost_motion(jb.Record(T, {"x": played(x, 0.5 * PLAY * ONE, ONE) + 1e-4 * np.sin(T * 50), "y": x}))
    holds(driven, PLAY, 0.05)
    assert "link drives" in driven.notes[0]


def test_torque_tells_wind_up_from_play():
    x, y = rig(noise=1e-4)
    draw = np.random.default_rng(5)
    direction = np.sign(np.gradient(x))
    torque = -direction * (1.0 + 0.5 * np.sin(0.9 * T)) * 2.0
    stiffness = 800.0
    record = jb.Record(T, {"x": x, "z": y - x + torque / stiffness, "T": torque + 0.01 * draw.standard_normal(T.size)})
    found = jb.lost_motion(record, gear_ratio=35.0)
    assert not found.includes_wind_up
    holds(found, PLAY, 0.1)
    assert found.parameters["stiffness"].value == pytest.approx(stiffness, rel=0.05)
    assert found.parameters["lost_motion"].value == pytest.approx(PLAY + 2.0 * 2.0 / stiffness, rel=0.03)


def test_wind_up_that_is_known_is_taken_off():
    x, y = rig()
    record = jb.Record(T, {"x": x, "y": y})
    whole, less = jb.lost_motion(record), jb.lost_motion(record, wind_up=0.002)
    assert less.parameters["backlash"].value == pytest.approx(whole.parameters["backlash"].value - 0.002)
    assert not less.includes_wind_up


def test_lag_is_told_from_play_where_the_speed_varies():
    x, y = rig(lag=0.035)
    found = jb.lost_motion(jb.Record(T, {"x": x, "y": y}), gear_ratio=35.0)
    holds(found, PLAY, 0.2)
    assert found.parameters["lag"].value == pytest.approx(0.035, rel=0.05)


def test_a_link_with_inertia_that_friction_carries():
    """Against a simulation of contact, friction and inertia: the lost motion is the play and the wind-up under friction."""
    step = 5e-4
    t = np.arange(0.0, 40.0, step)
    x = 0.4 * np.sin(2.0 * np.pi * t / 6.0)
    friction, stiffness, inertia = 2.0, 4000.0, 0.05
    y = carried(x[:, None], step, inertia=inertia * ONE, friction=friction * ONE, play=PLAY * ONE, stiffness=stiffness * ONE,
                damping=5.0 * ONE, keep=20)[:, 0]  # fmt: skip
    noisy = y + 1e-4 * np.random.default_rng(4).standard_normal(y.size)
    found = jb.lost_motion(jb.Record(t[::20], {"x": x[::20], "y": noisy}))
    holds(found, PLAY + 2.0 * friction / stiffness, 0.02)


def test_a_link_that_is_pulled():
    draw = np.random.default_rng(6)
    t = np.arange(0.0, 10.0, 0.002)
    pull = np.where((10.0 * t) % 1.0 < 0.5, 1.0, -1.0)
    z = np.convolve(0.5 * PLAY * pull, np.ones(5) / 5.0)[: t.size] + 3e-4 * draw.standard_normal(t.size)
    found = jb.lost_motion(jb.Record(t, {"F": pull, "z": z}))
    holds(found, PLAY, 0.02)
    assert found.way == "pulled"


def test_a_loop_of_torque_over_angle():
    draw = np.random.default_rng(7)
    t = np.arange(0.0, 60.0, 0.02)
    z = 0.015 * np.sin(0.8 * t)
    torque = loop(z, PLAY, (2000.0, 2600.0), 0.6) + 0.02 * draw.standard_normal(t.size)
    found = jb.lost_motion(jb.Record(t, {"T": torque, "z": z + 3e-5 * draw.standard_normal(t.size)}))
    holds(found, PLAY, 0.03)
    for name, truth in (("stiffness_up", 2000.0), ("stiffness_down", 2600.0), ("friction", 0.6)):
        assert found.parameters[name].value == pytest.approx(truth, rel=0.05), name


def refused(record, *words, **how):
    found = jb.lost_motion(record, **how)
    b = found.parameters["backlash"]
    assert b.value is None, found
    assert not found.applies
    assert any(word in b.why for word in words), b.why
    return found


def test_records_that_do_not_show_their_play():
    x, y = rig()
    noise = 1e-5 * np.random.default_rng(0).standard_normal(T.size)
    early = T < 8.0
    refused(jb.Record(T[early], {"x": x[early], "y": y[early]}), "too few reversals")
    refused(jb.Record(T, {"x": 0.003 * x, "y": noise}), "edges not reached")
    refused(jb.Record(T, {"x": x, "y": x + 0.003 * np.sin(35.0 * x) + 10.0 * noise}), "does not show", gear_ratio=35.0)
    count = 3.0 * PLAY
    refused(jb.Record(T, {"x": x, "y": np.round(y / count) * count}), "below a count", "does not show")
    refused(jb.Record(T, {"x": x, "y": np.interp(T - 0.05, T, x) + noise}), "lag")
    refused(jb.Record(T, {"F": np.where(np.sin(T) > 0, 1.0, 0.0), "z": PLAY * (np.sin(T) > 0) + noise}), "one way")
    sure = frozenset("xyz")
    assert refused(jb.Record(T, {"x": x, "y": -y}, confirmed=sure), "opposite").failed.way_out == "--sign y"
    geared = refused(jb.Record(T, {"x": 35.0 * x, "y": y}, confirmed=sure), "missing")
    assert geared.failed.way_out == "--ratio 35"
    inverse = refused(jb.Record(T, {"x": 35.0**2 * x, "y": y}, confirmed=sure), "1/N", gear_ratio=1.0 / 35.0)
    assert inverse.failed.way_out == "--ratio 35"


def test_a_fast_record_is_not_taken_for_a_slow_one():
    record, _ = jb.demo_records()
    assert slow_reading(record) is None


def test_channels_that_cannot_tell():
    record = jb.Record(T, {"x": np.sin(T), "T": np.cos(T)})
    with pytest.raises(jb.BadInput, match="two positions"):
        jb.lost_motion(record)


@pytest.mark.slow
def test_intervals_hold_the_play():
    """95 % intervals of 120 records of six strokes: noise, a gear's error, and a wind-up that scatters from stroke to stroke."""
    t = T[:4000]
    inside, widths = 0, []
    for seed in range(120):
        draw = np.random.default_rng(1000 + seed)
        x = 0.5 * np.sin(2.0 * np.pi * t / 13.0 + draw.uniform(0, 6))
        link = played(x, 0.5 * PLAY * ONE, ONE)
        stroke = np.cumsum(np.append(0, np.diff(np.sign(np.gradient(x))) != 0))
        link = link + 3e-4 * draw.standard_normal(stroke.max() + 1)[stroke] + 0.002 * np.sin(20.0 * x + draw.uniform(0, 6))
        found = jb.lost_motion(jb.Record(t, {"x": x, "y": link + 1e-4 * draw.standard_normal(t.size)}), gear_ratio=20.0)
        low, high = found.parameters["backlash"].ci95
        inside += low <= PLAY <= high
        widths.append(0.5 * (high - low) / PLAY)
    assert 0.90 <= inside / 120 <= 1.0
    assert np.median(widths) < 0.1


def test_means_in_cells_are_those_of_the_samples(monkeypatch):
    from jaxbacklash.quasistatic import cells as module

    monkeypatch.setattr(module, "AT_ONCE", 50)
    draw = np.random.default_rng(8)
    values, group = draw.standard_normal(1000), np.arange(1000) // 100
    parts = module.cells(group, values, values > -1.0)

    def function(v):
        return np.stack([v, v**2], axis=1)

    assert parts.mean_of(function, values) == pytest.approx(parts.mean(function(values)))
    assert parts.size.sum() == np.count_nonzero(values > -1.0)
    assert np.average(parts.mean(values), weights=parts.size) == pytest.approx(values[values > -1.0].mean())


@pytest.mark.shared
@pytest.mark.parametrize("name", ["q01", "q02", "q03", "q05", "q06"])
def test_records_with_dynamics_get_no_number_and_no_bound(shared, name):
    """Drives that swing, whose play is 6 to 17 mrad: read as slow ones they would seem to have none."""
    path = shared / "records_drives" / name
    if not path.exists():
        pytest.skip("the practice records of drives are not here")
    table = np.genfromtxt(path / "train.csv", delimiter=",", names=True)
    ratio = json.loads((path / "answer.json").read_text())["ratio"]
    found = refused(jb.Record(table["t"], {"x": table["motor"] / ratio, "y": table["link"]}), "inertia", gear_ratio=ratio)
    assert "less than" not in found.parameters["backlash"].why
