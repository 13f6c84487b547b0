"""Parameters moved by hand: a slider for each, and the model that moves against the record."""

from __future__ import annotations

import threading
from typing import Any

import panel as pn
import panel_material_ui as pmui

from ..figures import Figure, drawn
from ..moving import moved, ranges, shown_part
from ..worker import sentence
from ..zoomable import zoomable
from .part import WIDE, Desk, Part, button, escaped, row, text


class ValuesPart(Part):
    """Sliders, and the stretch of the record that the model misses most."""

    title = "Move parameters"

    def __init__(self, desk: Desk) -> None:
        super().__init__(desk)
        self.told = text()
        self.sliders: dict[str, Any] = {}
        self.place = pn.FlexBox(gap="24px", **WIDE)
        self.drawing = zoomable(stays=True, visible=False)
        self.back = button("Back to the fitted values", self._back, variant="outlined")
        self.content = pn.Column(
            text("<h2>Move a parameter, and see the model move against the record</h2>"), self.place, row(self.back), self.told,
            self.drawing, **WIDE,
        )  # fmt: skip
        self._of: Any = None
        self._still = False
        self._lock = threading.Lock()
        self._wanted: Any = None
        self._drawn: Any = None
        self._at_work = False

    def refresh(self) -> None:
        model = self.model
        if model is None:
            self.told.object = "<p>No model has been fitted yet.</p>"
            self.drawing.visible = self.back.visible = False
            self.place.objects, self._of = [], None
            return
        if self._of is None or self._of.fit is not model.fit:
            self._of = model
            self._slide(model)
        with self._lock:
            drawn_now, self._drawn = self._drawn, None
        if drawn_now is not None:
            self._show(*drawn_now)

    def _slide(self, model: Any) -> None:
        self.sliders = {}
        for one in ranges(model):
            slider: Any = pmui.FloatSlider(
                label=f"{one.name} [{one.unit}]",
                start=one.low,
                end=one.high,
                step=one.step,
                value=one.value,
                format="0.[00000]",
                width=280,
            )
            slider.param.watch(lambda _: self._ask(), "value")
            self.sliders[one.name] = slider
        self.place.objects = list(self.sliders.values())
        self.back.visible = True
        self.told.object = "<p>The model is being computed with these values.</p>"
        self._ask()

    def _back(self) -> None:
        if self._of is not None:
            self._still = True
            for one in ranges(self._of):
                self.sliders[one.name].value = one.value
            self._still = False
            self._ask()

    def _ask(self) -> None:
        """Draw the model with the values as they are now; of those asked for while one is drawn, only the last."""
        if self._still or self._of is None:
            return
        with self._lock:
            self._wanted = self._of, {name: float(slider.value) for name, slider in self.sliders.items()}
            if self._at_work:
                return
            self._at_work = True
        threading.Thread(target=self._work, daemon=True).start()

    def _work(self) -> None:
        while True:
            with self._lock:
                wanted, self._wanted = self._wanted, None
                if wanted is None:
                    self._at_work = False
                    return
            model, changes = wanted
            part = shown_part(model)
            try:
                found = moved(model, changes, part)
                figure = drawn("fit", found, between=part)
                said = f"error over the noise in these {part[1] - part[0]:.3g} s: {found.score.rms:.4g}"
            except Exception as why:  # values may be chosen for which no motion is finite
                figure, said = Figure("", "", ""), sentence(why)
            with self._lock:
                self._drawn = figure, said
            self.session.touch()

    def _show(self, figure: Figure, said: str) -> None:
        self.told.object = f"<p>{escaped(said)}</p>"
        self.drawing.put(figure)
        self.drawing.visible = bool(figure.svg)
