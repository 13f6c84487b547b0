"""Run a case: in a warm worker, or in a process of its own with its surroundings and signals; a hang ends the process."""

from __future__ import annotations

import contextlib
import json
import os
import select
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from tests.fuzz.case import LIMIT, Case

ROOT = Path(__file__).resolve().parents[2]
HUNG = -2
"""The code of a run that was ended for its length."""


@dataclass(frozen=True)
class Run:
    """What a run left: exit code (-1 a traceback within a worker, `HUNG`), stdout, stderr, seconds; for one that was interrupted
    the seconds from the last signal to its end, None where it had ended before."""

    code: int
    out: str
    err: str
    seconds: float
    after_signal: float | None = None


def limit() -> float:
    """`LIMIT`, longer by as much as others keep the machine busy."""
    return LIMIT * crowd()


def crowd() -> float:
    """Programs that wait for each processor core, at least 1."""
    return max(1.0, os.getloadavg()[0] / (os.cpu_count() or 1))


class Worker:
    """A warm process, begun when first needed and anew after a hang."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[str] | None = None

    def __call__(self, case: Case, folder: Path) -> Run:
        process = self._alive()
        assert process.stdin is not None
        assert process.stdout is not None
        begun = time.monotonic()
        process.stdin.write(json.dumps({"words": case.words, "folder": str(folder)}) + "\n")
        process.stdin.flush()
        ready = select.select([process.stdout], [], [], limit())[0]
        line = process.stdout.readline() if ready else ""
        if not line:
            code = HUNG if not ready else process.wait()
            self.close()
            return Run(code, "", "" if code == HUNG else f"the process ended with {code}", time.monotonic() - begun)
        return Run(*json.loads(line))

    def _alive(self) -> subprocess.Popen[str]:
        if self._process is None:
            self._process = subprocess.Popen(
                [sys.executable, "-m", "tests.fuzz.worker"], cwd=ROOT, env=environment(), stdin=subprocess.PIPE,
                    stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL, text=True,
            )  # fmt: skip
        return self._process

    def close(self) -> None:
        """End the process."""
        if self._process is not None:
            self._process.kill()
            self._process.wait()
        self._process = None


def environment(**changes: str | None) -> dict[str, str]:
    """The environment with changes; None removes a name."""
    merged: dict[str, str | None] = {**os.environ, "PYTHONPATH": str(ROOT), **changes}
    return {name: value for name, value in merged.items() if value is not None}


def alone(case: Case, folder: Path) -> Run:
    """Run a case in a process of its own, or in two at once."""
    running = [_begin(case, folder) for _ in range(2 if case.twice else 1)]
    runs = [_ended(case, each) for each in running]
    # Of two, the one that went worse: a code other than 0, 1 and 2 before a refusal before an answer.
    return max(runs, key=lambda each: (each.code not in (0, 1, 2), each.code != 0))


@dataclass
class _Process:
    """A process, its stdout and stderr as files, and when it began."""

    process: subprocess.Popen[bytes]
    out: Path
    err: Path
    begun: float


def _begin(case: Case, folder: Path) -> _Process:
    scratch = Path(tempfile.mkdtemp(prefix="fuzz-"))
    out, err = scratch / "out", scratch / "err"
    words = [*case.before, sys.executable, "-m", "jaxbacklash.cli", *case.words]
    with open(case.stdout or out, "wb") as stdout, err.open("wb") as stderr:
        process = subprocess.Popen(
            words, cwd=folder, env=environment(**case.env), stdin=subprocess.DEVNULL, stdout=stdout, stderr=stderr,
            start_new_session=True, preexec_fn=_heeding_interrupts,
        )  # fmt: skip
    return _Process(process, out, err, time.monotonic())


def _heeding_interrupts() -> None:
    """A run in the background ignores interrupts, and so would all that it starts."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def _ended(case: Case, running: _Process) -> Run:
    process, after, code = running.process, None, HUNG
    try:
        for moment in case.interrupts:
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(max(0.0, running.begun + moment - time.monotonic()))
                break
            process.send_signal(signal.SIGINT)
            after = time.monotonic()
        code = process.wait(limit())
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
    ended = time.monotonic()
    texts = [path.read_text(errors="replace") if path.exists() else "" for path in (running.out, running.err)]
    for path in (running.out, running.err):
        path.unlink(missing_ok=True)
    running.out.parent.rmdir()
    return Run(code, *texts, ended - running.begun, None if after is None else ended - after)
