"""Figures from any input, even hardly any, and numbers with honest digits."""

import json

import matplotlib
import numpy as np
import pytest
from matplotlib.figure import Figure

from jaxbacklash.plot.drawing import on_page, to_png_data_uri, to_svg
from jaxbacklash.plot.joints import phase_plane, restoring_force
from jaxbacklash.plot.models import candidate_ranking, error_by_stage
from jaxbacklash.plot.style import error_decimals, format_interval, format_value, pretty_unit, short
from jaxbacklash.plot.thinning import envelope, extremes
from jaxbacklash.plot.times import measured_against_model, residual_in_time
from jaxbacklash.plot.zooms import worst_and_typical
from jaxbacklash.report.series import series_json

from .report_samples import EDGES, HOSTILE, NOISE, RATE, all_figures


@pytest.mark.parametrize(
    ("value", "stderr", "unit", "text"),
    [
        (0.02618, 1.1e-5, "rad", "0.026180 ± 0.000011 rad (1.5000 ± 0.0006 deg)"),
        (13000.5, 0.34, "N m/rad", "13000.50 ± 0.34 N m/rad"),
        (13000.5, 96.0, "N m/rad", "13000 ± 100 N m/rad"),
        (3.012e7, 2.2e5, "N m/rad^3", "(3.012 ± 0.022)×10⁷ N m/rad³"),
        (2.1e-6, 3.6e-7, "1/s", "(2.1 ± 0.4)×10⁻⁶ 1/s"),
        (0.0, 0.0012, "1", "0.0000 ± 0.0012"),
        (-0.00001, 0.0012, "1", "0.0000 ± 0.0012"),
        (12.0, None, "N m s/rad", "12.000 N m s/rad"),
        (None, None, "rad", "not determined"),
        (float("nan"), 1.0, "rad", "not determined"),
    ],
)
def test_value_has_the_digits_of_its_error(value, stderr, unit, text):
    assert format_value(value, stderr, unit) == text


def test_numbers_and_units():
    assert [error_decimals(e) for e in (0.0354, 0.0356, 0.0949, 0.096, 7.0, 99.0)] == [3, 2, 2, 1, 0, -2]
    assert pretty_unit("N m s^2/rad^-1") == "N m s²/rad⁻¹"
    assert short(3.06e-5) == "3.06×10⁻⁵"
    assert short(None) == short(float("inf")) == "–"
    assert format_interval([0.02616, 0.0262], 1.1e-5, "rad") == "0.026160 to 0.026200 rad"
    assert format_interval([None, 3.0], 0.2, "N m") == "-∞ to 3.00 N m"
    assert format_interval(None, None, "rad") == "–"


def test_thinning_keeps_peaks_and_breaks():
    y = np.zeros(200_000)
    y[123_457], y[50_001], y[170_003] = 5.0, -7.0, np.nan
    _, low, high = envelope(np.arange(y.size), y)
    assert np.nanmin(low) == -7.0
    assert np.nanmax(high) == 5.0
    kept = extremes([y, -y], 20_000)
    assert kept.size <= 20_000
    assert {0, 123_457, 50_001, 170_003, y.size - 1} <= set(kept.tolist())


def test_figures_draw_and_leave_matplotlib_alone():
    before = dict(matplotlib.rcParams)
    for name, figure in all_figures().items():
        svg = to_svg(figure)
        assert isinstance(figure, Figure)
        assert svg.startswith("<svg")
        assert svg.endswith("</svg>")
        assert len(svg) < 1_000_000, name
        assert "currentColor" in svg
        assert to_png_data_uri(figure, 40).startswith("data:image/png;base64,")
    assert dict(matplotlib.rcParams) == before


def test_figures_say_what_they_show():
    drawn = {name: to_svg(figure) for name, figure in all_figures().items()}
    assert "total play b = 0.02618 rad = 1.500 deg" in drawn["force"]
    assert "total play b = 0.02618 rad = 1.500 deg" in drawn["phase"]
    assert "torque of the joint [N m]" in drawn["force"]
    assert "costs $3 &amp; more" in drawn["ranking"]
    assert "z [rad]" in drawn["model"]
    assert ">12.9<" in drawn["stages"]


EMPTY = {"window_starts": [], "label": "z", "unit": "rad", "noise": None}
NOTHING = {
    "no samples": lambda: on_page(measured_against_model, [], [], [], **EMPTY),
    "three samples": lambda: on_page(measured_against_model, [0, 1, 2], [1, 1, 1], [1, np.nan, 1], **EMPTY),
    "no model": lambda: on_page(measured_against_model, np.arange(9), np.ones(9), np.full(9, np.nan), **EMPTY),
    "no residual": lambda: on_page(residual_in_time, [], [], window_edges=[], window_rms=[]),
    "all nan": lambda: on_page(residual_in_time, [0, 1], [np.nan] * 2, window_edges=[0], window_rms=[np.nan]),
    "huge": lambda: on_page(residual_in_time, [0, 1], [1e7, -3], window_edges=[0, 1], window_rms=[7e6]),
    "no motion": lambda: on_page(phase_plane, [], [], edges=None),
    "standing still": lambda: on_page(phase_plane, [0.1, 0.1], [0, 0], edges=(None, 0.1)),
    "no torque": lambda: on_page(restoring_force, [], [], model_z=None, model_torque=None, edges=None, unit="N"),
    "no play": lambda: on_page(restoring_force, [0], [1], model_z=[], model_torque=[], edges=[np.nan, 1], unit="N"),
    "no stages": lambda: on_page(error_by_stage, []),
    "null stage": lambda: on_page(error_by_stage, [{"rms_over_noise": None}]),
    "no candidates": lambda: on_page(candidate_ranking, []),
    "null candidate": lambda: on_page(candidate_ranking, [{"name": "dahl", "predicted_rms_over_noise": None}]),
}


@pytest.mark.parametrize("case", NOTHING)
def test_figures_of_nearly_nothing(case):
    assert to_svg(NOTHING[case]()).startswith("<svg")


def test_long_record_stays_small():
    t = np.arange(300_000) / RATE
    z = 0.02 * np.sin(20 * t)
    starts = np.arange(0, 600, 0.2)
    whole = on_page(measured_against_model, t, z, z, window_starts=starts, label="z", unit="rad", noise=NOISE)
    assert len(to_svg(whole)) < 1_000_000
    assert len(to_svg(on_page(phase_plane, z, np.gradient(z, t), edges=EDGES))) < 1_000_000
    data = json.loads(series_json({"t": t, "measured": z, "model": z, "residual_over_noise": z}))
    assert len(data["t"]) <= 20_000
    assert data["samples"] == 300_000


def test_series_breaks_are_null_and_close_no_script():
    text = series_json({"t": [0, 1], "measured": [1, np.nan], "model": [np.inf, 2], "label": HOSTILE})
    assert json.loads(text)["measured"] == [1.0, None]
    assert json.loads(text)["model"] == [None, 2.0]
    assert not set("<>&") & set(text)


def test_series_numbers_are_those_that_text_with_as_many_digits_gives():
    rng = np.random.default_rng(5)
    values = np.concatenate([rng.standard_normal(4000) * 10.0 ** rng.integers(-12, 9, 4000), [0.0, -0.0, 1e30, 123456789.5]])
    data = json.loads(series_json({"t": np.arange(values.size) / 500.0, "measured": values, "residual_over_noise": values}))
    assert data["t"] == [k / 500.0 for k in range(values.size)]
    for name, digits in (("measured", 7), ("residual", 4)):
        assert data[name] == [float(f"{value:.{digits}g}") for value in values]


@pytest.mark.parametrize(
    ("misfit", "shown"),
    [([1.0, 1.0, 5.0, 1.0, 1.1, 1.2, 1.3, 1.1], (2, 7)), ([1.0, 3.0, 1.1], (1, 2)), ([np.nan] * 3, (1, 1))],
)
def test_a_typical_window_is_not_shown_beside_the_worst_where_there_is_another(misfit, shown):
    assert worst_and_typical(np.asarray(misfit)) == shown
