"""Before laws are looked for: a cause of misfit that lies in the record is told first, and no law is looked for in its place."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from ..causes import Cause, find_causes
from ..errors import NoAnswer
from ..fitting.fit import fit as fit_record
from ..fitting.result import Fit, causes_text
from ..fitting.search import silent
from ..records import Record
from ..system import System
from .refinement import Refinement
from .steps import Stage
from .verdict import Verdict


def causes_first(
    record: Record,
    *,
    heldout: Record | None = None,
    model: str = "joint",
    inertia: float | None = None,
    system: System | None = None,
    window: float | None = None,
    translational: bool = False,
    seed: int = 0,
    progress: Callable[[str, float], None] = silent,
) -> tuple[Refinement | None, list[Cause]]:
    """The causes of misfit that lie in a record, and a refinement that ends with them where they leave nothing to look for.

    The arguments are those of `refine`; ``seed`` changes nothing here either, as only one start is tried. None where the base
    model explains the record, or where the cause is one that an effect of the catalogue tells as well (a lag of the measured
    channel), so that a search may name it.
    """
    if record.kind == "transmitted":
        return None, []
    try:
        base = fit_record(
            record, heldout=heldout, model=model, inertia=inertia, system=system, window=window, starts=1, seed=seed,
            translational=translational,
        )  # fmt: skip
    except NoAnswer:
        return None, []
    causes = find_causes(base, progress)
    if any(cause.certain and not cause.law for cause in causes):
        return ended(base, causes), causes
    return None, causes


def ended(base: Fit, causes: Sequence[Cause]) -> Refinement:
    """A refinement that has looked for no law, since the record has to be mended first."""
    beside = "No law was looked for on the record as it stands; the numbers below are of it, too."
    said = f"Incomplete: {causes_text(causes)} {beside}"
    return Refinement((Stage(None, (), base, (), {}),), (), Verdict(False, said, False), causes=tuple(causes))


def told(found: Refinement, causes: Sequence[Cause]) -> Refinement:
    """A refinement beside the causes that were found in its record.

    Where a cause explains the record and the search has named something else instead of the effect that is the same, what it has
    named stands in for the cause: only the base model is kept.
    """
    sure = [cause for cause in causes if cause.certain]
    if not sure or any(cause.law in found.effects for cause in sure):
        return found
    return ended(found.stages[0].fit, causes)
