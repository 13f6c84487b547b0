"""The errors a user can cause or meet; the command line turns them into exit codes."""


class BadInput(ValueError):
    """Input that cannot be used: one sentence says where, what was found and what is wanted (exit code 2)."""


class NoAnswer(RuntimeError):
    """The input was fine but the computation could not reach an answer (exit code 1)."""
