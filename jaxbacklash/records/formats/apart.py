"""Reading in a process of its own, for libraries whose compiled parts end the process on damaged files.

`read_apart` starts `python -m jaxbacklash.records.formats.apart MODULE FILE RESULT`, which reads the file by the module's
`read_here` and writes the table as an archive of arrays; whatever becomes of that process, this one goes on.
"""

from __future__ import annotations

import importlib
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from jaxbacklash.errors import BadInput

from ..checks import wrong
from ..table import Column, Table

MAX_SECONDS = 600.0
"""Longer than any file takes that fits into memory."""


def read_apart(module: str, path: Path, kind: str, wanted: str) -> Table:
    """The table that a module of this package reads from a file.

    Parameters
    ----------
    module : str
        Name of the module; it has `read_here(path) -> Table`.
    path : Path
    kind, wanted : str
        For the sentence where the process ends without an answer.

    Raises
    ------
    BadInput
        As `read_here` does, or where its process came to an end or takes more than `MAX_SECONDS`.
    """
    with tempfile.TemporaryDirectory() as folder:
        result = Path(folder) / "table.npz"
        command = [sys.executable, "-m", __name__, module, str(path), str(result)]
        paths = os.pathsep.join(each or os.getcwd() for each in sys.path)
        try:
            done = subprocess.run(
                command, env={**os.environ, "PYTHONPATH": paths}, capture_output=True, check=False, timeout=MAX_SECONDS
            )
        except subprocess.TimeoutExpired as why:
            raise wrong(str(path), kind, wanted) from why
        if done.returncode or not result.exists():
            raise wrong(str(path), kind, wanted)
        with np.load(result, allow_pickle=False) as arrays:
            told = json.loads(str(arrays["told"]))
            if "refused" in told:
                raise BadInput(told["refused"], remedy=told["remedy"])
            loaded = {name: arrays[name] for name in arrays.files if name != "told"}
    columns = [
        Column(one["name"], loaded[one["values"]], one["unit"], loaded.get(one["clock"]), tuple(one["aliases"]))
        for one in told.pop("columns")
    ]
    told["notes"] = tuple(told["notes"])
    return Table(tuple(columns), **told)


def _main(module: str, path: str, result: str) -> None:
    """What the process does."""
    arrays: dict[str, np.ndarray] = {}
    try:
        table: Table = importlib.import_module(f".{module}", __package__).read_here(Path(path))
    except BadInput as why:
        told: dict = {"refused": str(why), "remedy": why.remedy}
    else:
        names: dict[int, str] = {}
        columns = []
        for column in table.columns:
            for each in (column.values, column.clock):
                if each is not None and id(each) not in names:
                    names[id(each)] = f"array {len(names)}"
                    arrays[names[id(each)]] = each
            clock = "" if column.clock is None else names[id(column.clock)]
            one = {"name": column.name, "unit": column.unit, "aliases": column.aliases}
            columns.append(one | {"values": names[id(column.values)], "clock": clock})
        kept = ("format", "details", "notes", "rate_hz", "left_out")
        told = {name: getattr(table, name) for name in kept} | {"columns": columns}
    np.savez(result, told=np.array(json.dumps(told)), **arrays)  # type: ignore[arg-type]


if __name__ == "__main__":
    _main(*sys.argv[1:])
