"""A result on one card: a title, what to know first, tables of numbers as they are printed, and its pictures.

One card is shown in two ways: by `rich` in a terminal, without pictures, and as HTML in a notebook. Text in HTML takes the
colours of the page around it, so that a card reads on light and on dark ones; no script and no style sheet is needed.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import singledispatch
from html import escape
from itertools import count
from pathlib import PurePosixPath
from typing import Any

from ..errors import BadInput

CELL = "text-align:left;vertical-align:top;padding:0.25em 1.2em 0.25em 0;white-space:pre-line"
LINE = "border-bottom:1px solid rgba(128,128,128,0.35)"


@dataclass(frozen=True)
class Grid:
    """A table of texts: ``heads`` of the columns and ``rows``; a cell may have several lines. ``title`` stands above it."""

    heads: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    title: str = ""


@dataclass(frozen=True)
class Picture:
    """A function of `jaxbacklash.plot` by its name, and what it draws."""

    draw: str
    shown: tuple[Any, ...]


@dataclass(frozen=True)
class Card:
    """``title``; ``sentences``, the first of which says most; tables; pictures."""

    title: str
    sentences: tuple[str, ...]
    grids: tuple[Grid, ...] = ()
    pictures: tuple[Picture, ...] = ()


@singledispatch
def card_of(result: Any) -> Card:
    """The card of a result.

    Raises
    ------
    BadInput
        It is no result of this package.
    """
    raise BadInput(f"a {type(result).__name__} is no result that has a card")


def name_of(path: str, otherwise: str = "a record") -> str:
    """The file's own name, without its folders."""
    return PurePosixPath(path.replace("\\", "/")).name or otherwise


def grid(heads: Sequence[str], rows: Sequence[Sequence[Any]], title: str = "") -> Grid:
    """A table of anything that has a text."""
    return Grid(tuple(heads), tuple(tuple(str(cell) for cell in row) for row in rows), title)


_number = count(1)


def as_html(card: Card, svg_of: Callable[..., str], plots: Any) -> str:
    """A card as HTML; ``svg_of`` draws functions of ``plots``."""
    title = f'<div style="font-weight:600;margin-bottom:0.3em">{escape(card.title)}</div>'
    parts = [title, *(f'<div style="max-width:60em;margin-bottom:0.3em">{escape(said)}</div>' for said in card.sentences)]
    parts += [_table(one) for one in card.grids]
    for one in card.pictures:
        parts.append(_placed(svg_of(getattr(plots, one.draw), *one.shown), one.draw.replace("_", " ")))
    return f'<div class="jaxbacklash">{"".join(parts)}</div>'


def _table(one: Grid) -> str:
    head = "".join(f'<th scope="col" style="{CELL};font-weight:500;opacity:0.75">{escape(name)}</th>' for name in one.heads)
    rows = "".join(
        "<tr>" + "".join(f'<td style="{CELL};{LINE}">{escape(cell)}</td>' for cell in row) + "</tr>" for row in one.rows
    )
    above = f'<caption style="text-align:left;opacity:0.75">{escape(one.title)}</caption>' if one.title else ""
    table = f'<table style="border-collapse:collapse;font-variant-numeric:tabular-nums;margin:0.4em 0">{above}'
    return f"{table}<thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>"


def _placed(svg: str, words: str) -> str:
    """A drawing whose ids no other drawing of the notebook has, as wide as the page lets it be."""
    from .html import own_ids

    drawn = own_ids(svg, f"jaxbacklash-{next(_number)}", words)
    return f'<div style="max-width:62em;margin-top:0.4em">{drawn}</div>'


def as_rich(card: Card) -> Any:
    """A card as `rich` prints it: a heading, sentences, and tables."""
    from rich import box
    from rich.console import Group
    from rich.table import Table
    from rich.text import Text

    parts: list[Any] = [Text(card.title, style="bold"), *(Text(said) for said in card.sentences)]
    for one in card.grids:
        table = Table(box=box.SIMPLE_HEAD, title=one.title or None, title_justify="left", title_style="dim", pad_edge=False)
        for head in one.heads:
            table.add_column(Text(head), overflow="fold")
        for row in one.rows:
            table.add_row(*(Text(cell) for cell in row))
        parts.append(table)
    return Group(*parts)
