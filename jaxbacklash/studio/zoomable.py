"""A drawing on the page that can be looked at closely, by mouse and by keyboard, and that is described in words."""

from __future__ import annotations

import html
from pathlib import Path
from typing import Any

import param
from panel.custom import JSComponent

from ..report.html import own_ids
from .figures import Figure

STYLE = """
figure { margin: 0; color: var(--panel-on-background-color, inherit); }
figure[hidden] { display: none; }
.bar { display: flex; gap: 6px; justify-content: flex-end; }
.bar button { font: inherit; font-size: 0.85rem; min-width: 2rem; padding: 2px 8px; cursor: pointer; border-radius: 4px;
  border: 1px solid currentColor; background: transparent; color: inherit; }
.bar button:focus-visible, .paper:focus-visible { outline: 3px solid #2b83c6; outline-offset: 1px; }
.paper { overflow: auto hidden; touch-action: pan-x pan-y; }
.paper svg { display: block; width: 100%; min-width: 600px; height: auto; }
"""


class Zoomable(JSComponent):
    """One drawing: ``svg`` its text, ``words`` what it is, ``stays`` whether a new one of its size keeps the part looked at."""

    svg = param.String(default="")
    words = param.String(default="")
    stays = param.Boolean(default=False)

    _esm = Path(__file__).with_name("zoomable.js")
    _stylesheets = [STYLE]  # noqa: RUF012

    def put(self, figure: Figure | None) -> None:
        """Show a figure, or nothing."""
        if figure is None or not figure.svg:
            self.svg = ""
            return
        words = f"{figure.title}. {figure.says}"
        self.param.update(words=words, svg=own_ids(figure.svg, "drawing", html.escape(words)))


def zoomable(**how: Any) -> Zoomable:
    """A drawing as wide as its place."""
    return Zoomable(sizing_mode="stretch_width", **how)
