"""Which effect is missing: the ranking with its evidence; controls that add one, take one out, or let the search do it."""

from __future__ import annotations

from typing import Any

import panel as pn

from ...plot.style import format_evidence, short
from ...report.fit_cards import of_refinement
from .. import work
from ..select import select
from .part import WIDE, Desk, Figures, Part, button, escaped, row, same, table, text

SHOWN = 12
NONE = "Nothing speaks for any of these effects: the record gives no reason to add one."
HOW = {True: "refitted", False: "predicted"}


class MissingPart(Part):
    """Rank, add, take out, search."""

    title = "What is missing"

    def __init__(self, desk: Desk) -> None:
        super().__init__(desk)
        self.effect: Any = select("Effect to add", width=260)
        self.gone: Any = select("Effect to take out", width=260)
        self.add: Any = button("Add and fit", lambda: desk.do(self.session.add, self.effect.value or ""))
        self.remove: Any = button(
            "Take out and fit", lambda: desk.do(self.session.remove, self.gone.value or ""), variant="outlined"
        )
        self.search: Any = button("Search for all that is missing", lambda: desk.do(self.session.refine), variant="outlined")
        self.take: Any = button("Fit with what the search found", self._take, visible=False)
        self.told, self.found = text(), text()
        self.pictures, self.fallen = Figures(desk, 1), Figures(desk, 1)
        self.content = pn.Column(
            text("<h2>Which effect is missing?</h2>"), row(self.effect, self.add, self.gone, self.remove), self.fallen.content,
            self.pictures.content, self.told, row(self.search), self.found, row(self.take), **WIDE,
        )  # fmt: skip
        self._of: Any = None

    def _take(self) -> None:
        found = self.session.refinement
        if found is not None:
            self.desk.do(self.session.take, tuple(found.effects))

    def refresh(self) -> None:
        model, found = self.model, self.session.refinement
        known = model is not None
        for widget in (self.effect, self.add, self.gone, self.remove):
            widget.disabled = not known
        self.remove.disabled = self.gone.disabled = not (known and model.effects)
        self.search.disabled = self.session.record is None or self.session.record.record is None
        if not same(self._of, (model, found)):
            self._of = model, found
            self._told(model)
            self.found.object = "" if found is None else _found(found)
            self.take.visible = found is not None and bool(found.effects) and known
        path = self.session.tree.path(model.number) if known else []
        self.fallen.show([("stages", *(one.fit for one in path))] if len(path) > 1 else [])
        self.pictures.show([("ranking", model.ranking)] if known and model.ranking is not None and len(model.ranking) else [])

    def _told(self, model: Any) -> None:
        if model is None:
            self.told.object = "<p>No model has been fitted yet.</p>"
            return
        ranked = [] if model.ranking is None else [one.name for one in model.ranking]
        rest = [name for name in work.addable(model.effects) if name not in ranked]
        self.effect.offer([*ranked, *rest], (ranked or rest)[0])
        self.gone.offer(list(model.effects) or ["none"], (model.effects or ("none",))[-1])
        if model.ranking is None:
            waits = "The absent effects are being judged; one can be added already."
            self.told.object = f"<p>{escaped(model.refused or waits)}</p>"
            return
        rows = [
            (one.name, short(one.rms_over_noise), format_evidence(one.evidence), HOW[one.refitted], _values(one))
            for one in list(model.ranking)[:SHOWN]
        ]
        heads = ["effect", "error over the noise with it", "evidence", "how it is known", "its values"]
        none = "" if any(one.evidence > 0.0 for one in model.ranking) else f"<p>{NONE}</p>"
        self.told.object = none + table(f"What one more effect would bring to: {model.name}", heads, rows)


def _found(refinement: Any) -> str:
    """What the search found, as its card tells it: sentences, the stages, the parameters at both ends."""
    card = of_refinement(refinement)
    said = "".join(f"<p>{escaped(sentence)}</p>" for sentence in card.sentences if sentence)
    titles = "Stages of the search", "Parameters"
    return f"<h3>What the search found</h3>{said}" + "".join(
        table(title, one.heads, one.rows) for title, one in zip(titles, card.grids, strict=True)
    )


def _values(entry: Any) -> str:
    return str(entry).partition(": ")[2]
