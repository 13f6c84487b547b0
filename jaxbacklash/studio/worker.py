"""One process that computes beside the page, one job after another: how far it is, and an end to it at once when it is told to.

A computation of XLA hears of no interrupt, so that only the end of its process stops it. A new process is begun in the place of
one that was stopped; what it computed before lies in the cache of compiled programs.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
import time
import warnings
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from multiprocessing.connection import Connection
from typing import Any

import jaxbacklash as jb

from ..errors import BadInput, NoAnswer

LONGEST = 300


@dataclass
class Job:
    """Something to compute.

    Attributes: ``title`` in words; ``function`` of `work`, called with ``arguments`` and a function that is told how far it is;
    ``done`` is called with what comes back, ``failed`` with a sentence, both in the thread that waits for the process; ``aside``
    True of what nobody asked for, which others go before.
    """

    title: str
    function: Callable[..., Any]
    arguments: tuple[Any, ...]
    done: Callable[[Any], None]
    failed: Callable[[str], None]
    aside: bool = False
    stage: str = ""
    share: float = 0.0
    begun: float = field(default_factory=time.monotonic)


def sentence(error: BaseException) -> str:
    """An error as one sentence for a person."""
    text = " ".join(str(error).split())
    if isinstance(error, BadInput | NoAnswer):
        return text
    if isinstance(error, MemoryError) or "RESOURCE_EXHAUSTED" in text:
        return "there is not enough memory for this; try a shorter record or a lower rate"
    return f"{type(error).__name__}: {text[:LONGEST] or 'no message'}; please report it"


class Worker:
    """The process, and the jobs that wait for it.

    Parameters
    ----------
    changed : called whenever there is something new to show
    """

    def __init__(self, changed: Callable[[], None] = lambda: None) -> None:
        self._changed = changed
        self._lock = threading.Condition()
        self._waiting: list[Job] = []
        self._now: Job | None = None
        self._stopped = False
        self._closed = False
        self._process: Any = None
        self._pipe: Connection | None = None
        self._thread = threading.Thread(target=self._work, daemon=True)
        self._thread.start()

    @property
    def now(self) -> Job | None:
        """What is being computed."""
        return self._now

    @property
    def waiting(self) -> int:
        """How many jobs wait."""
        return len(self._waiting)

    @property
    def busy(self) -> bool:
        """Whether anything is computed or waits."""
        with self._lock:
            return self._now is not None or bool(self._waiting)

    def submit(self, job: Job) -> None:
        """Compute this when its turn comes: before everything that nobody asked for."""
        with self._lock:
            place = len(self._waiting)
            if not job.aside:
                place = next((n for n, other in enumerate(self._waiting) if other.aside), place)
            self._waiting.insert(place, job)
            self._lock.notify_all()
        self._changed()

    def stop(self) -> None:
        """End what is being computed and forget what waits."""
        with self._lock:
            self._waiting.clear()
            if self._now is not None:
                self._stopped = True
                self._kill()
        self._changed()

    def close(self) -> None:
        """End the process for good."""
        with self._lock:
            self._closed = True
            self._waiting.clear()
            self._kill()
            self._lock.notify_all()

    def wait(self, seconds: float) -> bool:
        """Wait until nothing is left to compute; False where that takes longer."""
        with self._lock:
            return self._lock.wait_for(lambda: self._now is None and not self._waiting, seconds)

    def _kill(self) -> None:
        if self._process is not None and self._process.is_alive():
            self._process.kill()

    def _begin(self) -> None:
        """A new process in the place of none, or of one that has ended."""
        context = multiprocessing.get_context("spawn")
        pipe, theirs = context.Pipe()
        process = context.Process(target=serve, args=(theirs,), daemon=True)
        process.start()
        theirs.close()
        with self._lock:
            self._process, self._pipe = process, pipe

    def _work(self) -> None:
        while True:
            with self._lock:
                if self._closed:
                    return
                absent = self._process is None or not self._process.is_alive()
            if absent:
                self._begin()
            with self._lock:
                self._lock.wait_for(lambda: bool(self._waiting) or self._closed)
                if self._closed:
                    return
                self._now, self._stopped = self._waiting.pop(0), False
                self._now.begun = time.monotonic()
            self._changed()
            job = self._now
            try:
                self._run(job)
            except (EOFError, OSError):
                with self._lock:
                    self._kill()
                    self._process = None  # it may take a moment to end; nothing more is asked of it
                job.failed("stopped" if self._stopped else "the computation ended by itself, maybe for want of memory")
            except Exception as why:  # what the page does with a result must not end the thread
                job.failed(sentence(why))
            with self._lock:
                self._now = None
                self._lock.notify_all()
            self._changed()

    def _run(self, job: Job) -> None:
        assert self._pipe is not None
        self._pipe.send((job.function, job.arguments))
        while True:
            word, what = self._pipe.recv()
            if word == "progress":
                job.stage, job.share = what
                self._changed()
            elif word == "done":
                job.share = 1.0
                return job.done(what)
            else:
                return job.failed(what)


def serve(pipe: Connection) -> None:
    """The process: computes what comes through the pipe until that is closed, and ends with the one that began it."""
    with suppress(ValueError, OSError):
        signal.signal(signal.SIGINT, signal.SIG_IGN)  # of a terminal, it reaches the page's process too, which ends this one
    threading.Thread(target=_end_with_parent, daemon=True).start()
    warnings.simplefilter("ignore")
    from ..program import start

    start(brief=True)  # as the commands compute
    _ = jb.fit, jb.rank_effects, jb.where_it_fails  # what is loaded now need not be when somebody waits for it
    while True:
        try:
            function, arguments = pipe.recv()
        except EOFError:
            return
        try:
            found = "done", function(*arguments, lambda stage, share: pipe.send(("progress", (stage, share))))
        except Exception as why:
            found = "failed", sentence(why)
        pipe.send(found)


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        multiprocessing.connection.wait([parent.sentinel])
        os._exit(0)
