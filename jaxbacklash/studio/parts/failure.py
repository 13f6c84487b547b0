"""Where the model fails: in sentences, over time, phase and place in the play, and as the torque that is missing."""

from __future__ import annotations

import panel as pn

from ..figures import of_failure
from .part import WIDE, Desk, Figures, Part, button, escaped, row, text


class FailurePart(Part):
    """What `jaxbacklash.where_it_fails` and `find_causes` tell."""

    title = "Where it fails"

    def __init__(self, desk: Desk) -> None:
        super().__init__(desk)
        self.ask = button("Look now", lambda: desk.do(self.session.judge), visible=False)
        self.told = text()
        self.pictures = Figures(desk, 3)
        head = text("<h2>Where does the model fail?</h2>")
        self.content = pn.Column(head, self.told, row(self.ask), self.pictures.content, **WIDE)

    def refresh(self) -> None:
        model = self.model
        if model is None:
            self.told.object = "<p>No model has been fitted yet.</p>"
            self.ask.visible = False
            self.pictures.show([])
            return
        said = [f"<h3>{escaped(model.name)}</h3>"]
        if model.causes:
            said += [f"<p>A cause lies in the record: {escaped(one.sentence)}. {escaped(one.remedy)}</p>" for one in model.causes]
        if model.findings is not None:
            said.append("<ul>" + "".join(f"<li>{escaped(sentence)}</li>" for sentence in model.findings.sentences) + "</ul>")
        elif model.refused:
            said.append(f"<p>{escaped(model.refused)}</p>")
        elif self.session.worker.busy:
            said.append("<p>This is being looked at.</p>")
        self.told.object = "".join(said)
        self.ask.visible = model.findings is None and not self.session.worker.busy
        self.pictures.show(of_failure(model))
