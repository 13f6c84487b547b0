"""The last word: is what the model leaves noise, and which other models would have done as well?"""

from __future__ import annotations

from dataclasses import dataclass

from ..fitting import Fit
from .workbench import Trial

NEAR_NOISE = 1.05
"""Root of the reduced chi-square of a tied fit up to which what is left counts as noise, since the noise itself is estimated."""


@dataclass(frozen=True)
class Verdict:
    """``complete`` when what is left is noise; ``text`` says so in one or two sentences."""

    complete: bool
    text: str

    @property
    def word(self) -> str:
        return "complete" if self.complete else "incomplete"


def judge_rest(final: Trial, fits: list[Fit]) -> Verdict:
    """Whether the last model leaves nothing but noise."""
    first, last = fits[0], fits[-1]
    complete = final.misfit < NEAR_NOISE and last.score.median < 1.1
    named = ", ".join(sorted(final.names))
    left = "what is left is noise"
    if last.score.rms > 1.1:
        left += f" but in a few windows (the median window is off by {last.score.median:.2f} times the noise)"
    if complete and not final.names:
        text = (
            f"The joint's play, stiffness and damping explain the record: the prediction error is {last.score.rms:.3g} times the "
            f"noise, and {left}."
        )
    elif complete:
        text = (
            f"Missing in the base model: {named}. With it the prediction error falls from {first.score.rms:.3g} to "
            f"{last.score.rms:.3g} times the noise, and {left}."
        )
    else:
        text = f"Incomplete: the misfit is still {last.score.rms:.3g} times the noise"
        text += f" with {named} added" if named else ""
        text += ", and no effect in the catalogue explains the rest."
    return Verdict(bool(complete), text)
