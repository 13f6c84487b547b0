"""Errors that a user's law raises, in a few words: what kind, and on which line of the user's file.

`laws` runs the file and `law_check` its classes; both say with this where something went wrong.
"""

from __future__ import annotations

from pathlib import Path


def named(error: BaseException) -> str:
    """An error in a few words: its kind and the first line of its text."""
    text = next((line for line in str(error).splitlines() if line.strip()), "")
    return f"{type(error).__name__}: {text[:160]}" if text else type(error).__name__


def line_in(error: BaseException, path: Path) -> str:
    """``, line N`` where the error passed through the file, the innermost such line; nothing where it did not."""
    found, here = "", error.__traceback__
    while here is not None:
        if here.tb_frame.f_code.co_filename == str(path):
            found = f", line {here.tb_lineno}"
        here = here.tb_next
    return found
