"""Two branches side by side: errors, parameters, windows, and the pictures of both."""

from __future__ import annotations

from typing import Any

import panel as pn

from ..comparing import compared
from ..select import select
from .part import WIDE, Desk, Figures, Part, row, table, text


class ComparePart(Part):
    """Choose two models, see both."""

    title = "Compare"

    def __init__(self, desk: Desk) -> None:
        super().__init__(desk)
        self.first: Any = select("First model", width=330)
        self.second: Any = select("Second model", width=330)
        for widget in (self.first, self.second):
            widget.param.watch(lambda _: self._show(), "value")
        self.told = text()
        self.pictures = Figures(desk, 3)
        self.content = pn.Column(
            text("<h2>Compare two models</h2>"), row(self.first, self.second), self.told, self.pictures.content, **WIDE
        )
        self._of: Any = None

    def refresh(self) -> None:
        tree = self.session.tree
        if self._of is None or self._of[0] is not tree or self._of[1] != len(tree):
            self._of = tree, len(tree)
            options = {f"{model.number}: {model.name}": str(model.number) for model in tree}
            for widget, number in ((self.first, 0), (self.second, len(tree) - 1)):
                widget.offer(options, str(number))
        self._show()

    def _show(self) -> None:
        tree = self.session.tree
        chosen = [int(widget.value or "0") for widget in (self.first, self.second)]
        if len(tree) < 2 or max(chosen) >= len(tree):
            self.told.object = "<p>Two models have to be fitted first.</p>"
            self.pictures.show([])
            return
        one, two = (tree[number] for number in chosen)
        rows = [(row.what, row.first, row.second) for row in compared(one, two)]
        self.told.object = table("The two models", ["what", one.name, two.name], rows)
        shown = [("stages", one.fit, two.fit), ("residuals", one.fit), ("residuals", two.fit)]
        self.pictures.show(shown, ["", one.name, two.name])
