"""Laws of a family with internal states, as they would stand in a model: which the quick look puts first, and from where."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from ..mechanics import AbstractEffect
from ..parameters import specs
from ..system import System
from .evidence import AS_WELL, demanded
from .tuning import Rival, Tuned, apart, lead, tune
from .workbench import Trial, Workbench, strengths


@dataclass(frozen=True)
class Member:
    """A law of a family as tuned beside a model: its ``name``, the ``beside`` effects that stay, ``lead`` its evidence in the
    weak form, and ``kin``, the law of its family whose place it takes."""

    name: str
    beside: dict[str, AbstractEffect]
    tuned: Tuned
    lead: float
    kin: str | None


def families(bench: Workbench) -> dict[str, list[str]]:
    """Names of the laws with internal states by family, the simplest of each first."""
    found: dict[str, list[str]] = {}
    for name in sorted(bench.laws, key=lambda n: len(specs(bench.laws[n]()))):
        law = bench.laws[name]
        if law.states and law.family:
            found.setdefault(law.family, []).append(name)
    return found


def members(
    bench: Workbench, trial: Trial, names: Sequence[str], rivals: Sequence[Rival] = (),
    seen: Callable[[Member], object] = lambda member: None,
) -> list[Member]:  # fmt: skip
    """The laws of one family that may stand in a model, the likeliest first, of those that are as likely the simplest.

    Where there is none yet, it takes the place of dry friction in the joint, which it contains. It has to be ahead of each of
    the ``rivals`` beside that friction; where there is no friction yet, by more than the share within which others do as
    well, since dry friction gives over no distance at all. Where there is one, its kin take its place unless the quick look
    puts them behind it, alone or with one of the rivals beside it. None where the link's motion is not in the record. ``seen`` is
    told the first as soon as it is tuned.
    """
    if bench.quick.blind:
        return []
    kin = next((n for n in names if n in trial.names), None)
    beside, system, free = without(bench, trial, kin)
    parted = [apart(e, strengths(e)) for n, e in bench.effects(trial).items() if n not in beside and n != kin]
    if kin is not None:
        present = tune(bench.quick, system, free, [trial.system.effects[kin]])
        parted = [([present.effect], present.count)]
    there = [effect for effects, _ in parted for effect in effects], sum(count for _, count in parted)
    rivals = [([*there[0], *effects], there[1] + count) for effects, count in (([], 0), *rivals)]
    found: list[Member] = []
    for name in names:
        if name == kin:
            continue
        law = bench.laws[name]
        instead = [] if kin is None else law.in_place_of(trial.system.effects[kin], bench.quick.motion)
        variants = instead or law.guesses(system, bench.quick.motion)
        tuned = tune(bench.quick, system, free, variants)
        ahead = lead(bench.quick, free, tuned, system, rivals)
        least = -demanded(bench) if kin else demanded(bench)
        if not parted:
            least = max(least, (1.0 - AS_WELL) * lead(bench.quick, free, tuned, system, [([], 0)]))
        if ahead > least:
            found.append(Member(name, beside, tuned, ahead, kin))
            if len(found) == 1:
                seen(found[0])
        elif kin is None and not found:
            break  # where the simplest of a family says nothing, its kin do not either
    most = max((m.lead for m in found), default=0.0)
    return sorted(found, key=lambda m: (most - m.lead, 0) if most - m.lead > demanded(bench) else (0.0, m.tuned.count))


def may_replace(
    bench: Workbench, trial: Trial, name: str, others: Sequence[AbstractEffect], sure: float = 1.0
) -> list[bool]:
    """Whether the quick look leaves open that each of some static laws would do in the place of a fitted one of a family.

    It does unless it puts them behind that one by ``sure`` times the evidence demanded.
    """
    if bench.quick.blind:
        return [True] * len(others)
    _, system, free = without(bench, trial, name)
    tuned = tune(bench.quick, system, free, [trial.system.effects[name]])
    least = sure * demanded(bench)
    return [lead(bench.quick, free, tuned, system, [apart(e, strengths(e))]) < least for e in others]


def without(bench: Workbench, trial: Trial, kin: str | None) -> tuple[dict[str, AbstractEffect], System, tuple[str, ...]]:
    """The effects of a model that stay when one named or dry friction gives way; the model left; what is free."""
    full = trial.system
    here = bench.effects(trial)
    beside = {n: e for n, e in here.items() if n != kin and (kin or not (e.slides and e.port == "joint"))}
    system = System(full.inertia, full.contact, full.damper, beside, full.observed)
    return beside, system, tuple(n for n in trial.free if "." not in n or n.partition(".")[0] in beside)
