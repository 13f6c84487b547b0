"""The last word: is what the model leaves noise, and which other models would have done as well?"""

from __future__ import annotations

from dataclasses import dataclass

from ..fitting import Fit
from .candidates import rank
from .search import CLOSE, Search, Step, demanded
from .workbench import Trial, Workbench

NEAR_NOISE = 1.05
"""Root of the reduced chi-square of a tied fit up to which what is left counts as noise, since the noise itself is estimated."""
WHITE = 1.3
"""Samples of the residual that count for one, up to which it counts as white."""


@dataclass(frozen=True)
class Verdict:
    """``complete`` when what is left is noise; ``text`` says so in one or two sentences."""

    complete: bool
    text: str

    @property
    def word(self) -> str:
        return "complete" if self.complete else "incomplete"


def judge_rest(bench: Workbench, final: Trial, fits: list[Fit]) -> Verdict:
    """Whether the last model leaves nothing but noise."""
    first, last = fits[0], fits[-1]
    complete = final.tied and final.misfit < NEAR_NOISE and last.score.median < 1.1
    named = ", ".join(sorted(final.names))
    if complete and not final.names:
        text = f"The joint's play, stiffness and damping explain the record: what is left is noise ({last.score.rms:.2f} of it)."
    elif complete:
        text = (
            f"Missing in the base model: {named}. With it the prediction error falls from {first.score.rms:.3g} to "
            f"{last.score.rms:.3g} times the noise, and what is left is noise."
        )
    else:
        text = f"Incomplete: the misfit is still {last.score.rms:.3g} times the noise"
        text += f" with {named} added" if named else ""
        text += ", and no effect in the catalogue explains the rest."
    return Verdict(bool(complete), text)


def alternatives(search: Search, path: list[Step]) -> tuple[tuple[str, ...], ...]:
    """Other sets of as many effects whose criterion is as good, within what chance may do."""
    final = path[-1].trial
    if not final.names or not final.tied:
        return ()
    bench, found = search.bench, {}
    for name in final.names:
        kept = {n: e for n, e in bench.effects(final).items() if n != name}
        ranking = next((s.ranking for s in path if s.trial.names == frozenset(kept)), None)
        if ranking is None:
            ranking = tuple(rank(bench, bench.fit(kept, final, patience=10)))
        own = next((c.gain for c in ranking if c.name == name), 0.0)
        for c in [c for c in ranking if c.name not in final.names and c.gain > CLOSE * own][:2]:
            # From the windows of the model kept: another law that does as well needs no other motion.
            other = bench.fit({**kept, c.name: c.effect}, final, tied=True, patience=12)
            if other.criterion - final.criterion < demanded(bench):
                found[tuple(sorted(other.names))] = other.criterion
    return tuple(sorted(found, key=lambda names: found[names]))
