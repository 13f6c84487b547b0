"""The rules by which the search fits a model, looks at what may be missing, and begins its windows.

The table of `benchmarks.search_rules` goes on here.
"""

from __future__ import annotations

import math

import numpy as np

from jaxbacklash.criticism.memories import Member
from jaxbacklash.criticism.tried import WHOLE, Tried
from jaxbacklash.criticism.workbench import PATIENCE, Trial, adequate
from jaxbacklash.fitting.search import NEAR
from jaxbacklash.mechanics import AbstractEffect
from jaxbacklash.parameters import specs, values, with_values

from .search_switches import Rule, always, argument


def tied_once(search: Tried, effects: dict[str, AbstractEffect], before: Trial, patience: int = PATIENCE) -> Trial:
    """In place of `joined`: one tied fit from the windows of the model before."""
    return search.bench.fit(effects, before, tied=True, patience=patience)


def left_out(search: Tried, before: Trial, name: str) -> Trial:
    """In place of `without`: what is known of the smaller model, else one fit of it."""
    names = before.names - {name}
    key = (names, before.tied and search.bench.grips(names) == search.bench.grips(before.names))
    if key not in search.known:
        effects = {n: e for n, e in search.bench.effects(before).items() if n != name}
        search.keep(search.bench.fit(effects, before, tied=key[1]))
    return search.known[key]


def simplified_once(search: Tried, final: Trial, name: str, other: str) -> Trial:
    """In place of `simplified`: one fit with the simpler law, tied as the model was."""
    effects = search.bench.effects(final)
    shared = {n: v for n, v in values(effects.pop(name)).items() if n in specs(search.bench.laws[other]())}
    effects[other] = with_values(search.bench.laws[other](), shared)
    return search.keep(search.bench.fit(effects, final, tied=final.tied, patience=WHOLE))


def placed_once(search: Tried, trial: Trial, member: Member, *, tied: bool, patience: int = PATIENCE) -> Trial:
    """In place of `placed`: one fit, from the model's own joint, without free windows where it has not arrived."""
    effects = {**member.beside, member.name: member.tuned.effect}
    key = (frozenset(effects), tied)
    if key not in search.known:
        search.keep(search.bench.fit(effects, trial, tied=tied, patience=patience, followed=True))
    return search.known[key]


FITS = (
    Rule("tied from finished windows", "criticism.tried:Tried.tied_anew", argument(1),
         "Where a tied search stuck at a corner, free windows are finished and tied again."),
    Rule("windows cut", "criticism.tried:Tried.let_go", always(None),
         "Where friction does not let a tied search through, a few ties are cut."),
    Rule("tied as well as free", "criticism.tried:follows", lambda tied, free: adequate(tied),
         "A tied fit that misses 1 % more than its free windows does not follow."),
    Rule("fitted to the end", "criticism.tried:Tried.finish", argument(1),
         "A model out of patience is fitted on as long as that helps."),
    Rule("known but stuck", "criticism.tried:Tried.stuck_elsewhere", always(False),
         "A known model that costs more than one it contains is fitted again from there."),
    Rule("begun slightly", "criticism.tried:SLIGHT", 1.0,
         "An addition that made the cost rise is begun again at a little of its strength.", read_by="criticism.tried:Tried.add"),
    Rule("begun barely", "criticism.tried:BARELY", 1.0,
         "An addition that promises little begins at next to no strength.", read_by="criticism.tried:Tried.add"),
    Rule("roughly beside a rival", "criticism.tried:ROUGH", NEAR,
         "Beside a simpler rival free windows are fitted roughly first.", read_by="criticism.tried:Tried.add"),
    Rule("tied by way of free", "criticism.tried:Tried.joined", tied_once,
         "A tied fit that sticks lets its windows go and is tied again.", fits=1),
    Rule("retied", "criticism.tried:Tried.retied", argument(1),
         "A model with a hidden law is freed and tied in turn as long as that helps."),
    Rule("left out from near", "criticism.tried:Tried.without", left_out,
         "A model without an effect is fitted anew where what is known of it is far.", fits=1),
    Rule("simplified by way of free", "criticism.tried:Tried.simplified", simplified_once,
         "A model with a simpler law is asked on free windows where those ruled it out, or where one trajectory sticks.", fits=1),
    Rule("placed by way of free", "criticism.tried:Tried.placed", placed_once,
         "A law with a memory is fitted from its tuned joint, and on free windows where one trajectory does not arrive.", fits=1),
    Rule("begun again once", "criticism.tried:Tried.shaken", argument(1),
         "A tied model that may have stuck is softened and begun anew, once in a search."),
    Rule("friction softened", "criticism.tried:Tried.softly", argument(1),
         "A tied model with dry friction is fitted by way of friction without corners."),
    Rule("friction begun anew", "criticism.tried:Tried.anew", argument(1),
         "A tied model with dry friction is begun again from its parameters and the data."),
    Rule("states followed", "criticism.workbench:Workbench._followed", lambda bench, effects, joint, starts: np.asarray(starts),
         "States of a new law begin as followed along the measured motion."),
    Rule("near in comparisons", "criticism.workbench:COMPARED", 1e-3,
         "Trajectories that are compared are not fitted as near to the minimum as the last."),
    Rule("wrong not fitted on", "criticism.workbench:ENOUGH", 0.0,
         "A model that is clearly wrong is not fitted on for small gains."),
    Rule("held link", "criticism.workbench:gripping", always(()),
         "Records of transmitted force: a link that friction holds runs through as one trajectory."),
)  # fmt: skip
LOOKS = (
    Rule("resonance heard", "criticism.ringing:ringing", always([]),
         "A law with a resonance is begun at frequencies at which the residual rings."),
    Rule("parabola checked", "criticism.under_noise:BENT", math.inf,
         "A promise counts only where a further size answers as foretold.", read_by="criticism.under_noise:Sounding.fall"),
    Rule("lost trajectory", "criticism.under_noise:LOST", math.inf,
         "A trajectory that dry friction holds promises nothing.", read_by="criticism.under_noise:Sounding.fall"),
    Rule("weakest believed", "criticism.under_noise:WEAKEST", 0.0,
         "A promised size is not taken for less than 5 % of the guess.", read_by="criticism.under_noise:promises"),
    Rule("strongest believed", "criticism.under_noise:STRONGEST", math.inf,
         "A promised size is not taken for more than three times the guess.", read_by="criticism.under_noise:promises"),
    Rule("smaller parts", "criticism.under_noise:PARTS", (0.3,),
         "Relatives are told apart by smaller parts where a larger one bends.", read_by="criticism.under_noise:changes"),
    Rule("more to be glimpsed", "criticism.unseen:GLIMPSED", 1.0,
         "A hidden law must show twice what an addition must bring before it is tried."),
    Rule("half a promise", "criticism.unseen:HALF", 1.0,
         "Half of a gain is enough to promise where more may come of it.", read_by="criticism.unseen:Unseen.unseen"),
    Rule("first fit brings a part", "criticism.unseen:KEPT", -math.inf,
         "A hidden law whose first fit brings less than a tenth of its promise is given up.",
         read_by="criticism.unseen:Unseen.unseen"),
    Rule("two guesses", "criticism.unseen:LIKELY", 99,
         "Two guesses of a law are fitted at most."),
    Rule("sign fixed by physics", "criticism.quick_look:fixed_sign", always(False),
         "The weak form takes nothing for a law whose torque would have the wrong sign."),
    Rule("rows whitened", "criticism.quick_look:whitener", always(lambda rows: rows),
         "The rows of the weak form are made white before they are compared."),
    Rule("runaway law silent", "criticism.quick_look:_led", argument(0),
         "A law that runs away along the measured motion says nothing."),
    Rule("law sized", "criticism.tuning:sized", argument(3),
         "A law with a memory is brought to the strength that the record asks for before it is tuned."),
)  # fmt: skip
WINDOWS = (
    Rule("windows handed on", "fitting.handed_on:handed_on", lambda problem, found, how: (found, 0),
         "Free windows that have stuck begin again where the one before has ended."),
    Rule("slightly worse windows", "fitting.handed_on:better_led", always(None),
         "Windows that miss a little too much do so, too, if a look says that it helps."),
    Rule("first window led in", "fitting.handed_on:led_in", lambda problem, found, first: np.array(found.value.starts),
         "A record's first window begins on curves through its samples."),
    Rule("memory led on", "fitting.led_on:led_on", argument(1),
         "For a score, windows begin with what the one before remembers."),
    Rule("scores gone on", "fitting.score:ROUNDS", 0,
         "The search for a score's window starts goes on as long as it promises more."),
    Rule("loose tie first", "fitting.search:TIES", ((100.0,), (100.0,), (100.0,)),
         "Where a sharp tie fails, a loose one leads to the trajectory."),
    Rule("far off given up", "fitting.search:FAR_OFF", math.inf,
         "A tied search that is far off after twenty steps is given up."),
    Rule("stretch first", "fitting.stretch:stretch", lambda problem, guess: (None, guess),
         "`fit` searches a stretch of the record first; no search for effects asks for it."),
    Rule("noise told to held-out", "fitting.left_over:quieter_elsewhere", always(1.0),
         "Noise that was taken down on the record is taken down on the held-out one."),
)  # fmt: skip
