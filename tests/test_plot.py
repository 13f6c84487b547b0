"""`jb.plot`: every picture draws the numbers that it is given, on axes of the user's choice and in the user's look."""

import re
from pathlib import Path

import matplotlib
import numpy as np
import pytest
from matplotlib import pyplot
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import jaxbacklash as jb
from jaxbacklash import plot
from jaxbacklash.plot.drawing import on_page
from jaxbacklash.plot.motion import Motion

from . import made_up
from .test_many import rows

matplotlib.use("Agg")


@pytest.fixture(autouse=True)
def closed():
    yield
    pyplot.close("all")


def one(draw, *args, **keywords):
    """What a plot draws on a single axes that somebody else has made."""
    ax = Figure(figsize=(6, 4)).subplots()
    assert draw(*args, ax=ax, **keywords) is ax
    return ax


def several(draw, count, *args, **keywords):
    """What a plot draws on as many axes as it has panels."""
    axes = list(Figure(figsize=(9, 9)).subplots(count))
    found = draw(*args, ax=axes, **keywords)
    assert list(found) == axes
    return axes


def curve(ax, x, y):
    """Whether one of an axes' lines has exactly these numbers."""
    lines = [line.get_data() for line in ax.get_lines()]
    return any(np.array_equal(a, x, equal_nan=True) and np.array_equal(b, y, equal_nan=True) for a, b in lines)


def steps(ax):
    """Values and edges of everything that is drawn in steps."""
    return [patch.get_data() for patch in ax.patches if hasattr(patch, "get_data")]


# ---- a fit beside its record ----


def test_a_fit_is_drawn_as_measured_and_predicted():
    fit = made_up.fit()
    for number, score in enumerate(fit.scores):
        ax = one(plot.fit, fit, record=number)
        assert curve(ax, score.t, score.measured)
        assert curve(ax, score.t, score.predicted)
        assert ax.get_ylabel() == "z [rad]"
    axes = several(plot.fit, 5, fit)
    rows = axes[1].get_lines()[0].get_xdata()
    inside = np.isin(fit.score.t, rows)
    assert curve(axes[1], fit.score.t[inside], fit.score.measured[inside])
    assert np.allclose(axes[3].get_lines()[-1].get_ydata(), fit.score.residual[inside])


def test_titles_of_a_fit_do_not_run_into_each_other():
    page = on_page(plot.fit, made_up.fit(miss=0.04))
    page.draw_without_rendering()
    first, second = (ax._left_title.get_window_extent() for ax in page.axes if ax.get_title(loc="left")[:2] in ("A,", "B,"))
    assert first.x1 < second.x0


def test_the_windows_that_are_shown_closely_tell_the_error_that_everything_else_tells():
    fit = made_up.fit(miss=0.04)
    axes = several(plot.fit, 5, fit)
    worst = int(np.nanargmax(fit.score.window_rms))
    title = " ".join(axes[1].get_title(loc="left").split())
    assert (
        title
        == f"A, missed most: {fit.score.window_rms[worst]:.3g} times the noise, window from {fit.score.window_times[worst]:.5g} s"
    )


def test_a_stretch_of_a_fit_is_drawn_window_by_window():
    fit, score = made_up.fit(), made_up.fit().score
    upper, lower = several(plot.fit, 2, fit, between=(1.0, 1.5))
    inside = (score.t >= 1.0) & (score.t <= 1.5)
    assert curve(upper, score.t[inside], score.measured[inside])
    predicted = [line.get_data() for line in upper.get_lines()[1:]]
    starts = [float(t[0]) for t, _ in predicted]
    assert np.allclose(starts, [1.0, 1.2, 1.4])
    assert np.array_equal(np.concatenate([values for _, values in predicted]), score.predicted[inside])
    assert np.allclose(lower.get_lines()[-1].get_ydata(), score.residual[inside])
    assert "No samples" in one(plot.fit, fit, between=(50.0, 60.0)).texts[0].get_text()


def test_residuals_and_the_misfit_of_each_window():
    fit, found = made_up.fit(), made_up.comparison()
    for shown, score in ((fit, fit.score), (found, found.score)):
        upper, lower = several(plot.residuals, 2, shown)
        assert curve(upper, score.t, score.residual)
        values, edges, _ = steps(lower)[0]
        assert np.array_equal(values, score.window_rms)
        assert np.array_equal(edges[:-1], score.window_times)


def test_a_record_is_drawn_channel_by_channel():
    record = made_up.record()
    for ax, (name, values) in zip(several(plot.record, 2, record), record.channels.items()):
        assert curve(ax, record.t, values)
        assert ax.get_ylabel() == f"{name} [rad]"


def test_the_joint_over_its_motion():
    fit = made_up.fit()
    ax = one(plot.restoring_force, fit)
    law = ax.get_lines()[2].get_data()
    expected = made_up.STIFFNESS * (law[0] - np.clip(law[0], -made_up.PLAY / 2, made_up.PLAY / 2))
    assert np.allclose(law[1], expected, atol=1e-6 * made_up.STIFFNESS)
    z = fit.records[0].channels["z"][10:-10]
    assert np.array_equal(ax.get_lines()[0].get_xdata(), z)
    points = ax.get_lines()[0].get_ydata()
    carried = Motion(fit.records[0], "z")
    # What a bare joint returns is what inertia and damping leave of nothing.
    expected = -made_up.INERTIA * carried.ddy - made_up.DAMPING * carried.dz
    assert np.allclose(points, expected[10:-10])
    edges = [line.get_xdata()[0] for line in ax.get_lines() if len(set(line.get_xdata())) == 1 and len(line.get_xdata()) == 2]
    assert np.allclose(sorted(edges)[:2], [-made_up.PLAY / 2, made_up.PLAY / 2])
    plane = one(plot.phase_plane, fit)
    left, right, bottom, top = plane.images[0].get_extent()
    assert left <= z.min() < z.max() <= right
    assert bottom < 0.0 < top
    assert plane.images[0].get_array().max() == 1.0
    assert one(plot.phase_plane, fit.records[0]).images


def test_what_a_record_does_not_hold_is_refused():
    loop = made_up.loop_fit()
    with pytest.raises(jb.BadInput, match="force_loop"):
        plot.phase_plane(loop)
    with pytest.raises(jb.BadInput, match="no transmitted force"):
        plot.force_loop(made_up.fit())
    with pytest.raises(jb.BadInput, match="record 2"):
        plot.fit(made_up.fit(), record=2)
    with pytest.raises(jb.BadInput, match="wanted a fit"):
        plot.residuals(made_up.ranking())
    with pytest.raises(jb.BadInput, match="record 7"):
        plot.missing_torque(made_up.latent(), record=7)


def test_the_force_loop():
    fit = made_up.loop_fit()
    record = fit.records[0]
    left, right = several(plot.force_loop, 2, fit)
    assert curve(left, record.channels["x"], record.channels["T"])
    assert curve(right, record.channels["x"], fit.score.predicted)
    both = one(plot.force_loop, fit)
    assert curve(both, record.channels["x"], record.channels["T"])
    assert curve(both, record.channels["x"], fit.score.predicted)


# ---- what is missing, and what was added ----


def test_stages_are_bars_of_the_error():
    found = made_up.refinement()
    held = [stage.fit.heldout.rms for stage in found.stages]
    for shown in (found, [stage.fit for stage in found.stages]):
        ax = one(plot.stages, shown)
        tops = [bar.get_y() + bar.get_height() for bar in ax.patches]
        assert np.allclose(tops, [*(stage.fit.score.rms for stage in found.stages), *held])
    words = [label.get_text() for label in one(plot.stages, found).get_xticklabels()]
    assert words[0] == "base model"
    assert "gravity" in words[1]
    assert "coulomb" in words[1]


def test_a_ranking_is_drawn_best_first_with_its_evidence():
    found = made_up.ranking()
    ax = one(plot.ranking, found)
    reach = [bar.get_x() + bar.get_width() for bar in ax.patches]
    assert np.allclose(reach, [1.02, 3.5])
    assert [label.get_text() for label in ax.get_yticklabels()] == ["gravity", "preload", "dahl"]
    told = [text.get_text() for text in ax.texts]
    assert {"812", "-4.0", "not evaluated"} <= set(told)
    assert any(np.allclose(line.get_xdata(), 12.9) for line in ax.get_lines())
    assert len(one(plot.ranking, found, most=1).patches) == 1


def test_the_missing_torque_in_time():
    found, latent = made_up.findings(), made_up.latent()
    here = latent.record == 1
    ax = one(plot.missing_torque, latent, record=1)
    t, torque = ax.get_lines()[0].get_data()
    rows = here & (latent.t >= t[0]) & (latent.t <= t[-1])
    assert np.array_equal(torque, latent.torque[rows])
    upper, lower = several(plot.missing_torque, 2, found)
    here = latent.record == 0
    assert curve(upper, latent.t[here], found.surface.torque[here])
    t, explained = lower.get_lines()[1].get_data()
    rows = here & (latent.t >= t[0]) & (latent.t <= t[-1])
    assert np.array_equal(explained, found.surface.fitted[rows])
    band = lower.collections[0].get_paths()[0].vertices
    assert np.isclose(band[:, 1].max(), np.max((found.surface.torque + 1.96 * latent.stderr)[rows]))


@pytest.mark.parametrize(("coordinates", "count"), [(("y",), 1), (("y", "z"), 2), (("side", "dz"), 3)])
def test_the_missing_torque_over_its_coordinates(coordinates, count):
    surface = made_up.surface(coordinates=coordinates)
    table = surface.table.reshape([len(row) for row in surface.knots])
    axes = [one(plot.torque_over, surface)] if count == 1 else several(plot.torque_over, count, surface)
    if count == 1:
        assert curve(axes[0], np.array(surface.knots[0]), surface.table)
        assert curve(axes[0], surface.coordinate_values[:, 0], surface.torque)
    elif count == 2:
        drawn = axes[0].collections[0].get_array()
        assert np.ma.allclose(drawn, table.T)
        assert len(axes[1].get_lines()) >= 3
    else:
        for ax, row in zip(axes, table):
            knots, values = ax.get_lines()[1].get_data()
            assert np.array_equal(values, row[np.isin(surface.knots[1], knots)])
    assert one(plot.torque_over, surface).get_ylabel()


def test_where_a_model_fails():
    found = made_up.findings()
    axes = several(plot.where_it_fails, 4, found)
    place, y = found.dependences[1], found.dependences[0]
    for upper, lower, entry in ((axes[0], axes[2], place), (axes[1], axes[3], y)):
        assert np.array_equal(steps(upper)[0][0], entry.misfit)
        assert np.array_equal(steps(lower)[0][0], entry.mean)
    assert np.array_equal(steps(axes[1])[0][1], y.edges)
    assert np.array_equal(steps(one(plot.where_it_fails, found))[0][0], place.misfit)
    assert "No torque" in one(plot.torque_over, made_up.adequate()).texts[0].get_text()
    assert "none of the coordinates" in one(plot.where_it_fails, made_up.adequate()).texts[0].get_text()


def test_a_parameter_over_the_records_and_its_change():
    of = jb.Each("fit", tuple(rows(40, growth=0.1)))
    told, ax = of.courses["backlash"], one(plot.course, of)
    assert curve(ax, told.numbers, told.values)
    bars = ax.collections[0].get_segments()
    assert np.allclose([bar[1, 1] - bar[0, 1] for bar in bars], 2 * 1.96 * told.stderr)
    assert curve(ax, [told.numbers[0], told.numbers[told.change.at] - 0.5], [told.change.before] * 2)
    assert curve(ax, [told.numbers[told.change.at] - 0.5, told.numbers[-1]], [told.change.after] * 2)
    still = jb.Each("fit", tuple(rows(40)))
    along, line = one(plot.course, still).get_lines()[-1].get_data()
    assert np.array_equal(line, still.courses["backlash"].trend.band(along)[0])
    with pytest.raises(jb.BadInput, match="no record has this parameter"):
        plot.course(of, "gravity.G")


# ---- axes, figures, looks ----


def test_without_axes_a_figure_of_pyplot_is_made_in_the_users_colours():
    before = dict(matplotlib.rcParams)
    axes = plot.residuals(made_up.fit())
    assert isinstance(axes, np.ndarray)
    assert axes[0].figure.number in pyplot.get_fignums()
    with pyplot.style.context("dark_background"):
        ax = plot.restoring_force(made_up.fit())
        assert isinstance(ax, Axes)
        assert ax.xaxis.label.get_color() == "white"
        assert matplotlib.colors.to_hex(ax.figure.get_facecolor()) == "#000000"
        guides = [line for line in ax.get_lines() if np.allclose(line.get_ydata(), 0.0) and len(line.get_ydata()) == 2]
        assert guides
        assert all(line.get_color() == "white" for line in guides)
    assert dict(matplotlib.rcParams) == before


def test_a_figure_or_part_of_one_is_laid_out():
    figure = Figure(figsize=(5, 5), layout="constrained")
    left, right = figure.subfigures(1, 2)
    assert len(plot.residuals(made_up.fit(), ax=left)) == 2
    assert len(plot.fit(made_up.fit(), ax=right)) == 5
    assert tuple(figure.get_size_inches()) == (5, 5)
    assert len(left.axes) == 2


def test_a_users_axes_keep_their_look():
    figure = Figure()
    ax = figure.subplots()
    before = ax.spines["top"].get_visible(), ax.xaxis.label.get_size()
    plot.stages(made_up.fit(), ax=ax)
    assert (ax.spines["top"].get_visible(), ax.xaxis.label.get_size()) == before


@pytest.mark.parametrize(
    ("ax", "said"),
    [("left", "a str"), ([1, 2], "a int"), (3, "a int"), (lambda: Figure().subplots(3), "3 axes, wanted one matplotlib axes, 2")],
)
def test_other_things_than_axes_are_refused_in_a_sentence(ax, said):
    with pytest.raises(jb.BadInput, match=said):
        plot.residuals(made_up.fit(), ax=ax() if callable(ax) else ax)


def test_every_public_plot_takes_axes_and_says_what_comes_back():
    import inspect

    assert {"fit", "residuals", "missing_torque", "ranking", "stages", "restoring_force", "skeleton", "map", "bifurcation",
            "chaos"} <= set(plot.__all__)  # fmt: skip
    for name in plot.__all__:
        draw = getattr(plot, name)
        assert inspect.signature(draw).parameters["ax"].kind is inspect.Parameter.KEYWORD_ONLY, name
        assert "ax : " in draw.__doc__, name
        assert "Returns" in draw.__doc__, name
    told = "".join(path.read_text(encoding="utf-8") for path in Path(__file__).parent.glob("test_*.py"))
    assert not [name for name in plot.__all__ if not re.search(rf"\bplot\.{name}\b", told)], "no test of what it draws"
