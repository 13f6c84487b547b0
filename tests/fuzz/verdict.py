"""Whether a run was right: exit code and one sentence, no traceback, no hang; no file lost, changed or half written."""

from __future__ import annotations

import hashlib
import json
import os
import re
import stat
from dataclasses import dataclass
from pathlib import Path

from tests.fuzz.case import Case
from tests.fuzz.run import HUNG, Run, crowd

Snapshot = dict[str, str]
WITHIN = 2.0
"""Seconds from Ctrl-C to the end of a command, on a machine that does nothing else."""
INTERRUPTED = 130
LIBRARY = re.compile(r"warning: (invalid value|divide by zero|overflow|All-NaN|Mean of empty|Degrees of freedom)[^\n]*")
"""Warnings of NumPy, which tell a user nothing."""
RESULTS = ("result.json", "model.toml", "report.html")


@dataclass(frozen=True)
class Verdict:
    """What is wrong, empty when nothing is."""

    complaints: tuple[str, ...]

    @property
    def failed(self) -> bool:
        """Whether anything is wrong."""
        return bool(self.complaints)


def snapshot(folder: Path) -> Snapshot:
    """A fingerprint of every file, link and folder in a folder, by its path within it."""
    found = {}
    for path in sorted(folder.rglob("*")):
        name = str(path.relative_to(folder))
        if path.is_symlink():
            found[name] = f"link to {os.readlink(path)}"
        elif path.is_dir():
            found[name] = "folder"
        elif stat.S_ISREG(path.stat().st_mode):
            found[name] = hashlib.sha256(path.read_bytes()).hexdigest()
        else:
            found[name] = "special"
    return found


def judge(case: Case, run: Run, before: Snapshot, after: Snapshot, folder: Path) -> Verdict:
    """All that is wrong with a run."""
    complaints = [*_ending(case, run), *_files(case, run, before, after)]
    if case.check is not None and (complaint := case.check(folder)):
        complaints.append(complaint)
    return Verdict(tuple(complaints))


def _ending(case: Case, run: Run) -> list[str]:
    if run.code == HUNG:
        return [f"hang: ended after {run.seconds:.0f} s"]
    if "Traceback" in run.err or run.code == -1:
        return [f"traceback: {(run.err.strip().splitlines() or [''])[-1][:300]}"]
    if "internal error" in run.err:
        return [f"internal error: {run.err.strip()[-300:]}"]
    if run.after_signal is not None:
        return _interrupted(run)
    if run.code == 0:
        return _answer(case, run)
    if run.code not in (1, 2):
        return [f"exit code {run.code}: {run.err[-200:]}"]
    lines = [line for line in run.err.splitlines() if line.strip() and not line.startswith("warning:")]
    complaints = []
    if len(lines) != 1 and case.words and not case.silent:  # without a word it answers with its help
        complaints.append(f"{len(lines)} sentences: {run.err[-300:]!r}")
    if run.out.strip() and run.code == 2:
        complaints.append(f"text on stdout beside a refusal: {run.out[:100]!r}")
    return complaints


def _interrupted(run: Run) -> list[str]:
    """A command that was told to stop: soon, with a sentence, and not as if it had ended."""
    complaints = []
    if run.after_signal is not None and run.after_signal > WITHIN * crowd():
        complaints.append(f"ended {run.after_signal:.1f} s after Ctrl-C")
    lines = [line for line in run.err.splitlines() if not line.startswith("warning:")]
    if run.code == 0 and not run.out.strip():
        complaints.append("Ctrl-C: exit code 0 in silence")
    elif run.code not in (0, 1, 2, INTERRUPTED, -2):
        complaints.append(f"Ctrl-C: exit code {run.code}")
    elif run.code != 0 and len(lines) != 1 and run.seconds > 1.0:
        complaints.append(f"Ctrl-C: {len(lines)} sentences: {run.err[-200:]!r}")
    return complaints


def _answer(case: Case, run: Run) -> list[str]:
    """What is wrong with an answer."""
    complaints = [] if case.accepts or case.words[0] == "look" else ["accepted: exit code 0"]
    if run.out.lstrip().startswith("{"):
        try:
            json.loads(run.out, parse_constant=lambda name: complaints.append(f"{name} in JSON"))
        except ValueError:
            complaints.append("JSON that cannot be read")
    elif found := re.search(r"(?<![\w./-])[-+]?(nan|inf)(?![\w./-])", run.out, re.I):
        complaints.append(f"{found[0]} in the answer: {run.out[max(0, found.start() - 60) : found.end() + 20]!r}")
    if leak := LIBRARY.search(run.err):
        complaints.append(f"a library's warning: {leak[0]}")
    return complaints


def _files(case: Case, run: Run, before: Snapshot, after: Snapshot) -> list[str]:
    complaints = []
    for name, mark in before.items():
        if after.get(name) != mark and not name.startswith(case.lost or ("\0",)):
            complaints.append(f"{name} is {'changed' if name in after else 'gone'}")
    new = {name: mark for name, mark in after.items() if name not in before and not name.startswith("cache/")}
    empty = hashlib.sha256(b"").hexdigest()
    for name, mark in new.items():
        if name.endswith((".part", ".tmp")) or (mark == empty and ".tiles/" not in name):
            complaints.append(f"{name} is half written")
    results = {name for name in new if Path(name).name in RESULTS}
    if run.code != 0 and results and run.after_signal is None and not (case.stdout or case.silent):
        complaints.append(f"results beside a failure: {', '.join(sorted(results))}")
    return complaints
