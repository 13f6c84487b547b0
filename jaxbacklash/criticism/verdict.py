"""The last word: is what the model leaves noise, and which other models would have done as well?"""

from __future__ import annotations

from dataclasses import dataclass

from ..fitting import Fit
from .evidence import at_a_limit, most_of_noise
from .unnamed import Unnamed
from .workbench import Trial

LITTLE_MORE = 1.1
"""A misfit below this looks like noise, so that a verdict against it says what noise would leave."""
WORSE = 1.1
"""Growth of the error on a held-out record from which what was added does not hold there."""


@dataclass(frozen=True)
class Verdict:
    """``complete`` when what is left is noise; ``text`` says so, and what a held-out record says against it."""

    complete: bool
    text: str

    @property
    def word(self) -> str:
        return "complete" if self.complete else "incomplete"


def judge_rest(final: Trial, fits: list[Fit], beyond: Unnamed | None = None) -> Verdict:
    """Whether the last model leaves nothing but noise; ``beyond`` is a torque outside the catalogue that it clearly asks for."""
    first, last = fits[0], fits[-1]
    most = most_of_noise(final)
    strained = [name for name in sorted(final.names) if at_a_limit(final, name)]
    complete = final.misfit < most and last.score.median < 1.1 and not strained and beyond is None
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
    elif beyond is not None and final.misfit < most:
        text = f"Incomplete: the prediction error is {last.score.rms:.3g} times the noise"
        text += f" with {named} added" if named else ""
        text += (
            f", but what is left is not noise alone: a torque that goes with {beyond.words} would clearly lower it (evidence "
            f"{beyond.fall:.0f}), and no effect in the catalogue exerts that."
        )
    else:
        text = f"Incomplete: the misfit is still {last.score.rms:.3g} times the noise"
        text += f" with {named} added" if named else ""
        if most < final.misfit < LITTLE_MORE:
            text += f" ({final.misfit:.3f} over the whole record, of which noise explains {most:.3f} at most)"
        text += ", and no effect in the catalogue explains the rest."
        if strained:
            text += f" {' and '.join(strained)} at the end of its range: more likely it stands in for something else."
    return Verdict(bool(complete), text + _elsewhere(first, last, complete))


def _elsewhere(first: Fit, last: Fit, complete: bool) -> str:
    """What a held-out record says against a model, nothing where it says nothing against it."""
    before, after = first.heldout, last.heldout
    if before is None or after is None:
        return ""
    if last is not first and after.rms > WORSE * before.rms:
        rises = f" On the held-out record the error rises from {before.rms:.3g} to {after.rms:.3g} times the noise: "
        return rises + ("there it does not hold." if complete else "what was added stands in for something else.")
    if complete and after.median > LITTLE_MORE:
        return f" The held-out record is still missed, by {after.rms:.3g} times the noise: something else is at work there."
    return ""
