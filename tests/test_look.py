"""`jaxbacklash look`: facts of a file, questions, and a command that goes on and is then right."""

import json
import shlex

import numpy as np
import pytest

from jaxbacklash.cli import app
from jaxbacklash.commands.look import spark
from jaxbacklash.errors import BadInput
from jaxbacklash.records import read_record
from jaxbacklash.records.description import describe
from jaxbacklash.records.options import ReadOptions
from jaxbacklash.records.roles import guess_roles
from jaxbacklash.records.table import Column, Table

N, RATE = 1500, 500.0
T = np.arange(N) / RATE
RNG = np.random.default_rng(1)
X = 0.1 * np.sin(13 * T) + 3e-5 * RNG.standard_normal(N)
Z = 0.02 * np.sin(29 * T + 0.4) + 3e-5 * RNG.standard_normal(N)


def written(path, names, *columns):
    rows = [",".join(f'"{name}"' for name in names), *(",".join(f"{value:.9g}" for value in row) for row in zip(*columns))]
    path.write_text("\n".join(rows) + "\n")
    return path


def looked(capsys, *words):
    app(["look", *map(str, words)], standalone_mode=False)
    return capsys.readouterr().out


def test_a_good_record_is_told_with_its_roles_and_the_command(tmp_path, capsys):
    path = written(tmp_path / "run 1.csv", ["t", "x", "z"], T, X, Z)
    said = looked(capsys, path)
    assert "500 Hz" in said
    assert "-> x" in said
    assert "a record of base motion" in said
    assert said.rstrip().endswith(f"next: jaxbacklash fit '{path}'")


def test_the_json_is_what_the_interface_says(tmp_path, capsys):
    path = written(tmp_path / "run.csv", ["Time [s]", "Base, deg", "Rel, deg"], T, np.degrees(X), np.degrees(Z))
    found = json.loads(looked(capsys, path, "--json"))
    assert {"format", "encoding", "rows", "rate_hz", "columns", "kind", "questions", "command"} <= set(found)
    assert found["kind"] == "base_motion"
    assert found["rows"] == N
    assert found["rate_hz"] == pytest.approx(RATE)
    assert [(column["role"], column["unit"]) for column in found["columns"]] == [("t", "s"), ("x", "deg"), ("z", "deg")]
    assert shlex.split(found["command"])[:3] == ["jaxbacklash", "fit", str(path)]
    assert "Base, deg" in found["command"]
    assert len(found["questions"]) == 1


def test_what_is_asked_is_answered_until_the_record_can_be_read(tmp_path):
    wrapped = np.mod(X + 3.1 + np.pi, 2 * np.pi) - np.pi
    holed = Z.copy()
    holed[900:902] = np.nan
    path = written(tmp_path / "run.csv", ["Time", "CH1", "CH2"], T, wrapped, holed)
    found = describe(path, ReadOptions())
    assert found.record is not None
    assert len(found.questions) == 3
    words = shlex.split(found.command)
    assert {"--columns", "--unwrap", "--resample"} <= set(words)
    np.testing.assert_allclose(np.ptp(found.record.channels["x"]), np.ptp(X), rtol=1e-6)


def test_one_series_goes_to_chaos(tmp_path):
    path = written(tmp_path / "laser.csv", ["intensity"], np.abs(np.sin(np.arange(800) ** 1.1)))
    found = describe(path, ReadOptions())
    assert found.kind == "series"
    assert found.command.startswith("jaxbacklash chaos ")
    assert "--rate HZ" in found.command


def test_a_page_shows_every_column(tmp_path, capsys):
    path = written(tmp_path / "run.csv", ["t", "x", "z", "temperature <b>"], T, X, Z, 20 + 0.1 * T)
    looked(capsys, path, "--out", tmp_path / "out")
    page = (tmp_path / "out" / "report.html").read_text()
    assert page.count("<figure ") == 4
    assert "temperature &lt;b&gt;" in page
    assert json.loads((tmp_path / "out" / "result.json").read_text())["rows"] == N


def test_a_row_of_blocks_follows_the_values():
    assert spark(np.linspace(0.0, 1.0, 8), 8) == "▁▂▃▄▅▆▇█"
    assert spark(np.array(["a", "b"])) == ""
    assert spark(np.ones(5)) == ""


def test_the_joint_in_a_name_says_more_than_the_quantity_behind_it():
    """Robots write "joint_states/base/position": every motion is a position."""
    names = ["t", "joint_states/link/position", "joint_states/link/velocity", "joint_states/base/position"]
    values = [T, X + Z, np.gradient(X + Z, T), X]
    roles = guess_roles(Table(tuple(map(Column, names, values)), "mcap"))
    assert {role: names[number] for role, number in roles.items()} == {"t": names[0], "x": names[3], "y": names[1]}


def test_a_command_names_its_columns_once(tmp_path):
    path = tmp_path / "short.csv"
    path.write_text("".join(f"{t:.3f} s,{z:.5f} deg\n" for t, z in zip(T[:40], np.degrees(Z))))
    found = describe(path, ReadOptions())
    assert found.kind == "series"
    assert found.command.count("--columns") == 1


def test_uneven_times_are_resampled_by_the_command(tmp_path):
    uneven = T + 0.2 / RATE * np.sin(np.arange(N))
    found = describe(written(tmp_path / "run.csv", ["t", "x", "z"], uneven, X, Z), ReadOptions())
    assert found.record is not None
    assert found.command.endswith("--resample")


def test_counts_too_long_for_a_number_are_proposed_as_times(tmp_path):
    path = tmp_path / "run.csv"
    rows = [f"{1700000000123456789 + 2000000 * k},{x:.7f},{z:.7f}" for k, (x, z) in enumerate(zip(X, Z))]
    path.write_text("\n".join(["moment,x,z", *rows]) + "\n")
    found = describe(path, ReadOptions())
    assert found.command.endswith("--columns t=moment")
    np.testing.assert_allclose(found.record.t, T, atol=1e-9)


def test_a_word_among_numbers_is_named_and_its_column_is_still_the_base(tmp_path, capsys):
    path = written(tmp_path / "run.csv", ["time_s", "base_rad", "joint_rad"], T, X, X + Z)
    rows = path.read_text().splitlines()
    rows[322] = rows[322].split(",")[0] + ",ERR," + rows[322].split(",")[2]
    path.write_text("\n".join(rows) + "\n")
    with pytest.raises(BadInput, match="x=base_rad,y=joint_rad"):
        read_record(path)
    found = describe(path, ReadOptions())
    assert found.record is None
    assert found.columns[1].role == "x"
    assert found.columns[1].findings[0] == 'numbers, but "ERR" at row 322 (line 323)'
    assert 'row 322 (line 323), column base_rad: found "ERR", wanted a number' in found.obstacle
    assert "--columns t=time_s,x=base_rad,y=joint_rad" in found.command
    assert found.command.startswith("jaxbacklash fit")


def test_counts_of_a_turn_that_are_too_few_are_asked_for_and_no_degrees_on_top(tmp_path):
    step = 2 * np.pi / 65536
    path = written(tmp_path / "run.csv", ["t", "x", "z"], T, np.round(X / step), np.round(4 * Z / step))
    found = describe(path, ReadOptions())
    assert "--scale z=0.00153398" in found.command
    assert "deg" not in found.command
    assert found.record is None
    assert "state the factor to radians (2 pi over the counts of a turn)" in found.obstacle
    assert describe(path, ReadOptions(scales={"x": step, "z": step})).record is not None
