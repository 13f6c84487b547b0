"""What a search will most likely ask the compiler for next, compiled beside it. It changes nothing but the time a cold run takes.

A search waits for one program after the other while the compiler keeps a single core busy. While the catalogue's program is in
the making, with which the joint alone is fitted, a quick look at what the joint leaves at its first estimate tells whether dry
friction, friction that gives, or a link that bends will want a program of its own.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from types import TracebackType

from ..fitting.levenberg import Levenberg, fetch, ready
from ..fitting.problem import Problem
from ..fitting.setup import first_guess
from ..mechanics import AbstractEffect
from ..parameters import values, with_values
from ..system import System
from .along_motion import own_torques
from .memories import Member, families
from .tuning import apart, tune
from .workbench import Workbench, strengths

CLEARLY = 0.1
"""Share of what the joint alone leaves that dry friction takes away in the quick look where its program is made beforehand."""


class Foresight:
    """Compiles ahead of a search as a context.

    What fails here fails again, and is told, where it is asked for.
    """

    def __init__(self, bench: Workbench) -> None:
        self.bench = bench
        self.aside = ThreadPoolExecutor(2)

    def __enter__(self) -> Foresight:
        self.aside.submit(self.catalogue)
        self.aside.submit(self.likely)
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.aside.shutdown(wait=True, cancel_futures=True)

    def likely(self) -> None:
        """The program of the law that the joint's first estimate most likely misses, if any has one of its own; then the small
        ones that the search will look with."""
        law, share = self.friction()
        if law is not None:
            if (giving := self.giving(share)) is None:
                self.sliding(law)
            else:
                self.remembering(giving, self.bench.base)
        elif (bending := self.bends()) is not None:
            self.remembering(bending, self.bench.base)
        self.looks(law)

    def member(self, law: Member) -> None:
        """Read the program of a model with a law that has a memory, if it is kept: it is the largest of all, and too dear to
        compile on a first sight of the law."""
        self.aside.submit(self.remembering, {**law.beside, law.name: law.tuned.effect}, law.tuned.system, fetch)

    def remembering(self, effects: dict[str, AbstractEffect], joint: System, get: Callable[..., None] = ready) -> None:
        """The program of a model with these effects."""
        problem, _ = self.bench.problem(effects, joint)
        get(problem, first_guess(problem), Levenberg())

    def catalogue(self) -> None:
        """The catalogue's program, with which every search begins."""
        problem, _ = self.bench.problem({}, self.bench.base)
        ready(problem, first_guess(problem), Levenberg())

    def friction(self) -> tuple[str | None, float]:
        """The simplest dry friction in the port where a quick look at what the joint leaves makes it likely, and the share of
        that which it takes away."""
        dry = {name: law for name, law in self.bench.static.items() if law.slides}
        simplest: dict[str, str] = {}
        for name in sorted(dry, key=lambda n: len(strengths(dry[n]()))):
            simplest.setdefault(dry[name].port, name)
        shares = {}
        for name in simplest.values():
            rubbing, _ = apart(dry[name](), strengths(dry[name]()))
            shares[name] = self.bench.quick.share(self.bench.base, self.bench.base_free, rubbing)
        likeliest = max(shares, key=lambda n: shares[n], default="")
        share = shares.get(likeliest, 0.0)
        return (likeliest if share > CLEARLY else None), share

    def giving(self, share: float) -> dict[str, AbstractEffect] | None:
        """The simplest law of friction that gives before it slips, by name, where a mere guess of it takes away more than that
        share already; friction that does not give leaves such guesses far behind."""
        return self.guessed([names[0] for names in families(self.bench).values()], share)

    def bends(self) -> dict[str, AbstractEffect] | None:
        """A law with states that is no friction, by name, where a mere guess of it takes away a clear part of what the joint
        alone leaves; where something else is missing, such guesses take away next to nothing."""
        return self.guessed([n for n, law in self.bench.laws.items() if law.states and not law.family], CLEARLY)

    def guessed(self, names: list[str], share: float) -> dict[str, AbstractEffect] | None:
        """The likeliest guess of the first of some laws, by name, whose guesses take away more than a share of what is left."""
        quick, bare, free = self.bench.quick, self.bench.base, self.bench.base_free
        for name in names:
            guesses = self.bench.laws[name].guesses(bare, quick.motion)
            if quick.share(bare, free, guesses) > share:
                return {name: quick.choose(bare, free, guesses)[0]}
        return None

    def sliding(self, name: str) -> None:
        """The catalogue's program with dry friction that can hold."""
        problem, _ = self._one_more(name)
        ready(problem, first_guess(problem), Levenberg())

    def looks(self, friction: str | None) -> None:
        """The small programs of the quick look at a model with one effect, and at laws that have a memory."""
        quick, laws, bare = self.bench.quick, self.bench.laws, self.bench.base
        problem, free = self._one_more(friction or next(iter(self.bench.static)))
        quick.missing(with_values(problem.system, values(problem.system)), free)
        if friction is not None:
            for names in families(self.bench).values():
                tune(quick, bare, self.bench.base_free, laws[names[0]].guesses(bare, quick.motion))
        for law in laws.values():
            if law.states and not law.family:
                own_torques(law.guesses(bare, quick.motion), bare, quick.motion)

    def _one_more(self, name: str) -> tuple[Problem, tuple[str, ...]]:
        return self.bench.problem({name: self.bench.laws[name].guesses(self.bench.base)[0]}, self.bench.base)
