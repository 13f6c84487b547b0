"""Make every table and figure of the source paper that rests on data or simulation again, and set its numbers beside the paper's.

    python -m benchmarks.paper [--out DIR] [--tiny] [--keep]

Each item leaves a picture and a JSON file: what was found beside what the paper prints, a verdict (reproduced, reproduced in
kind, not reproduced) with its reason, where the paper contradicts itself, and the curves of the picture. ``--keep`` writes the
JSON files where the site reads them (website/paper). The paper's own records are not public, so its rig is simulated (`rig`); no
figure is copied, only printed numbers are. It needs numba.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import jaxbacklash as jb

from . import cleaning, drive_levels, envelopes, hammer, oscillator, restoring, sweep
from .draw import page_of
from .item import Item

KEPT = Path(__file__).resolve().parents[2] / "website" / "paper"


def items(tiny: bool) -> Iterator[Item]:
    """All of them, in the order of the work."""
    yield oscillator.table_1(tiny)
    yield from oscillator.figures_2_and_3(tiny)
    yield from sweep.items()
    yield hammer.item()
    yield from envelopes.items()
    yield restoring.item(tiny)
    levels, rows = drive_levels.items(tiny)
    yield from levels
    yield from cleaning.items(rows, drive_levels.SHORT_RATE if tiny else drive_levels.RATE, tiny)


def tell(item: Item) -> None:
    """An item as text."""
    print(f"{item.name}, {item.title}: {item.verdict}")
    for row in item.beside:
        paper, ours = ("-" if one is None else f"{one:g}" if isinstance(one, float) else one for one in (row.paper, row.ours))
        print(f"    {row.what:<72} paper {paper:<16} here {ours} {row.unit}".rstrip())


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=Path("paper-items"), help="folder for pictures and JSON files")
    parser.add_argument("--tiny", action="store_true", help="only see that it works, in a temporary folder")
    parser.add_argument("--keep", action="store_true", help="write the JSON files for the site as well")
    chosen = parser.parse_args()
    jb.start(brief=chosen.tiny)
    begun = time.perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) if chosen.tiny else chosen.out
        out.mkdir(parents=True, exist_ok=True)
        if chosen.keep:
            KEPT.mkdir(exist_ok=True)
        for item in items(chosen.tiny):
            tell(item)
            item.write(out)
            if chosen.keep and not chosen.tiny:
                item.write(KEPT)
            page = page_of(item)
            if page is not None:
                page.savefig(out / f"{item.key}.png", dpi=130)
            print(f"    after {time.perf_counter() - begun:.0f} s", flush=True)
    print(f"all in {time.perf_counter() - begun:.0f} s")


if __name__ == "__main__":
    main()
