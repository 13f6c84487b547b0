"""The errors a user can cause or meet; the command line turns them into exit codes."""


class BadInput(ValueError):
    """Input that cannot be used: one sentence says where, what was found and what is wanted (exit code 2).

    ``remedy`` is what to add to the command so that it goes on, quoted for a shell; empty where only the user can know. The
    command line shows the whole command with it.
    """

    def __init__(self, sentence: str = "", *, remedy: str = "") -> None:
        super().__init__(sentence)
        self.remedy = remedy


class NoAnswer(RuntimeError):
    """The input was fine but the computation could not reach an answer (exit code 1)."""
