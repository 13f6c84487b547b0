"""What is said of a word of the command line that the parser refuses: which one, what was wanted, and an example."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from typing import Any


def refused(error: Any, words: Sequence[str] | None = None) -> str:
    """The sentence for an error of the parser.

    Parameters
    ----------
    error : an exception with ``format_message()``, and ``param`` and ``ctx`` where one parameter or one command is to blame
    words : what was typed; by default the words of this process

    Returns
    -------
    str
        For a number that is none and for what is missing in words of our own; else in the parser's.
    """
    said = " ".join(error.format_message().split())
    param, kind = getattr(error, "param", None), type(error).__name__
    if param is None:
        return said
    typed = max(param.opts, key=len) if param.opts and param.opts[0].startswith("-") else str(param.name).upper()
    if kind == "MissingParameter":
        command = getattr(getattr(error, "ctx", None), "command", None)
        what, example = getattr(param, "help", "") or "", getattr(command, "epilog", "") or ""
        return ". ".join(part for part in (f"{typed} is missing{': ' * bool(what)}{what}", example) if part)
    # The versions of the parser say it differently: "not a valid float", "should be a valid number".
    wanted = "a whole number" if "valid int" in said else "a number" if "valid number" in said or "valid float" in said else ""
    if not wanted:
        return said
    found = _value(param.opts, sys.argv[1:] if words is None else words)
    comma = ", with a point and not a comma" if "," in found else ""
    return f"{typed}{' ' * bool(found)}{found[:40]}: wanted {wanted}{comma}"


def _value(names: Sequence[str], words: Sequence[str]) -> str:
    """What stands behind the last of an option's names, or behind its equals sign; empty where that is not found."""
    found = ""
    for number, word in enumerate(words):
        name, equals, value = word.partition("=")
        if name in names:
            found = value if equals else words[number + 1] if number + 1 < len(words) else ""
    return found
