"""Whether the browser prefers dark pages, which the toolkit does not ask (Panel Material UI 0.16)."""

from __future__ import annotations

import panel as pn
import param
from panel.custom import JSComponent

ASK = """
export function render({model}) {
  const wish = matchMedia("(prefers-color-scheme: dark)")
  const tell = () => { if (model.asked) { model.dark = wish.matches } }
  wish.addEventListener("change", tell)
  model.on("asked", tell)
  model.on("remove", () => wish.removeEventListener("change", tell))
  tell()
}
"""


class Preference(JSComponent):
    """Takes no room on the page; ``dark`` is True where the browser prefers dark pages, and goes with its setting.

    The browser is ``asked`` once the page is there: what it tells while that is still being put together does not reach Python.
    """

    dark = param.Boolean(default=False)
    asked = param.Boolean(default=False)

    _esm = ASK

    def ask(self) -> None:
        """Ask when the page is there."""

        def asked() -> None:
            self.param.update(asked=True)

        pn.state.onload(asked)
