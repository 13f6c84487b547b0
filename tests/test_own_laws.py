"""A law of one's own is one class: those of docs/how-to/own-effect.md pass the checks of the package's laws, by a row each."""

import re
from pathlib import Path

import pytest

import jaxbacklash as jb

from . import test_gradients
from .laws import LAWS
from .test_examples import forget
from .test_gradients import record as short  # noqa: F401  a fixture of the checks that are used below

PAGE = Path(__file__).resolve().parents[1] / "docs" / "how-to" / "own-effect.md"
ROWS = {"rubber_mount": ("RubberMount", (900.0, 0.08)), "bent_scale": ("BentScale", (0.8,))}
"""The rows that such laws have in the table of laws: class and telling values."""


@pytest.fixture(scope="module")
def own():
    """The classes of the page by name, in the catalogue as long as these tests last."""
    blocks = re.findall(r"^```python\n(.*?)^```$", PAGE.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE)
    text = "".join(block for block in blocks if block.startswith("class "))
    names = {"jb": jb}
    exec(compile(text, str(PAGE), "exec"), names)
    yield dict(names)
    forget(names)


@pytest.mark.parametrize("name", ROWS)
def test_a_row_of_the_table_checks_such_a_law(own, name, monkeypatch, short):  # noqa: F811
    cls, values = ROWS[name]
    assert name in jb.catalogue()
    monkeypatch.setitem(LAWS, name, own[cls](*values))
    for width in (0.0, 5e-4):
        test_gradients.test_rates_in_parameters_and_state(name, width)
    test_gradients.test_shooting_residual(name, short)
