"""What is checked of a command's words before any library loads: its numbers, its file names, and where it would write.

One place for all commands: `check` is handed the parsed words as they are. A name that cannot be a file's, an output that would
replace what the command reads, and a folder that nobody may write to are told at once instead of after a minute of computing.
"""

from __future__ import annotations

import os
import shlex
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from ..errors import BadInput
from .ranges import check_numbers

RESULTS = ("result.json", "model.toml", "model-with-learned-torque.toml", "report.html")
"""What a command writes into its folder ``--out``."""
OF_EACH = ("table.csv", "table.parquet", "rows.jsonl")
"""What it writes beside result.json and report.html with ``--each``."""
ONE_FILE = ("simulate", "map", "export")
"""Commands whose ``--out`` is a file."""
BESIDE = {"map": (".html", ".png")}
"""What a command writes beside that file, by suffix."""
MADE_HERE = {".html": b"by jaxbacklash</title>", ".png": b"Software\0jaxbacklash"}
"""What stands near the beginning of such files where this program made them, by suffix."""
BEGINNING = 4096
"""Bytes of a file in which that is looked for."""
OUT = "out"


def check(command: str, given: Mapping[str, Any], options: Mapping[str, str]) -> None:
    """Refuse numbers out of range, impossible file names, and outputs that cannot be written or are inputs too.

    Parameters
    ----------
    command : the command's name
    given : what was given, by the parameter's name
    options : each parameter's name as it is typed

    Raises
    ------
    BadInput
        One sentence that names the option or file.
    """
    check_numbers(command, given, options)
    for path in _paths(given):
        state_of(path)
    out = given.get(OUT)
    if out is None:
        return
    read = [path for path in _paths(given, but=OUT) if _file(path)]
    beside = [Path(out) / name for name in OF_EACH] if given.get("each") else []
    for target in [*_written(command, Path(out)), *beside]:
        if target.is_dir():
            raise BadInput(f"--out {shlex.quote(str(out))}: {target} is a folder, wanted a place for a file of that name")
        same = next((path for path in read if _file(target) and os.path.samefile(path, target)), None)
        if same is not None:
            raise BadInput(
                f"--out {shlex.quote(str(out))}: would overwrite {target}, which this command reads; wanted another place"
            )
    if command in BESIDE:
        _only_its_own(Path(out))
    _writable(command, Path(out))


def _only_its_own(out: Path) -> None:
    """Refuse to replace a page or picture that this program did not make: only the file itself was named by the user."""
    page, *others = (out.with_suffix(suffix) for suffix in BESIDE["map"])
    if _foreign(page):
        taken = page
    elif not _file(page) and any(map(_foreign, others)):  # a picture beside a page of ours may be of an older version
        taken = next(filter(_foreign, others))
    else:
        return
    found = f"would also overwrite {shlex.quote(str(taken))}, which is no {taken.suffix[1:]} of jaxbacklash"
    raise BadInput(f"--out {shlex.quote(str(out))}: {found}; move that file, or pass another name as --out")


def _foreign(path: Path) -> bool:
    if not _file(path):
        return False
    try:
        with path.open("rb") as file:
            return MADE_HERE[path.suffix] not in file.read(BEGINNING)
    except OSError:
        return True


def state_of(path: Path) -> os.stat_result | None:
    """What the system says of a path, None where there is nothing.

    Raises
    ------
    BadInput
        It cannot be the name of a file, or the system will not tell.
    """
    try:
        return os.stat(path)
    except (FileNotFoundError, NotADirectoryError):
        return None
    except (OSError, ValueError) as why:
        text = str(path)
        short = text if len(text) < 80 else f"{text[:60]}..."
        reason = getattr(why, "strerror", None) or str(why)
        raise BadInput(f"{short!r}: cannot be used as the name of a file ({reason})") from None


def each_file(path: Path) -> list[Path]:
    """What a path stands for where many records are wanted: all files of a folder by their names, else itself.

    A folder that is one recording, as ROS writes them, is itself.
    """
    if not path.is_dir() or (path / "metadata.yaml").exists():
        return [path]
    return sorted(entry for entry in path.iterdir() if entry.is_file() and not entry.name.startswith("."))


def _paths(given: Mapping[str, Any], but: str | None = None) -> Iterator[Path]:
    """Every path among the words; a model and an excitation may be words or the name of a file."""
    for name, value in given.items():
        for one in value if isinstance(value, list | tuple) else [value]:
            if name != but and (isinstance(one, Path) or (name in ("model", "excitation") and isinstance(one, str))):
                yield Path(one)


def _file(path: Path) -> bool:
    return state_of(path) is not None


def _written(command: str, out: Path) -> Iterator[Path]:
    if command in ONE_FILE:
        yield out
        if out.name:
            yield from (out.with_suffix(suffix) for suffix in BESIDE.get(command, ()))
    else:
        yield from (out / name for name in RESULTS)


def _writable(command: str, out: Path) -> None:
    """Refuse a place where this user may not write."""
    folder = out.parent if command in ONE_FILE else out
    while not _file(folder) and folder != folder.parent:
        folder = folder.parent
    if not folder.is_dir():
        raise BadInput(f"--out {shlex.quote(str(out))}: {folder} is a file, wanted a folder to write into")
    if not os.access(folder, os.W_OK | os.X_OK):
        raise BadInput(f"--out {shlex.quote(str(out))}: {folder} cannot be written to, wanted a folder that can")
