"""``jaxbacklash map``."""

from __future__ import annotations

import contextlib
import importlib
import os
import shlex
import sys
import time
import warnings
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np

from .. import __version__
from ..dynamics.family import CASES, PaperCase
from ..dynamics.follow import trace_exact
from ..dynamics.maps import labelled_map
from ..dynamics.netcdf import LARGEST, can_keep_tiles, write_netcdf
from ..dynamics.request import Request, request
from ..dynamics.tile_folder import remove, reserve, used_alone
from ..errors import BadInput
from ..whole_file import write_whole
from .common import json_text, progress
from .ranges import bounded, shown

MOST = 10_000_000
"""Cells at most."""
MOST_PERIODS = 1e10
"""Periods that are followed in all cells together at most: hours on a few cores."""
MOST_KEPT = 1e9
"""Stroboscopic samples in all cells together at most: 8 GB."""
FARTHEST = 1e6
"""Half plays, and half plays over the unit of tau, from which a motion may start."""
DEFAULTS = {"inverse_alpha": "1:5:256", "zeta": "0.005:0.03:64"}


def run(
    case: int, *, inverse_alpha: str | None, zeta: str | None, omega: str | None, periods: int, skip: int, samples: int | None,
    start: str, out: Path, as_json: bool,
) -> None:  # fmt: skip
    """Check, compute tile by tile, beside the output where zarr keeps the tiles, write the map, draw it, and tell."""
    begun = time.perf_counter()
    if case not in CASES:
        raise BadInput(f"--case {case}: wanted 1 or 2")
    if out.suffix.lower() not in (".nc", ".nc4"):
        raise BadInput(f"--out {out}: found the suffix {out.suffix!r}, wanted .nc")
    wanted = read_request(case, {"inverse_alpha": inverse_alpha, "zeta": zeta, "Omega": omega}, periods, skip, samples, start)
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise BadInput(f"--out {out}: cannot make its folder ({error.strerror})") from None
    store = out.with_name(out.name + ".tiles") if can_keep_tiles() else None
    if store is None:
        fits_in_memory(wanted)
    else:
        reserve(store, wanted.fingerprint())
    ready = time.perf_counter()
    start_up = process_age() or ready - begun
    alone = contextlib.nullcontext() if store is None else used_alone(store)
    with alone, progress(as_json) as tell, ThreadPoolExecutor(1) as aside:
        tell("compiling", 0.0)
        compile_beside_imports(wanted, aside, keeps_tiles=store is not None)
        compiled = time.perf_counter()
        map_ = labelled_map(wanted, store=store, progress=tell)
        computed = time.perf_counter()
        drawn = map_.loaded()
        writing = aside.submit(write_netcdf, map_, out)
        result: dict[str, Any] = {
            "schema": 1, "command": "map", "command_line": shlex.join(["jaxbacklash", *sys.argv[1:]]), "version": __version__,
            "case": case, "cells": wanted.cells, "periods": periods,
            "skip": skip, "axes": {name: [values[0], values[-1], len(values)] for name, values in wanted.axes},
            "solver": map_.attrs["solver"], **counts(drawn), "out": str(out),
            "wall_s": {
                "start_up": round(start_up, 3), "compile": round(compiled - ready, 3),
                "run": round(computed - compiled, 3),
            },
        }  # fmt: skip
        tell("drawing", 1.0)
        picture(drawn, result, out)
        writing.result()
        if store is not None and (left := remove(store)):
            warnings.warn(f"{store} stays: it holds {left[0]!r}, which is no part of a store of tiles", stacklevel=2)
    if as_json:
        sys.stdout.write(json_text(result))
    else:
        print("\n".join(words(result)))
        print(f"written: {out}, {out.with_suffix('.html').name}, {out.with_suffix('.png').name}")


def fits_in_memory(wanted: Request) -> None:
    """Refuse a map that a file written from memory does not take.

    Raises
    ------
    BadInput
        Its samples have more than `LARGEST` bytes.
    """
    if 8 * wanted.cells * wanted.plan.samples > LARGEST:
        raise BadInput(
            f"map: {wanted.cells} cells with {wanted.plan.samples} samples each take more than the 2 GB of a netCDF-3 variable: "
            'take fewer, or pip install "jaxbacklash[sweep]", which keeps the map on disk'
        )


def compile_beside_imports(wanted: Request, aside: ThreadPoolExecutor, keeps_tiles: bool) -> None:
    """Compile the map's program while the libraries that keep and draw it are loaded: the compiler leaves Python free.

    Tracing does not, so it comes first.
    """
    compile_exact = trace_exact(int(np.prod(wanted.tile)), wanted.plan)
    compiling = aside.submit(compile_exact)
    if keeps_tiles:
        importlib.import_module("zarr")
        importlib.import_module("h5netcdf")
    from ..report import map_report as map_report

    compiling.result()


def read_request(case: int, given: dict[str, str | None], periods: int, skip: int, samples: int | None, start: str) -> Request:
    """The request that the options describe; a parameter with one value is a constant."""
    axes: dict[str, np.ndarray] = {}
    fixed: dict[str, np.ndarray] = {}
    if all(text is None for text in given.values()):
        given = {**given, **DEFAULTS}
    for name, text in given.items():
        if text is None:
            continue
        values = read_range(f"--{name.lower().replace('_', '-')}", text)
        (axes if values.size > 1 else fixed)[name] = values
    if not axes:
        raise BadInput("map: every parameter has one value, wanted a range FROM:TO:COUNT for at least one of them")
    cells = int(np.prod([values.size for values in axes.values()]))
    if cells > MOST:
        raise BadInput(f"map: {cells} cells, wanted at most {MOST}")
    kept = min(32, max(1, periods - skip)) if samples is None else samples
    bounded("map", cells * periods, MOST_PERIODS, "periods to follow in all cells together", "take fewer cells or --periods")
    bounded("map", cells * kept, MOST_KEPT, "samples to keep in all cells together", "take fewer cells or --samples")
    family = PaperCase(case, **{name: float(values[0]) for name, values in fixed.items()})
    return request(family, axes, periods=periods, skip=skip, samples=kept, start=read_start(start))


def read_range(option: str, text: str) -> np.ndarray:
    """``FROM:TO:COUNT`` as evenly spaced values, or the one value that is given; all above zero."""
    parts = text.split(":")
    wanted = "wanted FROM:TO:COUNT or one number, above 0"
    try:
        numbers = [float(part) for part in parts[:2]]
        count = int(parts[2]) if len(parts) == 3 else 1
    except ValueError:
        raise BadInput(f"{option} {text}: {wanted}") from None
    if count > MOST:
        raise BadInput(f"{option} {text[:60]}: {shown(count)} values, wanted at most {MOST}")
    if len(parts) not in (1, 3) or count < 1 or not all(0.0 < n < np.inf for n in numbers):
        raise BadInput(f"{option} {text}: {wanted}")
    return np.linspace(numbers[0], numbers[-1], count)


def read_start(text: str) -> tuple[float, float]:
    """``P,V``: where every cell starts."""
    try:
        p, v = (float(part) for part in text.split(","))
    except ValueError:
        raise BadInput(f"--start {text}: wanted position and speed, two numbers with a comma between") from None
    if not (abs(p) <= FARTHEST and abs(v) <= FARTHEST):
        raise BadInput(f"--start {text[:60]}: wanted numbers from {-FARTHEST:g} to {FARTHEST:g}")
    return p, v


def counts(map_: Any) -> dict[str, Any]:
    """How many cells are chaotic, periodic and undecided, and the largest exponent."""
    period, exponent = map_.values("period"), map_.values("lyapunov")
    known = exponent[np.isfinite(exponent)]
    found, number = np.unique(period[period > 0], return_counts=True)
    return {
        "chaotic": int((period == 0).sum()), "unsettled": int((period == -1).sum()),
        "unresolved": int(map_.values("unresolved").sum()),
        "by_period": {str(int(T)): int(n) for T, n in zip(found, number)},
        "largest_exponent": {
            "value": float(known.max()) if known.size else None, "unit": "1/tau",
            **({} if known.size else {"why": "no cell could be followed to its end"}),
        },
    }  # fmt: skip


def words(result: dict[str, Any]) -> list[str]:
    """What a person reads."""
    cells = result["cells"]
    regular = sum(result["by_period"].values())
    share = {name: 100.0 * n / cells for name, n in (("chaotic", result["chaotic"]), ("periodic", regular))}
    largest = result["largest_exponent"]["value"]
    wall = result["wall_s"]
    return [
        f"CASE {result['case']}: {cells} cells, {result['periods']} periods each, the first {result['skip']} left out; "
        f"{result['solver']}.",
        f"{share['chaotic']:.1f} % of the cells are chaotic, {share['periodic']:.1f} % periodic, "
        f"{100.0 - sum(share.values()):.1f} % unresolved"
        + (f"; largest exponent {largest:.4g} per unit of tau." if largest is not None else "."),
        f"start-up {wall['start_up']:.1f} s, compiling {wall['compile']:.1f} s, run {wall['run']:.1f} s",
    ]


def picture(map_: Any, result: dict[str, Any], out: Path) -> None:
    """The page and the picture beside the map."""
    from ..report.map_report import map_report

    png = map_report(map_, result, " ".join(words(result)[:2]), out.with_suffix(".html"))
    target = out.with_suffix(".png")
    try:
        write_whole(target, png)
    except OSError as error:
        raise BadInput(f"--out {target}: cannot be written ({error.strerror})") from None


def process_age() -> float | None:
    """Seconds since this process began, its imports included; None where the system does not tell."""
    try:
        ticks = float(Path("/proc/self/stat").read_text().rsplit(")", 1)[1].split()[19])
        return float(Path("/proc/uptime").read_text().split()[0]) - ticks / os.sysconf("SC_CLK_TCK")
    except (OSError, ValueError, IndexError):
        return None
