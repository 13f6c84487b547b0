"""``jaxbacklash check``: known answers are asked for, a wrong one ends in an error, extras are named."""

import importlib.metadata
import json
import tomllib
from pathlib import Path

import pytest

from jaxbacklash.commands import check

from .test_cli import call as call
from .test_cli import sentence


def test_what_is_quick_is_right():
    for name in ("double precision", "a free swing"):
        right, told = check.KNOWN[name]()
        assert right, told


@pytest.mark.slow
def test_every_known_answer_is_right(call):
    code, out, err = call("check", "--json")
    assert code == 0, err
    assert [one["right"] for one in json.loads(out)["checks"]] == [True] * len(check.KNOWN)


def test_a_wrong_answer_ends_in_a_sentence_and_an_error(call, monkeypatch):
    monkeypatch.setattr(check, "KNOWN", {"sums": lambda: (True, "2"), "products": lambda: (False, "2 x 3 = 5")})
    code, out, err = call("check")
    assert code == 1
    assert "ok    sums: 2" in out
    assert "WRONG products: 2 x 3 = 5" in out
    assert "products" in sentence(err)
    assert "sums" not in err


def test_an_extra_names_what_it_lacks(monkeypatch):
    told = ['h5py>=3.10; extra == "io"', 'no-such-library[all]>=1; extra == "io"', "numpy>=1.26", 'zarr>=3; extra == "sweep"']
    monkeypatch.setattr(importlib.metadata, "requires", lambda name: told)
    assert check.missing("io") == ["no-such-library"]
    assert check.missing("nothing") == []


def test_extras_are_those_of_the_package():
    project = tomllib.loads((Path(__file__).resolve().parents[1] / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert set(check.EXTRAS) == set(project["optional-dependencies"]) - {"test", "dev", "docs"}
