"""Switching one rule of the search off while a program runs, and counting which rules act on a record.

A rule is a function, a method or a number of the package with something else that can stand in its place. Modules hold what
they import under a name of their own, so that the stand-in is put wherever `jaxbacklash.criticism` and `jaxbacklash.fitting`
import it. Code that JAX has compiled does not look anything up again: nothing that is only called while a program is traced can
be a rule.
"""

from __future__ import annotations

import ast
import copy
import functools
import importlib
import importlib.util
import pkgutil
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

PACKAGES = ("jaxbacklash.criticism", "jaxbacklash.fitting")


@dataclass(frozen=True)
class Rule:
    """A rule of the search, and what stands in its place when it is off.

    Attributes: ``name``; ``at``, where it is, as ``folder.module:name`` or ``folder.module:Class.name``; ``instead`` the
    stand-in; ``why``, what the rule is for; ``fits`` that the stand-in makes itself, so that the rule acts only when it makes
    more; ``read_by``, for a number, the function that reads it, if there is one: unless that is called the number does not act.
    """

    name: str
    at: str
    instead: Any
    why: str
    fits: int = 0
    read_by: str | None = None


@dataclass
class Tally:
    """How often a rule was asked and acted, and the seconds spent in it."""

    calls: int = 0
    acted: int = 0
    seconds: float = 0.0
    depth: int = 0


def argument(number: int) -> Callable[..., Any]:
    """A stand-in that gives one of its arguments back, a method's object being number 0."""
    return lambda *args, **kwargs: args[number]


def always(value: Any) -> Callable[..., Any]:
    """A stand-in that gives the same value whatever it is asked."""
    return lambda *args, **kwargs: copy.copy(value)


def places(at: str) -> list[tuple[Any, str]]:
    """Objects and the names under which they hold what is at ``folder.module:name``: its own module or class first.

    Raises
    ------
    AttributeError
        There is no such thing there; what a class inherits is at the class that defines it.
    """
    home, _, name = at.partition(":")
    module = importlib.import_module(f"jaxbacklash.{home}")
    owner, _, method = name.partition(".")
    if method:
        if method not in vars(getattr(module, owner)):
            raise AttributeError(f"{at}: {owner} defines no {method}")
        return [(getattr(module, owner), method)]
    getattr(module, name)
    return _holders(module.__name__, name)


def _holders(home: str, name: str) -> list[tuple[ModuleType, str]]:
    """The module that has a name, and all that import it from there, or from one of those."""
    found: list[tuple[ModuleType, str]] = [(importlib.import_module(home), name)]
    for importer, own in _imports().get((home, name), ()):
        found += _holders(importer, own)
    return found


@functools.cache
def _imports() -> dict[tuple[str, str], list[tuple[str, str]]]:
    """Who imports what in the two folders: importing modules, and the names that they give it, by module and name."""
    found: dict[tuple[str, str], list[tuple[str, str]]] = {}
    for package in map(importlib.import_module, PACKAGES):
        for info in pkgutil.iter_modules(package.__path__, f"{package.__name__}."):
            module = importlib.import_module(info.name)
            for node in ast.parse(Path(str(module.__file__)).read_text(encoding="utf-8")).body:
                if not isinstance(node, ast.ImportFrom):
                    continue
                said = "." * node.level + (node.module or "")
                source = importlib.util.resolve_name(said, package.__name__)
                for alias in node.names:
                    found.setdefault((source, alias.name), []).append((info.name, alias.asname or alias.name))
    return found


@contextmanager
def replaced(at: str, instead: Any) -> Iterator[None]:
    """Something else in the place of what is at ``at``, wherever the package looks it up."""
    held = [(owner, name, vars(owner)[name]) for owner, name in places(at)]
    try:
        for owner, name, _ in held:
            setattr(owner, name, instead)
        yield
    finally:
        for owner, name, own in held:
            setattr(owner, name, own)


def present(at: str) -> Any:
    """What is at ``at`` now."""
    owner, name = places(at)[0]
    return vars(owner)[name]


@contextmanager
def counted(rules: Iterable[Rule]) -> Iterator[dict[str, Tally]]:
    """All rules on, and by the name of each how often it acted while this lasts.

    A function acts where it gives another answer than its stand-in, or has models fitted that may be found again; with a stand-in
    that fits models itself, where it makes more fits than that. A number acts when what reads it is called.
    """
    tallies = {}
    with ExitStack() as stack:
        for rule in rules:
            tally = tallies[rule.name] = Tally()
            if callable(original := present(rule.at)):
                stack.enter_context(replaced(rule.at, _counting(rule, original, tally)))
            elif rule.read_by is None:
                tally.acted = 1
            else:
                stack.enter_context(replaced(rule.read_by, _counting(rule, present(rule.read_by), tally)))
        yield tallies


def _counting(rule: Rule, original: Callable[..., Any], tally: Tally) -> Callable[..., Any]:
    """The same function, which counts when it acts."""

    @functools.wraps(original)
    def function(*args: Any, **kwargs: Any) -> Any:
        before, begun = _left(args), time.perf_counter()
        tally.calls, tally.depth = tally.calls + 1, tally.depth + 1
        try:
            found = original(*args, **kwargs)
        except Exception:
            tally.acted += 1
            raise
        finally:
            tally.depth -= 1
            if not tally.depth:  # one that calls itself is timed once
                tally.seconds += time.perf_counter() - begun
        (fits, ruled), (had, knew) = _left(args), before
        if rule.read_by or fits - had > rule.fits or ruled != knew:
            tally.acted += 1
        elif not rule.fits:
            tally.acted += not same(found, rule.instead(*args, **kwargs))
        return found

    return function


def _left(args: tuple[Any, ...]) -> tuple[int, int]:
    """What a call leaves behind beside its answer: fits made by the search or the bench it is of, and models ruled out."""
    first = args[0] if args else None
    return getattr(getattr(first, "bench", first), "fits", 0), len(getattr(first, "behind", ()))


def same(one: Any, other: Any) -> bool:
    """Whether two answers are the same: equal numbers, words and arrays, the very same models, and what is made of such."""
    if one is other:
        return True
    if isinstance(one, np.ndarray) or isinstance(other, np.ndarray):
        return bool(np.array_equal(one, other))
    if isinstance(one, bool | int | float | str | frozenset | np.generic):
        return bool(one == other)
    if type(one) is not type(other):
        return False
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(same(one[key], other[key]) for key in one)
    return isinstance(one, list | tuple) and len(one) == len(other) and all(map(same, one, other))
