"""Rules of the search are switched off where they are used, counted where they act, and told in a table."""

import math
import re
from collections import Counter
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

pytest.importorskip("numba")  # the benchmark makes its records with it

from benchmarks import search_ablation, search_rules
from benchmarks.search_switches import Rule, always, argument, counted, places, present, replaced, same
from jaxbacklash.criticism import evidence, preference, search

RULES = search_rules.RULES
LEAD = Rule("lead", "criticism.preference:doubt", always(2.0), "how clear a lead must be")


def bench(laws=8):
    """A bench of so many laws, none of which slides."""
    return SimpleNamespace(laws={f"law {n}": SimpleNamespace(slides=False) for n in range(laws)}, fits=0)


@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule.name)
def test_rule_is_there_and_leaves_nothing_behind(rule):
    before = [vars(owner)[name] for owner, name in places(rule.at)]
    with replaced(rule.at, rule.instead):
        assert all(vars(owner)[name] is rule.instead for owner, name in places(rule.at))
    assert all(vars(owner)[name] is own for (owner, name), own in zip(places(rule.at), before))
    assert callable(before[0]) == callable(rule.instead)
    assert rule.read_by is None or callable(present(rule.read_by))


def test_every_rule_is_read_by_more_than_its_definition(words):
    names = {rule.name: re.split(r"[.:]", rule.at)[-1] for rule in RULES}
    assert [rule for rule, name in names.items() if words[name] < 2] == []


@pytest.fixture(scope="module")
def words():
    """How often each word stands in the two folders."""
    files = [path for name in ("criticism", "fitting") for path in (Path(search.__file__).parents[1] / name).glob("*.py")]
    return Counter(word for path in files for word in re.findall(r"\w+", path.read_text(encoding="utf-8")))


def test_rules_have_names_of_their_own_and_say_what_they_are_for():
    assert len({rule.name for rule in RULES}) == len({rule.at for rule in RULES}) == len(RULES) > 55
    assert all(rule.why.endswith(".") and "|" not in rule.why for rule in RULES)


def test_a_function_is_replaced_in_modules_that_import_it():
    with replaced("criticism.evidence:demanded", always(0.0)):
        assert search.demanded(bench()) == preference.demanded(bench()) == evidence.demanded(bench()) == 0.0
    assert search.demanded(bench()) == pytest.approx(2.0 * math.log(8))


def test_a_name_that_a_class_inherits_is_no_place():
    with pytest.raises(AttributeError, match="Search defines no softly"):
        places("criticism.search:Search.softly")


def test_what_is_replaced_comes_back_after_an_error():
    with pytest.raises(KeyError), replaced("criticism.search:CLEAR", math.inf):
        {}["no such effect"]
    assert search.CLEAR == 8.0


def test_a_rule_acts_where_it_says_something_else_than_its_stand_in():
    smooth, jagged = SimpleNamespace(names=["law 0"]), SimpleNamespace(names=["law 1"])
    place = bench()
    place.laws["law 1"].slides = True
    with counted([LEAD]) as tallies:
        preference.doubt(place, smooth)
        assert (tallies["lead"].calls, tallies["lead"].acted) == (1, 0)
        assert preference.doubt(place, jagged) == pytest.approx(2.0 * math.log(8))
    assert (tallies["lead"].calls, tallies["lead"].acted) == (2, 1)


def fitting(fits, answer):
    """A rule in the place of `doubt` that makes so many fits on its way to an answer."""

    def doubt(bench, *trials):
        bench.fits += fits
        return answer

    return doubt


@pytest.mark.parametrize(("made", "own", "acts"), [(0, 0, False), (1, 0, True), (1, 1, False), (2, 1, True)])
def test_a_rule_acts_that_makes_more_fits_than_its_stand_in(made, own, acts):
    rule = Rule("lead", LEAD.at, LEAD.instead, LEAD.why, fits=own)
    with replaced(LEAD.at, fitting(made, 2.0)), counted([rule]) as tallies:
        preference.doubt(bench())
    assert bool(tallies["lead"].acted) is acts


def test_a_number_acts_when_it_is_read():
    read = Rule("clear", "criticism.search:CLEAR", math.inf, "", read_by="criticism.evidence:excess")
    with counted([read, Rule("few", "criticism.search:HOPEFUL", 0.0, "")]) as tallies:
        assert (tallies["clear"].acted, tallies["few"].acted) == (0, 1)
        search.excess(SimpleNamespace(misfit=2.0))
    assert tallies["clear"].acted == 1


def test_a_rule_that_fails_acts():
    with counted([LEAD]) as tallies, pytest.raises(KeyError):
        preference.doubt(bench(), SimpleNamespace(names=["no such law"]))
    assert tallies["lead"].acted == 1


def test_same_answers():
    model = object()
    assert same([model, {"a": (1, np.ones(2))}], [model, {"a": (1, np.ones(2))}])
    assert same(True, np.True_)
    assert not same([model], [object()])
    assert not same((1, 2), (1,))
    assert not same(None, 0.0)
    assert argument(1)("this", "that") == "that"


def told(found="gravity", verdict="complete", right=True, misfit=1.0, held=1.0, seconds=10.0):
    return {"found": found.split("+"), "verdict": verdict, "right": right, "misfit": misfit, "held": held, "seconds": seconds}


@pytest.mark.parametrize(
    ("off", "changed", "worse"),
    [
        (told(misfit=1.005, held=0.995), False, 0),
        (told(held=1.02), True, 1),
        (told(held=0.9), True, -1),
        (told(held=math.nan), True, 1),
        (told(misfit=1.02), True, 0),
        (told("gravity+dahl", right=False, held=0.9), True, 1),
        (told(verdict="incomplete"), True, 0),
        ({"failed": "KeyError: 'dahl'", "right": False, "seconds": 1.0}, True, 1),
    ],
)
def test_what_changed_and_whether_for_the_worse(off, changed, worse):
    assert search_ablation.changed(told(), off) is changed
    assert search_ablation.worse(told(), off) == worse


def test_a_wrong_answer_that_becomes_right_is_better():
    assert search_ablation.worse(told("dahl", right=False), told(held=2.0)) == -1


def test_table_puts_first_what_makes_most_difference():
    rules = [Rule(name, "criticism.search:CLEAR", 0.0, f"For {name}.") for name in ("idle", "useful", "silent")]
    spent = {name: {"acted": 1, "seconds": 0.5} for name in ("idle", "useful", "silent")}
    row = {"record": "strangers x1 3", "hidden": ["gravity"], "repeats": True, "rules": spent}
    rows = [{**told(), **row, "off": {"idle": told(seconds=4.0), "useful": told("dahl", right=False, seconds=12.0)}}]
    lines = search_ablation.table(rows, rules).splitlines()
    assert lines[2] == "| useful | 1 | 1 | 1 | 0 | -2 | 0.5 | For useful. |"
    assert lines[3] == "| idle | 1 | 0 | 0 | 0 | +6 | 0.5 | For idle. |"
    assert lines[4] == "| silent | did not act |  |  |  |  | 0.5 | For silent. |"
    assert lines[6].startswith("* strangers x1 3, hidden gravity: gravity (complete, right), error 1.000, held out 1.000")
    assert lines[7] == "  * without *useful*: dahl (complete, wrong), error 1.000, held out 1.000, 12.0 s"
    assert len(lines) == 8


def test_more_records_hold_those_of_fewer():
    assert set(search_ablation.drawn(2)) < set(search_ablation.drawn(5))
    assert len(search_ablation.drawn(10_000)) == sum(search_ablation.WHERE.values())


def test_an_answer_is_made_once(tmp_path):
    made = []
    for _ in range(2):
        row = search_ablation.kept(tmp_path / "case" / "rule.json", lambda: made.append(1) or {"found": []})
    assert row == {"found": []}
    assert made == [1]


def test_rules_have_files_of_their_own(tmp_path):
    assert len({search_ablation.file_of(tmp_path, rule) for rule in RULES}) == len(RULES)
