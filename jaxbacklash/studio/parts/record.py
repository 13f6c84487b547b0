"""The record: which file, which columns, in which units; what is wrong with it; its first picture."""

from __future__ import annotations

from typing import Any

import panel as pn
import panel_material_ui as pmui

from ..choice import CHANNELS, WORDS, Choice, Opened, units_of
from ..select import select
from .part import WIDE, Desk, Figures, Part, button, escaped, row, same, table, text, worded

NO_FILE, NO_COLUMN, AS_STATED = "choose a file", "none", "as in the file"
PAIR = {"flex": "0 1 460px", "min-width": "0", "max-width": "100%"}
"""A column with its unit: both in one line where there is room, one below the other on a narrow window."""


class RecordPart(Part):
    """Files, columns, and what was measured."""

    title = "Record"

    def __init__(self, desk: Desk) -> None:
        super().__init__(desk)
        self._following = False
        self.file: Any = select("File", [NO_FILE], NO_FILE, width=300)
        self.held: Any = select("Held-out record, only predicted", [NO_COLUMN], NO_COLUMN, width=300)
        self.again: Any = button("Look for files again", self._list, variant="outlined")
        self.file.param.watch(self._open, "value")
        self.held.param.watch(self._open_held, "value")
        self.columns: Any = {name: select(f"{name}: {WORDS[name]}", {NO_COLUMN: ""}, width=260) for name in CHANNELS}
        self.units: Any = {
            name: select(f"unit of {name}", {AS_STATED: "", **{unit: unit for unit in units_of(name)}}, width=150)
            for name in CHANNELS
        }
        self.words: Any = pmui.TextInput(
            label="Further options, as on the command line", placeholder="--unwrap x --from 2", width=360
        )
        self.read: Any = button("Read it so", self._read_so)
        self.mend: Any = button("Mend", self._mend, visible=False)
        self.wrong, self.facts, self.notes = text(), text(), text()
        self.pictures = Figures(desk, 1)
        pairs = [pn.FlexBox(self.columns[name], self.units[name], styles=PAIR) for name in CHANNELS]
        self.how = pn.Column(pn.FlexBox(*pairs, **WIDE), row(self.words, self.read), self.facts, visible=False, **WIDE)
        self.more: Any = pmui.Checkbox(label="Columns, units and other options", value=False)
        self.more.param.watch(lambda event: setattr(self.how, "visible", event.new), "value")
        self.content = pn.Column(
            text("<h2>Which record?</h2>"), row(self.file, self.held, self.again), self.wrong, row(self.mend), self.notes,
            self.more, self.how, self.pictures.content, **WIDE,
        )  # fmt: skip
        self._seen: Any = None
        self._list()

    def _list(self) -> None:
        files = self.desk.do(self.session.folder.files) or []
        chosen, held = self.session.record, self.session.heldout
        self._following = True
        for widget, first, opened in ((self.file, NO_FILE, chosen), (self.held, NO_COLUMN, held)):
            own = [] if opened is None or opened.choice.name in files else [opened.choice.name]
            widget.offer([first, *files, *own], first if opened is None else opened.choice.name)
        self._following = False

    def _open(self, event: Any) -> None:
        if not self._following and event.new not in (NO_FILE, None):
            self.session.say(f"reading {event.new}")
            self.desk.later(self.session.open, Choice(event.new))

    def _open_held(self, event: Any) -> None:
        if self._following or event.new is None:
            return
        choice = None
        if event.new != NO_COLUMN:  # of the same logger most likely: read in the same way
            options = self.session.record.choice.options if self.session.record is not None else None
            choice = Choice(event.new) if options is None else Choice(event.new, options)
        self.desk.later(self.session.open_heldout, choice)

    def _read_so(self) -> None:
        opened = self.session.record
        if opened is None:
            self.session.say("choose a file first", bad=True)
            return
        columns = {name: widget.value for name, widget in self.columns.items()}
        units = {name: widget.value for name, widget in self.units.items()}

        def act() -> None:
            choice = Choice(opened.choice.name, opened.choice.options)
            if columns != self._roles(opened) or any(units.values()):
                choice = choice.with_columns(columns, units)
            self.session.open(choice.with_words(self.words.value or ""))

        self.desk.later(act)

    def _mend(self) -> None:
        opened = self.session.record
        if opened is not None and opened.remedy:
            self.desk.later(lambda: self.session.open(opened.choice.with_words(opened.remedy)))

    @staticmethod
    def _roles(opened: Opened) -> dict[str, str]:
        """Which column each channel is read from, or seems to be."""
        known = dict.fromkeys(CHANNELS, "")
        facts = () if opened.facts is None else opened.facts.columns
        return known | {one.role: f"#{one.number}" for one in facts if one.role in known} | dict(opened.choice.options.columns)

    def refresh(self) -> None:
        opened = self.session.record
        if not same(self._seen, (opened, self.session.heldout)):
            self._seen = opened, self.session.heldout
            self._list()
            self._told(opened)
        good = opened is not None and opened.record is not None
        self.pictures.show([("record", opened.record)] if opened is not None and good else [])

    def _told(self, opened: Opened | None) -> None:
        if opened is None:
            self.wrong.object = f"<p>Records of the folder {escaped(self.session.folder.root)} can be chosen.</p>"
            self.mend.visible, self.facts.object, self.notes.object = False, "", ""
            return
        held = self.session.heldout
        said = [f'<p class="bad" role="alert">{worded(one.wrong)}</p>' for one in (opened, held) if one is not None and one.wrong]
        if opened.record is not None:
            said.insert(0, f"<p>{escaped(_summary(opened))}</p>")
        self.wrong.object = "".join(said)
        self.mend.visible = bool(opened.remedy)
        self.mend.label = f"Read it with {opened.remedy}" if opened.remedy else "Mend"
        self.notes.object = "".join(f"<p>{worded(note)}</p>" for note in opened.notes)
        self.more.value = self.more.value or opened.record is None
        facts = opened.facts
        if facts is None:
            self.facts.object = ""
            return
        options = {NO_COLUMN: ""} | {f"#{one.number} {one.name}": f"#{one.number}" for one in facts.columns}
        roles = self._roles(opened)
        for name, widget in self.columns.items():
            value = roles[name]
            extra = {} if value in options.values() else {value: value}
            widget.offer(options | extra, value)
            self.units[name].value = opened.choice.options.units.get(name, "")
        rows = [
            (
                f"#{one.number} {one.name}", one.role, one.unit or ("not stated" if one.role else ""), _number(one.low),
                _number(one.high), "; ".join(one.findings),
            )
            for one in facts.columns
        ]  # fmt: skip
        self.facts.object = table("Columns of the file", ["column", "read as", "unit", "from", "to", "noted"], rows)


def _summary(opened: Opened) -> str:
    assert opened.record is not None
    return opened.record.summary().replace(opened.record.path, opened.choice.name)


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:.6g}"
