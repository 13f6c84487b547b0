"""Many like pieces of work, such as fits of many records, whose costly parts meet in one compiled program.

Each piece runs in a thread of its own, as it would alone, up to where it asks for a program (`jaxbacklash.compiled.kept_jit`).
There it waits until every other one asks too or is done. Those that ask for the same program with arguments of the same shapes
are then answered by one call of it, lane after lane, each lane with as many steps as it needs: what a call costs beside the
computing is paid once, and a lane's numbers do not depend on who stands beside it. Only one thread works at a time, in a fixed
order.
"""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any, Generic, TypeVar

import jax
import numpy as np

from .compiled import lane

Name = TypeVar("Name")
Result = TypeVar("Result")
LANES = 32
"""Lanes of a program."""
LARGEST = 64_000_000
"""Bytes of all lanes' arguments at most: what is larger is computed by itself, and does not gain by company."""


def in_lockstep(jobs: Sequence[tuple[Name, Callable[[], Result]]]) -> Iterator[tuple[Name, Result]]:
    """What each job returns, with its name, in the order in which they are done.

    Parameters
    ----------
    jobs : names and functions, which raise nothing

    Examples
    --------
    >>> sorted(in_lockstep([("one", lambda: 1), ("two", lambda: 2)]))
    [('one', 1), ('two', 2)]
    """
    waiting = [_Job(*job) for job in jobs]
    running: list[_Job[Name, Result]] = []
    while running or waiting:
        running, waiting = running + waiting[: LANES - len(running)], waiting[LANES - len(running) :]
        for job in running:
            job.go_on()
        for job in running:
            if job.done:
                yield job.name, job.outcome()
        running = [job for job in running if not job.done]
        _answer(running)


class _Job(Generic[Name, Result]):
    """A piece of work in its thread; it runs only while `go_on` waits for it."""

    def __init__(self, name: Name, work: Callable[[], Result]) -> None:
        self.name, self.asked, self.done = name, _Asked(), False
        self._answers: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self._turn = threading.Semaphore(0)
        self._found: tuple[Any, BaseException | None] = None, None
        self._thread = threading.Thread(target=self._run, args=(work,), daemon=True)
        self._begun = False

    def go_on(self) -> None:
        """Let it work until it asks for something, or is done."""
        if self._begun:
            self._answers.put(self.asked.answer)
        else:
            self._begun = True
            self._thread.start()
        self._turn.acquire()

    def outcome(self) -> Result:
        """What the work returned."""
        value, error = self._found
        if error is not None:
            raise error
        return value

    def _run(self, work: Callable[[], Result]) -> None:
        lane.ask = self._ask
        try:
            self._found = work(), None
        except BaseException as error:
            self._found = None, error
        finally:
            self.done = True
            self._turn.release()

    def _ask(self, function: Any, args: Any) -> Any:
        self.asked = _Asked(function, args)
        self._turn.release()
        answer = self._answers.get()
        if isinstance(answer, _Failed):
            raise answer.error
        return answer


@dataclass
class _Asked:
    """A program that is asked for, its arguments, and the ``answer`` once there is one."""

    function: Any = None
    args: Any = None
    answer: Any = None
    leaves: list[Any] = field(init=False, default_factory=list)
    structure: Any = field(init=False, default=None)

    def __post_init__(self) -> None:
        self.leaves, self.structure = jax.tree.flatten(self.args)

    def kind(self) -> Any:
        """What all that one program answers have in common."""
        fixed = tuple(leaf if not _is_array(leaf) else (leaf.shape, leaf.dtype.str) for leaf in self.leaves)
        return self.function, self.structure, fixed

    @property
    def size(self) -> int:
        """Bytes of the arguments."""
        return sum(leaf.nbytes for leaf in self.leaves if _is_array(leaf))


@dataclass
class _Failed:
    """In place of an answer: what went wrong."""

    error: BaseException


def _answer(jobs: Sequence[_Job[Any, Any]]) -> None:
    """Answer all that is asked for, those together that one program can answer."""
    groups: dict[Any, list[_Asked]] = {}
    for job in jobs:
        try:
            groups.setdefault(job.asked.kind(), []).append(job.asked)
        except TypeError:  # a fixed part that cannot be told from others
            groups[id(job)] = [job.asked]
    for group in groups.values():
        try:
            # One program for all numbers of lanes, and for one alone another: its arguments need no room for others.
            if LANES * group[0].size > LARGEST or not any(map(_is_array, group[0].leaves)):
                for asked in group:
                    asked.answer = asked.function(*asked.args)
            else:
                _together(group)
        except Exception as error:
            for asked in group:
                if asked.answer is None:
                    asked.answer = _Failed(error)


def _together(group: Sequence[_Asked]) -> None:
    lead = group[0]
    stacked = list(lead.leaves)
    for place, leaf in enumerate(lead.leaves):
        if _is_array(leaf):
            stacked[place] = np.zeros((LANES, *leaf.shape), leaf.dtype)
            for number, asked in enumerate(group):
                stacked[place][number] = asked.leaves[place]
    args = jax.tree.unflatten(lead.structure, stacked)
    found = lead.function.on_lanes(args, np.asarray(len(group), np.int32))
    leaves, structure = jax.tree.flatten(found)
    leaves = [np.asarray(leaf) for leaf in leaves]
    for number, asked in enumerate(group):
        # Copies: a view would hold on to what all the others were answered.
        asked.answer = jax.tree.unflatten(structure, [leaf[number].copy() for leaf in leaves])


def _is_array(leaf: Any) -> bool:
    return isinstance(leaf, jax.Array | np.ndarray | np.generic)
