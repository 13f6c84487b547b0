"""The rules of the search for missing effects, each with what stands in its place when it is off and what it is for.

`benchmarks.search_ablation` switches them off one at a time. Those of how a model is fitted and looked at are in
`benchmarks.search_rules_of_fits`. Not here is what only saves time without a word in any decision
(programs compiled ahead, laws that are not evaluated), what JAX compiles (the steps of the least squares), what draws a picture
(tables over the missing torque), and the numbers that are default values of an argument, which were read when Python began.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from jaxbacklash.criticism.candidates import Candidate
from jaxbacklash.criticism.evidence import NOISE_FLOOR, demanded, explained
from jaxbacklash.criticism.preference import AHEAD
from jaxbacklash.criticism.search import Search
from jaxbacklash.criticism.unseen import GLIMPSED
from jaxbacklash.criticism.workbench import Trial, Workbench

from .search_rules_of_fits import FITS, LOOKS, WINDOWS
from .search_switches import Rule, always, argument


def absent(bench: Workbench, trial: Trial) -> list[str]:
    """In place of `may_join`: every absent law without a state."""
    return [name for name in bench.static if name not in trial.names]


def on_tied_windows(
    search: Search, current: Trial, tried: dict[str, Trial], ranking: tuple[Candidate, ...]
) -> tuple[Trial, dict[str, Trial]]:
    """In place of `judged_loose`: a stage of one trajectory is always judged by candidates that are one."""
    one = current.tied and not search.runs_through(current)
    return current, {name: t for name, t in tried.items() if t.tied or not one}


def lowest(bench: Workbench, tried: Mapping[str, Trial], slack: float, *, more: bool = False) -> str:
    """In place of `simplest`: the candidate with the lowest criterion."""
    return min(tried, key=lambda name: tried[name].criterion)


def any_may(bench: Any, trial: Trial, name: str, others: Any, sure: float = 1.0) -> list[bool]:
    """In place of `may_replace`: nothing is ruled out beforehand."""
    return [True] * len(others)


STAGES = (
    Rule("noise taken down", "criticism.evidence:noise_too_large", always(False),
         "A model that leaves less than the noise shows that the noise was taken for too large: all begins again with less."),
    Rule("hidden laws tried", "criticism.search:Search.with_hidden", argument(1),
         "Where a rest stays, laws with internal states are tried beside the joint and beside the last model."),
    Rule("hidden law glimpsed", "criticism.unseen:Unseen.glimpsed", always(False),
         "They are tried beside a model that explains, too, if the weak form sees one."),
    Rule("own motion taken off", "criticism.under_noise:own_rest", always(0.0),
         "What the weak form leaves of the model's own motion is taken off before it is believed."),
    Rule("path without states", "criticism.search:Search.with_static", argument(1),
         "Another path without a law with states whose free windows no trajectory follows."),
    Rule("path by free windows", "criticism.loose:by_free_windows", argument(1),
         "Another path on free windows where one trajectory misses more than they do."),
    Rule("hidden law under noise, last", "criticism.search:Search.with_unseen", argument(1),
         "A law with states that the noise hides is looked for beside the last model."),
    Rule("yielding friction joins", "criticism.search:Search.with_yielding", argument(1),
         "Friction that gives replaces dry friction where only that makes one trajectory."),
    Rule("joined by an addition", "criticism.joining:one_piece", argument(1),
         "An effect that noise hides is added where it joins windows that only apart are explained."),
    Rule("better model recalled", "criticism.recall:recalled", argument(1),
         "A model found earlier and left behind is taken where the search ends with a worse one."),
    Rule("relatives tried", "criticism.search:Search.with_kin", argument(1),
         "Near relatives of a law with a memory are tried in its place."),
    Rule("relatives under noise", "criticism.under_noise:changes", always([]),
         "Relatives are asked for along one trajectory, too, where noise makes the weak form blind."),
    Rule("gone on after soaking", "criticism.loose:without_soaking", lambda search, steps, least: search.trim(steps),
         "Where a law with a state was trimmed that soaked up the misfit, the search goes on without such laws."),
    Rule("small additions trimmed", "criticism.search:Search.trim", argument(1),
         "Last additions that take away little of a clear rest are taken back."),
    Rule("trimmed like with like", "criticism.search:Search.alike", lambda search, before, after: (before, after),
         "Trimming compares free windows with free windows where that is known."),
    Rule("richer law reduced", "criticism.search:Search.reduced", argument(1),
         "A law gives way to a simpler one that it contains where that does as well."),
    Rule("effects swapped", "criticism.search:Search.swap", lambda search, steps, *seen: (steps, {}),
         "Each effect of the last model is replaced by what else would do; what does as well is told."),
    Rule("two for one", "criticism.two_for_one:two_for_one", argument(2),
         "Two simpler effects are tried in the place of one that stands in for both."),
    Rule("law at its bound", "criticism.within_bounds:within_bounds", argument(1),
         "Where a law ends at the end of its shapes, the next best addition is followed instead."),
    Rule("last search gone on", "criticism.arriving:arrived", argument(1),
         "The last model is fitted on, or begun anew, where its search may have stuck."),
    Rule("yielding friction, last", "criticism.yielding:given_at_last", argument(1),
         "At the end one trajectory is asked whether dry friction gives."),
    Rule("yielding after reduction", "criticism.yielding:gives_after_all", argument(1),
         "Friction that gives is tried where a richer dry law was reduced though it explained more."),
    Rule("dry as well", "criticism.yielding:sharp_as_well", always(None),
         "Dry friction replaces a law that gives where the record does not tell them apart."),
    Rule("richer law at another shape", "criticism.reshaping:reshaped_at_last", argument(1),
         "At the end a richer law is tried at the shape that the trajectory asks for."),
    Rule("relatives as alternatives", "criticism.unseen:Unseen.kin_as_good", always({}),
         "Relatives that do as well are told beside the model kept."),
)  # fmt: skip
ADDITIONS = (
    Rule("one friction in the joint", "criticism.candidates:may_join", absent,
         "A second law of friction in the joint is no candidate unless it contains the first."),
    Rule("strength taken over", "criticism.candidates:contained", always({}),
         "A richer law begins with the strength of the simpler one that it replaces."),
    Rule("few refitted", "criticism.search:HOPEFUL", 0.0,
         "What promises less than a fifth of the best candidate is not refitted."),
    Rule("close ones only", "criticism.search:CLOSE", 0.0,
         "Once noise is reached, only what promises nine tenths of the best is refitted, finished or swapped in."),
    Rule("enough promised", "criticism.search:Search.may_help", always(True),
         "A candidate must promise half of what it has to bring to be refitted."),
    Rule("friction with memory", "criticism.unseen:Unseen.memories", always({}),
         "At every stage friction that gives is tried where the weak form puts it before every static law."),
    Rule("memory by chance", "criticism.unseen:Unseen.by_noise", always(False),
         "It is not tried where noise drawn anew on the model's own motion speaks for it as much."),
    Rule("yielding where untold", "criticism.unseen:Unseen.given", always({}),
         "It is tried in place of dry friction where the weak form cannot tell them apart."),
    Rule("untold by the weak form", "criticism.unseen:Unseen.untold", always([]),
         "The weak form says itself which law of friction it could not tell from another; only such are tried unasked."),
    Rule("richer law tried", "criticism.unseen:Unseen.richer", always({}),
         "A law is tried in place of one that it contains, whatever its rank."),
    Rule("stage on free windows", "criticism.loose:judged_loose", on_tied_windows,
         "A stage whose trajectories stick on the way to a clear gain is judged on free windows."),
    Rule("free windows soak up", "criticism.loose:soaked_up", always(False),
         "Not so where free windows are helped only by laws with states that one trajectory does not follow."),
    Rule("soaking laws apart", "criticism.tried:Tried.soaks", always(False),
         "A law that gives free windows states to choose counts less than one without."),
    Rule("static law first", "criticism.search:Search.plain", always({}),
         "A law without a state goes first where no trajectory follows the one with a state."),
    Rule("close ones finished", "criticism.search:Search.finished", argument(2),
         "Candidates close to the best are fitted to the end before one is chosen."),
    Rule("outdone by simpler", "criticism.tried:Tried.outdone", always(False),
         "A candidate clearly behind a simpler law that it contains is not finished."),
    Rule("stuck friction renewed", "criticism.tried:Tried.unstuck", argument(2),
         "The best candidate with dry friction is begun again from the data as long as that helps."),
    Rule("broken promise shaken", "criticism.tried:Tried.as_promised", argument(3),
         "A candidate with dry friction that brought less than half of its promise is begun again."),
    Rule("only led on", "criticism.evidence:led_on", always(False),
         "What only led a stuck search on is no evidence for an effect."),
    Rule("small gain refused", "criticism.search:Search.nibbles", always(False),
         "An addition must take a share of the misfit as long as a clear rest remains."),
    Rule("effect's own claim", "criticism.evidence:claim", always(math.inf),
         "What leaving an effect out would cost, as the fit's information tells, limits the evidence for it."),
    Rule("freed model pruned", "criticism.search:Search.freed", lambda search, step, relieved: replace(step, trial=relieved),
         "A model that came free drops what stood in for its having been stuck."),
    Rule("larger share at first", "criticism.evidence:MUCH", 0.1,
         "That share is a quarter until laws with states were tried, and a tenth then."),
    Rule("lag read between samples", "criticism.under_noise:delayed", always(False),
         "Beside a lag an addition is held against what reading between samples would explain."),
    Rule("blurred sensor", "criticism.under_noise:blurred", always(0.0),
         "What a sensor that averages over a short time explains is no evidence."),
    Rule("imitated by the sensor", "criticism.unseen:Unseen.imitated", always(False),
         "An addition that explains no more than such a sensor is refused."),
    Rule("model relieved first", "criticism.tried:Tried.relieved", argument(1),
         "A model that may have stuck gets its turn again before a larger one takes its place."),
    Rule("hidden law under noise", "criticism.unseen:Unseen.unseen", always(None),
         "A law with states is scored along one trajectory before another effect is added."),
    Rule("look when worth it", "criticism.unseen:Unseen.worth_a_look", lambda search, *trials: GLIMPSED * demanded(search.bench),
         "It must promise half of what the other addition brings."),
    Rule("loaded link", "criticism.unseen:Unseen.loaded", always([]),
         "A law that loads the link is begun strong, too, with all torques as strong as that asks for."),
    Rule("at most five effects", "criticism.unseen:MOST_EFFECTS", 99,
         "A model with more effects is no explanation."),
    Rule("needless dropped", "criticism.search:Search.prune", lambda search, trial, spare=None: (trial, ()),
         "After each addition effects are left out that are no longer needed."),
    Rule("far from zero", "criticism.search:CLEAR", math.inf,
         "An effect eight standard errors from zero is not left out to see.", read_by="criticism.search:Search.prune"),
)  # fmt: skip
JUDGING = (
    Rule("simplest of as good", "criticism.preference:simplest", lowest,
         "Of candidates that do as well the one with fewest parameters is taken."),
    Rule("as good within 2 %", "criticism.evidence:AS_WELL", 1.0,
         "While more is missing, 98 % of the best gain counts as doing as well."),
    Rule("acting before measuring", "criticism.evidence:measures_only", always(False),
         "Laws of the measuring chain must bring more than laws that act."),
    Rule("doubt of a sensor", "criticism.preference:doubt", always(AHEAD),
         "Where corners of friction end a search, the lead that tells a sensor from a torque is larger."),
    Rule("lead by relation", "criticism.preference:lead", always(AHEAD),
         "The lead that another model needs depends on which law contains which and on what only measures."),
    Rule("effects charged", "criticism.preference:advantage", lambda bench, other, kept: kept.criterion - other.criterion,
         "A model with more effects is charged for their having been chosen from many."),
    Rule("choice charged", "criticism.evidence:demanded", always(1e-6),
         "An addition must bring more evidence the more laws there are to choose from."),
    Rule("evidence scaled", "criticism.evidence:gain", lambda before, after: before.criterion - after.criterion,
         "Evidence is scaled down where the rest is larger than noise or correlated."),
    Rule("correlated rest", "criticism.workbench:correlation_length", always(1.0),
         "Neighbouring residuals that hang together count for one."),
    Rule("rest by freedom", "criticism.evidence:leaves_a_rest", lambda trial: not explained(trial),
         "Whether a search may go on is asked by the degrees of freedom, not by 3 % alone."),
    Rule("noise by freedom", "criticism.evidence:most_of_noise", always(NOISE_FLOOR),
         "What noise may leave, for that and for the verdict, follows from the degrees of freedom."),
    Rule("shape undetermined", "criticism.evidence:shapeless", always(False),
         "A richer law whose shape is not determined gives way to the simpler one."),
    Rule("acts anyway", "criticism.evidence:acts_anyway", always(False),
         "It stays all the same where it explains very much more."),
    Rule("resting link", "criticism.workbench:Workbench.rests", always(False),
         "No such lead counts where the link rests for long."),
    Rule("law at a bound", "criticism.evidence:at_a_bound", always(False),
         "A law at the end of its shapes may be another's limit."),
    Rule("strength at a limit", "criticism.evidence:at_a_limit", always(False),
         "A model with a strength at the end of its range is incomplete."),
    Rule("ruled out by free windows", "criticism.tried:Tried.ruled_out", always(False),
         "A model behind on free windows is not tied."),
    Rule("ruled out by weak form", "criticism.memories:may_replace", any_may,
         "A static law that the weak form puts behind a law with a memory is not tried in its place."),
    Rule("unnamed torque", "criticism.unnamed:unnamed", always(None),
         "Torques outside the catalogue are held against a model before it is called complete."),
    Rule("held-out record asked", "criticism.verdict:_elsewhere", always(""),
         "A model that does worse on the held-out record is incomplete."),
    Rule("models averaged", "criticism.either:either", argument(0),
         "Intervals allow for models that do as well."),
)  # fmt: skip
RULES = (*STAGES, *ADDITIONS, *JUDGING, *FITS, *LOOKS, *WINDOWS)
