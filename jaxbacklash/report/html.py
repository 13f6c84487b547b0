"""One self-contained page: verdict first, then pictures with a sentence each, then the tables."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup, escape

from ..errors import BadInput
from ..plot.style import GAP, HELDOUT, MEASURED, MODEL
from ..whole_file import write_whole
from .series import series_json
from .summary import summarise


@dataclass(frozen=True)
class Panel:
    """One picture on the page.

    Attributes: ``title`` a heading; ``sentence`` what to see in it; ``figure_svg`` from `plot.drawing.to_svg`, or an
    address from `plot.drawing.to_png_data_uri`; ``anchor`` its name in links; ``detail`` more words behind a fold.
    """

    title: str
    sentence: str
    figure_svg: str
    anchor: str
    detail: str | None = None


def render(result: Mapping[str, Any], figures: Sequence[Panel], series: Mapping[str, Any] | None = None) -> str:
    """The page as text.

    Parameters
    ----------
    result : result.json of ``fit``, ``refine`` or ``compare``; whatever is missing or null is left out or says why
    figures : pictures in reading order
    series : ``t``, ``measured``, ``model``, ``residual_over_noise`` (N,) for the zoomable view, and optionally
        ``window_starts``, ``label`` and ``unit`` (see `series.series_json`); None: no such view

    Returns
    -------
    HTML that needs no network; every text of the result is escaped
    """
    taken: set[str] = set()
    panels = []
    for panel in figures:
        anchor = _anchor(panel.anchor or panel.title, taken)
        panels.append({"panel": panel, "anchor": anchor, "picture": _picture(panel, anchor), "closer": False})
    if panels:
        # The zoomable view follows the picture it enlarges, wherever that stands.
        next((entry for entry in panels if entry["anchor"] == "figure-model"), panels[0])["closer"] = True
    colours = {"measured": MEASURED, "model": MODEL, "heldout": HELDOUT, "gap": GAP}
    data = None if series is None else Markup(series_json(series))
    return _template().render(**summarise(result), panels=panels, series=data, colours=colours)


def write_report(
    path: str | os.PathLike[str],
    result: Mapping[str, Any],
    figures: Sequence[Panel],
    series: Mapping[str, Any] | None = None,
) -> Path:
    """Write the page whole or not at all; arguments as in `render`.

    Returns
    -------
    where it was written

    Raises
    ------
    BadInput
        The folder is missing or cannot be written.
    """
    target = Path(path)
    text = render(result, figures, series)
    try:
        write_whole(target, text)
    except OSError as error:
        raise BadInput(f"{target}: the report cannot be written ({error.strerror}), wanted a folder to write into") from None
    return target


@cache
def _template() -> Any:
    environment = Environment(
        loader=PackageLoader("jaxbacklash.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return environment.get_template("report.html.j2")


def _anchor(wanted: str, taken: set[str]) -> str:
    """A name fit for an id that no other panel has."""
    plain = re.sub(r"[^a-z0-9]+", "-", wanted.lower()).strip("-") or "figure"
    name, count = f"figure-{plain}", 2
    while name in taken:
        name, count = f"figure-{plain}-{count}", count + 1
    taken.add(name)
    return name


def _picture(panel: Panel, anchor: str) -> Markup:
    """The drawing as it stands in the page: described in words too, its ids unlike those of any other drawing."""
    words = escape(f"{panel.title}. {panel.sentence}")
    text = panel.figure_svg.strip()
    if text.startswith("data:image/"):
        return Markup('<img class="paper" src="{}" alt="{}">').format(text, words)
    found = re.match(r"<svg\b[^>]*>", text)
    if not found:
        raise ValueError(f"panel {panel.title!r}: figure_svg must be an <svg> element or a data:image address")
    return Markup(own_ids(text, anchor, words))


def own_ids(svg: str, anchor: str, words: str) -> str:
    """An ``<svg>`` element that is described in words, already escaped, whose ids begin with an anchor that no other has."""
    found = re.match(r"<svg\b[^>]*>", svg)
    assert found is not None
    box = re.search(r'viewBox="([^"]*)"', found.group(0))
    # The drawing's own style sheet would hold for everything on the page; what it says is inherited as well.
    look = 'style="stroke-linejoin: round; stroke-linecap: butt"'
    head = f'<svg role="img" aria-label="{words}" {look}' + (f' viewBox="{escape(box.group(1))}">' if box else ">")
    body = svg[found.end() :].replace("xlink:href=", "href=")
    body = re.sub(r"<style\b.*?</style>", "", body, count=1, flags=re.DOTALL)
    body = re.sub(r'\bid="([^"]+)"', rf'id="{anchor}-\1"', body)
    body = re.sub(r'href="#([^"]+)"', rf'href="#{anchor}-\1"', body)
    return head + re.sub(r"url\(#([^)]+)\)", rf"url(#{anchor}-\1)", body)
