"""Runs the command line from its first word to its exit code: `jaxbacklash.cli` declares the commands and begins here."""

from __future__ import annotations

import atexit
import gc
import sys
from typing import Any

from ..stopping import end_when_told
from .outcome import fill_closed_streams, let_go_of_output, say, tell_plainly, told


def run(app: Any) -> None:
    """Run a typer application on the words of this process and end it; every error is one sentence and an exit code."""
    fill_closed_streams()
    end_when_told()
    tell_plainly()
    for stream in (sys.stdout, sys.stderr):  # names of files may hold what the terminal's letters cannot show
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")
    # Much is loaded, most of it stays, and a command ends soon: looking through all of it for garbage is a fifth of the time.
    gc.set_threshold(100_000, 50, 100)
    atexit.register(gc.freeze)  # nor once more when all of it goes anyway, which took longer than a fit
    # The parser reads the signature of every command that is declared, which takes as long as reading a record.
    every = app.registered_commands
    asked = [one for one in every if (one.name or one.callback.__name__.replace("_", "-")) in sys.argv[1:2]]
    app.registered_commands = asked or every
    try:
        code = app(standalone_mode=False)  # the exit code where the parser ended the command, after --help
        if sys.stdout is not None:  # it was closed before the command began
            sys.stdout.flush()
    except BaseException as error:
        if len(sys.argv) < 2 and hasattr(error, "format_message"):  # without any word the parser answers with the help
            print(error.format_message(), file=sys.stderr)
            sys.exit(2)
        code = say(*told(error))
        if isinstance(error, OSError | SystemExit):
            let_go_of_output()
    finally:
        app.registered_commands = every
    sys.exit(code if isinstance(code, int) else 0)
