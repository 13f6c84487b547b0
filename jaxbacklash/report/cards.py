"""How every result is shown in a notebook and in a terminal: the module that the package names to `jaxbacklash.showing`."""

from __future__ import annotations

from typing import Any

from . import dynamics_cards as dynamics_cards
from . import fit_cards as fit_cards
from . import lost_motion_card as lost_motion_card
from . import many_card as many_card
from .card import as_html, as_rich, card_of


def html(result: Any) -> str:
    """A result as HTML: its card, with its pictures."""
    from .. import plot
    from ..plot.drawing import svg_of

    return as_html(card_of(result), svg_of, plot)


def table(result: Any) -> Any:
    """A result for `rich`: its card without pictures."""
    return as_rich(card_of(result))
