"""`jb.plot` of skeletons, responses, chaos, maps and signatures: the numbers that are given are the numbers that are drawn."""

import dataclasses

import numpy as np
import pytest

import jaxbacklash as jb
from jaxbacklash import plot
from jaxbacklash.dynamics import Attractor, Basins

from .test_frequency_response import preloaded
from .test_plot import curve, one, several
from .test_signature import AMPLITUDES, made_up, windowed
from .test_signature_figures import levels

xarray = pytest.importorskip("xarray")


@pytest.fixture(scope="module")
def skeletons():
    t = np.arange(0.0, 14.0, 2e-3)
    x = 0.04 * np.sin(2.0 * np.pi * (1.0 + 0.3 * t) * t)
    z = 0.03 * np.sin(2.0 * np.pi * (1.0 + 0.3 * t) * t - 0.6) * (1.0 + 0.05 * t)
    return jb.skeleton(jb.Record(t, {"x": x, "z": z}), inertia=3.16)


def test_skeletons(skeletons):
    drive, answer = several(plot.envelopes, 2, skeletons)
    for method in skeletons.methods:
        assert curve(drive, method.t, method.drive)
        assert curve(answer, method.t, method.amplitude)
        assert curve(one(plot.instantaneous_frequency, skeletons), method.t, method.frequency)
        kept = method.kept
        assert curve(one(plot.skeleton, skeletons), method.amplitude[kept], method.restoring_force[kept])
        natural, damping = several(plot.backbone, 2, skeletons)
        assert curve(natural, method.amplitude[kept], np.sqrt(np.maximum(method.stiffness[kept], 0.0)) / (2.0 * np.pi))
        assert curve(damping, method.amplitude[kept], method.damping[kept])
    along = skeletons.wavelet.along
    ridge = one(plot.ridge, skeletons)
    assert curve(ridge, along.picture.t, along.path)
    size = np.abs(along.picture.values)
    assert np.argmax(ridge.collections[0].get_array()) == np.argmax(size)


def test_a_frequency_response():
    found = jb.frequency_response(preloaded("random", 2, seconds=30.0), band=(4.0, 40.0))
    size, phase, share = several(plot.frequency_response, 3, found)
    f = size.get_lines()[1].get_xdata()
    shown = np.isin(found.frequency, f)
    assert curve(size, f, np.abs(found.h1[shown]))
    assert curve(size, f, np.abs(found.h2[shown]))
    assert curve(share, f, found.coherence[shown])
    turned = np.exp(1j * np.radians(phase.get_lines()[0].get_ydata()))
    assert np.allclose(turned, found.h1[shown] / np.abs(found.h1[shown]))


@pytest.fixture(scope="module")
def chaotic():
    from .independent.chaotic import HENON

    return jb.chaos(HENON.series(1200, 1, 3)[0], 0.01)


def test_chaos(chaotic):
    found = chaotic
    lags = found.curve.lags
    ax = one(plot.stretching, found)
    factor = 1e3 if lags[-1] * found.dt < 1.0 else 1.0
    named = {line.get_label(): line.get_data() for line in ax.get_lines()}
    for label, values in (("Kantz, averaged over a swing", found.curve.smooth), ("Rosenstein", found.curve.rosenstein)):
        assert np.array_equal(named[label][0], factor * found.dt * lags)
        assert np.array_equal(named[label][1], values)
    assert np.allclose(named["unrelated points"][1], found.curve.plateau)
    assert curve(one(plot.chaos, found), factor * found.dt * lags, found.curve.rosenstein)
    four = several(plot.chaos, 4, found)
    assert curve(four[3], found.walk.p, found.walk.q)
    left, right = several(plot.surrogates, 2, found)
    assert sum(bar.get_height() for bar in left.patches) == found.surrogates.count
    assert np.allclose(left.get_lines()[0].get_xdata(), found.surrogates.statistic)
    assert curve(right, found.walk.p, found.walk.q)
    untold = np.where(np.arange(found.surrogates.count) < 3, found.surrogates.surrogates, np.nan)
    for surrogates, bars in ((untold, 3), (np.full_like(untold, np.nan), 0)):
        some = dataclasses.replace(found, surrogates=dataclasses.replace(found.surrogates, surrogates=surrogates))
        left = several(plot.surrogates, 2, some)[0]
        assert sum(bar.get_height() for bar in left.patches) == bars
    values = found.mean + found.deviation * (found.cleaned.series if found.cleaned is not None else found.series)
    later = found.delay.samples
    assert curve(one(plot.attractor, found), values[:-later], values[later:])
    assert curve(one(plot.delay, found), found.delay.lags, found.delay.information)
    raw = found.raw_dimension
    e1, neighbours = several(plot.dimension, 2, found)
    assert curve(e1, raw.dimensions, raw.e1)
    assert curve(e1, raw.dimensions, raw.e2)
    assert curve(neighbours, raw.dimensions, 100.0 * raw.false_share)
    sums, slopes = several(plot.correlation, 2, found)
    for row in found.correlation.sums:
        assert curve(sums, found.correlation.radii[row > 0.0], row[row > 0.0])
    assert slopes.get_lines()
    whole, some = several(plot.series, 2, found, "z", "rad")
    _, drawn = some.get_lines()[0].get_data()
    full = found.mean + found.deviation * found.series
    first = int(np.argmin(np.abs(full - drawn[0])))
    assert np.array_equal(drawn, full[first : first + drawn.size])
    assert whole.get_ylabel() == "z [rad]"
    assert "No law" in one(plot.driven_growth, found).texts[0].get_text()


def test_growth_under_a_drive():
    from .test_timeseries_driven import DT, swept

    x, z, _ = swept(0.055)
    found = jb.chaos(z, DT, drive=x, clean=False)
    law, growth = several(plot.driven_growth, 2, found)
    one_ = found.driven
    assert np.allclose(growth.get_lines()[0].get_ydata(), np.concatenate([[0.0], np.cumsum(one_.rates)]))
    assert np.allclose(law.get_lines()[0].get_ydata(), -one_.deviation * one_.surface.force / found.dt**2)


def made_up_map(unit="half play", axis="1"):
    rng = np.random.default_rng(1)
    a, b = np.linspace(1.0, 2.0, 5), np.linspace(0.01, 0.03, 4)
    size = (5, 4)
    return xarray.Dataset(
        {
            "lyapunov": (("inverse_alpha", "zeta"), rng.standard_normal(size), {"units": "1/tau"}),
            "lyapunov_stderr": (("inverse_alpha", "zeta"), 0.01 * np.ones(size)),
            "period": (("inverse_alpha", "zeta"), rng.integers(-1, 5, size)),
            "poincare": (("sample", "inverse_alpha", "zeta"), rng.standard_normal((6, *size)), {"units": unit}),
        },
        {"inverse_alpha": ("inverse_alpha", a, {"units": axis}), "zeta": ("zeta", b, {"units": "1"})},
    )


def test_maps_of_two_parameters_and_of_one():
    found = made_up_map()
    exponent, period = several(plot.map, 2, found)
    assert np.array_equal(exponent.images[0].get_array(), found.lyapunov.values.T)
    assert np.array_equal(period.images[0].get_array(), found.period.values.T + 1)
    assert (exponent.get_xlabel(), exponent.get_ylabel()) == ("1/α", "ζ")
    assert exponent.images[0].get_extent()[0] == pytest.approx(1.0 - 0.125)
    line = found.isel(zeta=1)
    upper, lower = several(plot.exponents, 2, line)
    assert curve(upper, line.inverse_alpha.values, line.lyapunov.values)
    assert np.array_equal(lower.get_lines()[0].get_ydata(), line.poincare.values.ravel())
    assert lower.get_ylabel() == "p at whole periods [half plays]"
    assert len(one(plot.exponents, line, samples=False).get_lines()) == 4
    angles = made_up_map("rad", "rad").isel(zeta=0)
    upper, lower = several(plot.exponents, 2, angles, degrees=True)
    assert curve(upper, np.degrees(angles.inverse_alpha.values), angles.lyapunov.values)
    assert lower.get_xlabel() == "1/α [deg]"
    assert lower.get_ylabel() == "z at whole periods [rad]"
    with pytest.raises(jb.BadInput, match="wanted one axis"):
        plot.exponents(found)
    with pytest.raises(jb.BadInput, match="wanted 2 axes"):
        plot.map(line)
    with pytest.raises(jb.BadInput, match="no exponents"):
        plot.map(found[["period"]])
    with pytest.raises(jb.BadInput, match="no sweep"):
        plot.bifurcation(found)


def test_sweeps():
    rng = np.random.default_rng(2)
    at = np.linspace(3.0, 4.0, 6)
    found = xarray.Dataset(
        {
            **{way: (("sample", "inverse_alpha"), rng.standard_normal((5, 6)), {"units": "half play"})
               for way in ("swept_up", "swept_down")},
            "swept_up_lyapunov": (("inverse_alpha",), rng.standard_normal(6)),
            "from_starts": (("sample", "start", "inverse_alpha"), rng.standard_normal((5, 3, 6))),
        },
        {"inverse_alpha": ("inverse_alpha", at, {"units": "1"})},
    )  # fmt: skip
    axes = several(plot.bifurcation, 3, found)
    for ax, name in zip(axes, ("swept_up", "swept_down", "from_starts")):
        assert np.array_equal(ax.get_lines()[0].get_ydata(), found[name].values.ravel())
    assert axes[2].get_title(loc="left") == "from 3 starts"
    both = one(plot.bifurcation, found)
    assert np.array_equal(both.get_lines()[0].get_ydata(), found.swept_up.values.ravel())
    assert len([patch for patch in both.patches if patch.get_alpha() == 0.15]) == 1


def test_basins():
    number = np.array([[0, 1, -1], [1, 0, 0]])
    found = Basins(
        np.array([-1.0, 1.0]), np.array([-1.0, 0.0, 1.0]), number,
        [Attractor(1, -0.02, np.array([0.3]), np.array([0.1]), 0.5), Attractor(0, 0.1, np.arange(3.0), np.arange(3.0), 0.3)],
        "half play",
    )  # fmt: skip
    ax = one(plot.basins, found)
    assert np.array_equal(ax.images[0].get_array(), number.T + 1)
    assert curve(ax, np.arange(3.0), np.arange(3.0))
    assert ax.get_xlabel() == "p at the start [half plays]"
    assert one(plot.basins, found._replace(unit="rad")).get_xlabel() == "z at the start [rad]"


def test_signatures():
    map_ = windowed()
    found = jb.signature.play_from_exponents(map_, levels())
    ax = one(plot.exponent_over_drive, map_, found)
    row, seen = map_.exponent[0], map_.chaotic[0]
    assert curve(ax, map_.ratios[seen], row[seen])
    assert curve(ax, map_.ratios[~seen], row[~seen])
    upper, lower = several(plot.play_likelihood, 2, found)
    drawn = lower.collections[0].get_paths()[0].vertices
    assert drawn[:, 1].max() == pytest.approx(found.density.max())
    assert len(upper.collections) == len(found.levels)
    wanted = jb.signature.expected_precision(map_, AMPLITUDES, (0.021, 0.045), experiments=5)
    ax = one(plot.expected_precision, wanted)
    some = wanted.determined & wanted.covered
    assert curve(ax, np.degrees(wanted.play)[some], 100.0 * wanted.half_width[some])
    over = made_up(np.stack([row, np.roll(row, 40), -np.ones_like(row)]), {"linear_gravity.G": np.array([-60.0, -30.0, 0.0])})
    seen = np.array([False, False, True, True, True, True, False, False])
    match = jb.signature.match_pattern(over, AMPLITUDES, seen, np.radians([1.4, 1.5, 1.6]))
    best, mean = several(plot.pattern_region, 2, match)
    for ax in (best, mean):
        assert np.ma.allclose(ax.collections[0].get_array(), match.chance.T)
