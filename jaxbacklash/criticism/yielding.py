"""Friction that gives before it slips, where dry friction leaves windows that no trajectory joins.

Free windows hardly tell how friction turns: each has a start of its own, and few samples near rest. One trajectory tells, but
where friction in the joint gives a little before it slips, the one of dry friction sticks at every corner that is not there,
so that its windows stay free and leave noise. The law that gives is then tried as one trajectory, from its own free windows.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..mechanics import AbstractEffect, canonical_name
from ..parameters import free_specs, with_values
from .along_motion import own_torques
from .candidates import rubs
from .evidence import demanded, explained, gain, shapeless
from .memories import families, may_replace
from .steps import Step
from .tried import WHOLE, Tried
from .tuning import at_level, level, stronger
from .under_noise import Sounding
from .workbench import Trial, Workbench, adequate, strengths

if TYPE_CHECKING:
    from .search import Search

FAR = 50.0
"""Times the evidence demanded that the quick look must put dry friction behind what gives to rule it out. Noise turns dry
friction over along the measured motion: where it was the truth, it was up to 14 times behind, in 36 records at three noises."""


def yielding(search: Tried, final: Trial) -> tuple[str, Trial] | None:
    """The model with a law that gives in place of its dry friction in the joint, by that law's name.

    None where the windows are one trajectory already, where no such law makes them one, or where its shape is not determined:
    then it only leads dry friction round its corners, and if that is one trajectory from there, it is what is returned.
    """
    bench = search.bench
    dry = search.dry_in_joint(final)
    if final.tied or dry is None or not adequate(final) or bench.outright:
        return None
    # One of a family may be no way to another: Dahl's friction does not follow a link that LuGre's holds at rest and lets slide.
    for name in (name for names in families(bench).values() for name in names):
        if (soft := _joined(search, final, dry, name)) is None:
            continue
        sharp = _sharp(search, soft, name, final.system.effects[dry])
        if sharp.tied and explained(sharp) and gain(sharp, soft) < demanded(bench):
            return dry, sharp
        if not shapeless(soft, name, bench.slowest):
            return name, soft
    return None


def gives_after_all(search: Search, steps: list[Step]) -> list[Step]:
    """The path with friction that gives in the place of its last model's dry friction in the joint, if that is clearly better.

    For where a richer dry law explained more by a shape near rest that the record does not determine. A link that sticks tightly
    follows the noise of the base motion, which looks like evidence; the simplest law that gives never sticks tighter than it
    slides, so that what it gains is none of that.
    """
    bench, final = search.bench, steps[-1].trial
    dry = search.dry_in_joint(final)
    if not final.tied or dry is None or bench.outright:
        return steps
    for names in families(bench).values():
        soft = _joined(search, final, dry, names[0])
        if soft is not None and not shapeless(soft, names[0], bench.slowest) and gain(final, soft) > demanded(bench):
            settled, dropped = search.prune(search.keep(soft), spare=names[0])
            return search.with_kin([*steps, Step(settled, names[0], (dry, *dropped), ())])
    return steps


def given_at_last(search: Search, steps: list[Step]) -> list[Step]:
    """The path with friction that gives in the place of its last model's dry friction, if one trajectory asks for that.

    It is asked with the difference of their torques along it. Free windows hardly tell how friction turns, and a search that has
    stuck on the way from them with one law that gives has said nothing of another.
    """
    bench, final = search.bench, steps[-1].trial
    dry = search.dry_in_joint(final)
    if not final.tied or dry is None or bench.outright or bench.quick.blind or not explained(final):
        return steps
    search.progress(f"looking for friction that gives in place of {dry}", 0.7)
    sounding, present = Sounding(bench, final), final.system.effects[dry]
    own = own_torques([present], final.system, sounding.along)[0]
    for names in families(bench).values():
        laws = at_level(bench.laws[names[0]].guesses(final.system, bench.quick.motion), level(present))
        torques = own_torques(laws, final.system, sounding.along)
        # Any: one guess whose answer is no number says nothing of the others.
        if any(sounding.gained(torque - own) > demanded(bench) for torque in torques):
            return gives_after_all(search, steps)
    return steps


def sharp_as_well(search: Tried, final: Trial) -> tuple[str, Trial] | None:
    """The model with dry friction in the place of a law that gives, by that friction's name, where the record does not tell them
    apart: it may have come for another of its kin, and dry friction is the limit of all of them.

    The quick look is asked first, then free windows: what they rule out has no trajectory to be looked for.
    """
    bench = search.bench
    name = search.gives(final)
    if name is None or not final.tied or not explained(final) or bench.outright:
        return None
    counts = {n: len(free_specs(law())) for n, law in bench.static.items() if rubs(law)}
    dry = min(counts, key=counts.__getitem__, default=None)
    if dry is None or counts[dry] >= len(free_specs(bench.laws[name]())):
        return None
    law = bench.static[dry]()
    if not all(may_replace(bench, final, name, [law], sure=FAR)):
        return None
    law = with_values(law, {strengths(law)[0]: level(final.system.effects[name])})
    names = final.names - {name} | {dry}
    free = search.known.get((names, False)) or search.keep(bench.fit({**_beside(bench, final, name), dry: law}, final))
    if not explained(free):
        return None
    sharp = _sharp(search, final, name, law)
    return (dry, sharp) if explained(sharp) and gain(sharp, final) < demanded(bench) else None


def _beside(bench: Workbench, final: Trial, name: str) -> dict[str, AbstractEffect]:
    return {n: e for n, e in bench.effects(final).items() if n != name}


def _joined(search: Tried, final: Trial, dry: str, name: str) -> Trial | None:
    """One trajectory with the law that gives, from the first of its guesses that leads to one."""
    bench = search.bench
    beside = _beside(bench, final, dry)
    for guess in at_level(bench.laws[name].guesses(final.system, bench.quick.motion), level(final.system.effects[dry])):
        search.progress(f"trying {name} in place of {dry}", 0.65)
        free = bench.fit({**beside, name: guess}, final, followed=True, patience=WHOLE)
        if not adequate(free):
            continue
        tried = bench.fit(bench.effects(free), free, tied=True, patience=WHOLE)
        if explained(tried):
            return tried
    return None


def _sharp(search: Tried, soft: Trial, name: str, law: AbstractEffect) -> Trial:
    """Dry friction of the same level, as one trajectory from that of the law that gives."""
    effects = search.bench.effects(soft)
    effects[canonical_name(law)] = stronger(law, level(effects.pop(name)) / max(level(law), 1e-300))
    return search.softly(search.bench.fit(effects, soft, tied=True, patience=WHOLE))
