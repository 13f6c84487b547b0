"""What stands beside a stage or an absent effect, in pictures and tables alike."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from .style import is_number


def error_with(candidate: Mapping[str, Any]) -> Any:
    """The error with an effect added, as its refit found it, else as predicted."""
    known = candidate.get("refitted_rms_over_noise")
    return known if is_number(known) else candidate.get("predicted_rms_over_noise")


def stage_name(stage: Mapping[str, Any], number: int) -> str:
    """What a stage did, short enough for an axis: ``base model``, ``+ gravity``, ``− preload``."""
    added, dropped = stage.get("added"), stage.get("dropped") or []
    gone = [dropped] if isinstance(dropped, str) else list(dropped)
    parts = ([f"+ {added}"] if added else []) + [f"− {name}" for name in gone]
    text = "\n".join(parts) or ("base model" if number == 0 else "fitted again")
    return text.replace("_", "_\n", 1) if len(text) > 14 else text
