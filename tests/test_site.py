"""The documentation site: its code runs, its commands can be typed, every name and every law is there, no link is dead."""

import ast
import contextlib
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest
import typer.main

import jaxbacklash as jb
from jaxbacklash.cli import app
from jaxbacklash.model_file import dump_model
from tests.in_process import call
from tests.test_examples import public
from website import catalogue, commands, paper
from website.links import broken
from website.pictures import SHOWN

ROOT = Path(__file__).resolve().parents[1]
DOCS = ROOT / "docs"
MADE = {"commands": commands.page, "catalogue": catalogue.page, "paper": paper.page}
PAGES = {path.relative_to(DOCS).with_suffix("").as_posix(): path for path in sorted(DOCS.rglob("*.md"))
         if path.stem not in {*MADE, "conventions", "changes", "benchmarks"}} | {"README": ROOT / "README.md"}  # fmt: skip
BLOCK = re.compile(r"^```(\w*)\n(.*?)^```$", flags=re.DOTALL | re.MULTILINE)
PLAY = 0.02618


def text_of(name: str) -> str:
    """A page's Markdown, made anew where it is made from the package."""
    return MADE[name]() if name in MADE else PAGES[name].read_text(encoding="utf-8")


def blocks(name: str) -> list[tuple[str, str]]:
    """Language and text of a page's blocks of code, in order."""
    return BLOCK.findall(text_of(name))


def typed(block: str) -> list[str]:
    """The commands of a shell block, one each; several on a line are taken apart."""
    lines = [line.split(" #")[0].strip() for line in block.splitlines()]
    return [part.strip() for line in lines for part in line.split("&&") if part.strip()]


ALL = [*PAGES, *MADE]
WITH_CODE = [name for name in ALL if any(kind in ("python", "sh") for kind, _ in blocks(name))]


@pytest.mark.parametrize("name", WITH_CODE)
def test_every_block_is_of_a_kind_that_is_tested_and_can_be_typed(name):
    known = typer.main.get_command(app)
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["optional-dependencies"]
    for kind, block in blocks(name):
        assert kind in ("python", "sh", "text"), f"{name}: a block of {kind or 'no kind'}"
        if kind == "python":
            ast.parse(block)
        for command in typed(block) if kind == "sh" else []:
            program, *words = shlex.split(command)
            if program == "jaxbacklash" and not words[0].startswith("-"):
                options = {option for one in known.commands[words[0]].params for option in one.opts}
                assert {word for word in words if word.startswith("--")} <= options, command
            elif program == "pip":
                assert words[:1] == ["install"], command
                assert set(re.findall(r"\[(\w+)\]", command)) <= extras.keys(), command
            else:
                assert program in ("jaxbacklash", "pytest", "python"), command


def files(folder: Path) -> None:
    """The records that the pages speak of, from the demo's."""
    data = ROOT / "jaxbacklash" / "data"
    for name, source in (("run1", "demo_train"), ("run2", "demo_heldout"), ("sweep1", "demo_train")):
        shutil.copy(data / f"{source}.csv", folder / f"{name}.csv")
    shutil.copy(data / "own_effect.py", folder)
    (folder / "runs").mkdir()
    for name in ("run1", "run2"):
        shutil.copy(folder / f"{name}.csv", folder / "runs")
    t, x, z = np.loadtxt(data / "demo_train.csv", delimiter=",", skiprows=1, unpack=True)
    step = PLAY / 4
    for name, head, rows in (("counts4", "t,x,z", [t, step * np.round(x / step), step * np.round(z / step)]),
                             ("notime", "x,z", [x, z]), ("laser", "t,intensity", [t, z])):  # fmt: skip
        np.savetxt(folder / f"{name}.csv", np.column_stack(rows), delimiter=",", header=head, comments="", fmt="%.7f")
    (folder / "drive1").mkdir()
    drive = jb.drive(4e-5, 9e-5, 50.0, inertia=0.05, backlash=0.0126, stiffness=860.0, damping=0.7)
    (folder / "drive1" / "model.toml").write_text(dump_model(drive), encoding="utf-8")
    slow = next(block for kind, block in blocks("how-to/lost-motion") if kind == "python" and "slow1.csv" in block)
    with contextlib.chdir(folder):
        exec(slow, {})  # the page makes it itself; others only name it


@pytest.mark.slow
@pytest.mark.parametrize("name", WITH_CODE)
def test_every_block_runs(name, tmp_path):
    """Commands in turn, as they stand; all of a page's Python so far with each block, as a reader's session would hold it."""
    files(tmp_path)
    session = f"import sys\nsys.path.insert(0, {str(ROOT)!r})\nimport matplotlib\nmatplotlib.use('Agg')\n"
    pending = ""
    for kind, block in [*blocks(name), ("sh", "")]:
        if kind == "python":
            pending += block + "\n"
            continue
        if kind == "sh" and pending:
            (tmp_path / "block.py").write_text(session + pending)
            done = subprocess.run([sys.executable, "block.py"], cwd=tmp_path, capture_output=True, text=True, timeout=600)
            assert done.returncode == 0, done.stderr
        for command in typed(block) if kind == "sh" else []:
            program, *words = shlex.split(command)
            if program == "jaxbacklash" and words[0] != "studio":  # which serves until it is ended
                outcome = call(words, tmp_path)
                assert outcome.code == 0, f"{command}: {outcome.err}"


def test_every_public_name_is_on_a_page_of_the_api():
    told = set()
    for path in (DOCS / "api").glob("*.md"):
        told |= set(re.findall(r"^::: jaxbacklash\.([\w.]+)$", path.read_text(encoding="utf-8"), flags=re.MULTILINE))
    listed = {name for name in public() if name not in ("plot", "dynamics", "signature")}
    assert not listed - told
    assert not told - listed


def test_every_law_is_in_the_catalogue_with_its_picture():
    page = catalogue.page()
    own = {name for name, law in jb.catalogue().items() if law.__module__.startswith("jaxbacklash.")}
    assert {name for group in catalogue.GROUPS.values() for name in group} == own
    at_motor = {name for name in own if jb.catalogue()[name].port == "motor"}  # the joint of the pictures has none
    assert set(SHOWN) == own - {"learned_torque"} - at_motor
    for name in SHOWN:
        assert f"\n### {name}\n" in page
        assert f'aria-label="Restoring torque with and without {name}, ' in page
    assert page.count("times the noise; fitted values are off by") == len(SHOWN)


def test_a_page_says_what_a_dead_link_is(tmp_path):
    (tmp_path / "a.html").write_text(
        '<a href="b.html#there">1</a><a href="b.html#not">2</a><a href="c.html">3</a><img src="d.png">'
    )
    (tmp_path / "b.html").write_text('<h1 id="there">b</h1><a href="a.html">back</a>')
    assert broken(tmp_path) == ["a.html: b.html#not", "a.html: c.html", "a.html: d.png"]


def test_words_of_parameters_stand_where_descriptions_do():
    pytest.importorskip("griffe")
    from website.plain_words import rewritten

    text = "Fit.\n\nParameters\n----------\nrate, length : samples per second\n    and seconds\n\nReturns\n-------\nthe fit\n"
    assert rewritten(text, "Fit").splitlines()[4:] == [
        "rate, length", "    samples per second", "    and seconds", "", "Returns", "-------", "Fit", "    the fit", "",
    ]  # fmt: skip


@pytest.mark.slow
def test_the_site_builds_without_a_warning_and_every_link_leads_somewhere():
    pytest.importorskip("zensical")
    done = subprocess.run([sys.executable, "-m", "website"], cwd=ROOT, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "every link leads somewhere" in done.stdout
