"""Maps of exponent, period and stroboscopic samples over named parameters, as labelled datasets.

Cells are computed tile by tile in one compiled program per tile shape, two or more tiles at a time, one on each core. With a
store the tiles go to disk as they are done, see `tiles`.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import BadInput
from .family import PaperCase
from .follow import follow
from .labels import Labelled, dataset, labelled
from .periodicity import periodicity, sizes
from .request import VARIABLES, Request, request
from .tiles import MemoryTiles, TileStore

Progress = Callable[[str, float], None]


def compute_tile(wanted: Request, box: tuple[slice, ...]) -> tuple[dict[str, np.ndarray], str]:
    """The variables of one tile, each of the tile's shape (kept samples first), and the name of the solver."""
    size, lanes = [s.stop - s.start for s in box], int(np.prod(wanted.tile))
    grids = np.meshgrid(*(np.array(values)[s] for (_, values), s in zip(wanted.axes, box)), indexing="ij")
    # A tile at the edge is filled up with its last cell, so that all tiles run the same program.
    given = {name: np.pad(g.ravel(), (0, lanes - g.size), mode="edge") for name, g in zip(wanted.names, grids)}
    system, drive = wanted.family.build(given)
    one = np.ones(lanes)
    y0, dy0 = wanted.start[0] * one, wanted.start[1] * one
    found, solver = follow(system, drive, y0, dy0, wanted.plan, period=wanted.period, exact=wanted.exact, panels=wanted.panels)
    half, speed = sizes(system)
    number = {
        "lyapunov": found.lyapunov, "lyapunov_stderr": found.stderr, "unresolved": found.unresolved, "poincare": found.p,
        "period": periodicity(found.p, found.v, found.lyapunov, found.stderr, scale=half, speed=speed),
    }  # fmt: skip
    inside = int(np.prod(size))
    arrays = {name: np.asarray(number[name]).astype(kind) for name, kind in VARIABLES.items()}
    return {name: a[..., :inside].reshape(*a.shape[:-1], *size) for name, a in arrays.items()}, solver


def run_map(
    wanted: Request, *, store: str | os.PathLike[str] | None = None, client: Any = None, workers: int | None = None,
    progress: Progress | None = None,
) -> Any:  # fmt: skip
    """Compute a map.

    Parameters
    ----------
    wanted : from `request`
    store : folder of tiles; a run that was stopped goes on there and gives the same bits. None: all in memory
    client : a dask.distributed client whose workers compute the tiles; None: threads of this process
    workers : threads; default: one a core
    progress : called with words and the share done

    Returns
    -------
    `xarray.Dataset` over the axes; from a store large arrays are read when they are needed

    Raises
    ------
    BadInput
        xarray (or zarr, for a store) is missing, or the store holds another map.

    Examples
    --------
    >>> family = jb.dynamics.PaperCase(1)
    >>> wanted = jb.dynamics.request(family, {"inverse_alpha": [1.5, 2.0, 3.0]}, periods=60, skip=20)
    >>> jb.dynamics.run_map(wanted).lyapunov.sizes["inverse_alpha"]
    3
    """
    return dataset(labelled_map(wanted, store=store, client=client, workers=workers, progress=progress))


def labelled_map(
    wanted: Request, *, store: str | os.PathLike[str] | None = None, client: Any = None, workers: int | None = None,
    progress: Progress | None = None,
) -> Labelled:  # fmt: skip
    """`run_map` without xarray: arrays with their names and units."""
    kept = MemoryTiles(wanted) if store is None else TileStore(Path(store), wanted)
    missing = [k for k, _ in enumerate(wanted.tiles()) if not kept.has(k)]
    tell = Clock(progress, len(wanted.tiles()), len(missing))
    for k, (numbers, solver) in _results(wanted, missing, client, workers):
        kept.put(k, numbers, solver)
        tell.one_more()
    return labelled(wanted, kept)


def _results(wanted: Request, missing: list[int], client: Any, workers: int | None) -> Iterator[tuple[int, Any]]:
    boxes = wanted.tiles()
    if client is not None:
        from dask.distributed import as_completed as done

        # pure=False: a worker that dies is asked again, never answered from a stale result.
        futures = {client.submit(_on_worker, wanted, boxes[k], pure=False): k for k in missing}
        for future in done(list(futures)):
            yield futures.pop(future), future.result()
        return
    threads = workers or os.cpu_count() or 1
    with ThreadPoolExecutor(threads) as pool:
        # No more than a few tiles wait for the disk, so that memory stays bounded.
        queue, running = iter(missing), {}
        for k in queue:
            running[pool.submit(compute_tile, wanted, boxes[k])] = k
            if len(running) >= 2 * threads:
                future = next(as_completed(running))
                yield running.pop(future), future.result()
        for future in as_completed(list(running)):
            yield running[future], future.result()


def _on_worker(wanted: Request, box: tuple[slice, ...]) -> Any:
    from ..precision import enable_double_precision

    enable_double_precision()
    return compute_tile(wanted, box)


class Clock:
    """Tells the share of tiles that are done and how long the rest will take."""

    def __init__(self, progress: Progress | None, tiles: int, missing: int) -> None:
        self._progress = progress
        self._tiles, self._missing, self._done, self._begun = tiles, missing, 0, time.monotonic()

    def one_more(self) -> None:
        self._done += 1
        if self._progress is None:
            return
        left = (time.monotonic() - self._begun) / self._done * (self._missing - self._done)
        share = (self._tiles - self._missing + self._done) / self._tiles
        self._progress(f"tile {self._tiles - self._missing + self._done} of {self._tiles}, {_words(left)} to go", share)


def _words(seconds: float) -> str:
    if seconds < 90.0:
        return f"{seconds:.0f} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 5400.0 else f"{seconds / 3600.0:.1f} h"


def paper_map(case: int, axes: Mapping[str, Any], **options: Any) -> Any:
    """`run_map` of a case of the paper over ``inverse_alpha``, ``zeta`` and ``Omega``; options of `request` and `run_map`.

    Examples
    --------
    >>> axes = {"inverse_alpha": [1.5, 2.0, 3.0], "zeta": [0.02, 0.03]}
    >>> jb.dynamics.paper_map(1, axes, periods=60, skip=20).lyapunov.shape
    (3, 2)
    """
    later = {name: options.pop(name) for name in ("store", "client", "workers", "progress") if name in options}
    if case not in (1, 2):
        raise BadInput(f"case {case}: wanted 1 or 2")
    return run_map(request(PaperCase(case), axes, **options), **later)
