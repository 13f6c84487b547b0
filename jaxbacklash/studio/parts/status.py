"""What stands beside every part: the models that were tried, undo and redo, how far the work is, and a stop."""

from __future__ import annotations

import time
from typing import Any

import panel as pn
import panel_material_ui as pmui

from ...plot.style import short
from .part import WIDE, Desk, Part, button, escaped, row, same, text, worded

INDENT = "\u2003"
RED = {"&:not(.Mui-disabled)": {"backgroundColor": "#c62828", "color": "#ffffff"}}
"""The toolkit's own red on a dark page is too bright for the white words on it."""


class StatusPart(Part):
    """The tree, and the work in hand."""

    title = "Models"

    def __init__(self, desk: Desk) -> None:
        super().__init__(desk)
        self._following = False
        self.models: Any = pmui.RadioBoxGroup(label="Models tried, error over the noise", options={}, inline=False, **WIDE)
        self.models.param.watch(self._go, "value")
        self.undo: Any = button("Undo", lambda: desk.do(self.session.undo), variant="outlined")
        self.redo: Any = button("Redo", lambda: desk.do(self.session.redo), variant="outlined")
        self.stop: Any = button("Stop", lambda: desk.do(self.session.stop), color="error", sx=RED)
        self.message, self.work = text(), text()
        self.content = pn.Column(self.work, row(self.stop), self.message, self.models, row(self.undo, self.redo), **WIDE)
        self._of: Any = None

    def _go(self, event: Any) -> None:
        if not self._following and event.new is not None:
            self.desk.do(self.session.go, event.new)

    def refresh(self) -> None:
        session, tree, model = self.session, self.session.tree, self.model
        self.undo.disabled, self.redo.disabled = not tree.can_undo, not tree.can_redo
        now = tree, *tree
        if not same(self._of, now):
            self._of = now
            self._following = True
            self.models.options = {_line(one, tree.depth(one.number)): one.number for one in tree}
            self.models.value = None if model is None else model.number
            self.models.visible = model is not None
            self._following = False
        elif model is not None and self.models.value != model.number:  # undone, or chosen at another tab
            self._following = True
            self.models.value = model.number
            self._following = False
        role = "alert" if session.bad else "status"
        style = ' class="bad"' if session.bad else ""
        said = f'<p role="{role}"{style}>{worded(session.message)}</p>' if session.message else ""
        if self.message.object != said:
            self.message.object = said
        self.tick()

    def tick(self) -> None:
        """How far the work is, which changes while nothing else does."""
        job = self.session.worker.now
        self.stop.disabled = not self.session.worker.busy
        if job is None:
            told = "<p>Nothing is being computed.</p>"
        else:
            waiting = self.session.worker.waiting
            more = f", {waiting} more to come" if waiting else ""
            seconds = int(time.monotonic() - job.begun)
            told = (
                f"<p>{escaped(job.title)}: {escaped(job.stage or 'starting')}, {seconds} s{more}</p>"
                f'<progress aria-label="{escaped(job.title)}" max="1" value="{job.share:.3f}"></progress>'
            )
        if self.work.object != told:
            self.work.object = told


def _line(model: Any, depth: int) -> str:
    held = "" if model.heldout_rms is None else f", held out {short(model.heldout_rms)}"
    name = "base model" if model.parent is None else model.name.removeprefix("base model ")
    return f"{INDENT * depth}{model.number}: {name}: {short(model.rms)}{held}"
