"""Many records: the table, what is kept of it on disk, and what the command line says."""

import csv
import json
import os
import pickle
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import jaxbacklash as jb
from jaxbacklash.commands.reading import Reading
from jaxbacklash.many.kept import NAME, KeptRows
from jaxbacklash.many.rows import row_of_failure
from jaxbacklash.many.wanted import Wanted, keys_of
from jaxbacklash.many.workers import portable
from jaxbacklash.report.many_report import many_report
from jaxbacklash.report.many_result import many_json
from jaxbacklash.simulation import as_record

from .test_cli import call as call
from .test_cli import sentence


def row(name, play, error=0.01, verdict="complete"):
    """A row as a fit makes it, with a play."""
    one = {"value": play, "stderr": error, "low": play - 2 * error, "high": play + 2 * error, "unit": "rad", "verdict": "found"}
    return {
        "record": name, "verdict": verdict, "why": "The model explains the record.", "samples": 1000, "rate_hz": 200.0,
        "rms_over_noise": 1.0, "effects": [], "parameters": {"backlash": one}, "notes": [],
    }  # fmt: skip


def rows(count, *, growth=0.0, folder="runs", seed=0):
    rng = np.random.default_rng(seed)
    plays = np.where(np.arange(count) < count // 2, 1.0, 1.0 + growth) + 0.01 * rng.standard_normal(count)
    return [row(f"{folder}/{k}.csv", play) for k, play in enumerate(plays)]


def test_a_change_is_said_in_words_with_its_interval_and_place():
    each = jb.Each("fit", tuple(rows(40, growth=0.1)))
    assert each.courses["backlash"].change.at == 20
    assert "The play has grown by 10" in str(each)
    assert "since record 21" in str(each)
    assert "Nothing speaks of a change" in str(jb.Each("fit", tuple(rows(40))))


def test_a_fleet_names_the_joint_that_differs():
    of = [one for joint in range(8) for one in rows(5, folder=f"joint{joint}", seed=joint)]
    for one in of[10:15]:
        one["parameters"]["backlash"]["value"] *= 1.3
    said = str(jb.Each("fit", tuple(of)))
    assert "Of 8 joints differ from the others: joint2 (+30" in said
    assert "joint3" not in said


def test_a_failed_record_is_one_line_of_table_and_page(tmp_path):
    broken = row_of_failure(Path("runs/bad.csv"), jb.BadInput("runs/bad.csv, line 3: found 'foo', wanted a number"))
    each = jb.Each("fit", (*rows(12), broken))
    assert each.sentence() == "13 records: 12 explained to their noise, 1 without a result"
    table = list(csv.DictReader(each.write(tmp_path / "table.csv").read_text().splitlines()))
    assert [len(table), table[-1]["verdict"], table[-1]["backlash"]] == [13, "failed", ""]
    assert "line 3" in table[-1]["why"]
    assert float(table[0]["backlash.low"]) < float(table[0]["backlash"]) < float(table[0]["backlash.high"])
    many_report(each, json.loads(json.dumps(many_json(each))), tmp_path / "report.html")
    page = (tmp_path / "report.html").read_text()
    assert "Record 13 has no result" in page
    assert "<svg" in page


def test_parquet_needs_a_library_or_holds_the_same(tmp_path):
    each = jb.Each("fit", tuple(rows(3)))
    try:
        import pyarrow.parquet
    except ImportError:
        with pytest.raises(jb.BadInput, match="pyarrow, which is not installed"):
            each.write(tmp_path / "table.parquet")
        return
    found = pyarrow.parquet.read_table(each.write(tmp_path / "table.parquet")).to_pydict()
    assert found["backlash"] == list(each.numbers("backlash"))


def test_kept_rows_survive_a_line_that_was_cut(tmp_path):
    with KeptRows(tmp_path, ["a", "b"]) as kept:
        kept.put("a", {"verdict": "complete"})
        kept.put("b", {"verdict": "failed"})
    path = tmp_path / NAME
    path.write_bytes(path.read_bytes()[:-9])
    with KeptRows(tmp_path, ["a", "b", "c"]) as kept:
        assert kept.found == {"a": {"verdict": "complete"}}
        with pytest.raises(jb.BadInput, match="another process is writing it"):
            KeptRows(tmp_path, ["a"])
        kept.put("b", {"verdict": "complete"})
    with KeptRows(tmp_path, ["a", "b"]) as kept:
        assert set(kept.found) == {"a", "b"}
    path.write_text("a,b\n")
    with pytest.raises(jb.BadInput, match="no file of rows of jaxbacklash"):
        KeptRows(tmp_path, ["a"])


def test_a_row_is_kept_by_what_is_wanted_and_what_is_in_the_record(tmp_path):
    file = tmp_path / "one.csv"
    file.write_text("t,x,z\n")
    wanted = Wanted("fit", inertia=3.0, read=Reading().record)
    (first,) = keys_of(wanted, [file])
    assert keys_of(pickle.loads(pickle.dumps(wanted)), [file]) == [first]
    assert keys_of(Wanted("fit", inertia=3.1, read=Reading().record), [file]) != [first]
    assert keys_of(Wanted("fit", inertia=3.0, read=Reading(skip=1).record), [file]) != [first]
    file.write_text("t,x,z\n1,2,3\n")
    assert keys_of(wanted, [file]) != [first]


def test_what_a_notebook_defines_stays_in_this_process():
    class Own(jb.AbstractEffect):
        pass

    assert portable(Wanted("fit"))
    assert not portable(Wanted("fit", before=lambda: Own))


def test_an_unforeseen_error_is_a_row_too():
    def breaks(path):
        raise ZeroDivisionError("no way")

    each = jb.fit_each(["a.csv"], read=breaks, workers=0)
    assert each.rows[0]["verdict"] == "failed"
    assert "no way" in each.rows[0]["why"]
    with pytest.raises(jb.BadInput, match="found none"):
        jb.fit_each([])
    assert jb.refine_each(["nowhere.csv"], workers=0, seed=0).rows[0]["why"].startswith("nowhere.csv: found no such file")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["fit", "a.csv", "--cluster", "tcp://nowhere:1"], "--cluster: is for many records"),
        (["fit", "a.csv", "--each", "--profile"], "--profile: is not for many records"),
        (["refine", "a.csv", "a.csv"], "is a second record, wanted one, or --each"),
        (["fit", "a.csv", "--each", "--workers", "0"], "--workers 0: wanted 1 to 1024"),
        (["fit", ".", "--each", "--rate", "-1"], "--rate"),
    ],
)
def test_words_that_do_not_go_together(call, tmp_path, words, said):
    (tmp_path / "a.csv").write_text("t,x,z\n")
    code, out, err = call(*words)
    assert (code, out) == (2, "")
    assert said in sentence(err)


def files(folder, count):
    """Records of two seconds of a joint, the last one broken."""
    system = jb.base_motion_joint(3.0, 0.024, 12000.0, 15.0)
    rng = np.random.default_rng(3)
    for k in range(count):
        lines = 2 * np.pi * np.array([1.1, 2.7, 4.3])
        drive = jb.Multisine(np.array([0.05, 0.03, 0.02]), lines, rng.uniform(0.0, 6.0, 3))
        clean = as_record(jb.simulate(system, drive, duration=2.0, rate=200.0), system)
        noisy = clean.replace(**{n: v + 3e-5 * rng.standard_normal(v.size) for n, v in clean.channels.items()})
        jb.write_record(noisy, folder / f"run{k:02d}.csv")
    (folder / f"run{count:02d}.csv").write_text("t,x,z\n0,1,2\nfoo,1,2\n")


def command(*words):
    return [sys.executable, "-m", "jaxbacklash.cli", *map(str, words)]


@pytest.mark.slow
def test_a_run_that_is_killed_ends_with_the_same_table(tmp_path):
    (tmp_path / "runs").mkdir()
    files(tmp_path / "runs", 12)
    words = ["fit", tmp_path / "runs", "--each", "--inertia", 3.0, "--out"]
    whole = subprocess.run(command(*words, tmp_path / "whole"), capture_output=True, text=True, check=True)
    assert "13 records: 12 explained to their noise, 1 without a result" in whole.stdout
    rows = tmp_path / "cut" / NAME
    run = subprocess.Popen(command(*words, tmp_path / "cut"))
    while run.poll() is None and (not rows.exists() or rows.read_bytes().count(b"\n") < 4):
        time.sleep(0.02)
    run.send_signal(signal.SIGKILL)
    run.wait()
    done = rows.read_bytes()
    assert 4 <= done.count(b"\n") < 14
    subprocess.run(command(*words, tmp_path / "cut"), capture_output=True, check=True)
    assert rows.read_bytes().startswith(done)
    assert (tmp_path / "cut" / "table.csv").read_bytes() == (tmp_path / "whole" / "table.csv").read_bytes()


@pytest.mark.slow
def test_a_process_that_dies_loses_nothing(tmp_path):
    files(tmp_path, 6)
    paths = sorted(tmp_path.glob("*.csv"))
    killed = []

    def kill_one(words, share):
        if not killed and share > 0.0:
            own = Path(f"/proc/{os.getpid()}/task/{os.getpid()}/children")
            started = [int(word) for path in own.parent.parent.glob("*/children") for word in path.read_text().split()]
            killed.append(min(started))
            os.kill(killed[0], signal.SIGKILL)

    each = jb.fit_each(paths, inertia=3.0, progress=kill_one)
    assert killed
    assert [one["verdict"] for one in each.rows] == ["complete"] * 6 + ["failed"]
    assert each.rows == jb.fit_each(paths, inertia=3.0).rows


@pytest.mark.slow
def test_a_dask_worker_that_is_killed_loses_nothing(tmp_path):
    distributed = pytest.importorskip("dask.distributed")
    files(tmp_path, 6)
    paths = sorted(tmp_path.glob("*.csv"))
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        client.wait_for_workers(2)
        killed = []

        def kill_one(words, share):
            if not killed and share > 0.0:
                killed.append(next(iter(cluster.workers.values())).pid)
                os.kill(killed[0], signal.SIGKILL)

        each = jb.fit_each(paths, inertia=3.0, client=client, progress=kill_one)
    assert killed
    assert [one["verdict"] for one in each.rows] == ["complete"] * 6 + ["failed"]


@pytest.mark.slow
def test_no_result_at_all_is_no_answer(call, tmp_path):
    (tmp_path / "a.csv").write_text("t,x,z\n0,foo,1\n")
    code, out, err = call("fit", "a.csv", "b.csv", "--each", "--workers", 1)
    assert code == 1
    assert "2 records: 2 without a result" in out
    assert "none of the 2 records has a result; the first: a.csv" in sentence(err)
