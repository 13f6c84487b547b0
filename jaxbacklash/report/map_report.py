"""The page of a map: exponent and period over two parameters, and cuts through them as the paper draws its figures."""

from __future__ import annotations

import base64
from pathlib import Path
from typing import Any

import numpy as np

from ..plot.drawing import Page, on_page, to_png_data_uri, to_svg
from ..plot.maps import LABELS, exponent_and_period_map, exponent_curve
from .html import Panel, write_report


def map_report(map_: Any, result: dict[str, Any], sentence: str, path: Path) -> bytes:
    """Write the page of a map and return its first picture as PNG.

    Parameters
    ----------
    map_ : `Labelled` from `jaxbacklash.dynamics.labels`, over any number of axes; more than two are cut in their middle
    result : what the command answers
    sentence : what to say first
    path : the page
    """
    names = list(map_.variables["lyapunov"].dims)
    panels, first = [], None
    if len(names) >= 2:
        at, note = _cut(map_, names[2:])
        drawn = _two(map_, at, names[:2])
        first = drawn
        panels.append(
            Panel(
                "Exponent and period",
                f"Where small differences grow (orange) the motion is chaotic; elsewhere it repeats.{note}",
                to_svg(drawn),
                "map",
                "The exponent is the mean growth rate of a small difference, per unit of dimensionless time. The period counts "
                "periods of the drive. Grey cells neither return within the kept samples nor grow by three error bars. 1/α is "
                "k_0 x_0 / A, backlash over force; ζ the damping ratio; Ω the drive's frequency over that of the contact.",
            )
        )
    at, note = _cut(map_, names[1:])
    drawn = _one(map_, at, names[0])
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
        "command": "map", "command_line": result["command_line"], "version": result["version"], "record": {"path": result["out"]},
        "verdict_text": sentence,
    }  # fmt: skip
    write_report(path, told, panels)
    return base64.b64decode(to_png_data_uri(first).split(",", 1)[1])


def _cut(map_: Any, names: list[str]) -> tuple[dict[str, int], str]:
    """Where to cut some axes, near their middle or at the paper's own value, and words for it."""
    if not names:
        return {}, ""
    own = {"zeta": 0.02, "inverse_alpha": 2.0, "Omega": 0.2}
    at, words = {}, []
    for name in names:
        values = map_.coordinates[name].data
        wanted = own.get(name, np.nan)
        inside = values.min() <= wanted <= values.max()
        at[name] = k = int(np.argmin(np.abs(values - wanted))) if inside else values.size // 2
        words.append(f"{LABELS.get(name, name)} = {values[k]:.4g}")
    return at, f" Cut at {', '.join(words)}."


def _two(map_: Any, at: dict[str, int], names: list[str]) -> Page:
    axes = [map_.coordinates[name] for name in names]
    return on_page(
        exponent_and_period_map, axes[0].data, axes[1].data, map_.values("lyapunov", at), map_.values("period", at), names=names,
        units=[axis.attrs["units"] for axis in axes], exponent_unit=map_.variables["lyapunov"].attrs["units"],
    )  # fmt: skip


def _one(map_: Any, at: dict[str, int], name: str) -> Page:
    axis = map_.coordinates[name]
    return on_page(
        exponent_curve, axis.data, map_.values("lyapunov", at), map_.values("lyapunov_stderr", at), name=name,
        unit=axis.attrs["units"], exponent_unit=map_.variables["lyapunov"].attrs["units"], samples=map_.values("poincare", at),
    )  # fmt: skip
