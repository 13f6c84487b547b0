"""The command line called within this process: compiled programs stay warm from one call to the next."""

from __future__ import annotations

import contextlib
import io
import os
import sys
import time
import traceback
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from unittest import mock

CRASH = -1
"""The code of a call that ended in a traceback."""


@dataclass(frozen=True)
class Outcome:
    """What a call left: exit code, stdout, stderr, seconds; and the records it read where it was stopped after reading."""

    code: int
    out: str
    err: str
    seconds: float
    records: tuple[Any, ...] = ()

    @property
    def sentences(self) -> list[str]:
        """The lines of stderr that are no warnings."""
        return [line for line in self.err.splitlines() if line.strip() and not line.startswith("warning:")]

    @property
    def last(self) -> str:
        """The last line of stderr."""
        return (self.err.strip().splitlines() or [""])[-1]


def call(words: Sequence[str], folder: Path) -> Outcome:
    """Run ``jaxbacklash WORDS`` as if typed in ``folder``."""
    from jaxbacklash import cli

    out, err, begun = io.StringIO(), io.StringIO(), time.monotonic()
    with _typed(words, folder), _staying(), contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            cli.main()
            code = 0
        except SystemExit as end:
            code = end.code if isinstance(end.code, int) else 0 if end.code is None else 1
        except BaseException:
            code = CRASH
            err.write(traceback.format_exc())
    return Outcome(code, out.getvalue(), err.getvalue(), time.monotonic() - begun)


def read_only(words: Sequence[str], folder: Path) -> Outcome:
    """The same for a `fit`, stopped where its records are read and the fit would begin."""
    from jaxbacklash.commands import fit

    records: list[Any] = []

    def keep(given: Sequence[Any], **_: Any) -> None:
        records.extend(given)

    with mock.patch.object(fit, "fit_records", keep), mock.patch.object(fit, "deliver"):
        outcome = call(words, folder)
    return Outcome(outcome.code, outcome.out, outcome.err, outcome.seconds, tuple(records))


@contextlib.contextmanager
def _staying() -> Iterator[None]:
    """What a command does to its process at its end, which is not its own here, is left out."""
    from jaxbacklash import stopping
    from jaxbacklash.commands import outcome

    with mock.patch.object(stopping, "end_when_told"), mock.patch.object(outcome, "let_go_of_output"):
        yield


@contextlib.contextmanager
def _typed(words: Sequence[str], folder: Path) -> Iterator[None]:
    """The process as if the words had been typed in a folder; all as before afterwards."""
    before, argv = Path.cwd(), sys.argv
    os.chdir(folder)
    sys.argv = ["jaxbacklash", *words]
    try:
        with warnings.catch_warnings():
            # A new process shows a warning though one before has shown it; pytest's own filters are not a user's.
            warnings.resetwarnings()
            warnings.simplefilter("always", UserWarning)
            for usual in (DeprecationWarning, PendingDeprecationWarning, ImportWarning, ResourceWarning):
                warnings.simplefilter("ignore", usual)
            yield
    finally:
        sys.argv = argv
        os.chdir(before)
