"""The last word: is what the model leaves noise, and which other models would have done as well?"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ..fitting import Fit, error_in_words
from ..fitting.settings import AT_NOISE, NEARLY
from .evidence import at_a_limit, most_of_noise
from .fitted_model import FittedModel
from .unnamed import Unnamed


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
    against = _elsewhere(last, here)
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


def borne_out(fits: Sequence[Fit]) -> int:
    """How many models of a search's path are kept: the last is one that misses the held-out record by no more than every model
    before it does. What fits one record and not the other is not added."""
    count = len(fits)
    while count > 1 and any(_rises(before, fits[count - 1]) for before in fits[: count - 1]):
        count -= 1
    return count


def not_added(kept: Fit, refused: Fit, names: Sequence[str]) -> str:
    """What is said of laws that the search had added and the held-out record does not bear out, nothing where there are none: a
    law that was left out stays in."""
    if not names:
        return ""
    assert kept.heldout is not None
    assert refused.heldout is not None
    them, lower = "it is" if len(names) == 1 else "they are", error_in_words(refused.score)
    return (
        f"{' and '.join(names)} would lower the error here from {kept.score.rms:.3g} to {lower}, but raise it on the held-out "
        f"record from {kept.heldout.rms:.3g} to {refused.heldout.rms:.3g}: {them} not added."
    )


def _rises(first: Fit, last: Fit) -> bool:
    """Whether the error on the held-out record is clearly larger with the second model."""
    before, after = first.heldout, last.heldout
    return before is not None and after is not None and after.rms > NEARLY * before.rms and after.median > AT_NOISE


def _elsewhere(last: Fit, here: bool) -> str:
    """What a held-out record says against a model, nothing where it says nothing against it."""
    if here and last.heldout is not None and last.heldout.median > NEARLY:
        return f"The held-out record is still missed, by {error_in_words(last.heldout)}: something else is at work there."
    return ""
