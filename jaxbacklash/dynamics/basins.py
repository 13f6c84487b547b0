"""Basins of attraction: which of the coexisting attractors each start leads to.

Periodic attractors are told apart by their points: two motions are on the same one if every stroboscopic point of one lies on a
point of the other. Chaotic motions never repeat, so all of them at one parameter count as one attractor unless the places they
keep to are apart: their middle and spread are compared.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..frames import dataframe, dataset
from ..showing import html_of, print_of, table_of
from .family import Family
from .follow import follow
from .periodicity import CHAOTIC, periodicity, sizes
from .plan import Plan

Array = Any


class Attractor(NamedTuple):
    """One attractor: ``period`` (0: chaotic), largest exponent ``lyapunov``, its stroboscopic points ``p``, ``v`` (K,), and the
    ``share`` of the starts that lead to it."""

    period: int
    lyapunov: float
    p: np.ndarray
    v: np.ndarray
    share: float

    def __str__(self) -> str:
        kind = "chaotic" if self.period == CHAOTIC else f"period {self.period}"
        return f"{kind}, exponent {self.lyapunov:.4g}"


class Basins(NamedTuple):
    """``number`` (M, N): which of ``attractors`` the start ``y`` (M,), ``dy`` (N,) leads to, -1 where it settles on none.

    ``unit`` of ``y``: ``"half play"`` or ``"rad"``.
    """

    y: np.ndarray
    dy: np.ndarray
    number: np.ndarray
    attractors: list[Attractor]
    unit: str = "rad"

    def __str__(self) -> str:
        told = [f"  {100.0 * one.share:5.1f} % of the starts: {one}" for one in self.attractors]
        return "\n".join([f"{len(told)} attractors from {self.number.size} starts", *told])

    def to_dataset(self) -> Any:
        """Which attractor each start leads to, as an `xarray.Dataset` over ``y`` and ``dy``: ``number``, -1 for none."""
        return dataset(
            {"number": (("y", "dy"), self.number, "1")}, {"y": (self.y, self.unit), "dy": (self.dy, "")},
            attractors=[str(one) for one in self.attractors],
        )  # fmt: skip

    def to_dataframe(self) -> Any:
        """The attractors as a `pandas.DataFrame`, a row each: ``period`` (0: chaotic), ``lyapunov``, ``share`` of the starts."""
        names = ("period", "lyapunov", "share")
        return dataframe({"attractor": range(len(self.attractors)),
                          **{name: [getattr(one, name) for one in self.attractors] for name in names}}, "attractor")  # fmt: skip

    def _repr_html_(self) -> str:
        return html_of(self)

    def __rich__(self) -> Any:
        return table_of(self)

    def _repr_pretty_(self, printer: Any, cycle: bool) -> None:
        print_of(self, printer, cycle)


def basins(
    family: Family, given: dict[str, float], y: Any, dy: Any, *, periods: int = 400, samples: int = 32, near: float = 1e-3,
    period: float | None = None, exact: bool | None = None, panels: int | None = None,
) -> Basins:  # fmt: skip
    """Follow a grid of starts and sort them by where they end.

    Parameters
    ----------
    family, given : whose basins, at which parameter values
    y, dy : (M,), (N,) starting positions and speeds
    periods, samples : how long each start is followed and how many points it is judged by
    near : largest distance between points of the same periodic attractor, in half plays and half plays times the contact's
        natural frequency (rad and rad/s where there is no play)
    period, exact, panels : see `follow`

    Returns
    -------
    Basins, the attractor with the largest share first

    Examples
    --------
    >>> case = jb.dynamics.PaperCase(1)
    >>> found = jb.dynamics.basins(case, {"inverse_alpha": 3.0}, [-1.0, 0.0, 1.0], [-1.0, 0.0, 1.0], periods=120)
    >>> found.number.shape
    (3, 3)
    """
    y, dy = np.asarray(y, dtype=float), np.asarray(dy, dtype=float)
    grid = np.meshgrid(y, dy, indexing="ij")
    one = np.ones(grid[0].size)
    system, drive = family.build({name: value * one for name, value in given.items()})
    plan = Plan(periods, max(0, min(periods // 2, periods - max(100, samples))), samples)
    found, _ = follow(system, drive, grid[0].ravel(), grid[1].ravel(), plan, period=period, exact=exact, panels=panels)
    p, v, exponent = (np.asarray(a) for a in (found.p, found.v, found.lyapunov))
    scale = np.array([float(np.max(size)) for size in sizes(system)])
    repeats = periodicity(p, v, exponent, np.asarray(found.stderr), scale=scale[0], speed=scale[1])
    number = np.full(one.size, -1)
    kept: list[tuple[int, np.ndarray]] = []
    for k in np.argsort(repeats == CHAOTIC, kind="stable"):
        if repeats[k] < 0:
            continue
        points = np.stack([p[:, k], v[:, k]], axis=1)[-(int(repeats[k]) or samples) :] / scale
        for j, (T, others) in enumerate(kept):
            if repeats[k] == T and _same(T, points, others, near):
                number[k] = j
                break
        else:
            number[k] = len(kept)
            kept.append((int(repeats[k]), points))
    attractors, order = [], np.argsort([-(number == j).sum() for j in range(len(kept))], kind="stable")
    for j in order:
        T, points = kept[j][0], kept[j][1] * scale
        inside = number == j
        attractors.append(Attractor(T, float(np.median(exponent[inside])), points[:, 0], points[:, 1], float(inside.mean())))
    rank = np.append(np.argsort(order), -1)
    unit = "half play" if family.time_unit == "1/omega_0" else "rad"
    return Basins(y, dy, rank[number].reshape(y.size, dy.size), attractors, unit)


def _same(period: int, points: np.ndarray, others: np.ndarray, near: float) -> bool:
    if period != CHAOTIC:
        from scipy.spatial import cKDTree  # loads a fifth of a second, for which a map need not wait

        return bool(cKDTree(others).query(points)[0].max() <= near)
    apart = np.abs(points.mean(axis=0) - others.mean(axis=0))
    # Middles of two chaotic runs on one attractor differ by the scatter of a mean; five of it, or half a play, is the same place.
    scatter = np.hypot(points.std(axis=0), others.std(axis=0)) / np.sqrt(len(points))
    return bool(np.all(apart <= np.maximum(5.0 * scatter, 0.5)))
