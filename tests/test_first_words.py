"""What a newcomer is told first: the version, the effects by name, the models, the paper, and how to cite."""

import re
import tomllib
from pathlib import Path

import pytest
import typer.main

import jaxbacklash as jb
from jaxbacklash.cli import app
from jaxbacklash.commands.fit import refining
from jaxbacklash.commands.options import EFFECTS
from jaxbacklash.fitting.setup import add_effects
from tests.in_process import call

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
OWN = set(jb.AbstractEffect.__module__.split(".")[:1])


def shipped() -> set[str]:
    """The names of the effects that the package itself defines."""
    return {name for name, law in jb.catalogue().items() if law.__module__.split(".")[0] in OWN}


def test_version_is_printed_and_nothing_else(tmp_path):
    told = call(["--version"], tmp_path)
    assert (told.code, told.out, told.err) == (0, f"jaxbacklash {jb.__version__}\n", "")


def test_the_first_screen_is_whole_and_says_where_to_begin(tmp_path):
    for words, code in (((), 2), (("--help",), 0)):
        told = call(words, tmp_path)
        assert told.code == code
        screen = told.out + told.err
        for name in typer.main.get_command(app).commands:
            assert re.search(rf"^  {name} +[A-Z].*[a-z]$", screen, flags=re.MULTILINE), name
        assert "Begin with: jaxbacklash look YOUR_FILE" in " ".join(screen.split())
        assert not re.search(r"[a-z]\.\.\.", screen)
        assert max(len(line) for line in screen.splitlines()) <= 80


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["fit", "a.csv", "--inertia", "1,5"], "--inertia 1,5: wanted a number, with a point and not a comma"),
        (["fit", "a.csv", "--starts=two"], "--starts two: wanted a whole number"),
        (["fit"], "RECORDS is missing: Records"),
        (["fit"], "Example: jaxbacklash fit run1.csv"),
        (["simulate", "a.toml"], "--out is missing: Record to write"),
        (["fti", "a.csv"], "Did you mean 'fit'?"),
    ],
)
def test_a_wrong_word_is_answered_with_what_was_wanted(tmp_path, words, said):
    (tmp_path / "a.csv").write_text("")
    told = call(words, tmp_path)
    assert told.code == 2
    assert told.err.startswith("error: ")
    assert said in told.err
    assert len(told.err.splitlines()) == 1


def test_the_command_after_a_fit_is_one_that_refine_takes():
    words = ["fit", "./run1.csv", "run2.csv", "--heldout", "run2.csv", "--effects=gravity", "--out", "fit1", "--inertia", "3"]
    assert refining(words, ["run2.csv"]) == "jaxbacklash refine ./run1.csv --heldout run2.csv --inertia 3"
    assert refining(["fit", "a.csv", "a.csv"], ["a.csv"]) == "jaxbacklash refine a.csv"


def test_a_misspelt_effect_is_answered_with_the_nearest(tmp_path):
    system = jb.base_motion_joint(inertia=1.0, backlash=0.02, stiffness=1e4, damping=10.0)
    with pytest.raises(jb.BadInput, match=r"gravty: no such effect \(did you mean gravity\?\), wanted some of"):
        add_effects(system, ["gravty"])


def test_help_names_every_effect_and_what_each_model_is(tmp_path):
    assert set(EFFECTS.split(", ")) == shipped()
    for command in ("fit", "diagnose"):
        told = " ".join(call([command, "--help"], tmp_path).out.split())
        assert not [name for name in shipped() if name not in told]
        assert "linear (a spring without play)" in told
        assert "free (damping alone)" in told


def test_readme_names_every_effect_the_paper_and_the_cache():
    assert not [name for name in shipped() if f"`{name}`" not in README]
    for words in ("*Identification of backlash in mechanical systems*", "Tjahjowidodo", "XDG_CACHE_HOME", "--model linear",
                  "--model free", 'fit.parameters["backlash"].value', "--version"):  # fmt: skip
        assert words in README, words


def test_citation_is_of_this_version():
    lines = (ROOT / "CITATION.cff").read_text(encoding="utf-8").splitlines()
    fields = dict(re.fullmatch(r"([a-z-]+):\s*(.*)", line).groups() for line in lines if re.match(r"[a-z-]+:", line))
    assert fields["version"] == jb.__version__
    assert fields["cff-version"] == "1.2.0"
    assert {"message", "title", "authors", "references"} <= fields.keys()


def test_the_notebooks_extra_can_execute_what_it_converts():
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["optional-dependencies"]
    names = {re.split(r"[>=\[]", one)[0] for one in extras["notebooks"]}
    assert {"jupytext", "nbconvert", "ipykernel"} <= names  # what `jupytext --to ipynb --execute` asks for
