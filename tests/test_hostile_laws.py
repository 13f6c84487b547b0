"""A user's law that cannot be used is refused in one sentence: file, line, law, what was found, what to write instead."""

import sys

import pytest

from jaxbacklash.commands.laws import load_laws
from jaxbacklash.effects import Damper, Gravity
from jaxbacklash.errors import BadInput
from jaxbacklash.fitting.setup import add_effects
from jaxbacklash.mechanics import AbstractEffect, catalogue
from jaxbacklash.system import System

from .hostile import ended, one_sentence, write_record_csv

HEAD = """from jaxbacklash import AbstractEffect, param
import jax.numpy as jnp
import numpy as np
import math, os, sys

class Mine(AbstractEffect):
    s: float = param(unit="N m/rad", null=0.0, scale=10.0)
"""
TORQUE = "    def torque(self, now):\n        {}\n"


@pytest.fixture(autouse=True)
def forgotten(monkeypatch):
    """No other test finds these laws in the catalogue."""
    kept = AbstractEffect.__subclasses__
    yield
    own = [cls for cls in kept() if cls.__module__.startswith("own_laws_file_")]
    for cls in own:
        cls.__name__ = "Abstract" + cls.__name__


def law(body):
    return HEAD + TORQUE.format(body)


def field(text):
    return HEAD.replace('s: float = param(unit="N m/rad", null=0.0, scale=10.0)', text) + TORQUE.format("return -now.y")


CASES = {
    "if": (law("return -self.s * now.y if now.y > 0 else 0.0"), ["line 9", "law mine, torque", "jnp.where"]),
    "max": (law("return -self.s * max(now.y, 0.0)"), ["line 9", "jnp.maximum"]),
    "numpy": (law("return -self.s * np.sin(now.y)"), ["line 9", "numpy", "import jax.numpy as jnp"]),
    "math": (law("return -self.s * math.sin(now.y)"), ["line 9", "jnp.sin for math.sin"]),
    "float": (law("return float(now.y)"), ["line 9", "float()"]),
    "index": (law("return [0.0, 1.0][now.y.astype(int)]"), ["line 9", "an index"]),
    "none": (law("self.s * now.y"), ["line 8", "nothing (None)", "wanted one real number"]),
    "text": (law("return 'much'"), ["line 8", "str 'much'"]),
    "array": (law("return jnp.ones(3) * now.y"), ["line 8", "shape (3,)"]),
    "complex": (law("return now.y * 1j"), ["line 8", "a complex number"]),
    "comparison": (law("return now.y > 0"), ["line 8", "True or False"]),
    "nan": (law("return jnp.nan * now.y"), ["line 8", "is nan at t ="]),
    "inf": (law("return self.s + jnp.inf"), ["line 8", "is inf"]),
    "a root": (law("return self.s * jnp.sqrt(now.y)"), ["line 8", "is nan", "guard roots"]),
    "a division": (law("return self.s / now.dz"), ["at rest (all motion 0)"]),
    "a derivative": (law("return -jnp.sqrt(jnp.abs(self.s)) * now.y"), ["derivative with respect to s", "s = 0"]),
    "attribute": (law("return now.speed"), ["line 9", "AttributeError", "speed"]),
    "raises": (law("raise KeyError('k')"), ["line 9", "KeyError"]),
    "exits": (law("sys.exit(5)"), ["line 9", "tries to end the program"]),
    "leaves": (law("os._exit(5)"), ["line 9", "tries to end the program"]),
    "interrupts": (law("raise KeyboardInterrupt"), ["line 9", "KeyboardInterrupt"]),
    "deep": (law("return self.torque(now)"), ["line 9", "RecursionError"]),
    "no argument": (HEAD + "    def torque(self):\n        return 0.0\n", ["line 8", "TypeError"]),
    "no method": (HEAD, ["law mine", "changes nothing"]),
    "states": (
        law("return 0.0").replace("    s:", '    states = ("q",)\n    s:') + "    def rate(self, now):\n        return 0.0\n",
        ["rate", "a tuple of 1 numbers"],
    ),
    "port": (law("return 0.0").replace("    s:", '    port = "gear"\n    s:'), ["port is 'gear'"]),
    "no param": (field("s: float = 3.0"), ["s is not declared as a parameter"]),
    "bounds": (field('s: float = param(unit="rad", lower=2.0, upper=1.0)'), ["lower 2 and upper 1"]),
    "null outside": (field('s: float = param(unit="rad", null=-1.0, lower=0.0)'), ["null -1"]),
    "a null that is text": (field('s: float = param(unit="rad", null="0")'), ["null '0'"]),
    "unit of two lines": (field('s: float = param(unit="N\\nm", null=0.0)'), ["unit 'N\\nm'"]),
    "unit that is none": (field("s: float = param(unit=None, null=0.0)"), ["unit None"]),
    "unknown word": (field('s: float = param(unit="rad", nul=0.0)'), ["line 7", "TypeError"]),
    "required": (field('s: float = param(unit="rad", required=True)'), ["law mine, guesses", "TypeError"]),
    "taken": (law("return 0.0").replace("Mine", "Gravity"), ["the name gravity", "taken"]),
    "twice": (law("return -self.s * now.y") + law("return 0.0").replace("Mine", "mine"), ["both named mine"]),
    "syntax": ("def f(:\n", ["line 1", "is not Python"]),
    "null byte": ("a = 1\0", ["is not Python"]),
    "import": ("import no_such_library\n", ["line 1", "no_such_library"]),
    "exit": ("import sys\nsys.exit(5)\n", ["line 2", "SystemExit"]),
    "exit 0": ("raise SystemExit(0)\n", ["line 1", "SystemExit"]),
    "os exit": ("import os\nos._exit(0)\n", ["line 2", "SystemExit"]),
    "interrupt": ("raise KeyboardInterrupt\n", ["line 1", "KeyboardInterrupt"]),
    "nothing": ("", ["defines no effect"]),
    "only abstract": (law("return 0.0").replace("Mine", "AbstractMine"), ["defines no effect"]),
}  # fmt: skip


@pytest.mark.parametrize(("text", "fragments"), CASES.values(), ids=CASES)
def test_a_law_that_cannot_be_used(tmp_path, text, fragments):
    path = tmp_path / "laws.py"
    path.write_text(text)
    with pytest.raises(BadInput) as caught:
        load_laws(path)
    told = str(caught.value)
    assert str(path) in told
    assert len(told.splitlines()) == 1
    for fragment in fragments:
        assert fragment in told


@pytest.mark.parametrize("content", [b"\xff\xfe\x00", b"# -*- coding: nonsense -*-\n", b"x" * 3])
def test_a_file_that_is_no_python(tmp_path, content):
    (tmp_path / "laws.py").write_bytes(content)
    with pytest.raises(BadInput, match=r"laws\.py"):
        load_laws(tmp_path / "laws.py")


@pytest.mark.parametrize("text", [
    law("return -self.s * now.y"), law("return 0"), "from __future__ import annotations\n" + law("return -self.s * now.z"),
    law("print('traced'); return -self.s * jnp.where(now.y > 0, now.y, 0.0)") + "print('loaded')\n",
])  # fmt: skip
def test_a_good_law_is_known_and_says_nothing_on_stdout(tmp_path, capsys, text):
    (tmp_path / "numpy.py").write_text(text)  # the name of the file is of no matter
    load_laws(tmp_path / "numpy.py")
    load_laws(tmp_path / "numpy.py")  # as in a notebook whose cell is run again
    assert catalogue()["mine"].__module__ in sys.modules
    assert capsys.readouterr().out == ""


@pytest.mark.slow
def test_the_laws_that_ship_are_good():
    from pathlib import Path

    from jaxbacklash.commands.law_check import check_law

    before = {name: cls for name, cls in catalogue().items() if cls.__module__.startswith("jaxbacklash.")}
    for name, cls in before.items():
        if name != "learned_torque":  # made of a table, not of numbers
            check_law(cls, Path("none.py"), "--laws")


@pytest.mark.slow
@pytest.mark.parametrize(("text", "code"), [("import sys; sys.exit(5)", 2), ("import os; os._exit(0)", 2)])
def test_a_law_file_does_not_choose_the_exit_code(tmp_path, text, code):
    write_record_csv(tmp_path / "r.csv")
    (tmp_path / "laws.py").write_text(text)
    found, out, err = ended("fit", "r.csv", "--inertia", "2", "--laws", "laws.py", "--json", cwd=tmp_path)
    assert (found, out) == (code, "")
    assert "laws.py, line 1" in one_sentence(err)


@pytest.mark.slow
def test_a_law_file_that_never_ends_is_ended(tmp_path):
    write_record_csv(tmp_path / "r.csv")
    (tmp_path / "laws.py").write_text("while True:\n    pass\n")
    code, _, err = ended("fit", "r.csv", "--inertia", "2", "--laws", "laws.py", cwd=tmp_path)
    assert code == 2
    assert "is still running after" in one_sentence(err)


@pytest.mark.parametrize("effects", [["gravity", "gravity"], ["preload", "gravity", "preload"], [Gravity(1.0), "gravity"]])
def test_an_effect_named_twice_is_told(effects):
    with pytest.raises(BadInput, match=f"--effects {effects[-1]}: the model has this effect already"):
        add_effects(System(1.0, None, Damper(0.0)), effects)


def test_an_effect_that_the_model_file_has_is_not_begun_anew():
    with pytest.raises(BadInput, match="has this effect already"):
        add_effects(System(1.0, None, Damper(0.0), {"gravity": Gravity(3.0)}), ["gravity"])


def test_what_a_refused_file_printed_is_no_second_sentence(tmp_path, capsys):
    (tmp_path / "laws.py").write_text("print('hello')\n")
    with pytest.raises(BadInput, match="defines no effect"):
        load_laws(tmp_path / "laws.py")
    assert capsys.readouterr() == ("", "")
