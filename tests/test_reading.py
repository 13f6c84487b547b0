"""From a table to a record: columns by every way of naming them, units of the file, clocks, bridges; refusals that go on."""

import shlex
import warnings

import numpy as np
import pytest

from jaxbacklash.errors import BadInput
from jaxbacklash.records import parse_columns
from jaxbacklash.records.options import ReadOptions
from jaxbacklash.records.reader import record_of
from jaxbacklash.records.remedies import applied, with_remedy
from jaxbacklash.records.roles import columns_option, guess_roles
from jaxbacklash.records.table import Column, Table

N, RATE = 1500, 500.0
T = np.arange(N) / RATE
RNG = np.random.default_rng(0)
X = 0.1 * np.sin(13 * T) + 3e-5 * RNG.standard_normal(N)
Z = 0.02 * np.sin(29 * T + 0.4) + 3e-5 * RNG.standard_normal(N)


def table(*columns: Column, **about) -> Table:
    return Table(columns, "csv", **about)


def named(**columns) -> Table:
    return table(*(Column(name, np.asarray(values)) for name, values in columns.items()))


def read(source: Table, **options):
    """The record and the sentences of its warnings."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        found = record_of(source, ReadOptions(**options), "rec.csv")
    return found, [str(one.message) for one in caught]


def refusal(source: Table, **options) -> BadInput:
    with pytest.raises(BadInput) as caught:
        read(source, **options)
    assert "\n" not in str(caught.value)
    return caught.value


@pytest.mark.parametrize(
    ("text", "meant"),
    [
        ('t="Time, s",x="Base, deg"', {"t": "Time, s", "x": "Base, deg"}),
        ("t=Time, s,x=Base, deg,z=Rel, deg", {"t": "Time, s", "x": "Base, deg", "z": "Rel, deg"}),
        ("t=#1,z=group/ch 2", {"t": "#1", "z": "group/ch 2"}),
        (["t='a=b'", "x=c"], {"t": "a=b", "x": "c"}),
    ],
)
def test_columns_are_named_plainly_in_quotes_or_by_number(text, meant):
    assert parse_columns(text) == meant


def test_a_column_is_found_by_name_number_or_name_without_its_unit():
    source = table(Column("Time [s]", T, "s"), Column("p, q", X), Column("rel", Z))
    for spec in ("#1", "Time [s]", "Time"):
        found, _ = read(source, columns={"t": spec, "x": "p, q", "z": "#3"})
        np.testing.assert_array_equal(found.channels["x"], X)
    assert "#1 to #3" in str(refusal(source, columns={"t": "#4"}))
    assert "did you mean rel" in str(refusal(source, columns={"t": "#1", "z": "rell"}))


def test_a_channel_with_its_unit_in_the_name_is_read_in_that_unit_and_said():
    moved = Column("x [deg]", np.degrees(X), "deg"), Column("z [deg]", np.degrees(Z), "deg")
    source = table(Column("t [ms]", 1e3 * T, "ms"), *moved)
    found, said = read(source)
    np.testing.assert_allclose(found.channels["z"], Z, rtol=1e-12)
    np.testing.assert_allclose(found.t, T, atol=1e-12)
    assert sum("deg" in sentence for sentence in said) == 2
    stated, _ = read(source, units={"x": "mrad", "z": "mrad"})
    np.testing.assert_allclose(stated.channels["z"], 1e-3 * np.degrees(Z), rtol=1e-12)


def test_a_scale_beside_a_unit_of_the_file_is_asked_about():
    source = table(Column("t", T), Column("x", X), Column("z", np.degrees(Z), "deg"))
    assert "--unit z=deg" in str(refusal(source, scales={"z": 0.0174533}, units={"x": "rad"}))
    assert "--unit x=deg" in str(refusal(source))


def test_an_unknown_unit_of_the_file_is_not_passed_over():
    source = table(Column("t", T), Column("x", X, "rad"), Column("z", Z, "counts"))
    assert "--scale z=FACTOR" in str(refusal(source))
    assert read(source, scales={"z": 1.0})[0].samples == N


def test_time_by_its_own_word_is_taken_and_said():
    found, said = read(table(Column("Time [ms]", 1e3 * T, "ms"), Column("x", X), Column("z", Z)))
    np.testing.assert_allclose(found.t, T, atol=1e-12)
    assert any("taken as t" in sentence for sentence in said)
    assert "wanted a time column t" in str(refusal(named(time=T, Time=T, x=X, z=Z)))


def test_a_name_that_stands_twice_is_told_and_its_clock_compared():
    source = table(Column("Time", T), Column("p", X), Column("Time", T.copy()), Column("b", Z))
    found, said = read(source, columns={"t": "Time", "x": "p", "z": "b"})
    assert found.samples == N
    assert any("more than once" in sentence for sentence in said)
    assert any("the same as those of t" in sentence for sentence in said)


def test_one_name_for_two_channels_means_its_columns_one_after_the_other():
    refused = refusal(table(Column("t", T), Column("angle", X), Column("angle", Z)), columns={"x": "angle", "z": "angle"})
    assert refused.remedy == "--columns 'x=#2,z=#3'"


def test_clocks_apart_are_refused_and_brought_together_on_request():
    late = T + 0.0007
    shifted = np.interp(late, T, Z)
    source = table(Column("t", T), Column("x", X), Column("t_z", late), Column("z", shifted))
    refused = refusal(source)
    assert refused.remedy == "--resample"
    assert "0.7 ms" in str(refused)
    found, said = read(source, resample=True)
    inside = slice(5, -5)
    assert found.samples == N - 1
    assert np.max(np.abs(found.channels["z"][inside] - Z[1:][inside])) < 2e-4
    assert any("own times" in sentence for sentence in said)


def test_a_rate_takes_the_place_of_times_that_only_tell_when_rows_were_written():
    bursty = np.floor(T / 0.02) * 0.02
    source = named(t=bursty, x=X, z=Z)
    refusal(source)
    found, said = read(source, rate=RATE)
    assert found.rate_hz == pytest.approx(RATE)
    assert any("not used" in sentence for sentence in said)
    assert "leave --rate out" in str(refusal(named(t=np.arange(N) / 800.0, x=X, z=Z), rate=1000.0))


def test_a_file_without_times_needs_its_rate_and_says_the_one_it_states():
    refused = refusal(table(Column("x", X), Column("z", Z), rate_hz=500.0))
    assert refused.remedy == "--rate 500"
    assert "--rate HZ" in str(refusal(named(x=X, z=Z)))
    assert read(named(x=X, z=Z), rate=RATE)[0].rate_hz == pytest.approx(RATE)


def test_short_gaps_are_bridged_on_request_and_their_rows_named():
    holed = Z.copy()
    holed[700:703] = np.nan
    source = table(Column("t", T), Column("x", X), Column("z", holed), first_line=2)
    refused = refusal(source)
    assert "row 701 (line 702)" in str(refused)
    assert refused.remedy == "--resample"
    found, said = read(source, resample=True)
    assert np.max(np.abs(found.channels["z"] - Z)) < 3e-4
    assert any("row 701 (line 702)" in sentence for sentence in said)
    holed[700:710] = np.nan
    assert "10 missing values in a row" in str(refusal(source, resample=True))


def test_a_driven_record_is_no_free_decay_though_its_base_is_misnamed():
    refused = refusal(named(t=T, base=X, z=0.2 * X + Z))
    assert refused.remedy == "--columns x=base"
    decay = 0.1 * np.exp(-1.2 * T) * np.sin(40 * T) + 3e-5 * RNG.standard_normal(N)
    assert read(named(t=T, temperature=20 + 0.1 * T, z=decay))[0].kind == "free_decay"
    assert read(named(t=T, base=X, z=Z), columns={"z": "z"})[0].kind == "free_decay"


def test_signs_and_gears_are_mended_where_they_are_said():
    found, _ = read(named(t=T, x=10 * X, z=-Z), ratio=10.0, sign=frozenset("z"))
    np.testing.assert_allclose(found.channels["x"], X, rtol=1e-12)
    np.testing.assert_array_equal(found.channels["z"], Z)
    assert "which --sign names" in str(refusal(named(t=T, x=X, z=Z), sign=frozenset("F")))


def test_a_stretch_may_be_chosen():
    found, _ = read(named(t=T, x=X, z=Z), start=1.0, stop=2.0)
    assert (found.t[0], found.t[-1]) == (1.0, 2.0)
    again = np.concatenate([T[:700], T[: N - 700]])
    found, _ = read(named(t=again, x=X, z=Z), stop=float(T[699]))
    assert found.samples == 700
    assert "--from and --to" in str(refusal(named(t=T, x=X, z=Z), start=9.0))


def test_roles_are_guessed_from_names_and_then_from_what_moves():
    assert guess_roles(named(Time=T, Base=X, Rel=Z)) == {"t": 0, "x": 1, "z": 2}
    assert guess_roles(named(a=T, b=X, c=X + Z)) == {"t": 0, "x": 1, "y": 2}
    assert guess_roles(named(elapsed=T, CH1=X, CH2=Z)) == {"t": 0, "x": 1, "z": 2}
    assert guess_roles(named(t=T, Force=X, Angle=Z)) == {"t": 0, "y": 2, "F": 1}
    source = table(Column("Time, s", T), Column("Base", X), Column("Base", Z))
    assert shlex.split(columns_option(source, {"t": 0, "x": 1, "z": 2})) == ["--columns", 't="Time, s",x=#2,z=#3']


def test_a_remedy_goes_into_options_and_into_the_command():
    options = applied(ReadOptions(columns={"t": "Time"}), "--columns 't=Time,x=Base, deg' --unwrap x --rate 500")
    assert (options.columns, options.unwrap, options.rate) == ({"t": "Time", "x": "Base, deg"}, frozenset("x"), 500.0)
    words = ["fit", "a b.csv", "--columns=t=Time", "--resample", "--unwrap", "z"]
    assert with_remedy(words, "--columns t=Time,x=Base --resample --unwrap x") == [
        "fit", "a b.csv", "--unwrap", "z", "--columns", "t=Time,x=Base", "--resample", "--unwrap", "x",
    ]  # fmt: skip


def test_counts_that_were_scaled_are_unwrapped_by_a_whole_counter():
    count = 2.0 * np.pi / 2**18
    counted = np.round((X + 0.001) / count) % 2**12
    source = table(Column("t", T), Column("x", counted), Column("z", Z))
    record, _ = read(source, scales={"x": count}, unwrap=frozenset("x"))
    miss = record.channels["x"] - X
    assert np.ptp(miss) < 1.01 * count


def test_a_code_for_a_failed_reading_is_no_sign_of_degrees():
    z = Z.copy()
    z[[400, 900]] = 1e6
    _, said = read(named(t=T, x=X, z=z))
    assert any("rows 401 and 901" in one for one in said)


def test_three_axes_of_a_sensor_are_no_degrees():
    told = refusal(named(t=T, x=3.0 * np.sin(20.0 * T), y=2.0 * np.sin(31.0 * T), z=9.81 + 3.0 * np.sin(44.0 * T)))
    assert "accelerometer" in str(told)


@pytest.mark.parametrize(("factor", "unit"), [(180.0 / np.pi, "x=deg"), (0.5 / np.pi, "x=rev")])
def test_a_base_in_another_unit_than_the_link_is_told_by_the_unit(factor, unit):
    slow = 0.1 * np.sin(5.0 * T) + 0.05 * np.sin(11.0 * T) + 3e-5 * RNG.standard_normal(N)
    told = refusal(named(t=T, x=factor * slow, y=slow + 1e-3 * np.sin(60.0 * T)))
    assert told.remedy == f"--unit {unit}"


def test_times_that_grow_ever_faster_are_uneven_not_bursts():
    told = refusal(named(t=T**3, x=X, z=Z))
    assert "uneven" in str(told) or "gap" in str(told)


@pytest.mark.parametrize(("times", "found"), [(T[::-1], "sort them by time"), (0.0 * T + 5.0, "is 5 in every row")])
def test_times_in_no_order_get_no_rate_to_paste(times, found):
    told = refusal(named(t=times, x=X, z=Z))
    assert found in str(told)
    assert not told.remedy


def test_channels_of_one_group_have_one_clock_and_nothing_is_said():
    source = table(Column("x", X, clock=T), Column("z", Z, clock=T.copy()))
    found, said = read(source)
    assert found.samples == N
    assert not any("times of its own" in sentence for sentence in said)


def test_rows_in_messages_are_rows_of_the_file():
    spiked = Z.copy()
    spiked[1000] += 0.3
    _, said = read(table(Column("t", T), Column("x", X), Column("z", spiked)), start=T[400])
    (sentence,) = (each for each in said if "stands out" in each)
    assert "row 601 " in sentence
    assert "row 401 of the file" in sentence
    holed = Z.copy()
    holed[1000] = np.nan
    source = table(Column("t", T), Column("x", X), Column("z", holed), first_line=2)
    assert "row 1001 (line 1002)" in str(refusal(source, start=T[400]))
    _, said = read(source, start=T[400], resample=True)
    assert any("bridged, at row 1001 (line 1002)" in sentence for sentence in said)
    gap = np.r_[0:1000, 1003:N]
    refused = refusal(named(t=T[gap], x=X[gap], z=Z[gap]), start=T[400])
    assert "between rows 600 and 601 " in str(refused)
    assert "row 401 of the file" in str(refused)
    assert refused.remedy == "--resample"


def test_rows_left_out_because_a_channel_is_held_are_said():
    held = np.repeat(Z[2::5], 5)[: N - 3]
    z = np.concatenate([Z[:3], held])[:N]
    found, said = read(named(t=T, x=X, z=z), despike={"z"})
    assert found.samples == pytest.approx(N / 5, abs=1)
    (sentence,) = (each for each in said if "every 5 rows" in each)
    assert f"only those {found.samples} rows are used, at 100 Hz" in sentence
