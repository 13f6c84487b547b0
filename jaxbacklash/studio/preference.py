"""Whether the browser prefers dark pages, which the toolkit does not ask (Panel Material UI 0.16)."""

from __future__ import annotations

import param
from panel.custom import JSComponent

ASK = """
const SOON = 400
export function render({model}) {
  const wish = matchMedia("(prefers-color-scheme: dark)")
  const tell = () => { model.dark = wish.matches }
  wish.addEventListener("change", tell)
  model.on("remove", () => wish.removeEventListener("change", tell))
  setTimeout(tell, SOON)  // what changes while the page is still being put together does not reach Python
}
"""


class Preference(JSComponent):
    """Takes no room on the page; ``dark`` is True where the browser prefers dark pages, and goes with its setting."""

    dark = param.Boolean(default=False)

    _esm = ASK
