"""Figures of models: the error falling stage by stage, and what each absent effect would bring."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from ..criticism import Ranking, Refinement
from ..fitting import Fit
from .drawing import Drawn, Where, empty, ink, legend_above, panels, picture, readable_log
from .style import GAP, HELDOUT, MEASURED, MODEL, SHORT, format_evidence, is_number, short
from .words import error_with, stage_name

MOST_BARS = 12


@picture
def error_by_stage(stages: Sequence[Mapping[str, Any]], *, ax: Where = None) -> list[Axes]:
    """Prediction error over noise, model by model, on the record and on the held-out one.

    Parameters
    ----------
    stages : entries of ``stages`` in result.json; ``rms_over_noise`` and ``heldout_rms_over_noise`` may be null
    ax : where to draw
    """
    if not stages:
        return empty(ax, "No stages to draw.")
    axes = panels(ax, height=SHORT + 0.3)
    ax = axes[0]
    at = np.arange(len(stages), dtype=float)
    shown = [("rms_over_noise", "this record", MEASURED), ("heldout_rms_over_noise", "held-out record", HELDOUT)]
    shown = [entry for entry in shown if any(is_number(stage.get(entry[0])) for stage in stages)]
    reach = [1.0]
    width = 0.56 / max(len(shown), 1)
    for number, (key, name, colour) in enumerate(shown):
        values = np.array([float(s[key]) if is_number(s.get(key)) and s[key] > 0 else np.nan for s in stages])
        place = at + width * (number - 0.5 * (len(shown) - 1))
        reach += values[np.isfinite(values)].tolist()
        # Bars stand on the noise, so that their height is what there is to gain.
        ax.bar(place, values - 1.0, bottom=1.0, width=0.94 * width, color=colour, lw=0, label=name)
        for x, value in zip(place, values):
            if np.isfinite(value):
                ax.annotate(short(value), (x, max(value, 1.0)), xytext=(0, 2), textcoords="offset points",
                            ha="center", va="bottom")  # fmt: skip
    ax.axhline(1.0, color=ink(ax), lw=0.9, label="1: noise alone")
    readable_log(ax, "y", min(0.85, 0.95 * min(reach)), max(1.6, max(reach) ** 1.12 * 1.1))
    middle, half = 0.5 * (len(stages) - 1), 0.5 * max(len(stages), 3)
    ax.set(xlim=(middle - half, middle + half), ylabel="rms over noise")
    ax.set_xticks(at, [stage_name(stage, number) for number, stage in enumerate(stages)])
    ax.tick_params(axis="x", length=0)
    ax.spines["bottom"].set_visible(False)
    ax.grid(False, axis="x")
    legend_above(axes)
    return axes


@picture
def candidate_ranking(
    candidates: Sequence[Mapping[str, Any]], *, current: float | None = None, most: int = MOST_BARS, ax: Where = None
) -> list[Axes]:
    """What the error would become with each absent effect added, best first.

    Parameters
    ----------
    candidates : entries of ``candidates`` in result.json: ``name``, ``predicted_rms_over_noise``,
        ``refitted_rms_over_noise``, which is drawn where it is known, ``evidence``
    current : rms over noise of the model as it is, drawn as a line
    most : how many are drawn
    ax : where to draw
    """
    kept = list(candidates)[:most]
    if not kept:
        return empty(ax, "No effect was left to try.")
    axes = panels(ax, height=0.9 + 0.27 * len(kept))
    ax = axes[0]
    at = np.arange(len(kept))
    values = [error_with(entry) for entry in kept]
    known = [float(value) for value in values if is_number(value) and value > 0]
    highest = max([*known, current if is_number(current) and current else 1.0, 1.5])
    spread = highest > 8.0
    lowest = min([*known, 0.8]) * 0.9 if spread else 0.0
    for place, (entry, value) in enumerate(zip(kept, values)):
        if is_number(value):
            told: Any = entry.get("evidence")
            best = place == 0 and not (is_number(told) and told <= 0.0)
            ax.barh(place, float(value) - lowest, left=lowest, height=0.62, color=MODEL if best else GAP, lw=0)
        else:
            # Right of the line that marks the noise, which would cross it.
            ax.annotate(str(entry.get("why") or "not evaluated"), (1.0, place), xytext=(5, 0), textcoords="offset points",
                        va="center", fontsize=8)  # fmt: skip
    _column(ax, 46, "rms", [short(value) for value in values])
    if any(is_number(entry.get("evidence")) for entry in kept):
        _column(ax, 98, "evidence", [format_evidence(entry.get("evidence")) for entry in kept])
    ax.set_yticks(at, [str(entry.get("name", "?")) for entry in kept])
    hidden = len(candidates) - len(kept)
    more = f"; the best {len(kept)} of {len(candidates)}" if hidden else ""
    ax.set(ylim=(len(kept) - 0.4, -0.6), xlabel=f"rms over noise with the effect added{more}")
    if spread:
        readable_log(ax, "x", lowest, highest * 1.05)
    else:
        ax.set_xlim(0.0, highest * 1.03)
    ax.axvline(1.0, color=ink(ax), lw=0.8, ls="--")
    _above(ax, 1.0, "noise", ink(ax))
    if is_number(current):
        assert current is not None
        ax.axvline(current, color=MEASURED, lw=1.2)
        if current > 1.25:
            _above(ax, current, "now", MEASURED)
    ax.grid(False, axis="y")
    ax.tick_params(axis="y", length=0)
    return axes


def stages(found: Refinement | Fit | Sequence[Fit], *, ax: Where = None) -> Drawn:
    """Prediction error over noise, model by model, on the record and on the held-out one.

    Parameters
    ----------
    found : a refinement, or fits of one record in order
    ax : one axes; a figure or part of one; None: a new figure

    Returns
    -------
    the axes

    Examples
    --------
    >>> record, heldout = (one.between(0.0, 2.0) for one in jb.demo_records())
    >>> fits = [jb.fit(record, inertia=3.16, effects=names, heldout=heldout, starts=1) for names in ([], ["gravity"])]
    >>> [label.get_text() for label in jb.plot.stages(fits).get_xticklabels()]
    ['base model', '+ gravity']
    """
    if isinstance(found, Refinement):
        return error_by_stage([_stage(stage.fit, stage.added, stage.dropped) for stage in found.stages], ax=ax)
    fits = [found] if isinstance(found, Fit) else list(found)
    before: list[set[str]] = [set(one.system.effects) for one in (*fits[:1], *fits)]
    return error_by_stage(
        [_stage(one, " + ".join(sorted(set(one.system.effects) - old)) or None, sorted(old - set(one.system.effects)))
         for one, old in zip(fits, before)], ax=ax,
    )  # fmt: skip


def ranking(found: Ranking, *, most: int = 12, ax: Where = None) -> Drawn:
    """What the error would become with each absent effect added, best first, with the evidence for it.

    Evidence allows for the parameters that an effect brings: below 0 it speaks against it.

    Parameters
    ----------
    found : from `jaxbacklash.rank_effects`
    most : how many are drawn
    ax : one axes; a figure or part of one; None: a new figure

    Returns
    -------
    the axes

    Examples
    --------
    >>> record, heldout = jb.demo_records()
    >>> fit = jb.fit(record.between(0.0, 2.0), inertia=3.16, starts=1)
    >>> jb.plot.ranking(jb.rank_effects(fit), most=5).get_xlabel()
    'rms over noise with the effect added; the best 5 of ...'
    """
    entries = [
        {
            "name": one.name, "evidence": one.evidence, "predicted_rms_over_noise": one.predicted_rms_over_noise,
            "refitted_rms_over_noise": one.refitted_rms_over_noise, "why": one.why,
        }
        for one in found
    ]  # fmt: skip
    return candidate_ranking(entries, current=found.current, most=most, ax=ax)


def _stage(fit: Fit, added: str | None, dropped: Sequence[str]) -> dict[str, Any]:
    held = None if fit.heldout is None else fit.heldout.rms
    return {"added": added, "dropped": list(dropped), "rms_over_noise": fit.score.rms, "heldout_rms_over_noise": held}


def _column(ax: Axes, offset: float, title: str, texts: list[str]) -> None:
    """Numbers to the right of a plot, ``offset`` points from its edge, one a bar."""
    place: dict[str, Any] = {"textcoords": "offset points", "ha": "right", "fontsize": 8.0, "annotation_clip": False}
    for row, text in enumerate(texts):
        ax.annotate(text, (1.0, row), xycoords=("axes fraction", "data"), xytext=(offset, 0), va="center", **place)
    ax.annotate(title, (1.0, 1.0), xycoords="axes fraction", xytext=(offset, 3), va="bottom", **place)


def _above(ax: Axes, at: float, text: str, colour: str) -> None:
    ax.annotate(text, (at, 1.0), xycoords=("data", "axes fraction"), xytext=(0, 3), textcoords="offset points",
                ha="center", va="bottom", fontsize=8.0, color=colour)  # fmt: skip
