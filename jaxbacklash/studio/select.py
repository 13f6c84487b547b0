"""A list of choices with its label, as the browser has it.

Those of the toolkit are lists of menu items (Panel Material UI 0.16), which a screen reader does not take for choices, or have no
label that belongs to them (Bokeh 3.9).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import param
from panel.custom import JSComponent

STYLE = """
:host { max-width: 100%; }
label { display: flex; flex-direction: column; gap: 3px; color: var(--panel-on-background-color, inherit); }
span { font-size: 0.85rem; }
select { font: inherit; padding: 8px; border-radius: 4px; border: 1px solid currentColor; max-width: 100%; width: 100%;
  color: var(--panel-on-background-color, inherit); background: var(--panel-background-color, Canvas); }
select:focus-visible { outline: 3px solid #2b83c6; outline-offset: 1px; }
select:disabled { opacity: 0.6; }
"""


class Select(JSComponent):
    """``choices`` are pairs of what is read and what is meant; ``value`` is what is meant by the one chosen."""

    label = param.String(default="")
    choices = param.List(default=[])
    value = param.String(default="")
    disabled = param.Boolean(default=False)

    _esm = Path(__file__).with_name("select.js")
    _stylesheets = [STYLE]  # noqa: RUF012

    def offer(self, options: Mapping[str, str] | Sequence[str], value: str | None = None) -> None:
        """Offer these, by what is read; ``value`` is chosen, else what was chosen before, else the first."""
        pairs = list(options.items()) if isinstance(options, Mapping) else [(one, one) for one in options]
        meant = [what for _, what in pairs]
        wanted = self.value if value is None else value
        chosen = wanted if wanted in meant else meant[0] if meant else ""
        self.param.update(choices=[list(pair) for pair in pairs], value=chosen)


def select(label: str, options: Mapping[str, str] | Sequence[str] = (), value: str = "", *, width: int = 280) -> Select:
    """A list of choices, so many pixels wide where there is room."""
    one = Select(label=label, value=value, width=width, margin=(6, 10))
    one.offer(options, value)
    return one
