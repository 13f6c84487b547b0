"""Benchmarks on the site: run one and keep what it says, ``python -m website.benchmarks NAME [--tiny]``; the page of them all."""

from __future__ import annotations

import ast
import json
import os
import re
import subprocess
import sys
import time
from datetime import date
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
KEPT = Path(__file__).with_name("measured.json")
HEAD = """# Benchmarks

Every figure that the package claims is made by a script: `python -m benchmarks.NAME`, from a clone, after `pip install
".[dev]"`; `--tiny` is a quick try of the same. Below is what some of them printed, with the commit, the processor and how
busy the machine was; speeds on another machine differ. `python -m website.benchmarks NAME` runs one and puts what it says
here.
"""


def main(words: list[str]) -> int:
    """Run one benchmark and keep its output beside commit and processor."""
    name, begun, load = words[0], time.monotonic(), os.getloadavg()[0]
    done = subprocess.run([sys.executable, "-m", f"benchmarks.{name}", *words[1:]], cwd=ROOT, capture_output=True, text=True)
    print(done.stdout, done.stderr, sep="\n")
    if done.returncode == 0:
        kept = json.loads(KEPT.read_text(encoding="utf-8")) if KEPT.exists() else {}
        kept[name] = {
            "command": " ".join(["python -m", f"benchmarks.{name}", *words[1:]]), "commit": commit(), "processor": processor(),
            "cores": os.cpu_count(), "load": round(load, 1), "date": date.today().isoformat(),
            "seconds": round(time.monotonic() - begun), "said": done.stdout.rstrip().splitlines(),
        }  # fmt: skip
        KEPT.write_text(json.dumps(dict(sorted(kept.items())), indent=1) + "\n", encoding="utf-8")
    return done.returncode


def commit() -> str:
    """The commit of the clone, short."""
    return subprocess.run(
        ["git", "rev-parse", "--short", "HEAD"], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout.strip()


def processor() -> str:
    """What the system calls the processor."""
    told = re.search(r"model name\s*:\s*(.*)", Path("/proc/cpuinfo").read_text()) if Path("/proc/cpuinfo").exists() else None
    return told.group(1) if told else "unknown"


def page() -> str:
    """The page as Markdown: what each script asks, and what those said that were run for it."""
    kept = json.loads(KEPT.read_text(encoding="utf-8")) if KEPT.exists() else {}
    parts = [HEAD, "## What was measured\n", *(section(name, run) for name, run in sorted(kept.items()))]
    rows = [f"| `{name}` | {question.replace('|', chr(92) + '|')} |" for name, question in scripts().items()]
    return "\n".join([*parts, "## Every script\n", "| `python -m benchmarks.` | what it asks |", "|---|---|", *rows]) + "\n"


def section(name: str, run: dict[str, Any]) -> str:
    """What one script said."""
    where = f"Commit {run['commit']}, {run['processor']}, {run['cores']} cores, load {run['load']} before it began"
    where += f", {run['date']}, {run['seconds']} s"
    return f"### {name}\n\n{scripts()[name]}\n\n`{run['command']}`. {where}.\n\n```text\n" + "\n".join(run["said"]) + "\n```\n"


def scripts() -> dict[str, str]:
    """The first sentence of every script that can be run, by name."""
    found = {}
    folder = ROOT / "benchmarks"
    for path in sorted([*folder.glob("*.py"), *folder.glob("*/__main__.py")]):
        text = path.read_text(encoding="utf-8")
        if "__main__" in text:
            name = path.parent.name if path.stem == "__main__" else path.stem
            found[name] = (ast.get_docstring(ast.parse(text)) or "").splitlines()[0]
    return found


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
