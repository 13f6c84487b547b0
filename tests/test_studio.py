"""The work behind the page of ``jaxbacklash studio``, without a browser: files, choices, the tree, jobs, the Python of it."""

import os
import shutil
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import pytest

import jaxbacklash as jb
from jaxbacklash.errors import BadInput
from jaxbacklash.studio import work
from jaxbacklash.studio.choice import Choice, opened
from jaxbacklash.studio.folder import Folder
from jaxbacklash.studio.script import script
from jaxbacklash.studio.session import Session
from jaxbacklash.studio.tree import Tree
from jaxbacklash.studio.work import Setup
from jaxbacklash.studio.worker import Job, Worker

DATA = Path(jb.__file__).parent / "data"
LONG = 600.0


@pytest.fixture
def folder(tmp_path):
    """A folder with the demo's records, a file that is no record, and one outside it."""
    inside = tmp_path / "bench"
    (inside / "day 2").mkdir(parents=True)
    shutil.copy(DATA / "demo_train.csv", inside / "run1.csv")
    shutil.copy(DATA / "demo_heldout.csv", inside / "day 2" / "run2.csv")
    (inside / "broken.csv").write_text("t,x,z\n0,0,0\n0.002,1,nan\n0.004,1,1\n")
    (inside / ".hidden.csv").write_text("t,x,z\n")
    (inside / "report.html").write_text("<html>")
    (tmp_path / "outside.csv").write_text("t,x,z\n")
    os.symlink(tmp_path / "outside.csv", inside / "link.csv")
    return inside


def test_only_files_that_may_be_records_are_listed(folder):
    assert Folder(folder).files() == ["broken.csv", "run1.csv", "day 2/run2.csv"]


@pytest.mark.parametrize("name", ["../outside.csv", "link.csv", "/etc/passwd", "day 2/../../outside.csv", "\0", "nothere", ""])
def test_a_file_outside_the_folder_is_refused(folder, name):
    with pytest.raises(BadInput):
        Folder(folder).path(name)


@pytest.mark.parametrize("name", ["../saved", "/tmp/saved", "", ".", "run1.csv", "day 2"])
def test_results_go_into_a_new_folder_within_the_folder(folder, name):
    with pytest.raises(BadInput):
        Folder(folder).new(name)
    assert Folder(folder).new("found1") == folder / "found1"


def test_a_record_is_opened_with_columns_and_units(folder):
    (folder / "degrees.csv").write_text(
        "time,base,link\n" + "\n".join(f"{0.002 * n:.3f},{(n % 7) + n / 50},{(n % 5) - n / 90}" for n in range(400))
    )
    choice = Choice("degrees.csv").with_columns({"t": "#1", "x": "#2", "z": "#3"}, {"x": "deg", "z": "deg", "y": "deg"})
    found = opened(choice, folder / "degrees.csv")
    assert found.record is not None, found.wrong
    assert found.record.channels["x"][1] == pytest.approx((1 + 1 / 50) * 3.141592653589793 / 180)
    assert dict(choice.options.units) == {"x": "deg", "z": "deg"}


def test_a_bad_file_says_what_is_wrong_and_what_may_mend_it(folder):
    found = opened(Choice("broken.csv"), folder / "broken.csv")
    assert found.record is None
    assert found.wrong.startswith("broken.csv")
    assert str(folder) not in found.wrong
    uneven = folder / "uneven.csv"
    rows = (folder / "run1.csv").read_text().splitlines()
    uneven.write_text("\n".join(rows[:400] + rows[402:900]) + "\n")
    found = opened(Choice("uneven.csv"), uneven)
    assert found.record is None
    assert found.remedy == "--resample"
    mended = opened(found.choice.with_words(found.remedy), uneven)
    assert mended.record is not None


def test_options_that_cannot_be_understood_are_refused():
    with pytest.raises(BadInput):
        Choice("a.csv").with_words("--rate fast")


def fitted(rms, held=None):
    """What the tree needs of a fit."""
    return SimpleNamespace(score=SimpleNamespace(rms=rms), heldout=None if held is None else SimpleNamespace(rms=held))


def test_the_tree_keeps_branches_and_goes_back_and_forth():
    tree = Tree()
    base = tree.add(None, (), fitted(4.0))
    wrong = tree.add(base.number, ("preload",), fitted(3.9))
    tree.undo()
    assert tree.current == base
    tree.redo()
    assert tree.current == wrong
    tree.undo()
    right = tree.add(base.number, ("gravity",), fitted(1.0, 1.1))
    assert not tree.can_redo
    assert tree.children(0) == [wrong, right]
    assert tree.path(right.number) == [base, right]
    assert tree.find(("gravity",)) == right
    tree.go(wrong.number)
    tree.undo()
    assert tree.current == right
    tree.learn(right.number, refused="no answer")
    assert tree.current.refused == "no answer"
    for number in (-1, 3):
        with pytest.raises(BadInput):
            tree.go(number)
    while tree.can_undo:
        tree.undo()
    with pytest.raises(BadInput):
        tree.undo()


def test_the_python_says_all_that_was_chosen():
    choice = Choice("run1.csv").with_columns({"x": "#2"}, {"x": "deg"}).with_words("--unwrap x --from 2")
    tree = Tree()
    tree.add(None, (), fitted(4.0, 4.1))
    last = tree.add(0, ("gravity",), fitted(1.0, 1.1))
    text = script(choice, Choice("run2.csv"), Setup("linear", 3.16, True), tree.path(last.number))
    compile(text, "repeat.py", "exec")
    assert "jb.read_record('run1.csv', columns={'x': '#2'}, units={'x': 'deg'}, unwrap=['x'], start=2.0)" in text
    assert "fit = jb.fit(record, heldout=heldout, effects=['gravity'], model='linear', inertia=3.16, translational=True)" in text
    assert "on the held-out record 1.1" in text


@pytest.mark.parametrize("wrong", [{"inertia": -1.0}, {"inertia": float("nan")}, {"model": "cubic"}])
def test_a_setup_that_cannot_be_meant_is_refused(wrong):
    with pytest.raises(BadInput):
        Setup(**wrong)


def double(value, tell):
    tell("doubling", 0.5)
    return 2 * value


def dawdle(tell):
    tell("dawdling", 0.1)
    time.sleep(LONG)


def refuse(tell):
    raise BadInput("wanted something else")


def vanish(tell):
    os._exit(3)


@pytest.fixture
def worker():
    one = Worker()
    yield one
    one.close()


def ask(worker, function, *arguments, aside=False):
    """Submit a job; the list takes what comes back."""
    came: list = []
    worker.submit(Job("a job", function, arguments, came.append, lambda why: came.append(f"no: {why}"), aside))
    return came


def until(true, seconds=LONG):
    end = time.monotonic() + seconds
    while not true():
        assert time.monotonic() < end
        time.sleep(0.02)


def test_jobs_come_back_stop_at_once_and_leave_a_worker_that_works(worker):
    assert (first := ask(worker, double, 21)) is not None
    assert worker.wait(LONG)
    assert first == [42]
    refused = ask(worker, refuse)
    assert worker.wait(LONG)
    assert refused == ["no: wanted something else"]

    stopped, forgotten = ask(worker, dawdle), ask(worker, double, 1)
    until(lambda: worker.now is not None and worker.now.stage == "dawdling")
    begun = time.monotonic()
    worker.stop()
    assert worker.wait(LONG)
    assert time.monotonic() - begun < 30.0
    assert stopped == ["no: stopped"]
    assert forgotten == []

    gone = ask(worker, vanish)
    assert worker.wait(LONG)
    assert "ended by itself" in gone[0]
    again = ask(worker, double, 4)
    assert worker.wait(LONG)
    assert again == [8]


def test_what_was_asked_for_goes_before_what_was_not(worker):
    order: list = []
    first = ask(worker, dawdle)
    until(lambda: worker.now is not None)
    for name, aside in (("aside", True), ("asked", False), ("asked later", False)):
        worker.submit(Job(name, double, (1,), lambda _, name=name: order.append(name), print, aside))
    assert [job.title for job in worker._waiting] == ["asked", "asked later", "aside"]
    worker.stop()
    assert worker.wait(LONG)
    assert first == ["no: stopped"]
    assert order == []


@pytest.fixture
def session(folder):
    one = Session(Folder(folder))
    yield one
    one.close()


def test_nothing_can_be_fitted_before_a_record_is_open(session):
    for act in (session.begin, session.refine, session.python, session.undo, lambda: session.add("gravity")):
        with pytest.raises(BadInput):
            act()
    session.open(Choice("broken.csv"))
    assert session.record.wrong.startswith("broken.csv")
    with pytest.raises(BadInput):
        session.begin()
    with pytest.raises(BadInput):
        session.open(Choice("../outside.csv"))


def test_every_effect_that_can_be_added_has_a_name_of_the_catalogue():
    assert set(work.addable(())) <= set(jb.catalogue())
    assert "gravity" not in work.addable(("gravity",))


def test_another_record_or_setup_forgets_the_models(session):
    session.open(Choice("run1.csv"))
    session.tree.add(None, (), fitted(1.0))
    before = session.version
    session.choose(Setup(inertia=3.16))
    assert session.version > before
    assert len(session.tree) == 0
    session.tree.add(None, (), fitted(1.0))
    session.open_heldout(Choice("day 2/run2.csv"))
    assert len(session.tree) == 0


def test_what_was_wrong_before_is_not_said_beside_new_work(session):
    session.open(Choice("run1.csv"))
    for act in (session.begin, session.refine):
        session.say("inertia 'heavy': wanted a number, or nothing", bad=True)
        act()
        assert (session.message, session.bad) == ("", False)
        session.stop()
        assert (session.message, session.bad) == ("stopped", False)  # even of what had not begun
        assert session.worker.wait(LONG)


@pytest.mark.slow
def test_the_whole_loop_and_the_python_that_repeats_it(session, folder):
    session.open(Choice("run1.csv").with_words("--to 4"))
    session.open_heldout(Choice("day 2/run2.csv").with_words("--to 4"))
    session.choose(Setup(inertia=3.16))
    session.begin()
    assert session.worker.wait(LONG), session.message
    base = session.tree.current
    assert base.rms > 2.0
    assert base.ranking[0].name == "gravity"
    assert base.findings.surface is not None
    assert base.causes == ()

    session.add("preload")
    assert session.worker.wait(LONG)
    assert session.tree.current.rms > 2.0
    session.undo()
    session.add("gravity")
    assert session.worker.wait(LONG)
    right = session.tree.current
    assert right.rms < 1.1
    assert right.heldout_rms < 1.2
    with pytest.raises(BadInput):
        session.add("gravity")
    session.add("preload")
    session.stop()
    assert session.worker.wait(LONG)
    assert session.message == "stopped"
    assert session.tree.current == right

    target, written = session.save("found1")
    assert sorted(path.name for path in target.iterdir()) == sorted(written)
    assert jb.load_model(target / "model.toml").effects.keys() == {"gravity"}
    assert "The error" in (target / "report.html").read_text() or "Prediction error" in (target / "report.html").read_text()
    with pytest.raises(BadInput):
        session.save("found1")
    done = subprocess.run([sys.executable, target / "repeat.py"], cwd=folder, capture_output=True, text=True, timeout=LONG)
    assert done.returncode == 0, done.stderr
    assert f"base model + gravity: error over the noise {right.rms!r} held out {right.heldout_rms!r}" in done.stdout
    assert jb.load_model(folder / "model.toml").effects.keys() == {"gravity"}
