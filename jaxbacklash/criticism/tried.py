"""Every model of a record that a search has fitted: none is fitted twice."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from ..fitting.search import silent
from ..mechanics import AbstractEffect
from ..parameters import specs, values, with_values
from .candidates import Candidate, contained, rubs
from .cuts import cut_free
from .evidence import demanded, explained, gain, significance
from .memories import Member
from .steps import Step
from .workbench import PATIENCE, Trial, Workbench, adequate, strengths

STUCK = 1.01
"""A tied fit that misses by so much more than its free windows has stuck, or their freedom hides what the model lacks."""
SLIGHT, BARELY = 0.03, 1e-4
"""Share of its predicted strength at which an effect begins where from the whole of it the fit has stuck, and where it promises
little beside one trajectory, which so much does not bend."""
ROUGH = 1.0
"""How much of half the sum of squares may be left to gain by a model that can hardly be chosen."""
BROUGHT = 0.5
"""Share of what a candidate promised that it brings at least where its search has arrived."""
LOOSER = 1.0
"""A fit that comes out so much lower when it is given its turn again had stuck."""
ROUNDS, CLEARLY = 8, 0.97
"""How often a search goes on or begins again, and the share of the misfit that must remain at most for it to go on."""
WHOLE = 60
"""Linearisations allowed to a model that is kept."""


def follows(tied: Trial, free: Trial) -> bool:
    """Whether a tied fit misses by hardly more than its free windows."""
    return adequate(tied) and tied.misfit < STUCK * free.misfit


class Tried:
    """Models by the names of their effects and by whether their windows are tied, each with the best fit of it so far."""

    def __init__(self, bench: Workbench, progress: Callable[[str, float], None] = silent) -> None:
        self.bench, self.progress = bench, progress
        self.known: dict[tuple[frozenset[str], bool], Trial] = {}
        self.path: list[Step] = []  # as far as a search has come
        self.asked: set[frozenset[str]] = set()  # models that were to be tied with cuts
        self.shook: set[frozenset[str]] = set()  # models that were begun again where dry friction may hold them
        self.passed: set[tuple[frozenset[str], frozenset[str], bool]] = set()  # models begun again from one they contain
        self.behind: set[frozenset[str]] = set()  # models not fitted on, as a simpler law is ahead on free windows
        self.apart = False  # windows are left free, and laws with states out of it

    def settle(self, trial: Trial) -> Trial:
        """The trial finished, and its windows tied where it is good enough for that."""
        if self.apart:
            return trial if trial.done else self.finish(trial)
        if not trial.tied and not trial.done and not adequate(trial):
            trial = self.finish(trial)  # what is still on its way may come to be good enough
        if not trial.tied and adequate(trial):
            tied = self.bench.fit(self.bench.effects(trial), trial, tied=True, patience=WHOLE)
            if follows(tied, trial):
                return self.keep(tied if tied.done or trial.done or not self.dry(tied) else self.tied_anew(tied, trial))
            if (through := self.let_go(trial)) is not None:
                return through
            if adequate(tied) and not tied.done and not self.dry(tied):
                tied = self.finish(tied)
            # A tied search that has stuck at corners tells nothing about the model.
            if adequate(tied) and (tied.done or not self.dry(tied)):
                return self.keep(tied)
        return trial if trial.done else self.finish(trial)

    def tied_anew(self, tied: Trial, free: Trial) -> Trial:
        """A tied model whose search has stuck at a corner of dry friction or, where that is better, the same from free windows
        that have arrived."""
        free = self.finish(free)
        return min(tied, self.bench.fit(self.bench.effects(free), free, tied=True, patience=WHOLE), key=lambda t: t.cost)

    def let_go(self, free: Trial) -> Trial | None:
        """The same model tied by way of cuts where dry friction does not let the search through, if that helps.

        From there the whole trajectory may be in reach. If it is not, every model of the record is tied with these cuts from
        then on, so that they remain comparable.
        """
        asked = free.names in self.asked or not self.dry(free) or self.bench.is_cut
        if not asked and not free.done:  # windows that are still on their way are not where friction holds
            free = self.finish(free)
        ties = None if asked else cut_free(self.bench, free)
        self.asked.add(free.names)
        if ties is None:
            return None
        self.progress("letting go of windows that friction holds", 0.5)
        self.bench.cut(ties)
        parted = self.bench.fit(self.bench.effects(free), free, tied=True, patience=WHOLE)
        self.bench.cut(self.bench.ties)
        if not follows(parted, free):
            return None
        whole = self.bench.fit(self.bench.effects(parted), parted, tied=True, patience=WHOLE)
        if follows(whole, free):
            return self.keep(whole)
        self.bench.cut(ties)
        self.known = {key: trial for key, trial in self.known.items() if not trial.tied}
        return self.keep(parted)

    def add(self, before: Trial, candidate: Candidate, rival: Trial | None = None) -> Trial:
        """The model with one more effect, in place of simpler laws it contains, fitted as the model before was: tied or free.

        Beside a ``rival`` with fewer parameters its free windows are only fitted until it is clear that it does not replace that.
        """
        effects = self.with_one_more(before, candidate)
        names = frozenset(effects)
        key = (names, before.tied or self.bench.grips(names))
        if key not in self.known or self.stuck_elsewhere(self.known[key], before):
            start = before
            if rival is not None and not key[1]:
                start = self.bench.fit(effects, before, near=ROUGH)
                # What is left to gain is less than half of that lead.
                behind = start.criterion - rival.criterion > 2.0 * demanded(self.bench) and start.cost < before.cost
                if (behind and len(start.free) > len(rival.free)) or (not start.done and start.cost < before.cost):
                    return self.keep(start)  # what has run out of patience has had as much as any other
            if not before.tied:
                trial = self.keep(self.bench.fit(effects, start))
            elif names > before.names and self.promised(before, candidate) < 1.0 and not self.bench.is_cut:
                # One search is enough, from where the model before has arrived: if that has stuck, an addition that does nothing
                # else may bring it on.
                barely = {**effects, candidate.name: effects[candidate.name].scaled(BARELY)}
                return self.keep(self.bench.fit(barely, before, tied=True))
            else:
                trial = self.keep(self.joined(effects, before))
            if trial.cost > before.cost and names > before.names:
                # The larger model holds the smaller one: it has stuck on the way from the strength that was predicted.
                slight = {**effects, candidate.name: effects[candidate.name].scaled(SLIGHT)}
                self.keep(self.bench.fit(slight, before, tied=before.tied))
        return self.known[key]

    def stuck_elsewhere(self, known: Trial, before: Trial) -> bool:
        """Whether a model that contains another costs more than that, as far as it was fitted; true once for each two, since
        beginning again there need not help."""
        if known.tied != before.tied or not known.cost > before.cost:
            return False
        two = known.names, before.names, known.tied
        new = two not in self.passed
        self.passed.add(two)
        return new

    def with_one_more(self, before: Trial, candidate: Candidate) -> dict[str, AbstractEffect]:
        """The effects of a model with one more, in place of simpler laws that it contains and whose strength it takes over."""
        effect, law = candidate.effect, type(candidate.effect)
        present = {n: e for n, e in self.bench.effects(before).items() if n not in law.absorbs}
        held = max(map(abs, contained(self.bench, before, law).values()), default=0.0)
        return {**present, candidate.name: with_values(effect, {n: values(effect)[n] + held for n in strengths(effect)})}

    def promised(self, before: Trial, candidate: Candidate, *, counted: bool = True) -> float:
        """What a candidate is predicted to bring, as a share of what it must; ``counted`` says that it must outweigh its own
        parameters too."""
        own = len(strengths(candidate.effect)) * math.log(max(self.bench.record.samples, 2)) if counted else 0.0
        return candidate.gain / (max(1.0, before.misfit**2) * before.correlation * (demanded(self.bench) + own))

    def joined(self, effects: dict[str, AbstractEffect], before: Trial, patience: int = PATIENCE) -> Trial:
        """A tied fit from the windows of another model; where it sticks, as dry friction may, or creeps along a curved valley,
        its windows are let go first."""
        trial = self.bench.fit(effects, before, tied=True, patience=patience)
        better = trial.misfit < (STUCK if trial.done else 1.0) * before.misfit
        if self.bench.is_cut and gain(before, trial) < demanded(self.bench):
            # Where friction held the link, a search from a simpler model's windows ends near that: no gain there says nothing.
            free = self.keep(self.bench.fit(self.bench.effects(trial), trial, patience=WHOLE))
            again = self.bench.fit(self.bench.effects(free), free, tied=True, patience=WHOLE)
            return min(trial, self.softly(again), key=lambda t: t.cost)
        if better and (trial.done or self.dry(trial)):
            return trial
        free = self.keep(self.bench.fit(effects, before, tied=False))
        again = self.bench.fit(self.bench.effects(free), free, tied=True, patience=patience)
        best = min(trial, again, key=lambda t: t.cost)
        if better or follows(best, free):
            return best
        # Friction that remembers bends the valley: many steps lead round where dry friction's corners would stop them.
        return self.finish(self.keep(best), before.cost) if adequate(free) and not self.dry(best) else self.softly(best)

    def retied(self, tied: Trial) -> Trial:
        """A tied model or, where that is better, the same by way of free windows: one long trajectory has many minima."""
        for _ in range(ROUNDS):
            free = self.keep(self.bench.fit(self.bench.effects(tied), tied, patience=WHOLE))
            effects = self.bench.effects(free)
            again = self.bench.fit(effects, free, tied=True, patience=WHOLE)
            if not tied.cost - again.cost > LOOSER:
                # States that free windows chose for themselves may lead one trajectory astray where their law is right.
                anew = self.bench.fit(effects, tied, joint=free.system, tied=True, followed=True, patience=WHOLE)
                again = min(again, anew, key=lambda t: t.cost)
            if not tied.cost - again.cost > LOOSER:
                break
            tied = again
        return min(tied, again, key=lambda t: t.cost)

    def renewed(self, trial: Trial) -> Trial:
        """A free fit with dry friction begun again from its own parameters and the data, as long as that clearly helps.

        Windows that come from a model without that friction may stick where the link would rest, and hold the parameters back.
        """
        for _ in range(ROUNDS):
            if trial.tied or explained(trial) or not self.may_stick(trial):
                break
            again = self.begun_again(trial)
            if not again.misfit < CLEARLY * trial.misfit:
                break
            trial = self.keep(again)
        return trial

    def begun_again(self, trial: Trial) -> Trial:
        """The same model from its own parameters and the data, not from where any windows are."""
        self.progress(f"beginning again: {', '.join(sorted(trial.names))}", 0.45)
        return self.bench.fit(self.bench.effects(trial), joint=trial.system, tied=trial.tied, patience=WHOLE)

    def may_stick(self, trial: Trial) -> bool:
        """Whether a search may stick at corners of dry friction; one of a link that is held to the ground goes another way."""
        return self.dry(trial) and not self.bench.grips(trial.names)

    def unstuck(self, before: Trial, tried: dict[str, Trial]) -> dict[str, Trial]:
        """The same candidates, the best of those with dry friction that help `renewed`."""
        rubbing = [n for n, t in tried.items() if self.dry(t) and gain(before, t) > demanded(self.bench)]
        best = min(rubbing, key=lambda n: tried[n].criterion, default=None)
        return tried if best is None else {**tried, best: self.renewed(tried[best])}

    def as_promised(self, before: Trial, ranking: Sequence[Candidate], tried: dict[str, Trial]) -> dict[str, Trial]:
        """The same candidates; of those with dry friction that promised enough, and brought not half of it beside one trajectory,
        the likeliest `shaken`: its search has stuck at corners on the way."""

        def short(candidate: Candidate) -> bool:
            after = tried.get(candidate.name)
            stuck = after is not None and after.tied and self.may_stick(after)
            fell = 2.0 * (before.cost - after.cost) if after is not None else 0.0
            return stuck and fell < BROUGHT * candidate.gain and self.promised(before, candidate) > 1.0

        first = next((c.name for c in ranking if short(c)), None) if before.tied else None
        return tried if first is None else {**tried, first: self.shaken(tried[first])}

    def loosened(self, trial: Trial) -> Trial:
        """The same model with its windows free."""
        key = (trial.names, False)
        if key not in self.known:
            self.keep(self.bench.fit(self.bench.effects(trial), trial, tied=False))
        return self.known[key]

    def without(self, before: Trial, name: str) -> Trial:
        """The model without one of its effects, fitted from the model with it unless what is known of it is near that."""
        names = before.names - {name}
        key = (names, before.tied and self.bench.grips(names) == self.bench.grips(before.names))
        far = before.cost + significance(before, name) ** 2
        if key not in self.known or self.known[key].cost > far:
            effects = {n: e for n, e in self.bench.effects(before).items() if n != name}
            trial = self.keep(self.bench.fit(effects, before, tied=key[1]))
            if not trial.done and trial.cost > far:
                self.finish(trial, before.cost)  # it is still on its way round the bend that the effect has left
        return self.known[key]

    def relieved(self, before: Trial, after: Trial) -> Trial:
        """A model whose search may have stuck, given its turn again before a larger one or a richer law takes its place.

        Dry friction makes the cost of one trajectory jagged, a long trajectory has many minima, and some searches end before
        they have arrived: an addition that does nothing else may bring them on.
        """
        if not (before.tied and after.tied):
            return before
        more = after.names - before.names
        beside = self.without(after, next(iter(more))) if len(more) == 1 and before.names < after.names else before
        # What is fitted to windows apart is no match for one trajectory: so is a link that floats, once its friction is left out.
        return self.shaken(min((t for t in (before, beside) if t.tied), key=lambda t: t.cost))

    def dry(self, trial: Trial) -> bool:
        """Whether a model has dry friction, whose corners a search may stick at."""
        return any(self.bench.laws[name].slides for name in trial.names)

    def dry_in_joint(self, trial: Trial) -> str | None:
        """Name of a model's dry friction in the joint, None without."""
        return next((n for n in sorted(trial.names) if self.bench.laws[n].slides and self.bench.laws[n].port == "joint"), None)

    def gives(self, trial: Trial) -> str | None:
        """Name of a model's friction that gives before it slips, None without."""
        return next((n for n in sorted(trial.names) if self.bench.laws[n].states and self.bench.laws[n].family), None)

    def soaks(self, name: str) -> bool:
        """Whether a law brings free windows states to choose, which soak up what others would explain.

        What a law remembers, within a reach, is handed on from window to window even there.
        """
        law = self.bench.laws[name]
        return bool(law.states) and math.isinf(law.reach)

    def rubs(self, trial: Trial) -> bool:
        """Whether a model has friction in the joint: what a record asks for beside it may be that friction's memory."""
        return any(rubs(self.bench.laws[name]) for name in trial.names)

    def shaken(self, trial: Trial) -> Trial:
        """A tied model fitted `softly` and begun `anew`, once in a search, if that finds something better."""
        if not trial.tied or trial.names in self.shook:
            return trial
        self.shook.add(trial.names)
        found = self.anew(self.softly(trial))
        return trial if found is trial else self.keep(found)

    def anew(self, tied: Trial) -> Trial:
        """A tied model with dry friction begun again from its own parameters and the data, as long as that helps.

        It began with the windows of a model without one of its effects: where friction holds there, it may still hold.
        """
        for _ in range(ROUNDS if self.may_stick(tied) else 0):
            again = self.begun_again(tied)
            if not tied.cost - again.cost > LOOSER:
                break
            tied = again
        return tied

    def softly(self, tied: Trial) -> Trial:
        """A tied model with dry friction fitted by way of friction without corners, if that is better."""
        if not self.may_stick(tied):
            return tied
        self.progress(f"softening dry friction: {', '.join(sorted(tied.names))}", 0.5)
        for way in (0, 1, 0, 1):
            found = self.bench.fit_softly(tied, WHOLE, way)
            if way and tied.cost - found.cost < LOOSER:
                break
            tied = min(tied, found, key=lambda t: t.cost)
        return tied

    def simplified(self, final: Trial, name: str, other: str) -> Trial:
        """The model with a law reduced to a simpler one that it contains."""
        effects = self.bench.effects(final)
        shared = {n: v for n, v in values(effects.pop(name)).items() if n in specs(self.bench.laws[other]())}
        effects[other] = with_values(self.bench.laws[other](), shared)
        names = frozenset(effects)
        if final.tied and self.ruled_out(final, names) and not explained(self.known[names, False]):
            # It was left behind from elsewhere. If it is from here as well, one trajectory need not be looked for.
            apart = self.keep(self.bench.fit(effects, self.loosened(final), tied=False, patience=WHOLE))
            if self.ruled_out(final, names):
                return apart
        trial = self.keep(self.bench.fit(effects, final, tied=final.tied, patience=WHOLE))
        if final.tied and not trial.done and trial.misfit > STUCK * final.misfit:
            return self.keep(self.bench.fit(effects, final, tied=False, patience=WHOLE))
        return trial

    def outdone(self, name: str, tried: dict[str, Trial]) -> bool:
        """Whether a candidate is clearly behind a simpler law that it contains, which explains and has had no more patience."""
        own = tried[name]
        simpler = [tried[n] for n in self.bench.laws[name].absorbs if n in tried]
        return any(explained(t) and t.tied == own.tied and gain(own, t) > demanded(self.bench) for t in simpler)

    def runs_through(self, trial: Trial) -> bool:
        """Whether a model of a link that is not seen was judged by one run through the record, as it has to stay."""
        return bool(self.bench.outright) and (self.bench.grips(trial.names) or not adequate(trial))

    def ruled_out(self, final: Trial, names: frozenset[str]) -> bool:
        """Whether a model fell behind another on free windows already: tying them gives it nothing that it lacks there."""
        own, other = self.known.get((final.names, False)), self.known.get((names, False))
        if own is None or other is None or not (other.done or names in self.behind):
            return False
        return gain(other, own) > demanded(self.bench)

    def placed(self, trial: Trial, member: Member, *, tied: bool, patience: int = PATIENCE) -> Trial:
        """The model with a law of a family with internal states in it, in place of those it takes the place of."""
        effects = {**member.beside, member.name: member.tuned.effect}
        key = (frozenset(effects), tied)
        if key not in self.known:
            self.progress(f"trying {member.name}", 0.45)
            # A joint that was fitted without friction's memory is bent by it: the tuned one is nearer.
            joint = trial.system if member.kin else member.tuned.system
            fitted = self.keep(self.bench.fit(effects, trial, joint=joint, tied=tied, patience=patience, followed=True))
            arrived = adequate(fitted) and (fitted.done or fitted.cost < trial.cost)
            if tied and not arrived:
                # Windows that are one trajectory can keep a law from where free ones find it.
                free = self.placed(trial, member, tied=False, patience=patience)
                if explained(trial):
                    free = free if free.done else self.finish(free)
                    if self.ruled_out(trial, free.names):
                        return free
                return self.settle(free)
        return self.known[key]

    def finish(self, trial: Trial, goal: float = math.inf) -> Trial:
        """The trial fitted to the end, as long as that helps: along a curved valley it is a long way. Given up is what would not
        come down to the cost that is the ``goal`` at that pace."""
        for left in reversed(range(0 if trial.done else ROUNDS)):
            cost = trial.cost
            trial = self.keep(self.bench.fit(self.bench.effects(trial), trial, tied=trial.tied, patience=WHOLE))
            if trial.done or not cost - trial.cost > 0.5 * demanded(self.bench) or trial.cost - goal > left * (cost - trial.cost):
                break
        return trial

    def keep(self, trial: Trial) -> Trial:
        """The best fit so far of a model, this one counted."""
        key = (trial.names, trial.tied)
        known = self.known.get(key)
        # Of two that are as good the one that has arrived.
        if known is None or (trial.criterion, not trial.done) < (known.criterion, not known.done):
            self.known[key] = trial
        return self.known[key]
