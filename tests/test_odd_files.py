"""Odd files as people bring them, drawn at random with a seed: read right, or rightly refused, never silently wrong."""

import pytest

from tests.odd_files.draw import draft_of, plan
from tests.odd_files.judge import judge
from tests.odd_files.kinds import KINDS

FILES = plan(150, seed=0)
NAMES = [f"{index}-{'-'.join(kind.name for kind in kinds)}" for index, kinds in enumerate(FILES)]

FITTED = range(0, len(FILES), 6)
"""The files that are fitted as well; ``python -m tests.odd_files --full`` fits all of them."""


def judged(index, folder, full=False):
    for kind in FILES[index]:
        if kind.library:
            pytest.importorskip(kind.library)
    return judge(draft_of(FILES[index], index), folder, full)


def test_every_kind_is_drawn_and_a_third_of_the_files_has_two():
    assert set(KINDS) == {kind.name for kinds in FILES for kind in kinds}
    assert 45 <= sum(len(kinds) == 2 for kinds in FILES) <= 55


@pytest.mark.parametrize("index", range(len(FILES)), ids=NAMES)
def test_an_odd_file_is_read_right_or_rightly_refused(tmp_path, index):
    """Up to the fit: the record arrives as it was written, or a sentence says why not, and its text to paste works."""
    verdict = judged(index, tmp_path)
    assert not verdict.failed, f"{verdict.found}: {verdict.command}\n{verdict.detail}"


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(
    "names", ["bursts unit_row", "repeated_stamps unit_row", "name_twice unit_row", "repeated_stamps two_clocks"]
)
def test_units_are_those_of_all_columns_and_one_remedy_answers_one_kind(tmp_path, names, seed):
    """Pairs that the plan above does not draw: a row of units over times of another kind, a drift behind stamps that repeat."""
    verdict = judge(draft_of([KINDS[name] for name in names.split()], 0, seed), tmp_path)
    assert not verdict.failed, f"{verdict.found}: {verdict.command}\n{verdict.detail}"


@pytest.mark.slow
@pytest.mark.parametrize("index", FITTED, ids=[NAMES[index] for index in FITTED])
def test_no_interval_excludes_the_truth_without_a_word(tmp_path, index):
    verdict = judged(index, tmp_path, full=True)
    assert not verdict.failed, f"{verdict.found}: {verdict.command}\n{verdict.detail}"
