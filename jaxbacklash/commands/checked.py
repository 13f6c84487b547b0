"""How a command of the command line is run: what it was given is checked first, and a computing one begins as programs do."""

from __future__ import annotations

from typing import Any

from typer.core import TyperCommand


class Checked(TyperCommand):
    """A command whose numbers and file names are checked, all at once, before any library loads."""

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
