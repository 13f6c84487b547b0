"""The figures of chaos as a signature of the play draw what they are given, also when there is little to draw."""

import numpy as np
import pytest

from jaxbacklash import plot
from jaxbacklash.plot import twins
from jaxbacklash.plot.drawing import on_page, svg_of, to_svg
from jaxbacklash.signature import Level, expected_precision, match_pattern, play_from_exponents

from .test_signature import AMPLITUDES, made_up, windowed


def levels(play=0.03):
    map_ = windowed()
    at = np.rint(map_.place(AMPLITUDES, play)).astype(int)
    return [
        Level(a, "chaotic", map_.exponent[0, k], 0.05) if map_.chaotic[0, k] else Level(a, "regular")
        for a, k in zip(AMPLITUDES, at)
    ]


def test_levels_stand_on_the_map_where_the_play_puts_them():
    found = play_from_exponents(windowed(), levels())
    figure = on_page(plot.exponent_over_drive, windowed(), found)
    marks = [line for line in figure.axes[0].get_lines() if line.get_marker() == "s"]
    assert marks
    chaotic = [level.amplitude / found.value for level in found.levels if level.word == "chaotic"]
    np.testing.assert_allclose(np.asarray(marks[0].get_xdata(), float), chaotic)
    assert "amplitude of the base / total play" in to_svg(figure)


def test_the_likelihood_has_a_row_a_level_and_the_truth():
    found = play_from_exponents(windowed(), [*levels(), Level(0.08, "undecided")], plays=(0.021, 0.045))
    figure = on_page(plot.play_likelihood, found, truth=0.03, fit=(0.0299, 0.0301))
    drawn = to_svg(figure)
    assert len(figure.axes[0].get_yticks()) == 9
    assert "4.58° undecided" in drawn
    assert "true play" in drawn
    assert "direct fit" in drawn
    assert "likelihood" in svg_of(plot.play_likelihood, found)


def test_patterns_and_expected_precision():
    base = windowed().exponent[0]
    map_ = made_up(np.stack([base, np.roll(base, 40), -np.ones_like(base)]), {"linear_gravity.G": np.array([-60.0, -30.0, 0.0])})
    match = match_pattern(map_, AMPLITUDES, [False, False, True, True, True, True, False, False], np.radians([1.4, 1.5, 1.6]))
    assert "gravity G" in svg_of(plot.pattern_region, match)
    assert "no two axes" in svg_of(plot.pattern_region, match, across="damping")
    one = expected_precision(windowed(), AMPLITUDES, (0.021, 0.045), experiments=6)
    nothing = expected_precision(made_up(np.ones(301)), AMPLITUDES, (0.021, 0.045), experiments=3)
    assert not nothing.determined.any()
    assert "comes out of 0 %" in str(nothing)
    assert "no play determined" in svg_of(plot.expected_precision, {"eight": one, "flat": nothing})


@pytest.mark.parametrize("paper", [None, np.array([0.0, 1.4])])
def test_bars_of_a_verdict_without_a_number(paper):
    figure = on_page(
        twins.exponent_bars, [1.34, 2.68], [[0.0, 1.3], [0.0, 1.5]], [np.nan, 1.4], [[np.nan, np.nan], [1.2, 1.6]],
        ["regular", "chaotic"], paper=paper,
    )  # fmt: skip
    drawn = to_svg(figure)
    assert "2.68°" in drawn
    assert ("Table 2" in drawn) == (paper is not None)


def test_twins_of_the_published_figures():
    t = np.linspace(0.0, 6.0, 900)
    z = np.sin(7 * t)
    panels = [(f"{k}°", z, k % 2 == 0) for k in range(5)]
    assert "20 samples later" in svg_of(twins.phase_plots, panels, 20)
    assert "error" in svg_of(twins.cleaned_signal, t, z + 0.1, z, z)
    assert "error" not in svg_of(twins.cleaned_signal, t, z + 0.1, z)
    e1 = np.linspace(0.3, 1.0, 8)
    drawn = svg_of(twins.cao_before_and_after, np.arange(1, 9), e1, e1, (5, None))
    assert "dimension 5" in drawn
    assert "no dimension found" in drawn
