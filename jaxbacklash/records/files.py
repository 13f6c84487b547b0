"""From a path to a table: which reader a file needs, and what no reader can do anything with."""

from __future__ import annotations

import stat
from pathlib import Path

from .checks import wrong
from .formats import reader_for
from .options import ReadOptions
from .table import Table
from .text import read_text


def read_table(path: Path, options: ReadOptions | None = None) -> Table:
    """The columns of a file of any known format.

    Parameters
    ----------
    path : Path
    options : ReadOptions, optional
        `skip` concerns text tables only, `decimal` sheets of a workbook too.

    Raises
    ------
    BadInput
        When there is no such file, it cannot be read, or it holds no table.
    """
    options = options or ReadOptions()
    where = str(path)
    try:
        if path.is_dir():
            reader = reader_for(path)
            if reader is None:
                raise wrong(where, "a folder", "a file")
            return reader(path)
        if not path.exists():
            raise wrong(where, "no such file", "a record")
        if not stat.S_ISREG(path.stat().st_mode):
            raise wrong(where, "a device or a pipe", "a file")
        if not path.stat().st_size:
            raise wrong(where, "an empty file", "a record")
        reader = reader_for(path)
        if reader is None:
            return read_text(path, skip=options.skip, decimal=options.decimal)
        return reader(path, decimal=options.decimal)
    except OSError as why:
        raise wrong(where, f"a file that cannot be read ({why.strerror or why})", "one that can") from why
    except MemoryError as why:
        raise wrong(where, "more than fits into memory", "a shorter record, or one with fewer columns") from why
