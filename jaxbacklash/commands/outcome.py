"""What the command line says, and ends with, for every way in which a command can end.

0 done; 2 bad input; 1 no answer, or no room to compute or write; 130 and 143 stopped by a signal (`jaxbacklash.stopping`).
"""

from __future__ import annotations

import errno
import os
import shlex
import sys
import traceback
import warnings
from typing import Any

from ..errors import BadInput, NoAnswer

DEBUG = "JAXBACKLASH_DEBUG"
"""Environment variable: set it to see where an unforeseen error comes from."""
LONGEST = 300
"""Characters of an unforeseen error that are shown."""
NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)


def told(error: BaseException) -> tuple[str, int]:
    """The sentence for an error, and the exit code; no sentence where nobody would read it."""
    if isinstance(error, BadInput):
        return f"error: {error}{_next(error.remedy)}", 2
    if isinstance(error, NoAnswer):
        return f"no answer: {error}", 1
    if isinstance(error, KeyboardInterrupt):
        return "stopped", 130
    if isinstance(error, BrokenPipeError) or (isinstance(error, SystemExit) and isinstance(error.__context__, BrokenPipeError)):
        return "", 1  # the parser ends the process by itself where its reader has gone
    if hasattr(error, "format_message"):  # a wrong word on the command line
        from .wrong_words import refused

        return f"error: {refused(error)}", 2
    if os.environ.get(DEBUG):
        traceback.print_exception(error)
    return _unforeseen(error), 1


def _next(remedy: str) -> str:
    """The whole command that goes on, where a refusal proposes one."""
    if not remedy:
        return ""
    from ..records.remedies import with_remedy

    return f" Next: {shlex.join(['jaxbacklash', *with_remedy(sys.argv[1:], remedy)])}"


def _unforeseen(error: BaseException) -> str:
    text = " ".join(str(error).split())
    if isinstance(error, MemoryError) or "RESOURCE_EXHAUSTED" in text:
        return "no answer: there is not enough memory for this; try a shorter record, a lower rate or a smaller map"
    if isinstance(error, OSError) and error.errno in NO_ROOM:
        where = f"{error.filename}: " if error.filename else "the output "
        return f"error: {where}cannot be written ({error.strerror})"
    if isinstance(error, OSError) and error.errno == errno.EMFILE:
        return f"error: too many files are open ({error.strerror}); raise the limit with ulimit -n"
    if isinstance(error, RuntimeError) and "can't start new thread" in text:
        return "no answer: no more threads can be started; raise the limit with ulimit -u"
    if isinstance(error, ArithmeticError) or type(error).__name__ == "LinAlgError":
        return (
            f"no answer: the numbers of this record or model leave the range of double precision ({text[:LONGEST]}); "
            "check units and scales"
        )
    first = text[:LONGEST] + ("..." if len(text) > LONGEST else "")
    return (
        f"internal error: {type(error).__name__}: {first or 'no message'}; please report it with the text that "
        f"{DEBUG}=1 in front of the command shows"
    )


def say(sentence: str, code: int) -> int:
    """One line on stderr; returns the exit code."""
    if sentence and sys.stderr is not None:  # it may have been closed before the command began
        print(" ".join(sentence.splitlines()), file=sys.stderr)  # blanks stay: names of files may hold two
    return code


def let_go_of_output() -> None:
    """Nothing more is written to stdout, whose reader has gone or whose disk is full: Python would complain at its end."""
    nowhere: Any = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)


def tell_plainly() -> None:
    """Warnings are a sentence each, and those that tell a user nothing are not shown."""
    warnings.showwarning = _plain_warning
    warnings.filterwarnings("ignore", category=RuntimeWarning)  # of numpy's steps; what a command tells is finite, or an error
    # A cache that cannot be read or written costs time, nothing else.
    warnings.filterwarnings("ignore", message="Error (reading|writing) persistent compilation cache")


def _plain_warning(message: Any, category: Any, filename: str, lineno: int, file: Any = None, line: Any = None) -> None:
    if sys.stderr is not None:
        print(f"warning: {' '.join(str(message).split())}", file=sys.stderr)


def fill_closed_streams() -> None:
    """Put nothing in the place of streams that were closed before the command began: else the next file opened would stand there,
    and be written to by whatever complains on stderr."""
    for number in (0, 1, 2):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest number that is free
    # Python has made no files of them.
    sys.stdout, sys.stderr = (stream or open(os.devnull, "w") for stream in (sys.stdout, sys.stderr))  # noqa: SIM115
