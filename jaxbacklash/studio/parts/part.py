"""What the parts of the page share: the session, a way to call it that shows what it refuses, tables, and lists of pictures."""

from __future__ import annotations

import html
import re
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import Any

import panel as pn
import panel_material_ui as pmui

from ...errors import BadInput
from ..figures import Figure, Gallery
from ..session import Session
from ..worker import sentence
from ..zoomable import zoomable

WIDE: dict[str, Any] = {"sizing_mode": "stretch_width"}
STYLE = """
:host { color: var(--panel-on-background-color, inherit); max-width: 100%; }
h1, h2, h3 { margin: 0.4em 0 0.2em; line-height: 1.25; } h2 { font-size: 1.15rem; } h3 { font-size: 1rem; }
p { margin: 0.3em 0; } ul { margin: 0.3em 0; padding-left: 1.2em; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; } caption { text-align: left; font-weight: bold; padding: 0.3em 0; }
th, td { text-align: left; padding: 3px 14px 3px 0; border-bottom: 1px solid rgba(128, 128, 128, 0.4); vertical-align: top; }
td { white-space: pre-line; } td:last-child { min-width: 8em; }
pre { white-space: pre-wrap; overflow-wrap: anywhere; font-size: 0.85rem; }
progress { width: 100%; } code { white-space: nowrap; }
.bad { border-left: 4px solid #c62828; padding-left: 8px; }
"""


class Desk:
    """A session as one tab works with it.

    Attributes: ``session``; ``gallery`` of its pictures; ``aside`` a thread for what takes longer than a moment.
    """

    def __init__(self, session: Session, gallery: Gallery, aside: ThreadPoolExecutor) -> None:
        self.session, self.gallery, self._aside = session, gallery, aside

    def do(self, act: Callable[..., Any], *arguments: Any) -> Any:
        """Call something of the session; what it refuses is shown."""
        try:
            return act(*arguments)
        except BadInput as why:
            self.session.say(str(why), bad=True)
        except Exception as why:  # a page that no longer answers would help nobody
            self.session.say(sentence(why), bad=True)
        return None

    def later(self, act: Callable[..., Any], *arguments: Any) -> None:
        """The same for what takes longer than a moment: reading a file, writing a report."""
        self._aside.submit(self.do, act, *arguments)


class Part:
    """One part of the page: ``title``, ``content`` to be laid out, and `refresh`, called when the session has changed."""

    title = ""
    content: Any

    def __init__(self, desk: Desk) -> None:
        self.desk = desk

    @property
    def session(self) -> Session:
        """The work."""
        return self.desk.session

    @property
    def model(self) -> Any:
        """The model looked at, None where none has been fitted."""
        tree = self.session.tree
        return tree.current if len(tree) else None

    def refresh(self) -> None:
        """Show what is new."""


class Figures:
    """A place for some pictures below each other."""

    def __init__(self, desk: Desk, most: int) -> None:
        self._desk = desk
        self._texts = [text() for _ in range(most)]
        self._drawings = [zoomable(visible=False) for _ in range(most)]
        pairs = zip(self._texts, self._drawings)
        self.content = pn.Column(*(one for pair in pairs for one in pair), **WIDE)

    def show(self, wanted: Sequence[tuple[Any, ...]], names: Sequence[str] = ()) -> None:
        """Show these: of which kind, and of what; each as soon as it is drawn. ``names`` tell those of one kind apart."""
        found = [self._desk.gallery.figure(*one) for one in wanted]
        pairs = zip(found, names or [""] * len(found))
        self.put([one if one is None or not name else replace(one, title=f"{one.title}: {name}") for one, name in pairs])

    def put(self, figures: Sequence[Figure | None]) -> None:
        """Show these pictures, and that others are being drawn (None)."""
        padded: list[Any] = [*figures, *[""] * (len(self._drawings) - len(figures))]
        for place, drawing, figure in zip(self._texts, self._drawings, padded):
            known = isinstance(figure, Figure)
            drawing.put(figure if known else None)
            drawing.visible = bool(known and figure.svg)
            if known:
                why = f"<p>{escaped(figure.why)}</p>" if figure.why else ""
                place.object = f"<h3>{escaped(figure.title)}</h3><p>{escaped(figure.says)}</p>{why}"
            else:
                place.object = "<p>drawing a picture</p>" if figure is None else ""
            place.visible = figure != ""


def same(one: Sequence[object] | None, other: Sequence[object] | None) -> bool:
    """Whether these are the same things in the same order: results hold arrays, so that they cannot be compared."""
    return one is not None and other is not None and len(one) == len(other) and all(a is b for a, b in zip(one, other))


def text(words: str = "", **how: Any) -> Any:
    """A place for text, as HTML."""
    return pn.pane.HTML(words, stylesheets=[STYLE], margin=(2, 8), **{**WIDE, **how})


def escaped(words: object) -> str:
    """Text that may hold anything, for HTML."""
    return html.escape(str(words))


def worded(words: object) -> str:
    """A sentence for HTML; options of a command that it names are not broken at the end of a line."""
    return re.sub(r"(?<![\w-])--[a-z][a-z-]*", r"<code>\g<0></code>", escaped(words))


def table(caption: str, heads: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """A table as HTML; the first cell of a row is its head."""
    head = "".join(f'<th scope="col">{escaped(one)}</th>' for one in heads)
    body = "".join(
        f'<tr><th scope="row">{escaped(first)}</th>{"".join(f"<td>{escaped(cell)}</td>" for cell in rest)}</tr>'
        for first, *rest in rows
    )
    named = escaped(caption)
    return (
        f'<div class="scroll" tabindex="0" role="region" aria-label="{named}"><table><caption>{named}</caption>'
        f"<thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>"
    )


def button(label: str, act: Callable[[], Any], **how: Any) -> Any:
    """A button."""
    one = pmui.Button(label=label, margin=(4, 8), **how)
    one.on_click(lambda _: act())
    return one


def row(*parts: Any) -> Any:
    """Controls beside each other, or below where there is no room."""
    return pn.FlexBox(*parts, align_items="center", gap="4px", **WIDE)
