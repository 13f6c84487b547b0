"""The pictures of the page: the report's own, drawn once and kept, each with a title and what to see in it."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np

import jaxbacklash as jb

from ..plot.drawing import svg_of
from .tree import Model
from .worker import sentence

MOST = 200
"""Pictures that are kept."""
DRAWING = threading.Lock()
"""Matplotlib's settings are of the whole process, so that one picture is drawn at a time."""


@dataclass(frozen=True)
class Figure:
    """A picture as the page shows it: ``svg`` empty and ``why`` in its place where there is nothing to draw."""

    title: str
    says: str
    svg: str
    why: str = ""


SCALE = "above 10, odds of 150 to 1, is strong, below 0 it speaks against the effect"
"""What numbers of evidence mean."""
SAYS = {
    "record": ("The record", "Every channel as it was measured, in SI units."),
    "fit": ("Measured against model", "All of it, the stretch that the model misses most, and a typical one."),
    "residuals": ("What the model leaves", "Over the noise: within two noises where noise alone is left; below, by window."),
    "phase_plane": ("Phase plane", "Relative position against relative speed; between the two lines lies the play."),
    "restoring_force": ("Restoring force", "What the joint returns over its relative motion, measured and as the model has it."),
    "force_loop": ("Force loop", "Transmitted force over the base motion, measured and predicted."),
    "where_it_fails": (
        "Where it fails", "Misfit and missing torque over the coordinates that tell most, the place in the play first; "
        "numbers over bars are shares of the missing torque's mean square.",
    ),
    "missing_torque": ("The missing torque in time", "What would have to be added to the model for it to follow the record."),
    "torque_over": ("What the missing torque depends on", "Over the one or two coordinates that explain it best."),
    "ranking": ("Which effect is missing", f"The error with one effect added; evidence {SCALE}."),
    "stages": ("The error falling", "Model by model on the way to this one; 1 means that noise alone is left."),
}  # fmt: skip


class Gallery:
    """Pictures by what they show, drawn one after another in a thread of their own when they are first asked for.

    ``changed`` is called when one more can be shown.
    """

    def __init__(self, changed: Callable[[], None]) -> None:
        self._changed = changed
        self._kept: dict[tuple[Any, ...], tuple[Any, Future[Figure]]] = {}
        self._hand = ThreadPoolExecutor(1)

    def figure(self, kind: str, *shown: Any) -> Figure | None:
        """One picture, of `jaxbacklash.plot` by its name, drawn of ``shown``; None as long as it is not drawn."""
        key = kind, *map(id, shown)
        if key not in self._kept:
            if len(self._kept) > MOST:
                self._kept = {other: kept for other, kept in self._kept.items() if not kept[1].done()}
            # What is shown is kept too, so that no other object gets its id.
            work = self._hand.submit(drawn, kind, list(shown) if kind == "stages" else shown[0])
            self._kept[key] = shown, work
            work.add_done_callback(lambda _: self._changed())
        work = self._kept[key][1]
        return work.result() if work.done() else None

    def warm(self) -> None:
        """Load what the first picture needs, while the page is being opened."""
        t = np.linspace(0.0, 1.0, 200)
        record = jb.Record(t, {"x": 0.01 * np.sin(9.0 * t), "z": 0.01 * np.cos(9.0 * t)})
        self._hand.submit(drawn, "record", record)

    def close(self) -> None:
        """Draw no more."""
        self._hand.shutdown(wait=False, cancel_futures=True)


def of_model(model: Model) -> list[tuple[str, Any]]:
    """The pictures of a model beside its record: of which kind, and of what."""
    seen = model.fit.records[0].observed_name
    kinds = ["fit", "residuals", *(["force_loop"] if seen == "T" else ["phase_plane", "restoring_force"])]
    return [(kind, model.fit) for kind in kinds if kind != "restoring_force" or model.fit.system.contact is not None]


def of_failure(model: Model) -> list[tuple[str, Any]]:
    """The pictures of where a model fails; none as long as that is not known."""
    found = model.findings
    if found is None:
        return []
    kinds = ["missing_torque"] if found.surface is None else ["where_it_fails", "missing_torque", "torque_over"]
    return [(kind, found) for kind in kinds]


def drawn(kind: str, shown: Any, **how: Any) -> Figure:
    """Draw a picture now."""
    title, says = SAYS[kind]
    try:
        with DRAWING:
            return Figure(title, says, svg_of(getattr(jb.plot, kind), shown, **how))
    except Exception as why:  # one picture that cannot be drawn must not take the page with it
        return Figure(title, says, "", sentence(why))
