"""The search for the set of effects that explains a record: add, check what became needless, swap, and know when to stop."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from types import MappingProxyType

from ..fitting.search import ADEQUATE, silent
from .arriving import arrived
from .candidates import Candidate, may_join, rank
from .evidence import (
    AS_WELL,
    LITTLE,
    MOST,
    MUCH,
    NOISE_FLOOR,
    acts_anyway,
    at_a_bound,
    claim,
    demanded,
    excess,
    explained,
    gain,
    leaves_a_rest,
    led_on,
    measures_only,
    noise_too_large,
    shapeless,
    significance,
    worth,
)
from .joining import one_piece
from .loose import by_free_windows, judged_loose, without_soaking
from .memories import Member, families, may_replace, members
from .preference import AHEAD, advantage, lead, simplest
from .recall import recalled
from .reshaping import reshaped_at_last
from .steps import Step, leading
from .tried import LOOSER, WHOLE, follows
from .two_for_one import two_for_one
from .under_noise import delayed
from .unseen import GLIMPSED, MOST_EFFECTS, TRIED, Unseen
from .within_bounds import within_bounds
from .workbench import Trial, Workbench, adequate
from .yielding import given_at_last, gives_after_all, sharp_as_well, yielding

CLOSE, HOPEFUL = 0.9, 0.2
"""Predicted gain, as a share of the best candidate's, that earns a refit: once noise is reached, and before."""
CLEAR = 8.0
"""An effect that stands so many standard errors from zero need not be left out to see that it is missed."""


class Search(Unseen):
    """Adds effects to the joint one by one, and looks again at what it has added."""

    def __init__(
        self,
        bench: Workbench,
        progress: Callable[[str, float], None] = silent,
        seen: Callable[[Member], object] = lambda member: None,
        likely: Callable[[Trial], object] = lambda last: None,
    ) -> None:
        super().__init__(bench, progress, seen)
        self.likely = likely  # told a model that leaves but noise
        self.level: dict[tuple[str, ...], Trial] = {}
        self.gone_on: Trial | None = None  # the last model whose search was gone on with

    def base(self) -> Trial:
        """The joint alone."""
        self.progress("fitting the joint alone", 0.1)
        found = self.settle(self.keep(self.bench.fit({}, patience=WHOLE)))
        if self.bench.outright and not adequate(found):
            # A link that is not seen may be put anew at the start of every window; what it cannot do is jump between them.
            found = self.keep(self.bench.fit({}, found, through=True))
        return found

    def run(self) -> list[Step]:
        """The whole search: the path from the joint alone to the model kept."""
        steps = self.path = [Step(self.base(), None, (), ())]
        steps = self.path = self.forward(steps[0].trial, steps, MUCH)
        final = steps[-1].trial
        if noise_too_large(final) and (factor := self.bench.too_loud(final)) != 1.0:
            self.bench.quieter(factor)
            self.known.clear()
            return self.run()
        if not explained(final) or self.glimpsed(self.trim(steps)[-1].trial):
            # What acts through a state of its own is tried before what explains a little here and there.
            steps = self.with_hidden(steps)
            if not explained(steps[-1].trial):
                steps = self.forward(steps[-1].trial, steps, LITTLE)
        steps = self.path = by_free_windows(self, self.with_static(steps), MUCH)
        steps = self.path = recalled(self, one_piece(self, self.with_yielding(self.with_unseen(steps)), MUCH), MUCH)
        steps, self.level = self.swap(self.reduced(without_soaking(self, self.with_kin(steps), MUCH)))
        for asked in (within_bounds, arrived, given_at_last, reshaped_at_last, arrived):
            if (other := asked(self, steps)) is not steps:
                steps, self.level = self.swap(self.reduced(other))
        self.level |= self.kin_as_good(steps[-1].trial)
        return steps

    def trim(self, steps: list[Step]) -> list[Step]:
        """The path without its last additions where they only nibble at a misfit that nothing explains.

        What takes away little of a clear rest stands in for what else is at work; the measuring chain, which can imitate nearly
        anything a little, has to take away most. A law with states that no trajectory follows soaks up whatever is missing.
        """
        steps = list(steps)
        while len(steps) > 1 and leaves_a_rest(steps[-1].trial):
            law = self.bench.laws.get(steps[-1].added or "")
            before, after = (excess(t) for t in self.alike(steps[-2].trial, steps[-1].trial))
            least = MOST if law is not None and measures_only(law) else LITTLE
            soaks = law is not None and law.states and not adequate(steps[-1].trial) and not self.bench.outright
            if before - after > least * before and not soaks:
                break
            steps.pop()
        return steps

    def alike(self, before: Trial, after: Trial) -> tuple[Trial, Trial]:
        """Two models of a path as they compare: both with free windows where one of them has them, if that is known."""
        if after.tied and not before.tied:
            after = self.known.get((after.names, False), after)
        return before, after

    def with_hidden(self, steps: list[Step]) -> list[Step]:
        """Another path, by a law with internal states, if that explains the record in one piece and the one without does not."""
        base, final = steps[0].trial, steps[-1].trial
        tried = self.hidden(base)
        if final.names and not any(t.misfit < NOISE_FLOOR for t in tried):
            tried += self.hidden(final)
        for trial in sorted(tried, key=lambda t: t.criterion)[:2]:
            rest = not explained(final) and explained(trial)  # what free windows soak up counts for less than what is left
            if not rest and gain(self.known.get((final.names, False), final), trial) < demanded(self.bench):
                continue
            settled, dropped = self.prune(self.settle(trial))
            added = next((n for n in settled.names if self.bench.laws[n].states), None)
            if added is None:
                continue
            begun = [replace(steps[0], trial=base), Step(settled, added, dropped, ())]
            path = one_piece(self, self.forward(settled, begun, MUCH), MUCH)
            if path[-1].trial.tied and (not final.tied or path[-1].trial.criterion < final.criterion - demanded(self.bench)):
                return path
        return steps

    def with_static(self, steps: list[Step]) -> list[Step]:
        """Another path, without a law with internal states whose free windows no trajectory follows, if it ends better.

        It may do the work of several without, the first of which then did less; apart, what gives does that of dry friction.
        """
        final = steps[-1].trial
        free = self.known.get((final.names, False))
        remembers = [any(self.bench.laws[n].states for n in s.trial.names) for s in steps]
        apart = not final.tied and explained(final) and self.gives(final) is not None and not self.apart
        parted = final.tied and free is not None and not follows(final, free)
        if not remembers[-1] or not (apart or parted):
            return steps
        came = remembers.index(True)  # from there on one of its kin may have taken its place
        before = steps[came - 1]
        known = {n: self.known.get((before.trial.names | {n}, before.trial.tied)) for n in before.evidence}
        if apart:
            dry = [c for c in before.ranking if self.bench.laws[c.name].slides and self.bench.laws[c.name].port == "joint"]
            known |= {c.name: self.add(before.trial, c) for c in dry if c.gain > 0.0}
        same = {n for n in known if self.bench.laws[n].states and (apart or n in final.names)}
        helpful = self.clear(before.trial, {n: t for n, t in known.items() if t is not None and n not in same}, MUCH)
        if not helpful:
            return steps
        name = self.best(before.trial, helpful, MUCH)
        settled = self.settle(helpful[name])
        path = self.forward(settled, [*steps[:came], Step(settled, name, (), ())], MUCH)
        other = path[-1].trial
        ahead = other.tied and explained(other) and (apart or gain(final, other) > demanded(self.bench))
        return path if ahead else steps

    def with_unseen(self, steps: list[Step]) -> list[Step]:
        """The path with a law with internal states that the noise hides, where the trajectory of the last model asks for one.

        The joint's own numbers can take in most of what a flexible link does, and leave too little to be seen without simulation.
        """
        final = steps[-1].trial
        found = self.unseen(final, GLIMPSED * demanded(self.bench))
        evidence = gain(final, found[1]) if found else 0.0
        if found is None or evidence < demanded(self.bench):
            return steps
        name, trial = found
        settled, dropped = self.prune(self.settle(trial), spare=name)
        seen = replace(steps[-1], evidence={**steps[-1].evidence, name: evidence})
        return self.forward(settled, [*steps[:-1], seen, Step(settled, name, dropped, ())], MUCH)

    def with_yielding(self, steps: list[Step]) -> list[Step]:
        """The path with friction in the joint that gives, where only that makes one trajectory of the record."""
        found = yielding(self, steps[-1].trial)
        if found is None:
            return steps
        added, trial = found
        settled, dropped = self.prune(self.keep(trial), spare=added)
        path = [*leading(steps, settled), Step(settled, added, dropped, ())]
        # Which of a family it is comes first: what the wrong one leaves would ask for effects that are not there.
        kin = self.with_kin(path)
        return self.forward(settled, path, MUCH) if kin is path else kin

    def with_kin(self, steps: list[Step]) -> list[Step]:
        """Another path, where a near relative of a law with internal states explains with less beside it, or more."""
        final = steps[-1].trial
        name = self.gives(final)
        if name is None:
            return steps
        best = final
        for member in self.kindred(final, name):
            self.progress(f"trying {member.name} in place of {name}", 0.7)
            settled, _ = self.prune(self.settle(self.placed(final, member, tied=final.tied, patience=WHOLE)))
            ahead = advantage(self.bench, settled, best)
            better = settled.tied > best.tied or (settled.tied == best.tied and ahead > demanded(self.bench))
            if member.name in settled.names and better:
                best = settled
        if best is final:
            return steps
        added = next(n for n in best.names if self.bench.laws[n].states)
        return self.forward(best, [*leading(steps, best), Step(best, added, (), ())], MUCH)

    def swap(
        self, steps: list[Step], seen: Mapping[frozenset[str], float] = MappingProxyType({})
    ) -> tuple[list[Step], dict[tuple[str, ...], Trial]]:
        """One effect of the last model after the other replaced by what else would do: the better path, and what does as well.

        ``seen`` are the criteria of the models that were kept on the way, to none of which it goes back as it was.
        """
        level: dict[tuple[str, ...], Trial] = {}
        final = steps[-1].trial
        if not final.names or not final.tied or not adequate(final):
            return steps, level
        seen = {**seen, final.names: final.criterion}

        def new(trial: Trial) -> bool:
            return trial.criterion < seen.get(trial.names, math.inf) - AHEAD

        for name in sorted(final.names):
            for other in self.instead(steps, name):
                other = two_for_one(self, final, other)
                needless: tuple[str, ...] = ()
                if other.criterion - final.criterion < demanded(self.bench) and adequate(other):
                    # What does as well may do so without what took the place: where it led, the rest was stuck before.
                    other, needless = self.prune(other)
                ahead = final.criterion - other.criterion
                if new(other) and ahead > lead(self.bench, other, final, name) and adequate(other):
                    relieved = self.shaken(final)
                    if final.cost - relieved.cost > LOOSER:
                        return self.swap([*steps[:-1], self.freed(steps[-1], relieved)], seen)
                    # What stood beside the effect that is replaced may have made up for it.
                    other, gone = self.prune(other if other.done else self.finish(other))
                    if added := next(iter(sorted(other.names - final.names)), None):
                        step = Step(other, added, (*needless, *gone), ())
                    else:
                        step = replace(steps[-1], trial=other, dropped=(*steps[-1].dropped, *sorted(final.names - other.names)))
                    path = self.reduced([*steps[:-1], step])
                    if new(path[-1].trial):
                        return self.swap(path, seen)
                if -ahead < demanded(self.bench):
                    level[tuple(sorted(other.names))] = other
        return steps, level

    def reduced(self, steps: list[Step]) -> list[Step]:
        """The path with laws of its last model reduced to simpler ones that they contain, where those do as well."""
        final = steps[-1].trial
        for name in sorted(final.names):
            for other in self.bench.contained(name):
                simpler = self.simplified(final, name, other)
                richer = final if simpler.tied == final.tied else self.loosened(final)
                if gain(simpler, richer) >= demanded(self.bench):
                    simpler = self.shaken(simpler)
                # What leaves noise is not given up for what does not: the simpler one's search has stuck.
                acts = acts_anyway(self.bench, simpler, richer, name) or (explained(final) and not explained(simpler))
                if gain(simpler, richer) < demanded(self.bench) or (shapeless(final, name, self.bench.slowest) and not acts):
                    settled, dropped = self.prune(self.settle(simpler))
                    path = [*steps, Step(settled, other, (name, *dropped), ())]
                    return self.reduced(path if gain(simpler, richer) < demanded(self.bench) else gives_after_all(self, path))
        if sharp := sharp_as_well(self, final):
            settled, dropped = self.prune(self.keep(sharp[1]))
            return self.reduced([*steps, Step(settled, sharp[0], (*(final.names - sharp[1].names), *dropped), ())])
        return steps

    def instead(self, steps: list[Step], name: str) -> Iterator[Trial]:
        """One by one, models with another effect in the place of one, from the windows of the model kept.

        A law that does as well needs no other motion than that. Simpler laws that one contains were tried by `reduced`.
        """
        final = steps[-1].trial
        kept = {n: e for n, e in self.bench.effects(final).items() if n != name}
        known = next((s for s in steps if s.trial.names == frozenset(kept) and s.ranking), None)
        left = known.trial if known else self.bench.fit(kept, final, patience=10)
        ranking = known.ranking if known else tuple(rank(self.bench, left, may_join(self.bench, left)))
        own = next((c for c in ranking if c.name == name), None)
        near = [c for c in ranking if c.name not in final.names and c.gain > CLOSE * (own.gain if own else 0.0)][:2]
        if own and not self.bench.laws[name].states and at_a_bound(final, name):
            # As the limit of its shape it may stand in for any simpler law, whatever that promised far from here.
            near += [c for c in ranking if c.name not in final.names and c not in near and c.parameters < own.parameters]
        near = [c for c in near if c.name not in self.bench.laws[name].absorbs]
        near = [c for c in near if kept.keys().isdisjoint(self.bench.laws[c.name].absorbs)]
        # The quick look sees no more than free windows do: where those leave but noise without the law, it is not asked.
        if name == self.gives(final) and not explained(left):
            near = [c for c, may in zip(near, may_replace(self.bench, final, name, [c.effect for c in near])) if may]
        near = [c for c in near if not self.ruled_out(final, frozenset(kept) | {c.name})]
        for c in near:
            yield self.keep(self.joined({**kept, c.name: c.effect}, final))

    def forward(self, start: Trial, steps: list[Step], least: float) -> list[Step]:
        """Add effects one by one, dropping those that become needless, until nothing helps any more.

        ``least`` share of the misfit above noise that an addition must take away as long as a clear rest remains.
        """
        current, steps = start, list(steps)
        while len(current.names) < MOST_EFFECTS:
            self.progress("judging absent effects" if not current.names else f"with {', '.join(sorted(current.names))}", 0.3)
            if current.tied and explained(current):
                self.likely(current)
            ranking = tuple(rank(self.bench, current, may_join(self.bench, current)))
            tried = self.attempts(current, ranking)
            current, tried = judged_loose(self, current, tried, ranking)
            # Two of a family may each look better from the other, one with free windows and one without: none is kept twice.
            kept = {s.trial.names for s in steps}
            tried = self.finished(current, {n: t for n, t in tried.items() if t.names not in kept})
            if not self.helps(current, tried):
                tried = self.as_promised(current, ranking, tried)
            evidence = {n: worth(self.bench, current, t, n) for n, t in tried.items()}
            refits = {n: (current.misfit, t.misfit) for n, t in tried.items()}
            steps[-1] = replace(steps[-1], ranking=ranking, evidence=evidence, refits=refits)
            if not tried:
                break
            real = {n: t for n, t in tried.items() if not led_on(self.bench, current, t, n)}
            name = self.best(current, real or tried, least)
            if evidence[name] < demanded(self.bench) or self.nibbles(current, tried[name], least):
                break
            if delayed(self.bench, current) and self.imitated(current, tried[name]):
                break
            relieved = self.relieved(current, tried[name])
            if current.cost - relieved.cost > LOOSER:
                # What was stuck gets its turn again: what came free beside an effect is no evidence for that effect.
                steps[-1] = self.freed(steps[-1], relieved)
                current = steps[-1].trial
                continue
            if not real:
                break
            hidden = None if self.bench.laws[name].states else self.unseen(current, self.worth_a_look(current, tried[name]))
            if hidden is not None and tried[name].criterion - hidden[1].criterion > demanded(self.bench):
                # What acts through a state under the noise leaves less: it goes first.
                name, tried[hidden[0]] = hidden
                steps[-1] = replace(steps[-1], evidence={**evidence, name: gain(current, tried[name])})
            settled = self.settle(tried[name])
            if plain := self.plain(current, settled, name, self.clear(current, tried, least)):
                name = self.best(current, plain, least)
                settled = self.settle(plain[name])
            replaced = tuple(sorted(current.names - tried[name].names))
            current, dropped = self.prune(settled, spare=name)
            if current.names in kept:
                break
            steps.append(Step(current, name, replaced + dropped, ()))
        return steps

    def freed(self, step: Step, relieved: Trial) -> Step:
        """A step whose search was stuck and is no more, without what stood in for that."""
        trial, dropped = self.prune(relieved, spare=step.added)
        return replace(step, trial=trial, dropped=step.dropped + dropped)

    def helps(self, current: Trial, tried: dict[str, Trial]) -> bool:
        """Whether any of some candidates brings what is demanded."""
        return any(gain(current, t) > demanded(self.bench) for t in tried.values())

    def attempts(self, current: Trial, ranking: tuple[Candidate, ...]) -> dict[str, Trial]:
        """The likeliest candidates really refitted; few where the first already leaves nothing but noise."""
        if self.bench.outright and not self.bench.grips(current.names):
            # A link that floats says nothing of one that is held: friction at the ground is tried first, whatever its rank.
            grips = [Candidate(n, self.bench.laws[n](), 0.0, current.misfit, {}) for n in self.bench.outright]
            held = {c.name: self.add(current, c) for c in grips}
            if any(gain(current, t) > demanded(self.bench) for t in held.values()):
                return held
        telling = [c for c in ranking if self.may_help(current, c)][:TRIED]
        # Friction's memory is looked for first where no static law promises to do, there is friction that may have one, or where
        # so little is left under the noise that any law seems to do.
        looked = bool(telling) and (telling[0].predicted > ADEQUATE or self.rubs(current) or explained(current))
        tried = self.memories(current, ranking) if looked and not self.apart else {}
        tried |= self.given(current)
        # Of those that promise about as much the simplest goes first: a richer one then need not be fitted to the end.
        level = sorted((c for c in telling if c.gain >= CLOSE * telling[0].gain), key=lambda c: c.parameters)
        for c in (*level, *telling[len(level) :]):
            # Free windows, with starts to choose, say nothing of what else one trajectory lacks.
            alike = {n: t for n, t in tried.items() if t.tied or not current.tied}
            enough = any(t.misfit < NOISE_FLOOR for t in alike.values())
            if enough and any(self.bench.laws[n].states and gain(current, t) > demanded(self.bench) for n, t in alike.items()):
                break  # it was ahead of every static one before it was fitted
            # What leaves more than noise by chance may be the wrong one, however little that is.
            clean = enough and any(not leaves_a_rest(t) for t in alike.values())
            if c.gain < (CLOSE if clean else HOPEFUL) * telling[0].gain:
                continue
            self.progress(f"trying {c.name}", 0.4)
            rival = min(alike.values(), key=lambda t: t.criterion) if enough else None
            tried[c.name] = self.add(current, c, rival)
            if not looked and not explained(tried[c.name]) and not self.apart:
                tried, looked = tried | self.memories(current, ranking), True
        tried |= self.richer(current, [c for c in ranking if c.name not in tried])
        return {name: trial for name, trial in tried.items() if math.isfinite(trial.criterion)}

    def may_help(self, current: Trial, candidate: Candidate) -> bool:
        """Whether a candidate's predicted gain is half of what it must bring.

        Corners make predictions beside dry friction poor ones: there its parameters are not counted against it.
        """
        law = self.bench.laws[candidate.name]
        smooth = current.tied and adequate(current) and not (law.slides or self.dry(current))
        return self.promised(current, candidate, counted=smooth) > 0.5

    def finished(self, current: Trial, tried: dict[str, Trial]) -> dict[str, Trial]:
        """The same candidates, those fitted to the end that lie close to the best."""
        tried = self.unstuck(current, tried)
        lowest = min((t.criterion for t in tried.values()), default=0.0)
        close = [n for n, t in tried.items() if t.criterion - lowest <= (1.0 - CLOSE) * (current.criterion - lowest)]
        outdone = {n for n in close if self.outdone(n, tried)}
        self.behind |= {tried[n].names for n in outdone}
        close = [n for n in close if n not in outdone]
        undecided = len(close) > 1
        return {n: self.shaken(t if t.done else self.finish(t)) if undecided and n in close else t for n, t in tried.items()}

    def best(self, current: Trial, tried: dict[str, Trial], least: float) -> str:
        """The simplest of the candidates that do as well as any: fewest parameters, acting before measuring only."""
        # What leaves noise goes before what does not, however little is left.
        enough = {n: t for n, t in tried.items() if explained(t)}
        plain = {n: t for n, t in tried.items() if not self.soaks(n)}
        tried = enough or (plain if self.clear(current, tried, least) else tried)
        lowest = min(t.criterion for t in tried.values())
        # Among those the evidence decides; as long as more is missing, what will come changes it by shares of the whole.
        slack = demanded(self.bench) if enough else max(1.0, (1.0 - AS_WELL) * (current.criterion - lowest))
        return simplest(self.bench, tried, slack, more=not enough)

    def clear(self, current: Trial, tried: dict[str, Trial], least: float) -> dict[str, Trial]:
        """The candidates that soak up nothing and clearly help."""
        plain = {n: t for n, t in tried.items() if not self.soaks(n)}
        return {n: t for n, t in plain.items() if gain(current, t) > demanded(self.bench) and not self.nibbles(current, t, least)}

    def plain(self, current: Trial, settled: Trial, name: str, clear: dict[str, Trial]) -> dict[str, Trial]:
        """The candidates that help without a state, where one with a state soaks up what free windows leave: no trajectory
        follows it, or the one that does misses more than free windows without it. What acts without a state then goes first."""
        misled = settled.tied and not current.tied and settled.cost > current.cost and bool(self.bench.laws[name].states)
        if misled:
            return {n: t for n, t in clear.items() if not self.bench.laws[n].states}
        return clear if self.soaks(name) and not settled.tied else {}

    def nibbles(self, before: Trial, after: Trial, least: float) -> bool:
        """Whether an addition takes away only little of a misfit of which a clear rest remains."""
        return leaves_a_rest(after) and excess(before) - excess(after) < least * excess(before)

    def prune(self, trial: Trial, spare: str | None = None) -> tuple[Trial, tuple[str, ...]]:
        """The model without the effects it no longer needs."""
        dropped: list[str] = []
        while True:
            # Far from zero needs no trial; what is near is left out and fitted again.
            doubtful = [n for n in trial.names if n != spare and significance(trial, n) < CLEAR]
            simpler = {n: self.without(trial, n) for n in doubtful}
            # A model with as many parameters is another one, not a simpler one, unless what gives way adds nothing to the one.
            fewer = [n for n, t in simpler.items() if len(t.free) < len(trial.free)]
            idle = [n for n in doubtful if n not in fewer and claim(trial, n) < demanded(self.bench)]
            losses = {n: gain(simpler[n], trial) for n in (*fewer, *idle)}
            losses |= {n: min(loss, 0.0) for n, loss in losses.items() if led_on(self.bench, simpler[n], trial, n)}
            needless = [n for n, loss in losses.items() if loss < demanded(self.bench)]
            if not needless:
                return trial, tuple(dropped)
            name = min(needless, key=lambda n: losses[n])
            trial = self.settle(simpler[name])
            dropped.append(name)

    def hidden(self, start: Trial) -> list[Trial]:
        """Models with a law that has internal states beside those of ``start``, the likeliest of a family, until one explains."""
        found: list[Trial] = []
        if self.bench.outright and not self.bench.grips(start.names):
            return found  # a link that is not seen and floats follows anything in windows apart
        for names in families(self.bench).values():
            # Friction's memory was looked for at every stage; here it is the last resort.
            if start.names.isdisjoint(names) and not explained(start):
                found += [self.placed(start, m, tied=False) for m in members(self.bench, start, names)[:1]]
        for name, law in self.bench.laws.items():
            if not law.states or law.family or name in start.names or any(t.misfit < NOISE_FLOOR for t in found):
                continue
            guesses = law.guesses(start.system, self.bench.quick.motion)
            self.progress(f"trying {name}", 0.6)
            for effect in self.bench.quick.choose(start.system, start.free, guesses, keep=2):
                found.append(self.keep(self.bench.fit({**self.bench.effects(start), name: effect}, start, tied=False)))
                if found[-1].misfit < NOISE_FLOOR:
                    break
        return found
