"""Making a Figure without touching anyone's matplotlib settings, and turning it into text for a page.

Figures are built from `matplotlib.figure.Figure` alone. On paper they are dark on white; inside an SVG everything drawn
in `style.INK` takes the colour of the surrounding text and the background is clear, so that one drawing serves light
and dark pages.
"""

from __future__ import annotations

import base64
import io
import math
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from typing import Any, TypeVar

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from .style import INK, WIDTH

Draw = TypeVar("Draw", bound=Callable[..., Figure])

INKED = ("text", "axes.edge", "axes.label", "axes.title", "xtick", "ytick", "grid")
SETTINGS: Any = {
    "font.family": ["DejaVu Sans"],
    "font.size": 9.0,
    "axes.titlesize": 9.0,
    "axes.titlelocation": "left",
    "axes.labelsize": 9.0,
    "xtick.labelsize": 8.0,
    "ytick.labelsize": 8.0,
    "legend.fontsize": 8.0,
    "legend.frameon": False,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.axisbelow": True,
    "axes.grid": True,
    "grid.alpha": 0.12,
    "grid.linewidth": 0.6,
    "axes.linewidth": 0.7,
    "axes.formatter.limits": (-4, 5),
    "lines.linewidth": 1.1,
    "svg.fonttype": "none",
    "svg.hashsalt": "jaxbacklash",
    "path.simplify": True,
    "path.simplify_threshold": 0.2,
    "agg.path.chunksize": 20000,
    "text.parse_math": False,  # a name with dollar signs is a name
    **{name + ("color" if name.count(".") else ".color"): INK for name in INKED},
}
RASTER_DPI = 170


@contextmanager
def styled() -> Iterator[None]:
    """The look of all figures, for as long as one is built or written."""
    with matplotlib.rc_context(SETTINGS):
        yield


def drawn_in_style(draw: Draw) -> Draw:
    """Decorate a function that returns a Figure so that it draws in this look."""

    @wraps(draw)
    def inside(*args: Any, **keywords: Any) -> Figure:
        with styled():
            return draw(*args, **keywords)

    return inside  # type: ignore[return-value]


def new_figure(height: float, margins: tuple[float, float, float, float] | None = None) -> Figure:
    """An empty figure as wide as a page, ``height`` inches tall.

    ``margins`` left, right, below and above, in inches, for axes whose labels have a known room: finding it takes as long as
    drawing.
    """
    if margins is None:
        return Figure(figsize=(WIDTH, height), layout="constrained", facecolor="white")
    figure = Figure(figsize=(WIDTH, height), facecolor="white")
    left, right, below, above = margins
    figure.subplots_adjust(left / WIDTH, below / height, 1.0 - right / WIDTH, 1.0 - above / height)
    return figure


def empty_figure(sentence: str) -> Figure:
    """What stands in for a picture of nothing."""
    figure = new_figure(1.2)
    figure.text(0.5, 0.5, sentence, ha="center", va="center", color=INK)
    return figure


def column(values: Any) -> np.ndarray:
    """Any sequence as a flat array of floats; None gives an empty one."""
    return np.zeros(0) if values is None else np.asarray(values, dtype=float).ravel()


def in_degrees(ax: Axes, side: str, unit: str) -> None:
    """A second scale in degrees on an axis that is in radians; nothing for any other unit."""
    if unit != "rad":
        return
    add = ax.secondary_xaxis if side in ("top", "bottom") else ax.secondary_yaxis
    scale = add(side, functions=(np.degrees, np.radians))  # type: ignore[arg-type]
    (scale.set_xlabel if side in ("top", "bottom") else scale.set_ylabel)("deg", fontsize=8.0)
    scale.spines[:].set_visible(False)
    scale.tick_params(labelsize=7.0, length=2.0)


def readable_log(ax: Axes, axis: str, low: float, high: float) -> None:
    """A logarithmic axis with plain numbers at 1, 2, 5 of each decade, or at decades alone when it is long."""
    steps = (1, 2, 5) if high / low < 200.0 else (1,)
    powers = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    ticks = [step * 10.0**power for power in powers for step in steps]
    ticks = [tick for tick in ticks if low <= tick <= high]
    if axis == "y":
        ax.set(yscale="log", ylim=(low, high))
        ax.set_yticks(ticks, [f"{tick:g}" for tick in ticks])
    else:
        ax.set(xscale="log", xlim=(low, high))
        ax.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    (ax.yaxis if axis == "y" else ax.xaxis).set_minor_formatter(NullFormatter())


def lay_out(figure: Figure) -> None:
    """Put everything in its place, once: matplotlib would otherwise draw the whole figure for it each time one is written."""
    engine = figure.get_layout_engine()
    if engine is not None:
        if figure.axes:
            engine.execute(figure)
        figure.set_layout_engine(None)  # "none" would leave a stand-in, and the drawing for it


def to_svg(figure: Figure) -> str:
    """A figure as one ``<svg>`` element: text stays text, ink is ``currentColor``, the background is clear."""
    buffer = io.StringIO()
    nothing = dict.fromkeys(["Date", "Creator", "Format", "Type"])
    with styled():
        lay_out(figure)
        figure.savefig(buffer, format="svg", transparent=True, dpi=RASTER_DPI, metadata=nothing)
    text = buffer.getvalue()
    text = text[text.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>\s*", "", text, flags=re.DOTALL)
    # Thin curves would tear if their pixels were kept square when scaled.
    text = text.replace("image-rendering:crisp-edges;image-rendering:pixelated", "")
    # Wherever matplotlib's own face is missing, the next one must be as wide or labels would run into one another.
    text = text.replace("'DejaVu Sans'", "'DejaVu Sans', Verdana, sans-serif")
    return text.replace(INK, "currentColor").strip()


def to_png_data_uri(figure: Figure, dpi: float = 150.0) -> str:
    """A figure on white as a ``data:`` address, for places that take no SVG."""
    buffer = io.BytesIO()
    with styled():
        lay_out(figure)
        figure.savefig(buffer, format="png", dpi=dpi, facecolor="white", metadata={"Software": "jaxbacklash"})
    return "data:image/png;base64," + base64.b64encode(buffer.getvalue()).decode("ascii")
