"""What the tests of hostile input share: a small model and records on disk, and the command as a process of its own."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
MODEL = "[model]\ninertia = 2.0\nbacklash = 0.02\nstiffness = 2000.0\ndamping = 4.0\n"


def jaxbacklash(*words, cwd, **environment) -> subprocess.Popen:
    """The command as a process whose output is caught; environment variables by name, None takes one away."""
    known = {**os.environ, "PYTHONPATH": str(ROOT), **environment}
    return subprocess.Popen(
        [sys.executable, "-m", "jaxbacklash.cli", *map(str, words)], cwd=cwd, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        env={name: value for name, value in known.items() if value is not None},
    )  # fmt: skip


def ended(*words, cwd, timeout=120.0, **environment) -> tuple[int, str, str]:
    """The same, waited for: exit code, stdout, stderr."""
    run = jaxbacklash(*words, cwd=cwd, **environment)
    out, err = run.communicate(timeout=timeout)
    return run.returncode, out.decode("utf-8", "replace"), err.decode("utf-8", "replace")


def write_record_csv(path: Path, seed: int = 0, seconds: float = 4.0, rate: float = 250.0) -> Path:
    """A base-motion record of no physics at all, good enough to be read."""
    rng = np.random.default_rng(seed)
    t = np.arange(round(seconds * rate)) / rate
    x = 0.05 * np.sin(2 * np.pi * 3.1 * t) + 3e-5 * rng.standard_normal(t.size)
    z = 0.01 * np.sin(2 * np.pi * 3.1 * t + 1.0) + 0.003 * np.sin(40.0 * t) + 3e-5 * rng.standard_normal(t.size)
    rows = "".join(f"{a:.6f},{b:.9f},{c:.9f}\n" for a, b, c in zip(t, x, z))
    path.write_text("t,x,z\n" + rows)
    return path


def one_sentence(err: str) -> str:
    """The one line on stderr that is no warning."""
    lines = [line for line in err.splitlines() if not line.startswith("warning:")]
    assert len(lines) == 1, err
    assert "Traceback" not in err
    return lines[0]
