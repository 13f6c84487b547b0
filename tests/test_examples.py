"""The examples in the docstrings of everything public run, and tell what they say.

They begin where a user begins: with ``import jaxbacklash as jb``, `numpy` as ``np``, `jax.numpy` as ``jnp``, `pyplot` as ``plt``,
and ``jb.start()``.
"""

import doctest
import inspect
import pydoc
from types import ModuleType

import jax.numpy as jnp
import matplotlib
import numpy as np
import pytest
from matplotlib import pyplot as plt

import jaxbacklash as jb

HOW = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
LONG = {
    "cross_check", "refine", "missing_torque", "explain_torque", "where_it_fails", "rank_effects", "find_causes", "plot.ranking",
    "refine_each", "plot.force_loop", "plot.where_it_fails", "plot.missing_torque", "plot.torque_over", "plot.pattern_region",
}  # fmt: skip
"""Examples that take more than a few seconds, most of them to compile."""
ELSEWHERE = {"read_record", "read_series", "write_record", "start"}
"""Functions whose example needs a file of the user's, or changes the process."""


def public() -> dict[str, object]:
    """Everything that is public by its name below ``jb``: functions, classes, and the two modules that speak for themselves."""
    found: dict[str, object] = {"plot": jb.plot}
    for prefix, module in (("", jb), ("plot.", jb.plot), ("dynamics.", jb.dynamics), ("signature.", jb.signature)):
        for name in getattr(module, "__all__", None) or [n for n in dir(module) if not n.startswith("_")]:
            if not isinstance(getattr(module, name), ModuleType):
                found[prefix + name] = getattr(module, name)
    return found


def examples(name: str, thing: object) -> list[doctest.DocTest]:
    """Those of a thing, and of its methods where it is a class."""
    parser = doctest.DocTestParser()
    texts = {name: inspect.getdoc(thing) or ""}
    if inspect.isclass(thing):
        own = {key: value for key, value in vars(thing).items() if inspect.isfunction(value)}
        texts |= {f"{name}.{key}": inspect.getdoc(value) or "" for key, value in own.items()}
    names = {"jb": jb, "np": np, "jnp": jnp, "plt": plt}
    tests = [parser.get_doctest(text, dict(names), key, None, 0) for key, text in texts.items()]
    return [test for test in tests if test.examples]


TOLD = {name: thing for name, thing in public().items() if examples(name, thing)}


def forget(names: dict[str, object]) -> None:
    """Take the laws that an example has defined out of the catalogue again: other tests search all of it."""
    for thing in names.values():
        if inspect.isclass(thing) and issubclass(thing, jb.AbstractEffect) and not thing.__module__.startswith("jaxbacklash."):
            thing.__name__ = "Abstract"
    names.clear()


@pytest.mark.parametrize("name", [pytest.param(n, marks=[pytest.mark.slow] if n in LONG else []) for n in TOLD])
def test_examples_tell_what_comes_out(name):
    matplotlib.use("Agg")
    said: list[str] = []
    runner = doctest.DocTestRunner(optionflags=HOW)
    try:
        for test in examples(name, TOLD[name]):
            runner.run(test, out=said.append, clear_globs=False)
            forget(test.globs)
    finally:
        plt.close("all")
    assert not runner.failures, "".join(said)
    assert runner.tries


def test_no_example_leaves_a_law_behind():
    test_examples_tell_what_comes_out("param")
    assert "tide" not in jb.catalogue()


def test_every_public_function_has_an_example():
    functions = {name for name, thing in public().items() if inspect.isfunction(thing)}
    assert len(functions) > 70
    without = functions - TOLD.keys() - ELSEWHERE
    assert not without
    skipped = {name for name in functions & TOLD.keys() for test in examples(name, TOLD[name])
               if all(doctest.SKIP in one.options for one in test.examples)}  # fmt: skip
    assert skipped <= ELSEWHERE


def test_every_public_function_tells_what_comes_back():
    silent = set()
    for name, thing in public().items():
        if inspect.isfunction(thing) and ("Parameters\n---" in (inspect.getdoc(thing) or "")):
            told = inspect.signature(thing).return_annotation in (None, "None") or "Returns\n---" in (inspect.getdoc(thing) or "")
            silent |= set() if told else {name}
    assert not silent - ELSEWHERE


def test_help_of_fit_tells_a_newcomer_what_comes_back():
    text = pydoc.render_doc(jb.fit, renderer=pydoc.plaintext)
    for words in ('parameters["backlash"]', "value", "stderr", "ci95", "score.rms", "heldout.rms", "adequate", "system",
                  "to_dataframe()", "jb.plot.fit(fit)", "total play", ">>> fit = jb.fit("):  # fmt: skip
        assert words in text, words
