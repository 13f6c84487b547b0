"""The referee of the accuracy benchmark, and the step that says why two programs disagree about a cell."""

import numpy as np
import pytest

pytest.importorskip("numba")

from benchmarks import map_accuracy as accuracy

from .independent import exponents, taylor


@pytest.mark.parametrize(
    "cell", [exponents.Cell(2.0, 0.02), exponents.Cell(0.65, 0.023, 0.227, 1.0 / 31.0), exponents.Cell(2.0, 0.02, 0.2, cc=0.3)]
)
def test_the_taylor_series_are_scipy_with_events(cell):
    _, samples, growth = exponents.follow(cell, 4, 0, rtol=1e-12, atol=1e-14)
    ours, grown, tangent = taylor.follow(cell, 4)
    assert np.abs(ours - samples).max() < 1e-8
    assert np.abs(grown - growth).max() < 1e-8
    assert np.hypot(*tangent) == pytest.approx(1.0)


def test_the_taylor_series_start_in_contact_as_well():
    cell = exponents.Cell(3.0, 0.02)
    _, samples, _ = exponents.follow(cell, 3, 0, start=(-1.8, 0.4), rtol=1e-12, atol=1e-14)
    assert np.abs(taylor.follow(cell, 3, start=(-1.8, 0.4))[0] - samples).max() < 1e-8


def line(exponent, end):
    cells = len(exponent)
    return accuracy.Line(np.array(exponent), np.full(cells, 1e-3), np.zeros((32, cells)), np.array(end, dtype=float))


def program(by_place, transient):
    """A program on a line of two attractors, whose exponents are those of the sides of zero; until ``transient`` it says +1."""

    def follow(cells, periods, skip, start):
        side = np.where(start[0] == 0.0, by_place, np.sign(start[0]))
        exponent = np.where((periods <= transient) & (start[0] == 0.0), 1.0, np.where(side > 0.0, 0.1, -0.1))
        return line(exponent[: len(cells)], [side[: len(cells)], 0.0 * cells])

    return follow


@pytest.mark.parametrize(
    ("ours", "referee", "word"),
    [
        (program(-1.0, 400), program(-1.0, 0), "transient"),  # settles within five times as long
        (program(-1.0, 1500), program(-1.0, 0), "transient"),  # settles within twenty-five times
        (program(-1.0, 0), program(1.0, 0), "two attractors"),
    ],
)
def test_disagreements_are_explained(ours, referee, word):
    (answer,) = accuracy.explain_sign(np.array([2.0]), 100, ours, referee)
    assert answer.startswith(word)


def test_a_program_that_is_wrong_is_not_explained_away():
    def always(value):
        return lambda cells, periods, skip, start: line(np.full(len(cells), value), np.ones((2, len(cells))))

    answers = accuracy.explain_sign(np.array([2.0, 3.0]), 100, always(-0.1), always(0.1))
    assert all(answer.startswith("not explained") for answer in answers)


def test_real_cells_are_explained_and_agree(capsys):
    """Two regular cells and a chaotic one, by both programs."""
    inverse_alpha = np.array([3.0, 3.6, 4.7])
    rest = np.zeros((2, 3))
    ours, referee = (f(inverse_alpha, 60, 20, rest) for f in (accuracy.by_ours, accuracy.by_taylor))
    unlike = accuracy.compare("both", ours, referee)
    assert unlike.size == 0
    assert "met" in capsys.readouterr().out
    both = accuracy.by_ours, accuracy.by_taylor
    left, settled = accuracy.explain_regular(inverse_alpha[:2], 40, referee.end[:, :2], *both)
    assert left.max() < 1e-6
    assert settled.max() == 40


def test_a_cell_that_never_settles_is_said_not_to():
    """Two programs that differ by more than 1e-4 wherever they start."""

    def says(value):
        return lambda cells, periods, skip, start: line(np.full(len(cells), value), np.ones((2, len(cells))))

    left, settled = accuracy.explain_regular(np.array([2.0]), 10, np.zeros((2, 1)), says(-0.1), says(-0.2), (5, 25))
    assert left[0] == pytest.approx(0.1)
    assert settled[0] == 250


def test_the_divergence_is_found():
    inverse_alpha = np.array([3.0])
    assert accuracy.divergence(inverse_alpha[:1]) < 1e-8


@pytest.mark.slow
def test_scipy_runs_in_processes_of_its_own():
    """After jax has started its threads: spawned, so that nothing can hang."""
    found = accuracy.by_scipy(np.array([3.0]), 22, 2, 1)
    ours = accuracy.by_ours(np.array([3.0]), 22, 2, np.zeros((2, 1)))
    np.testing.assert_allclose(found.samples[-len(ours.samples) :], ours.samples, atol=1e-5)
