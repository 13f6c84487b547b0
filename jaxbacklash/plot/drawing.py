"""Where a picture is drawn: on axes that a user brings, in a figure of its own, or in one that the report turns into text.

A figure of our own has the look of `SETTINGS`, and nobody's matplotlib settings are touched: on a page it is dark on white, and
inside an SVG everything drawn in `style.INK` takes the colour of the surrounding text and the background is clear, so that one
drawing serves light and dark pages. On a user's axes the user's look stays, and lines that only guide the eye take the colour of
the axes' own labels.
"""

from __future__ import annotations

import base64
import io
import math
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, nullcontext
from functools import wraps
from typing import Any, ParamSpec, TypeAlias

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure, FigureBase
from matplotlib.ticker import NullFormatter

from ..errors import BadInput
from .style import INK, WIDTH

P = ParamSpec("P")

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
}
RASTER_DPI = 170


Where: TypeAlias = Axes | FigureBase | Iterable[Any] | None
"""What a plot may be drawn on: axes, as many as the picture has panels, a figure or part of one to lay it out in, or nothing."""
Drawn: TypeAlias = Any
"""The axes that were drawn on: one, or an array of them for a picture of several panels."""


class Page(Figure):
    """A figure as wide as a page, which takes the height and the margins that its picture wants.

    ``look`` are the settings that it is drawn with.
    """

    def __init__(self, *args: Any, look: dict[str, Any] | None = None, **keywords: Any) -> None:
        super().__init__(*args, **keywords)
        self.look = SETTINGS | inked(INK) if look is None else look

    def take(self, height: float, margins: tuple[float, float, float, float] | None = None) -> None:
        """Become ``height`` inches tall.

        ``margins`` left, right, below and above, in inches, are for axes whose labels have a known room: finding it takes as
        long as drawing.
        """
        self.set_size_inches(WIDTH, height)
        if margins is None:
            self.set_layout_engine("constrained")
            return
        left, right, below, above = margins
        self.subplots_adjust(left / WIDTH, below / height, 1.0 - right / WIDTH, 1.0 - above / height)


def inked(colour: Any) -> dict[str, Any]:
    """Settings by which axes and text are drawn in one colour."""
    return {name + ("color" if name.count(".") else ".color"): colour for name in INKED}


@contextmanager
def styled(look: dict[str, Any] | None = None) -> Iterator[None]:
    """A look, by default that of the report's figures, for as long as a figure is built or written."""
    settings: Any = SETTINGS | inked(INK) if look is None else look
    with matplotlib.rc_context(settings):
        yield


def users_look() -> dict[str, Any]:
    """Our look in the user's colours, in which labels may hold formulas."""
    return SETTINGS | {"text.parse_math": True} | inked(matplotlib.rcParams["text.color"])


def picture(draw: Callable[P, list[Axes]]) -> Callable[P, Drawn]:
    """Decorate a function that draws on ``ax`` and returns its axes, so that without ``ax`` it makes a figure of its own.

    That figure is pyplot's, so that a notebook and ``plt.show()`` find it.
    """

    @wraps(draw)
    def inside(*args: P.args, **keywords: P.kwargs) -> Drawn:
        where: Any = keywords.get("ax")
        if where is None:
            from matplotlib import pyplot

            where = pyplot.figure(FigureClass=Page, look=users_look())
        keywords["ax"] = where
        with styled(where.look) if isinstance(where, Page) else nullcontext():
            axes = draw(*args, **keywords)
        return axes[0] if len(axes) == 1 else np.array(axes, dtype=object)

    return inside


def on_page(draw: Callable[..., Drawn], *args: Any, **keywords: Any) -> Page:
    """What a plot draws, as a page's figure, which pyplot does not know of."""
    page = Page(facecolor="white")
    draw(*args, ax=page, **keywords)
    return page


def svg_of(draw: Callable[..., Drawn], *args: Any, **keywords: Any) -> str:
    """What a plot draws, as one ``<svg>`` element."""
    return to_svg(on_page(draw, *args, **keywords))


def panels(
    where: Any, rows: int = 1, columns: int = 1, *, height: float, margins: tuple[float, float, float, float] | None = None,
    mosaic: str = "", **how: Any,
) -> list[Axes]:  # fmt: skip
    """The axes of a picture, row by row.

    Where only one was brought it stands for the first, and the picture's other panels are not drawn.

    Parameters
    ----------
    where : axes, a figure, or part of one
    rows, columns : how many panels
    height, margins : what a `Page` takes
    mosaic : letters in place of rows and columns, where panels differ in size, see `matplotlib.figure.Figure.subplot_mosaic`
    how : further words for the panels: shared axes, ratios

    Raises
    ------
    BadInput
        So many axes were brought as the picture has no panels.
    """
    if isinstance(where, Axes):
        return [where]
    if isinstance(where, FigureBase):
        if isinstance(where, Page):
            where.take(height, margins)
        if mosaic:
            return list(where.subplot_mosaic(mosaic, **how).values())
        return list(where.subplots(rows, columns, squeeze=False, **how).ravel())
    brought = list(np.ravel(np.asarray(where, dtype=object)))
    count = len(set(mosaic) - {";"}) or rows * columns
    if not all(isinstance(ax, Axes) for ax in brought) or len(brought) not in (1, count):
        wanted = "one matplotlib axes" if count == 1 else f"one matplotlib axes, {count} of them"
        raise BadInput(f"ax: found {_what(brought)}, wanted {wanted}, or a figure to lay the picture out in")
    return brought


def _what(brought: list[Any]) -> str:
    other = next((one for one in brought if not isinstance(one, Axes)), None)
    return f"{len(brought)} axes" if other is None else f"a {type(other).__name__}"


def empty(where: Any, sentence: str) -> list[Axes]:
    """What stands in for a picture of nothing."""
    axes = panels(where, height=1.2) if isinstance(where, Axes | FigureBase) else list(np.ravel(np.asarray(where, dtype=object)))
    for ax in axes:
        ax.set_axis_off()
    axes[0].text(0.5, 0.5, sentence, ha="center", va="center", color=ink(axes[0]), transform=axes[0].transAxes)
    return axes


def ink(ax: Axes) -> Any:
    """What an axes writes its labels in, for lines that only guide the eye."""
    return ax.xaxis.label.get_color()


def legend_above(
    axes: Sequence[Axes], handles: Any = None, labels: Any = None, *, columns: int = 3, all_panels: bool = False
) -> None:
    """Names of the marks above the first axes, or above ``all_panels``, where no curve runs through them; inside an axes that the
    user laid out."""
    ax = axes[0]
    if handles is None:
        handles, labels = ax.get_legend_handles_labels()
    if isinstance(ax.figure, Page) and all_panels:
        ax.figure.legend(handles, labels, loc="outside upper right", ncols=columns)
    elif isinstance(ax.figure, Page):
        ax.legend(handles, labels, loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=columns, borderaxespad=0.2)
    else:
        ax.legend(handles, labels, loc="best")


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
