"""What is kept of the work: model, report and result in a folder, and the Python that repeats it."""

from __future__ import annotations

from typing import Any

import panel as pn
import panel_material_ui as pmui

from .part import WIDE, Desk, Part, button, escaped, row, same, text


class KeepPart(Part):
    """Save, and see the Python."""

    title = "Save"

    def __init__(self, desk: Desk) -> None:
        super().__init__(desk)
        self.name: Any = pmui.TextInput(label="New folder, beside the records", value="found1", width=260)
        self.save: Any = button("Save model, report and Python", self._save)
        self.told, self.python = text(), text()
        self.content = pn.Column(text("<h2>Keep it</h2>"), row(self.name, self.save), self.told, self.python, **WIDE)
        self._of: Any = None

    def _save(self) -> None:
        name = self.name.value_input or self.name.value or ""

        def act() -> None:
            folder, files = self.session.save(name)
            self.session.say(f"written: {folder}/{', '.join(files)}")

        self.session.say("the model, the report and the Python are being written")
        self.desk.later(act)

    def refresh(self) -> None:
        model = self.model
        self.save.disabled = model is None
        self.told.object = "" if model is not None else "<p>No model has been fitted yet.</p>"
        now = self.session.tree, model, self.session.record, self.session.heldout
        if not same(self._of, now):
            self._of = now
            known = self.session.record is not None and self.session.record.record is not None
            words = self.desk.do(self.session.python) if known else ""
            self.python.object = f"<h3>The Python that repeats it</h3><pre>{escaped(words)}</pre>" if words else ""
