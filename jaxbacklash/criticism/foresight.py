"""What a search will most likely ask the compiler for next, compiled beside it. It changes nothing but the time a cold run takes.

A search waits for one program after the other while the compiler keeps a single core busy. The joint alone is fitted while the
catalogue's program is in the making; what the joint leaves tells then whether dry friction, friction that gives, or a link that
bends will want a program of its own.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from types import TracebackType

from ..fitting.levenberg import Levenberg, fetch, ready
from ..fitting.setup import first_guess
from ..fitting.shooting import Problem
from ..mechanics import AbstractEffect
from ..parameters import values, with_values
from ..system import System
from .along_motion import own_torques
from .memories import Member, families
from .tuning import apart, tune
from .workbench import Trial, Workbench, strengths

CLEARLY = 0.1
"""Share of what the joint alone leaves that dry friction takes away in the quick look where its program is made beforehand."""


class Foresight:
    """Compiles ahead of a search as a context; `after` is to be told the fit of the joint alone.

    What fails here fails again, and is told, where it is asked for.
    """

    def __init__(self, bench: Workbench) -> None:
        self.bench = bench
        self.aside = ThreadPoolExecutor(2)

    def __enter__(self) -> Foresight:
        self.aside.submit(self.catalogue)
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.aside.shutdown(wait=True, cancel_futures=True)

    def after(self, base: Trial) -> None:
        """Go on from what the joint alone leaves."""
        law, share = self.friction(base)
        if law is not None:
            if (giving := self.giving(base, share)) is None:
                self.aside.submit(self.sliding, base, law)
            else:
                self.aside.submit(self.remembering, giving, base.system)
        else:
            self.aside.submit(self.bending, base)
        self.aside.submit(self.looks, base, law)

    def member(self, law: Member) -> None:
        """Read the program of a model with a law that has a memory, if it is kept: it is the largest of all, and too dear to
        compile on a first sight of the law."""
        self.aside.submit(self.remembering, {**law.beside, law.name: law.tuned.effect}, law.tuned.system, fetch)

    def remembering(self, effects: dict[str, AbstractEffect], joint: System, get: Callable[..., None] = ready) -> None:
        """The program of a model with these effects."""
        problem, _ = self.bench.problem(effects, joint)
        get(problem, first_guess(problem), Levenberg())

    def catalogue(self) -> None:
        """The catalogue's program, which every search needs after that of the joint alone."""
        name = next(iter(self.bench.static))
        problem, _ = self.bench.problem({}, self.bench.base, extra=[f"{name}.{n}" for n in strengths(self.bench.static[name]())])
        ready(problem, first_guess(problem), Levenberg())

    def friction(self, base: Trial) -> tuple[str | None, float]:
        """The simplest dry friction in the port where a quick look at what the joint leaves makes it likely, and the share of
        that which it takes away."""
        dry = {name: law for name, law in self.bench.static.items() if law.slides}
        simplest: dict[str, str] = {}
        for name in sorted(dry, key=lambda n: len(strengths(dry[n]()))):
            simplest.setdefault(dry[name].port, name)
        shares = {}
        for name in simplest.values():
            rubbing, _ = apart(dry[name](), strengths(dry[name]()))
            shares[name] = self.bench.quick.share(base.system, base.free, rubbing)
        likeliest = max(shares, key=lambda n: shares[n], default="")
        share = shares.get(likeliest, 0.0)
        return (likeliest if share > CLEARLY else None), share

    def giving(self, base: Trial, share: float) -> dict[str, AbstractEffect] | None:
        """The simplest law of friction that gives before it slips, by name, where a mere guess of it takes away more than that
        share already; friction that does not give leaves such guesses far behind."""
        return self.guessed(base, [names[0] for names in families(self.bench).values()], share)

    def bending(self, base: Trial) -> None:
        """The program of a law with states that is no friction, like that of a flexible link, where it is likely."""
        if (likely := self.bends(base)) is not None:
            self.remembering(likely, base.system)

    def bends(self, base: Trial) -> dict[str, AbstractEffect] | None:
        """A law with states that is no friction, by name, where a mere guess of it takes away a clear part of what the joint
        alone leaves; where something else is missing, such guesses take away next to nothing."""
        return self.guessed(base, [n for n, law in self.bench.laws.items() if law.states and not law.family], CLEARLY)

    def guessed(self, base: Trial, names: list[str], share: float) -> dict[str, AbstractEffect] | None:
        """The likeliest guess of the first of some laws, by name, whose guesses take away more than a share of what is left."""
        quick, bare = self.bench.quick, base.system
        for name in names:
            guesses = self.bench.laws[name].guesses(bare, quick.motion)
            if quick.share(bare, base.free, guesses) > share:
                return {name: quick.choose(bare, base.free, guesses)[0]}
        return None

    def sliding(self, base: Trial, name: str) -> None:
        """The catalogue's program with dry friction that can hold."""
        problem, _ = self._one_more(base, name)
        ready(problem, first_guess(problem), Levenberg())

    def looks(self, base: Trial, friction: str | None) -> None:
        """The small programs of the quick look at a model with one effect, and at laws that have a memory."""
        quick, laws = self.bench.quick, self.bench.laws
        problem, free = self._one_more(base, friction or next(iter(self.bench.static)))
        quick.missing(with_values(problem.system, values(problem.system)), free)
        if friction is not None:
            bare = System(base.system.inertia, base.system.contact, base.system.damper, {}, base.system.observed)
            for names in families(self.bench).values():
                tune(quick, bare, base.free, laws[names[0]].guesses(bare, quick.motion))
        for law in laws.values():
            if law.states and not law.family:
                own_torques(law.guesses(base.system, quick.motion), base.system, quick.motion)

    def _one_more(self, base: Trial, name: str) -> tuple[Problem, tuple[str, ...]]:
        return self.bench.problem({name: self.bench.laws[name].guesses(base.system)[0]}, base.system)
