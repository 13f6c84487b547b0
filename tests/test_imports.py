"""No files of the package import each other in a circle, be it at the top, in a function, or for types alone."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[1] / "jaxbacklash"

KNOWN: dict[tuple[str, ...], str] = {}
"""Circles that are left, each as its files in order, and why. One that has gone or changed fails as a new one does."""


def files(package: Path) -> dict[str, Path]:
    """A package's files by the names they are imported under; a folder's ``__init__.py`` has the folder's name."""
    parts = {path: path.relative_to(package.parent).with_suffix("").parts for path in sorted(package.rglob("*.py"))}
    return {".".join(p[:-1] if p[-1] == "__init__" else p): path for path, p in parts.items()}


def imported(name: str, known: dict[str, Path]) -> Iterator[str]:
    """The files that a file names in its import statements, and not a folder's ``__init__.py`` that runs on the way to them."""
    path = known[name]
    folder = name.split(".") if path.name == "__init__.py" else name.split(".")[:-1]
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name in known)
        elif isinstance(node, ast.ImportFrom):
            above = folder[: len(folder) + 1 - node.level] if node.level else []
            source = ".".join([*above, *([node.module] if node.module else [])])
            for alias in node.names:
                inside = f"{source}.{alias.name}"
                # A name in a file, or a file in a folder.
                yield from [inside] if inside in known else [source] if source in known else []


def circles(package: Path) -> set[tuple[str, ...]]:
    """The largest sets of files each of which comes to each other by imports, as their names in the package, in order."""
    known = files(package)
    graph = {name: set(imported(name, known)) - {name} for name in known}

    def reached(start: str) -> set[str]:
        seen: set[str] = set()
        ahead = [start]
        while ahead:
            new = graph[ahead.pop()] - seen
            seen |= new
            ahead += new
        return seen

    reach = {name: reached(name) for name in graph}
    own = len(package.name) + 1
    return {tuple(sorted(other[own:] for other in reach[name] if name in reach[other])) for name in graph if name in reach[name]}


def test_no_files_import_each_other_but_those_that_are_known_to():
    found = circles(PACKAGE)
    assert not found - KNOWN.keys(), "files import each other: move what both need to a file below them"
    assert not KNOWN.keys() - found, "a known circle has gone or changed: take it off the list, or put it right"


ONE_WAY = {
    "__init__.py": "",
    "low/__init__.py": "from .first import a",
    "low/first.py": "import json\nfrom typing import Any\na = 1",
    "low/second.py": "from .first import a",
    "high.py": "from .low import second\nfrom .low import a",
}


@pytest.mark.parametrize(
    ("name", "line", "circle"),
    [
        ("low/first.py", "", None),
        ("low/first.py", "from .second import a", "low.first low.second"),
        ("low/first.py", "from . import second", "low.first low.second"),
        ("low/first.py", "from ..low.second import a", "low.first low.second"),
        ("low/first.py", "from made.low.second import a", "low.first low.second"),
        ("low/first.py", "import made.low.second", "low.first low.second"),
        ("low/first.py", "def f():\n    from .second import a", "low.first low.second"),
        ("low/first.py", "TYPE_CHECKING = False\nif TYPE_CHECKING:\n    from .second import a", "low.first low.second"),
        ("low/first.py", "class A:\n    def f(self):\n        from .. import high", "high low low.first low.second"),
        ("low/second.py", "from . import a", None),
        ("low/first.py", "from . import b", "low low.first"),
        ("low/first.py", "from .first import a", None),
        ("high.py", "from .low.first import a", None),
    ],
)
def test_a_circle_is_found_wherever_its_imports_stand(tmp_path, name, line, circle):
    for path, text in ONE_WAY.items():
        file = tmp_path / "made" / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(f"{text}\n{line}\n" if path == name else f"{text}\n", encoding="utf-8")
    assert circles(tmp_path / "made") == ({tuple(circle.split())} if circle else set())
