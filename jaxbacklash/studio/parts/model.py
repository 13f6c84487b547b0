"""The model: what a fit begins with, the parameters that were found, and the model beside its record."""

from __future__ import annotations

from typing import Any

import panel as pn
import panel_material_ui as pmui

from ...errors import BadInput
from ...report.summary import verdict_words
from ..comparing import told
from ..figures import of_model
from ..saving import verdict
from ..select import select
from ..work import MODELS, Setup
from .part import WIDE, Desk, Figures, Part, button, escaped, row, table, text


class ModelPart(Part):
    """Fit the base model, and see it beside the record."""

    title = "Model"

    def __init__(self, desk: Desk) -> None:
        super().__init__(desk)
        setup = self.session.setup
        models = {f"{name}: {words}": name for name, words in MODELS.items()}
        self.base: Any = select("Base model", models, setup.model, width=330)
        self.inertia: Any = pmui.TextInput(label="Inertia [kg m²; kg], if known", width=220)
        self.straight: Any = pmui.Checkbox(label="A translating mass: m, kg, N", value=setup.translational)
        self.fit: Any = button("Fit", self._fit)
        self.told = text()
        self.pictures = Figures(desk, 4)
        self.content = pn.Column(
            text("<h2>Compare the model with the record</h2>"), row(self.base, self.inertia, self.straight, self.fit), self.told,
            self.pictures.content, **WIDE,
        )  # fmt: skip
        self._setup: Setup | None = None

    def _fit(self) -> None:
        words = (self.inertia.value_input or self.inertia.value or "").strip().replace(",", ".")

        def act() -> None:
            try:
                inertia = float(words) if words else None
            except ValueError:
                raise BadInput(f"inertia {words[:40]!r}: wanted a number, or nothing") from None
            self.session.choose(Setup(self.base.value, inertia, self.straight.value))
            self.session.begin()

        self.desk.do(act)

    def refresh(self) -> None:
        setup = self.session.setup
        if setup != self._setup:  # chosen here, or at another tab
            self._setup = setup
            self.base.value, self.straight.value = setup.model, setup.translational
            self.inertia.value = "" if setup.inertia is None else f"{setup.inertia:.12g}"
        model = self.model
        if model is None:
            self.told.object = "<p>No model has been fitted yet.</p>"
            self.pictures.show([])
            return
        fit = model.fit
        rows = [(one.label or name, name, told(one), _judged(one, not fit.adequate)) for name, one in fit.parameters.items()]
        self.told.object = f"<h3>{escaped(model.name)}</h3><p>{escaped(verdict(model))}</p>" + table(
            "Parameters", ["what", "name", "value ± standard error", "verdict"], rows
        )
        self.pictures.show(of_model(model))


def _judged(one: Any, doubted: bool) -> str:
    """A parameter's verdict as the report gives it."""
    said = verdict_words({"value": one.value, "verdict": one.verdict, "why": one.why}, doubted)
    return f"{said['mark']} {said['text']}"
