"""What a law with internal states has to say where noise hides it: looked for beside models that explain without it."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from ..fitting.search import silent
from ..mechanics import AbstractEffect
from ..parameters import free_specs, values, with_values
from .candidates import Candidate, reshaped
from .evidence import demanded, explained, measures_only
from .memories import Member, families, members, without
from .tried import LOOSER, WHOLE, Tried
from .tuning import Rival, Tuned, apart, at_level, level, told
from .under_noise import as_if_right, blurred, changes, own_rest, promises
from .workbench import Trial, Workbench, adequate, strengths

TRIED = 4
"""Candidates that are really refitted at every stage."""
MOST_EFFECTS = 5
"""A model with more effects than this is no explanation any more."""
GLIMPSED = 2.0
"""How many times what is demanded of an addition the quick look must show before such a law is tried beside what explains."""
DRAWS = 4
"""Draws of the noise that may speak for such a law where there is none."""
LIKELY, HALF = 2, 0.5
"""Guesses of such a law that are fitted at most, and share of a gain that is enough to promise where more may come of it."""
KEPT = 0.1
"""Share of what such a law promises that its first fit must bring for its search to go on."""


class Unseen(Tried):
    """Looks for laws with internal states under the noise; ``seen`` is told those of a family that may come in."""

    def __init__(
        self, bench: Workbench, progress: Callable[[str, float], None] = silent,
        seen: Callable[[Member], object] = lambda member: None,
    ) -> None:  # fmt: skip
        super().__init__(bench, progress)
        self.seen = seen

    def memories(self, current: Trial, ranking: tuple[Candidate, ...]) -> dict[str, Trial]:
        """Models with a law of friction that gives before it slips, where the quick look puts it before every static one.

        It stands in place of dry friction in the joint, and of its own kin: what is to stand beside one such law has to do
        better than another of its family alone.
        """
        rivals = [apart(c.effect, strengths(c.effect)) for c in ranking[:TRIED] if c.gain > 0.0]
        quiet = current.tied and explained(current)
        found: dict[str, Trial] = {}
        for names in families(self.bench).values():
            likely = members(self.bench, current, names, rivals, (lambda member: None) if quiet else self.seen)
            if not likely:
                continue
            first = likely[0]
            if quiet and first.kin is None and self.by_noise(current, first, rivals):
                continue
            if quiet:
                self.seen(first)
            found[first.name] = self.placed(current, first, tied=current.tied)
        return found

    def kindred(self, trial: Trial, name: str) -> list[Member]:
        """Near relatives of a model's law with a memory that may do better in its place.

        The quick look is asked where there is more than that law to the model, or something missing still. Noise makes it
        blind to how a knee is rounded long before one trajectory is.
        """
        family = families(self.bench)[self.bench.laws[name].family or ""]
        found = [] if explained(trial) and len(trial.names) == 1 else members(self.bench, trial, family)
        if not trial.tied or not adequate(trial) or self.bench.outright or self.bench.quick.blind:
            return found
        self.progress(f"looking for kin of {name} under the noise", 0.65)
        others = [n for n in family if n not in (name, *(m.name for m in found))]
        beside, _, _ = without(self.bench, trial, name)
        for other, fall, law in changes(self.bench, trial, name, others, demanded(self.bench)):
            found.append(Member(other, beside, Tuned(law, trial.system, np.zeros(0), len(free_specs(law))), fall, name))
        return found

    def kin_as_good(self, final: Trial) -> dict[tuple[str, ...], Trial]:
        """Models fitted on the way that do as well as the last one with a near relative of its law with a memory."""
        if not final.tied:
            return {}
        kin = [final.names - {n} | {o} for f in families(self.bench).values() for n in final.names.intersection(f) for o in f]
        tried = [self.known[names, True] for names in kin if names != final.names and (names, True) in self.known]
        good = [t for t in tried if adequate(t) and t.criterion - final.criterion < demanded(self.bench)]
        return {tuple(sorted(t.names)): t for t in good}

    def unseen(self, trial: Trial, least: float) -> tuple[str, Trial] | None:
        """The best model with a law with internal states, by name, beside one fitted trajectory, if the law promises to take
        ``least`` off the sum of squares."""
        if not trial.tied or not adequate(trial) or self.bench.outright or len(trial.names) >= MOST_EFFECTS:
            return None
        found: list[tuple[str, Trial]] = []
        for name, law in self.bench.laws.items():
            if not law.states or law.family or name in trial.names:
                continue
            self.progress(f"looking for {name} under the noise", 0.65)
            parameters = len(free_specs(law())) * math.log(self.bench.record.samples)
            worth = max(least, HALF * (demanded(self.bench) + parameters))
            telling = promises(self.bench, trial, law, worth)
            own: list[Trial] = []
            # Its frequency is a guess, and what is fitted from one need not be the best there is.
            for fall, effect in telling[:LIKELY]:
                if fall > max(worth, HALF * telling[0][0]):
                    effects = {**self.bench.effects(trial), name: effect}
                    fitted = self.bench.fit(effects, trial, tied=True, followed=True, patience=WHOLE)
                    # One long trajectory has many minima; a law that is there comes at once to one that is worth going on from.
                    if 2.0 * (trial.cost - fitted.cost) > KEPT * fall:
                        own.append(self.keep(self.retied(fitted)))
            strong = min(self.loaded(trial, name) if own else (), key=lambda t: t.cost, default=None)
            if strong is not None and strong.cost < min(t.cost for t in own) - LOOSER:
                own.append(self.keep(self.retied(strong)))
            found += [(name, one) for one in own]
        best = min(found, key=lambda one: one[1].criterion, default=None)
        return None if best is None or self.imitated(trial, best[1]) else best

    def loaded(self, trial: Trial, name: str) -> list[Trial]:
        """Models with a law that loads the link, begun as strong as its guesses, with all torques as strong as that asks for.

        A second inertia goes along with the link where that moves slowly, and is taken for a joint that is less stiff, by a
        quarter for a heavy one: what little it does at first says nothing of that, and no small step leads there.
        """
        begun: list[Trial] = []
        weighed = self.bench.windows.by_force  # where the force is known, so is all that it moves
        for guess in [] if weighed else self.bench.laws[name].guesses(trial.system, self.bench.quick.motion):
            factor = guess.loading(float(trial.system.inertia))
            if factor == 1.0:
                continue
            present, effects = values(trial.system), self.bench.effects(trial)
            joint = with_values(trial.system, {n: factor * present[n] for n in ("stiffness", "damping") if n in present})
            others = {n: e if measures_only(self.bench.laws[n]) else e.scaled(factor) for n, e in effects.items()}
            self.progress(f"trying a strong {name}", 0.66)
            begun.append(self.bench.fit({**others, name: guess}, trial, joint=joint, tied=True, followed=True))
        return begun

    def by_noise(self, current: Trial, member: Member, rivals: list[Rival]) -> bool:
        """Whether a law seems to bring as much beside a tied trial where that is right, in any of some draws of the noise.

        Near rest the noise of the motion may speak for any friction that gives, and by a lot.
        """
        for bench in as_if_right(self.bench, current, DRAWS):
            drawn = members(bench, current, [member.name], rivals)
            if drawn and member.lead - drawn[0].lead < demanded(self.bench):
                return True
        return False

    def given(self, trial: Trial) -> dict[str, Trial]:
        """The model with friction that gives in place of its dry friction in the joint, by name, where noise hides from the quick
        look which of them it is: one trajectory tells them apart long before."""
        dry = self.dry_in_joint(trial)
        if dry is None or not trial.tied or not adequate(trial):
            return {}
        found: dict[str, Trial] = {}
        beside, _, _ = without(self.bench, trial, dry)
        for name in (names[0] for names in families(self.bench).values()):
            key = frozenset(beside) | {name}, True
            if not (laws := self.untold(trial, dry, name)):
                continue
            for law in laws[:LIKELY] if key not in self.known else []:
                self.progress(f"trying {name} in place of {dry}", 0.45)
                self.keep(self.bench.fit({**beside, name: law}, trial, tied=True, followed=True, patience=WHOLE))
            found[name] = self.known[key]
        return found

    def richer(self, current: Trial, others: list[Candidate]) -> dict[str, Trial]:
        """Models with a law in place of a simpler one that it contains, by name.

        Beside a law that sticks its richer relative is judged badly from outside: it is tried unless the quick look could tell,
        and even then if the trajectory promises it, at the shape that the trajectory asks for.
        """
        found: dict[str, Trial] = {}
        for c in others:
            simpler = sorted(current.names.intersection(self.bench.laws[c.name].absorbs))
            if not simpler:
                continue
            quiet = explained(current)
            other = reshaped(self.bench, current, c.name) if quiet and current.tied else None
            untold = other is not None and self.untold(current, simpler[0], c.name)
            if quiet and not untold:
                if other is not None and self.promised(current, other) > 1.0:
                    found[c.name] = self.add(current, other)
                continue
            found[c.name] = self.add(current, c)
            # Nor does the quick look then know its shape, and from a wrong one a search may not come back.
            if other is not None and found[c.name].tied and other.gain > 2.0 * (current.cost - found[c.name].cost):
                found[c.name] = self.keep(self.bench.fit(self.with_one_more(current, other), current, tied=True))
        return found

    def untold(self, trial: Trial, dry: str, name: str) -> list[AbstractEffect]:
        """Guesses of a law of friction at the level of a model's dry friction; none where the quick look tells them apart."""
        friction, quick = trial.system.effects[dry], self.bench.quick
        if not (size := level(friction)) > 0.0 or quick.blind:
            return []
        _, system, free = without(self.bench, trial, dry)
        laws = at_level(self.bench.laws[name].guesses(system, quick.motion), size)
        least = demanded(self.bench) + np.log(self.bench.record.samples)
        return laws if laws and told(quick, free, laws[0], system, friction) <= GLIMPSED * least else []

    def imitated(self, before: Trial, after: Trial) -> bool:
        """Whether a sensor that averages over a short time explains as much as an addition to a model that leaves little."""
        if not (before.tied and after.tied and explained(before)):
            return False
        return 2.0 * (before.cost - after.cost) < blurred(self.bench, before) + demanded(self.bench)

    def worth_a_look(self, before: Trial, after: Trial) -> float:
        """What a law with internal states must promise in the place of an addition: the promise of a guess is a part of it."""
        return max(GLIMPSED * demanded(self.bench), HALF * 2.0 * (before.cost - after.cost))

    def glimpsed(self, trial: Trial) -> bool:
        """Whether the quick look sees a law with internal states that noise alone would hardly show.

        The joint's own numbers can take in most of what a flexible link does, and leave too little to look unexplained.
        """
        laws = [law for name, law in self.bench.laws.items() if law.states and not law.family and name not in trial.names]

        def seen(known: np.ndarray | None = None) -> bool:
            quick, here = self.bench.quick, trial.system
            evidence = [quick.evidence(here, trial.free, law.guesses(here, quick.motion), known) for law in laws]
            return max(evidence, default=0.0) > GLIMPSED * demanded(self.bench)

        return seen() and (not trial.tied or seen(own_rest(self.bench, trial)))
