"""Bad input drawn at random: exit code 2 or 1 with one sentence, or a right answer; nothing hangs, is lost or half written."""

import pytest

from tests.fuzz.draw import case_of, plan
from tests.fuzz.run import Worker, alone
from tests.fuzz.verdict import judge, snapshot

COUNT, SEED = 500, 0
PLAN = plan(COUNT, SEED)
QUICK = [index for index, kind in enumerate(PLAN) if not kind.alone and kind.name != "maps" and kind.door != "stores"][:40]
"""Cases for every day: those that need no process of their own."""
DRAWN = range(3, COUNT, 10)
"""A tenth of all cases; ``python -m tests.fuzz --count 500`` runs the whole."""
LONG = ("refine", "diagnose")
"""Commands that take long where they are given what they can use."""


@pytest.fixture(scope="module")
def worker():
    warm = Worker()
    yield warm
    warm.close()


def complaints(index, folder, worker, without=()):
    kind = PLAN[index]
    case = case_of(kind, index, SEED, folder)
    if case.words and case.words[0] in without:
        pytest.skip("a long command")
    before = snapshot(folder)
    run = alone(case, folder) if case.alone else worker(case, folder)
    return judge(case, run, before, snapshot(folder), folder).complaints, case.words, run.err[-500:]


def test_every_kind_is_drawn():
    assert len(PLAN) == COUNT
    assert len({kind.name for kind in PLAN}) >= 45


@pytest.mark.parametrize("index", QUICK, ids=[f"{index}-{PLAN[index].name}" for index in QUICK])
def test_bad_input_of_every_day(tmp_path, worker, index):
    found, words, told = complaints(index, tmp_path, worker, without=LONG)
    assert not found, f"{words}\n{told}"


@pytest.mark.slow
@pytest.mark.parametrize("index", DRAWN, ids=[f"{index}-{PLAN[index].name}" for index in DRAWN])
def test_bad_input(tmp_path, worker, index):
    found, words, told = complaints(index, tmp_path, worker)
    assert not found, f"{words}\n{told}"
