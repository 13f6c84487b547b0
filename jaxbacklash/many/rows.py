"""One record's line in the table: what its fit or refinement says, as plain data, or why there is none."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from ..criticism import Refinement
from ..errors import BadInput, NoAnswer
from ..fitting import Estimate, Fit, Score
from ..fitting.result import doubt, verdict_text
from .wanted import Source, path_of

Row = dict[str, Any]
FAILED, COMPLETE, INCOMPLETE = "failed", "complete", "incomplete"
LONGEST = 300
"""Characters of an unforeseen error that are kept."""


def row_of_fit(fit: Fit, notes: Sequence[str] = ()) -> Row:
    """What a fit says of its record."""
    return _row(fit, COMPLETE if fit.adequate else INCOMPLETE, verdict_text(fit), notes, holds=not doubt(fit))


def row_of_refinement(found: Refinement, notes: Sequence[str] = ()) -> Row:
    """What a refinement says of its record: the model kept, and which effects were missing."""
    from ..criticism.refinement import doubted

    return _row(found.fit, found.verdict.word, found.verdict.text, notes, holds=not doubted(found)) | {
        "effects": list(found.effects),
        "alternatives": [list(names) for names in found.alternatives],
    }


def row_of_failure(source: Source, error: BaseException, notes: Sequence[str] = ()) -> Row:
    """The line of a record that has no result: one clear sentence says why."""
    return {"record": path_of(source), "verdict": FAILED, "why": sentence(error), "parameters": {}, "notes": list(notes)}


def sentence(error: BaseException) -> str:
    """An error in one sentence."""
    text = " ".join(str(error).split())
    if isinstance(error, BadInput | NoAnswer):
        return text
    if isinstance(error, MemoryError) or "RESOURCE_EXHAUSTED" in text:
        return "there is not enough memory for this record; try a shorter one or a lower rate"
    if isinstance(error, OSError):
        return f"{error.filename or 'the file'}: cannot be read ({error.strerror or text[:LONGEST]})"
    if isinstance(error, ArithmeticError) or type(error).__name__ == "LinAlgError":
        return f"its numbers leave the range of double precision ({text[:LONGEST]}); check units and scales"
    return f"{type(error).__name__}: {text[:LONGEST] or 'no message'}; please report it"


def _row(fit: Fit, verdict: str, text: str, notes: Sequence[str], *, holds: bool) -> Row:
    record = fit.records[0]
    held = {f"heldout_{name}": value for name, value in errors(fit.heldout).items()} if fit.heldout is not None else {}
    return {
        "record": record.path, "verdict": verdict, "why": text, "samples": record.samples, "rate_hz": record.rate_hz,
        **errors(fit.score), **held, "noise": finite(fit.noise[0]), "per_inertia": fit.per_inertia,
        "effects": sorted(fit.system.effects), "intervals_hold": holds,
        "parameters": {name: _parameter(one, holds) for name, one in fit.parameters.items()}, "notes": list(notes),
    }  # fmt: skip


def errors(score: Score) -> dict[str, float | None]:
    """The prediction errors of a score: over the noise, and as a share of what was measured."""
    return {
        "rms_over_noise": finite(score.rms), "median_over_noise": finite(score.median), "nrmse": finite(score.nrmse),
    }  # fmt: skip


def _parameter(one: Estimate, holds: bool) -> dict[str, Any]:
    interval = one.ci95 if holds else None
    told = {
        "value": finite(one.value), "stderr": finite(one.stderr), "low": None if interval is None else finite(interval[0]),
        "high": None if interval is None else finite(interval[1]), "unit": one.unit, "verdict": one.verdict,
    }  # fmt: skip
    return told | ({"why": one.why} if one.why else {})


def finite(value: float | None) -> float | None:
    """A plain number, None for one that is not finite."""
    return None if value is None or not math.isfinite(value) else float(value)
