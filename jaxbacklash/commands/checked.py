"""How a command of the command line is run: what it was given is checked first, and a computing one begins as programs do."""

from __future__ import annotations

from typing import Any

from typer.core import TyperCommand

SUMMARIES = {
    "look": "Say what is in a file, and which command to go on with",
    "fit": "Fit backlash, stiffness, damping, and effects you name",
    "compare": "Predict a record with a model, and say where it fails",
    "diagnose": "Fit, say where the model fails, and rank what is missing",
    "refine": "Find the effects that are missing, and add them",
    "skeleton": "The classical way: play from envelopes and phases",
    "lost-motion": "Read the play of a slow record, in which nothing swings",
    "chaos": "Say whether a measured series is chaotic, and how much",
    "simulate": "Write what a measurement of a model would look like",
    "export": "Write a model for another simulator, MuJoCo or Modelica",
    "map": "Map where a joint is chaotic, over play and damping",
    "studio": "Do all of it at a page in the browser, on this machine",
    "demo": "Find what is hidden in the record that ships with it",
    "check": "Check this installation against known answers",
}
"""What each command is for, in a line that the list of them has room for."""


class Checked(TyperCommand):
    """A command whose numbers and file names are checked, all at once, before any library loads."""

    def get_short_help_str(self, limit: int = 45) -> str:
        """The line of the list of commands; the help of the command itself says more than a line holds."""
        return SUMMARIES.get(self.name or "") or super().get_short_help_str(limit)

    def invoke(self, ctx: Any) -> Any:
        """Check what was given, then run."""
        from .doors import check

        check(self.name or "", ctx.params, {p.name: max(p.opts, key=len) for p in self.params})
        return self.run(ctx)

    def run(self, ctx: Any) -> Any:
        """Run the command."""
        return super().invoke(ctx)


class Computation(Checked):
    """A command that computes."""

    def run(self, ctx: Any) -> Any:
        """Run it as the program computes, its last run's programs on their way."""
        from ..program import cache_folder, start

        start(brief=self.name != "map")  # a map computes for long
        from ..read_ahead import reading_ahead

        with reading_ahead(self.name or "", cache_folder()):
            return super().run(ctx)
