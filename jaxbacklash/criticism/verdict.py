"""The last word: is what the model leaves noise, and which other models would have done as well?"""

from __future__ import annotations

from dataclasses import dataclass

from ..fitting import Fit, error_in_words
from ..fitting.chance import NEARLY
from .evidence import at_a_limit, most_of_noise
from .fitted_model import FittedModel
from .unnamed import Unnamed

AT_NOISE = 1.05
"""Error of the median window of a held-out record, over the noise, up to which a larger error there speaks of a few windows,
which may begin where no start can be told, and not against what was added."""


@dataclass(frozen=True)
class Verdict:
    """``complete`` when what is left is noise, on a held-out record too where there is one; ``text`` says so, and what speaks
    against it; ``here`` whether it is noise on the record itself."""

    complete: bool
    text: str
    here: bool

    @property
    def word(self) -> str:
        return "complete" if self.complete else "incomplete"


def judge_rest(final: FittedModel, fits: list[Fit], beyond: Unnamed | None = None) -> Verdict:
    """Whether the last model leaves nothing but noise; ``beyond`` is a torque outside the catalogue that it clearly asks for."""
    first, last = fits[0], fits[-1]
    most = most_of_noise(final)
    strained = [name for name in sorted(final.names) if at_a_limit(final, name)]
    here = final.misfit < most and last.score.median < NEARLY and not strained and beyond is None
    against = _elsewhere(first, last, here)
    if here:
        return Verdict(not against, _what_explains(final, first, last, against), here)
    added = f" with {', '.join(sorted(final.names))} added" if final.names else ""
    if beyond is not None and final.misfit < most:
        text = (
            f"Incomplete: the prediction error is {error_in_words(last.score)}{added}, but what is left is not noise "
            f"alone: a torque that goes with {beyond.words} would clearly lower it (evidence {beyond.fall:.0f}), and no effect "
            "in the catalogue exerts that."
        )
    else:
        text = f"Incomplete: the misfit is still {error_in_words(last.score)}{added}"
        if most < final.misfit < NEARLY:
            text += f" ({final.misfit:.3f} over the whole record, of which noise explains {most:.3f} at most)"
        text += ", and no effect in the catalogue explains the rest."
        if strained:
            text += f" {' and '.join(strained)} at the end of its range: more likely it stands in for something else."
    return Verdict(False, f"{text} {against}".rstrip(), here)


def _what_explains(final: FittedModel, first: Fit, last: Fit, against: str) -> str:
    """What is said of a model that leaves but noise on the record, and what a held-out one has ``against`` it."""
    left = "what is left is noise"
    if last.score.rms > NEARLY:
        left += f" but in a few windows (the median window is off by {last.score.median:.2f} times the noise)"
    named, error = ", ".join(sorted(final.names)), error_in_words(last.score)
    if against:
        have = f"{named} added" if named else "play, stiffness and damping alone"
        return f"Incomplete: with {have} the prediction error is {error} on this record, but not on the held-out one. {against}"
    if not named:
        have = "The joint's play, stiffness and damping explain the record"
        return f"{have}: the prediction error is {error}, and {left}.{_few(last)}"
    fell = f"the prediction error falls from {first.score.rms:.3g} to {error}"
    return f"Missing in the base model: {named}. With {'it' if len(final.names) == 1 else 'them'} {fell}, and {left}.{_few(last)}"


def _few(last: Fit) -> str:
    """What is said where a held-out record ends at the noise but in a few windows."""
    held = last.heldout
    if held is None or held.rms <= NEARLY * max(NEARLY, last.score.rms):
        return ""
    return (
        f" On the held-out record a few windows are missed (its error is {error_in_words(held)}, in the median window "
        f"{held.median:.2f})."
    )


def _elsewhere(first: Fit, last: Fit, here: bool) -> str:
    """What a held-out record says against a model, nothing where it says nothing against it."""
    before, after = first.heldout, last.heldout
    if before is None or after is None:
        return ""
    if last is not first and after.rms > NEARLY * before.rms and after.median > AT_NOISE:
        rises = f"On the held-out record the error rises from {before.rms:.3g} to {error_in_words(after)}: "
        return rises + "what was added stands in for something else."
    if here and after.median > NEARLY:
        return f"The held-out record is still missed, by {error_in_words(after)}: something else is at work there."
    return ""
