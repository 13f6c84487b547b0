"""What the commands share: reading records by the user's options, writing results, telling how far the work is."""

from __future__ import annotations

import json
import math
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from importlib import import_module
from pathlib import Path
from threading import Thread
from typing import Any

from ..errors import BadInput, NoAnswer
from ..model_file import load_model
from ..system import System
from ..whole_file import write_whole
from .laws import load_laws as load_laws


def model_of_file(model: str, inertia: float | None) -> System | None:
    """The system of a model file, None for a model by name.

    Raises
    ------
    BadInput
        An inertia is given beside the file, which states its own.
    """
    if not model.endswith(".toml"):
        return None
    if inertia is not None:
        raise BadInput("--inertia: the model file already states the inertia; give one of the two")
    return load_model(model)


def check_window(window: float | None) -> None:
    """Refuse a window length [s] that no score can be quoted for."""
    if window is not None and not 0.02 <= window <= 10.0:
        raise BadInput(f"--window {window:g}: wanted a length between 0.02 and 10 s")


def names(text: str | None) -> list[str]:
    """A comma-separated list of names.

    Raises
    ------
    BadInput
        One is given twice.
    """
    found = [part.strip() for part in (text or "").split(",") if part.strip()]
    for name in found:
        if found.count(name) > 1:
            raise BadInput(f"--effects {name}: given twice, wanted each effect once")
    return found


def out_folder(path: Path | None) -> Path | None:
    """Make the folder for results, and begin to load what draws them: the compiler, which works next, leaves Python free.

    Raises
    ------
    BadInput
        The path is a file, or cannot be made.
    """
    if path is None:
        return None
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise BadInput(f"--out {path}: cannot make this folder ({error.strerror}), wanted a folder to write into") from None
    with suppress(RuntimeError):  # no more threads: it is loaded when it is needed
        Thread(target=import_module, args=("..plot.fits", __package__), daemon=True).start()
    return path


def write_text(path: Path, text: str) -> None:
    """Write a file whole or not at all."""
    try:
        write_whole(path, text)
    except OSError as error:
        raise BadInput(f"--out {path}: cannot be written ({error.strerror})") from None


def json_text(result: dict[str, Any]) -> str:
    """The machine-readable result.

    Raises
    ------
    NoAnswer
        A number in it is not finite.
    """
    try:
        return json.dumps(result, indent=2, allow_nan=False) + "\n"
    except ValueError:
        place = next(_not_finite(result, ""), "one of its numbers")
        raise NoAnswer(f"the result is not finite in {place}; check units and scales of the record and the model") from None


def _not_finite(part: Any, place: str) -> Iterator[str]:
    """Where numbers are not finite, as in ``stages.0.rms``."""
    inside = part.items() if isinstance(part, dict) else enumerate(part) if isinstance(part, list | tuple) else ()
    for name, one in inside:
        yield from _not_finite(one, f"{place}.{name}".lstrip("."))
    if isinstance(part, float) and not math.isfinite(part):
        yield place


class Progress:
    """One line on a terminal that tells the stage and the time, once the work lasts over two seconds."""

    def __init__(self, live: Any) -> None:
        self._live, self._begun = live, time.monotonic()

    def __call__(self, stage: str, share: float) -> None:
        if self._live is not None:
            bar = self._live
            bar.update(bar.task_ids[0], description=stage, completed=share, visible=True)


@contextmanager
def progress(quiet: bool = False) -> Iterator[Progress]:
    """A progress bar on stderr when that is a terminal; nothing otherwise."""
    if quiet or not sys.stderr.isatty():
        yield Progress(None)
        return
    from rich.console import Console
    from rich.progress import BarColumn, TextColumn, TimeElapsedColumn
    from rich.progress import Progress as Bar

    columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
    with Bar(*columns, console=Console(stderr=True), transient=True) as bar:
        bar.add_task("starting", total=1.0)
        yield Progress(bar)
