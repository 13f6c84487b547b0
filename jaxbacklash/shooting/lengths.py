"""How long windows and integration panels are: by the clock for records of hundreds of hertz, by samples for slower ones.

A window that is shot through on its own has to hold more samples than unknowns, whatever the rate, or it follows the noise; and a
joint whose motion shows at a sample every second does not need a panel every two milliseconds.
"""

from __future__ import annotations

from ..signals import SPAN, span

SHOOTING_WINDOW = SPAN
"""Length of a shooting window [s], or `jaxbacklash.signals.span` where that is longer. Windows of 0.1 s converge from wild
starts; 0.25 s and longer mostly do not."""
SCORE_WINDOW = 2.0 * SHOOTING_WINDOW
"""Length of the windows whose prediction error is quoted [s]; two shooting windows where samples are rare."""
LONGEST_PANEL = 2.0e-3
"""Longest integration panel [s]; a panel is two Runge-Kutta steps."""
PANELS = 16
"""Panels between two samples at most: a contact whose period these do not resolve is beyond what the samples show."""


def score_window(dt: float, said: float | None = None) -> float:
    """Length [s] of the windows whose error is quoted: as the user ``said``, else by the sample spacing ``dt`` [s]."""
    return 2.0 * span(dt) if said is None else said


def shooting_window(dt: float, score: float) -> float:
    """Length [s] of a shooting window in a score window of ``score`` [s]."""
    return 0.5 * score if score < 2.0 * span(dt) else span(dt)


def longest_panel(dt: float) -> float:
    """Longest integration panel [s] that the motion needs, whatever its contact."""
    return max(LONGEST_PANEL, dt / PANELS)
