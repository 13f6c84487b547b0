"""The page about the paper: every item that ``python -m benchmarks.paper --keep`` left in `website/paper`, with its picture."""

from __future__ import annotations

from pathlib import Path

from benchmarks.paper.draw import page_of
from benchmarks.paper.item import IN_KIND, NOT, REPRODUCED, Item, read
from jaxbacklash.plot.drawing import to_svg
from jaxbacklash.report.html import own_ids

KEPT = Path(__file__).with_name("paper")
HEAD = """# The paper, item by item

The source of this package is T. Tjahjowidodo, F. Al-Bender and H. Van Brussel, *Identification of backlash in mechanical
systems*. Here is each of its tables and figures that rests on data or simulation, made again by `python -m benchmarks.paper`:
the picture, the numbers that the paper prints beside those found here, and a verdict. No figure of the paper is shown; what
stands under *paper* is printed in its text.

- **Reproduced**: what the paper prints comes out.
- **Reproduced in kind**: the same behaviour comes out, where the paper prints no number, or where its own measurement would
  be needed for one.
- **Not reproduced**: it does not come out, and the text says why.

The paper's records are not public. Its rig is therefore simulated, by a program that shares no code with this package, from
what the paper prints; what it does not print was chosen, and is named.
"""
ORDER = ("table_1", "figure_02", "figure_03", *(f"figure_{n:02d}" for n in range(8, 16)), "table_2", "figure_16", "figure_17",
         "figure_18")  # fmt: skip


def items() -> list[Item]:
    """All that were kept, in the paper's order."""
    return [read(KEPT / f"{key}.json") for key in ORDER]


def page() -> str:
    """The page as Markdown, pictures within it so that they take the colours of the page."""
    kept = items()
    parts = [HEAD, "| item | what it shows | verdict |", "|---|---|---|"]
    parts += [f"| [{item.name}](#{item.key.replace('_', '-')}) | {item.title} | {item.verdict} |" for item in kept]
    parts += ["", contradictions(kept), *(section(item) for item in kept)]
    return "\n".join(parts)


def contradictions(kept: list[Item]) -> str:
    """Where the paper disagrees with itself, gathered."""
    rows = [f"- {sentence} ([{item.name}](#{item.key.replace('_', '-')}))" for item in kept for sentence in item.disagrees]
    return "\n".join(["## Where the paper disagrees with itself\n", *rows, ""])


def section(item: Item) -> str:
    """One item: verdict and reason, picture, numbers."""
    mark = {REPRODUCED: "success", IN_KIND: "info", NOT: "warning"}[item.verdict]
    anchor = item.key.replace("_", "-")
    text = [f"## {item.name}: {item.title} {{ #{anchor} }}\n", f'!!! {mark} "{item.verdict.capitalize()}"\n\n    {item.why}\n']
    drawing = page_of(item)
    if drawing is not None:
        svg = own_ids(to_svg(drawing), anchor, f"{item.name}: {item.title}")
        text.append(
            f'<figure class="law paper" tabindex="0" role="group" aria-label="Picture of {item.name}">\n{svg}\n</figure>\n'
        )
    if item.beside:
        text += ["| | paper | here | unit |", "|---|---|---|---|"]
        text += [f"| {row.what} | {cell(row.paper)} | {cell(row.ours)} | {row.unit} |" for row in item.beside]
        text.append("")
    return "\n".join(text)


def cell(value: float | str | None) -> str:
    """What stands in a table: a number with the digits it was kept with, a dash for none."""
    if isinstance(value, str):
        return value.replace("+-", "±").replace("|", "\\|")
    if value is None:
        return "–"
    return f"{value:,.0f}" if abs(value) >= 1000 else f"{value:.4g}"
