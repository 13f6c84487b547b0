"""The one folder whose files a page may read and write: names in it, and a refusal of everything else."""

from __future__ import annotations

import os
from pathlib import Path

from ..errors import BadInput

MOST_FILES = 500
DEEPEST = 3
"""Levels of folders that are looked through for records; a name may be typed of any depth."""
OURS = frozenset(("result.json", "model.toml", "report.html", "repeat.py"))
"""What a command or the page has written, which is no record."""
TEXT = frozenset((".toml", ".py", ".html", ".md", ".svg", ".png", ".pdf"))


class Folder:
    """A folder, and what may be read and written in it.

    Parameters
    ----------
    root : an existing folder

    Raises
    ------
    BadInput
        There is no such folder.

    Examples
    --------
    >>> from tempfile import mkdtemp
    >>> Folder(mkdtemp()).files()
    []
    """

    def __init__(self, root: str | os.PathLike[str]) -> None:
        self.root = Path(root).resolve()
        if not self.root.is_dir():
            raise BadInput(f"{root}: found no such folder, wanted the folder with the records")

    def files(self) -> list[str]:
        """Names of the files that may be records, in order, at most `MOST_FILES`."""
        found: list[str] = []
        for where, folders, names in os.walk(self.root):
            depth = len(Path(where).relative_to(self.root).parts)
            folders[:] = sorted(name for name in folders if not name.startswith(".")) if depth < DEEPEST else []
            for name in sorted(names):
                path = Path(where) / name
                hidden = name.startswith(".") or name in OURS or path.suffix.lower() in TEXT
                if not hidden and self._inside(path) and path.is_file():
                    found.append(path.relative_to(self.root).as_posix())
            if len(found) >= MOST_FILES:
                break
        return found[:MOST_FILES]

    def path(self, name: str) -> Path:
        """Where a file of the folder lies.

        Raises
        ------
        BadInput
            It lies outside, also by a link, or there is no such file.
        """
        path = self._within(name)
        try:
            there = path.is_file()
        except OSError:
            there = False
        if not there:
            raise BadInput(f"{name[:200]}: found no such file in the folder {self.root}")
        return path

    def new(self, name: str) -> Path:
        """Where a new folder for results will lie.

        Raises
        ------
        BadInput
            The name is empty or lies outside, or something is there already.
        """
        if not name.strip() or name.strip() in (".", ".."):
            raise BadInput("a folder to save into: wanted a name, such as found1")
        path = self._within(name.strip())
        if path.exists() and not (path.is_dir() and not any(path.iterdir())):
            raise BadInput(f"{name.strip()}: is there already and is not empty; wanted another name")
        return path

    def _within(self, name: str) -> Path:
        try:
            path = self.root / name
            if "\0" not in name and self._inside(path):
                return path
        except (OSError, ValueError, RuntimeError):
            pass
        raise BadInput(f"{name[:200]!r}: lies outside the folder {self.root}; start the page for the folder in which it lies")

    def _inside(self, path: Path) -> bool:
        return path.resolve().is_relative_to(self.root)
