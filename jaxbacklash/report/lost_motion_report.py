"""The page of a slow record's play, and its card."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from .. import plot
from ..plot.drawing import svg_of
from ..plot.levels import levels_sentence
from ..quasistatic import LostMotion
from .html import Panel, write_report


def lost_motion_report(found: LostMotion, result: dict[str, Any], path: Path) -> None:
    """Write the page of ``lost-motion``."""
    write_report(path, result, [Panel("Both edges", levels_sentence(found), svg_of(plot.lost_motion, found), "levels")])
