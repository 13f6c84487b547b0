"""The page of a map: exponent and period over two parameters, and cuts through them as the paper draws its figures."""

from __future__ import annotations

import base64
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from .drawing import to_png_data_uri, to_svg
from .figures_maps import LABELS, exponent_and_period_map, exponent_curve
from .html import Panel, write_report


def map_report(map_: Any, result: dict[str, Any], sentence: str, path: Path) -> bytes:
    """Write the page of a map and return its first picture as PNG.

    Parameters
    ----------
    map_ : Dataset from `jaxbacklash.dynamics.maps`, over any number of axes; more than two are cut in their middle
    result : what the command answers
    sentence : what to say first
    path : the page
    """
    names = [str(name) for name in map_["lyapunov"].dims]
    panels, first = [], None
    if len(names) >= 2:
        cut, note = _cut(map_, names[2:])
        drawn = _two(cut, names[:2])
        first = drawn
        panels.append(
            Panel(
                "Exponent and period",
                f"Where small differences grow (orange) the motion is chaotic; elsewhere it repeats.{note}",
                to_svg(drawn),
                "map",
                "The exponent is the mean growth rate of a small difference, per unit of dimensionless time. The period counts "
                "periods of the drive. Grey cells neither return within the kept samples nor grow by three error bars.",
            )
        )
    cut, note = _cut(map_, names[1:])
    drawn = _one(cut, names[0])
    first = first or drawn
    where = f" Here{note.removeprefix(' Cut')}" if note else ""
    panels.append(
        Panel(
            "Exponent and bifurcation diagram",
            f"The largest exponent, and below it the position each time the drive has come round.{where}",
            to_svg(drawn),
            "cut",
            "As in Figures 2 and 3 of the paper. One dot: the motion repeats with the drive; two: it takes two periods; "
            "a smear: it never repeats. The band is the play.",
        )
    )
    told = {
        "command": "map", "command_line": "", "version": result["version"], "record": {"path": result["out"]},
        "verdict_text": sentence,
    }  # fmt: skip
    write_report(path, told, panels)
    return base64.b64decode(to_png_data_uri(first).split(",", 1)[1])


def _cut(map_: Any, names: list[str]) -> tuple[Any, str]:
    """The map at one value of some of its axes, near their middle or the paper's own, and words for where."""
    if not names:
        return map_, ""
    own = {"zeta": 0.02, "inverse_alpha": 2.0, "Omega": 0.2}
    words = []
    for name in names:
        values = map_[name].values
        wanted = own.get(name, np.nan)
        inside = values.min() <= wanted <= values.max()
        k = int(np.argmin(np.abs(values - wanted))) if inside else values.size // 2
        map_ = map_.isel({name: k})
        words.append(f"{LABELS.get(name, name)} = {values[k]:.4g}")
    return map_, f" Cut at {', '.join(words)}."


def _two(map_: Any, names: list[str]) -> Figure:
    return exponent_and_period_map(
        map_[names[0]].values, map_[names[1]].values, map_["lyapunov"].transpose(*names).values,
        map_["period"].transpose(*names).values, names=names, units=[map_[name].attrs["units"] for name in names],
        exponent_unit=map_["lyapunov"].attrs["units"],
    )  # fmt: skip


def _one(map_: Any, name: str) -> Figure:
    return exponent_curve(
        map_[name].values, map_["lyapunov"].values, map_["lyapunov_stderr"].values, name=name,
        unit=map_[name].attrs["units"], exponent_unit=map_["lyapunov"].attrs["units"],
        samples=map_["poincare"].transpose("sample", name).values,
    )  # fmt: skip
