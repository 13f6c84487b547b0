"""How long windows and integration panels are: by the clock for records of hundreds of hertz, by samples for slower ones.

A torque that a model leaves out acts where shooting windows join, so that these are short beside the time in which it changes. A
window whose error is quoted is many of them; and a joint whose motion shows at a sample every second does not need a panel every
two milliseconds.
"""

from __future__ import annotations

from ..signals import SPAN, span

SHOOTING_WINDOW = 0.05
"""Length of a shooting window [s]; eight samples where those last longer."""
HELD_WINDOW = 16
"""Samples of a shooting window where each of them has a torque of its own, held by a controller."""
SCORE_WINDOW = 2.0 * SPAN
"""Length of the windows whose prediction error is quoted [s]; 32 samples where those last longer."""
LONGEST_PANEL = 2.0e-3
"""Longest integration panel [s]; a panel is two Runge-Kutta steps."""
PANELS = 16
"""Panels between two samples at most: a contact whose period these do not resolve is beyond what the samples show."""


def score_window(dt: float, said: float | None = None) -> float:
    """Length [s] of the windows whose error is quoted: as the user ``said``, else by the sample spacing ``dt`` [s]."""
    return 2.0 * span(dt) if said is None else said


def shooting_window(score: float) -> float:
    """Length [s] of a shooting window in a score window of ``score`` [s]: at least two make one."""
    return min(SHOOTING_WINDOW, 0.5 * score)


def longest_panel(dt: float) -> float:
    """Longest integration panel [s] that the motion needs, whatever its contact."""
    return max(LONGEST_PANEL, dt / PANELS)
