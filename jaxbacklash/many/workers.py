"""Where the rows of many records are made: in processes of this machine, one a core, or by the workers of a dask cluster.

A process that dies, of memory or by a signal, loses nothing but what it had not finished: that is given to a new one, and a
record at which process after process dies is told as a row of its own.
"""

from __future__ import annotations

import os
import pickle
import queue
import subprocess
import sys
import threading
from collections.abc import Iterator, Sequence
from typing import Any

from ..errors import NoAnswer
from ..program import BRIEF, cores
from .chunk import Item, begin, rows_of
from .rows import Row, row_of_failure
from .wanted import Wanted
from .worker import BEGIN, receive, send

Answer = tuple[int, Row]
DEATHS = 2
"""How many processes may die at a record before it is given up."""


def by_processes(wanted: Wanted, chunks: Sequence[Sequence[Item]], workers: int | None = None) -> Iterator[Answer]:
    """The rows of all records, in the order in which they are done, from processes of this machine.

    Parameters
    ----------
    wanted : what is wanted of each
    chunks : the records, some at a time
    workers : how many processes; default one a core
    """
    todo: queue.SimpleQueue[list[Item]] = queue.SimpleQueue()
    for chunk in chunks:
        todo.put(list(chunk))
    left = sum(map(len, chunks))
    # Few answers wait: who writes them down sets the pace.
    answers: queue.Queue[Any] = queue.Queue(maxsize=1000)
    crew = [_Hand(wanted, todo, answers) for _ in range(min(workers or cores(), len(chunks)))]
    try:
        while left:
            found = answers.get()
            if isinstance(found, BaseException):
                raise found
            left -= 1
            yield found
    finally:
        for hand in crew:
            hand.end()


class _Hand:
    """One process, and the thread that gives it work and takes its answers."""

    def __init__(self, wanted: Wanted, todo: queue.SimpleQueue[list[Item]], answers: queue.Queue[Any]) -> None:
        self._wanted, self._todo, self._answers = wanted, todo, answers
        self._process: subprocess.Popen[bytes] | None = None
        self._deaths: dict[int, int] = {}
        self._ended = False
        threading.Thread(target=self._work, daemon=True).start()

    def end(self) -> None:
        """End the process, whatever it is doing."""
        self._ended = True
        if self._process is not None:
            self._process.kill()
            self._process.wait()

    def _work(self) -> None:
        try:
            while not self._ended:
                try:
                    items = self._todo.get_nowait()
                except queue.Empty:
                    break
                while items and not self._ended:
                    items = self._some_of(items)
        except BaseException as error:
            self._answers.put(error)
        finally:
            if self._process is not None and self._process.stdin is not None:
                self._process.stdin.close()

    def _some_of(self, items: list[Item]) -> list[Item]:
        """Have these worked on; what is left of them where the process dies on the way."""
        left = dict(items)
        process = self._process = self._process or _started()
        assert process.stdin is not None
        assert process.stdout is not None
        try:
            send(process.stdin, (self._wanted, items))
            while (answer := receive(process.stdout)) is not None:
                number, _ = answer
                del left[number]
                self._answers.put(answer)
            return []
        except (EOFError, OSError, pickle.UnpicklingError):
            self._process = None
            if self._ended:
                return []
        return self._after_death(process, left)

    def _after_death(self, process: subprocess.Popen[bytes], left: dict[int, Any]) -> list[Item]:
        code = process.wait()
        if len(left) > 1:  # which of them it died at is not known: one after another shows it
            for item in left.items():
                self._todo.put([item])
            return []
        (number, source), *_ = left.items()
        self._deaths[number] = self._deaths.get(number, 0) + 1
        if self._deaths[number] < DEATHS:
            return [(number, source)]
        how = f"signal {-code}" if code < 0 else f"exit code {code}"
        self._answers.put((number, row_of_failure(source, NoAnswer(f"the process that worked on it ended ({how}) each time"))))
        return []


def _started() -> subprocess.Popen[bytes]:
    import jax

    setting: Any = jax.config
    brief = {f"--{name}={value}" for name, value in BRIEF.items()}
    flags = [word for word in os.environ.get("XLA_FLAGS", "").split() if word not in brief]
    # Each core has a process of its own, whose operations have no need to wait for threads of others.
    flags.append("--xla_cpu_multi_thread_eigen=false")
    environment = os.environ | {"XLA_FLAGS": " ".join(flags), "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    environment["PYTHONPATH"] = os.pathsep.join(path for path in sys.path if path)
    process = subprocess.Popen([sys.executable, "-c", BEGIN], stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=environment)
    assert process.stdin is not None
    send(process.stdin, setting.jax_compilation_cache_dir is not None)
    return process


def here(wanted: Wanted, chunks: Sequence[Sequence[Item]]) -> Iterator[Answer]:
    """The same in this process, one record after another: what cannot be handed to another one, such as a law that a notebook
    defines."""
    begin(wanted)
    for chunk in chunks:
        yield from rows_of(wanted, chunk)


def portable(wanted: Wanted) -> bool:
    """Whether another process understands what is wanted: not where it holds classes of a script or a notebook."""
    try:
        data = pickle.dumps(wanted)
    except Exception:  # whatever a class that cannot be written down raises
        return False
    return b"__main__" not in data
