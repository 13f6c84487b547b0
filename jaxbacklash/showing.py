"""How results show themselves: printed, as a table where a terminal has `rich`, as a table with its picture in a notebook.

A result stands below the files that draw it, so it does not name them: the package's own `__init__.py` says which module shows
results, and that module is loaded when one is shown.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

_place: dict[str, str] = {}


def shown_by(module: str) -> None:
    """Say which module shows results: it has ``html(result)`` and ``table(result)``."""
    _place["module"] = module


def html_of(result: Any) -> str:
    """A result as HTML with its picture, for a notebook."""
    return str(import_module(_place["module"]).html(result))


def table_of(result: Any) -> Any:
    """A result as something that `rich` can print."""
    return import_module(_place["module"]).table(result)


def print_of(result: Any, printer: Any, cycle: bool) -> None:
    """A result as IPython shows it in a terminal: as it prints."""
    printer.text("..." if cycle else str(result))


class Shown:
    """A result that shows itself."""

    _repr_html_ = html_of
    __rich__ = table_of
    _repr_pretty_ = print_of
