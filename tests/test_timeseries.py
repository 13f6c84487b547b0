"""Chaos from a series: each tool against what is known exactly, and the verdict on signals of every kind."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

from jaxbacklash import BadInput, chaos
from jaxbacklash.timeseries import (
    aaft,
    choose_delay,
    correlation,
    embed,
    embedding_dimension,
    fourier,
    iaaft,
    largest_exponent,
    mean_period,
    mutual_information,
    projective,
    simple,
    stretching,
    zero_one,
)
from jaxbacklash.timeseries.analyse import _drive_period
from jaxbacklash.timeseries.neighbours import nearest, references
from jaxbacklash.timeseries.region import straight_part
from jaxbacklash.timeseries.stationarity import kept_company
from jaxbacklash.timeseries.surrogates import matched_ends

from .independent.chaotic import HENON, LOGISTIC, LORENZ, ROSSLER, ar2, torus, with_noise


def rng(seed=0):
    return np.random.default_rng(seed)


def standard(series):
    return (series - series.mean()) / series.std()


@pytest.fixture(scope="module")
def henon():
    return standard(HENON.series(3000, 1, 2)[0])


@pytest.fixture(scope="module")
def lorenz():
    return standard(LORENZ.series(4000, 1, 2)[0])


# ---- Neighbours ----


def test_delay_vectors():
    found = embed(np.arange(10.0), 3, 2)
    assert found.shape == (6, 3)
    assert found[1].tolist() == [1.0, 3.0, 5.0]


@pytest.mark.parametrize("p", [2.0, np.inf])
def test_neighbours_are_those_of_all_pairs_outside_the_window(p):
    points = rng(1).standard_normal((400, 3)).cumsum(axis=0)
    apart = np.linalg.norm(points[:, None] - points[None], ord=p, axis=2)
    index = np.arange(400)
    apart[np.abs(index[:, None] - index[None]) <= 20] = np.inf
    distances, indices = nearest(cKDTree(points), points, index, 5, 20, p=p)
    assert np.allclose(distances, np.sort(apart, axis=1)[:, :5])
    assert np.all(np.abs(indices - index[:, None]) > 20)


def test_a_point_with_too_few_neighbours_says_so():
    points = rng(2).standard_normal((30, 2))
    distances, indices = nearest(cKDTree(points), points, np.arange(30), 10, 12)
    assert np.all((indices >= 0) == np.isfinite(distances))
    assert (indices[15] >= 0).sum() == 5  # 0 to 2 and 28, 29 are further than 12 from 15


def test_reference_points_are_spread_and_repeatable():
    found = references(100_000, 500, rng(3))
    assert found.size == 500
    assert np.all(np.diff(found) > 0)
    assert np.array_equal(found, references(100_000, 500, rng(3)))
    assert np.array_equal(found // 200, np.arange(500))


# ---- Delay and dimension ----


@pytest.mark.parametrize("rho", [0.0, 0.5, 0.9])
def test_mutual_information_of_gaussian_pairs(rho):
    a, b = rng(4).standard_normal((2, 4000))
    found = mutual_information(a, rho * a + np.sqrt(1.0 - rho**2) * b)
    assert found == pytest.approx(-0.5 * np.log(1.0 - rho**2), abs=0.05)


def test_delay_of_a_map_is_one_and_of_a_flow_a_part_of_its_swing(henon, lorenz):
    assert choose_delay(henon, rng()).samples == 1
    found = choose_delay(lorenz, rng())
    assert 5 <= found.samples <= 11  # about 0.16 time units, the literature's first minimum
    assert "minimum" in found.why


def test_a_swing_of_a_sine_with_noise():
    t = np.arange(4000)
    assert mean_period(np.sin(2.0 * np.pi * t / 37.0) + 0.05 * rng(5).standard_normal(t.size)) == pytest.approx(37.0, rel=0.01)


def test_embedding_dimension_of_known_attractors(henon, lorenz):
    assert embedding_dimension(henon, 1, 3, rng()).cao == 2
    assert embedding_dimension(henon, 1, 3, rng()).false_neighbours == 2
    assert embedding_dimension(lorenz, 8, 50, rng()).cao == 3


def test_noise_has_no_dimension_and_e2_near_one():
    found = embedding_dimension(rng(6).standard_normal(3000), 1, 3, rng())
    assert np.all(np.abs(found.e2[1:6] - 1.0) < 0.15)
    assert found.false_neighbours is None or found.false_neighbours > 4


def test_dimension_falls_when_noise_is_taken_off(henon):
    noisy = with_noise(henon, 0.03)
    cleaned = projective(noisy, window=6).series
    raw, after = (embedding_dimension(one, 1, 3, rng()).cao for one in (noisy, cleaned))
    assert raw is not None
    assert after is not None
    assert after < raw


# ---- Noise reduction ----


def test_noise_reduction_gains_and_says_how_much(lorenz):
    noisy = with_noise(lorenz, 0.02)
    found = projective(noisy, window=15)
    gain = 20.0 * np.log10(0.02 / np.sqrt(np.mean((found.series - lorenz) ** 2)))
    assert gain > 5.0
    assert found.gain_db == pytest.approx(gain, abs=4.0)
    assert found.noise == pytest.approx(0.02, rel=0.15)


def test_the_papers_simple_reduction_gains_too(henon):
    noisy = with_noise(henon, 0.05)
    left = np.sqrt(np.mean((simple(noisy, window=5).series - henon) ** 2))
    assert left < 0.7 * 0.05


@pytest.mark.parametrize(("name", "window"), [pytest.param("lorenz", 15, marks=pytest.mark.slow), ("henon", 6)])
def test_noise_reduction_does_not_invent_chaos(name, window, request):
    """Cleaned first and passed off as measured: a surrogate of a map is as good as white, and a projection would fold it."""
    for made in iaaft(request.getfixturevalue(name), 3, rng(7)):
        found = chaos(standard(projective(made, window=window).series), clean=False)
        assert found.verdict.word != "chaotic"
        assert found.lyapunov is None


@pytest.mark.parametrize("method", [simple, projective])
def test_too_much_noise_and_too_little_are_left_as_they_are(method, henon):
    noise = rng(8).standard_normal(2000)
    for series, why in ((noise, "too much"), (with_noise(henon, 3e-4), "too little")):
        found = method(series, window=6)
        assert found.why_untouched.startswith(why)
        assert found.gain_db is None
        assert np.array_equal(found.series, series)
    assert method(with_noise(henon, 0.1), window=6).why_untouched is None


# ---- Exponent ----


@pytest.mark.parametrize(("system", "share"), [(LOGISTIC, 0.10), (HENON, 0.10)])
@pytest.mark.parametrize("noise", [0.0, 0.02])
def test_exponent_of_maps(system, share, noise):
    series = with_noise(system.series(3000, 1, 5)[0], noise)
    found = largest_exponent(standard(series), 1, 3, rng())
    assert found.value == pytest.approx(system.published, rel=share + 5 * noise)
    assert found.interval[0] < system.published < found.interval[1]
    assert found.predicts


@pytest.mark.parametrize("noise", [0.0, pytest.param(0.02, marks=pytest.mark.slow)])
def test_exponent_of_lorenz(noise):
    series = with_noise(LORENZ.series(5000, 1, 6)[0], noise)
    found = chaos(series, LORENZ.dt, clean=bool(noise))
    assert found.lyapunov == pytest.approx(0.906, rel=0.10 + 5 * noise)
    assert found.interval[0] < 0.906 < found.interval[1]


def test_stretching_curves_agree_with_henon(henon):
    found = stretching(henon, 2, 1, 3, 3.0, rng())
    assert found.slope == pytest.approx(HENON.published, rel=0.1)
    assert found.rosenstein_slope == pytest.approx(HENON.published, rel=0.1)
    assert found.interval[0] < found.slope < found.interval[1]


def test_a_straight_part_is_found_where_it_is_and_only_there():
    x = np.arange(60.0)
    bent = np.where(x < 10, 0.3 * x, np.where(x < 40, 3.0 + 0.1 * (x - 10), 6.0 - 0.02 * (x - 40)))
    found = straight_part(x[10:], bent[10:], 1.0)
    assert found.slope == pytest.approx(0.1, rel=0.08)  # 3 % of the rise may bend
    assert straight_part(x, np.zeros(60), 0.5) is None
    assert straight_part(x, 3.0 * (1.0 - np.exp(-x / 3.0)), 2.0) is None


# ---- Correlation dimension, 0-1 test, surrogates ----


def test_correlation_dimension_of_henon(henon):
    found = correlation(henon, range(2, 6), 1, 3, rng())
    assert found.dimension == pytest.approx(1.21, abs=0.1)


def test_correlation_dimension_is_read_off_the_plateau_not_off_the_noise(lorenz):
    """Below it the slopes grow with the embedding, as the noise fills every direction; a line through both is too steep."""
    found = correlation(with_noise(lorenz, 0.02), range(2, 8), 8, 50, rng())
    assert found.dimension == pytest.approx(2.05, abs=0.12)
    assert found.spread > 0.02
    first = found.radii[found.regions[-1].first]
    assert first > 3 * 0.02


def test_noise_has_no_correlation_dimension():
    found = correlation(rng(8).standard_normal(4000), range(2, 8), 1, 3, rng())
    assert found.dimension is None
    assert found.why


def test_zero_one_test():
    assert zero_one(standard(LOGISTIC.series(1500, 1)[0]), 1, rng()).k > 0.9
    assert zero_one(np.sin(2.0 * np.pi * 0.137 * np.arange(1500)), 1, rng()).k < 0.2


def test_surrogates_keep_what_they_promise():
    series = np.exp(standard(ar2(1024, 1, 9)[0]) / 2.0)
    power = np.abs(np.fft.rfft(series - series.mean())) ** 2
    for make, values, spectrum in ((fourier, False, 1e-9), (aaft, True, 1.0), (iaaft, True, 0.05)):
        made = make(series, 3, rng(10))
        assert made.shape == (3, 1024)
        for one in made:
            assert np.array_equal(np.sort(one), np.sort(series)) == values
            off = np.abs(np.abs(np.fft.rfft(one - one.mean())) ** 2 - power).sum() / power.sum()
            assert off < spectrum
            assert not np.allclose(one, series)


def test_ends_are_matched():
    series = np.sin(2.0 * np.pi * np.arange(1000) / 130.0)
    used = matched_ends(series)
    kept = series[used]
    assert kept.size >= 900
    assert abs(kept[0] - series[used.stop % 1000]) < 0.05


# ---- Verdict ----


@pytest.mark.parametrize(
    ("series", "word"),
    [
        (with_noise(LORENZ.series(4000, 1, 11)[0], 0.02), "chaotic"),
        (with_noise(HENON.series(2000, 1, 11)[0], 0.02), "chaotic"),
        (ar2(3000, 1, 11)[0], "stochastic"),
        (torus(4000, 1, 11)[0], "regular"),
        (np.sin(0.1 * np.arange(3000)) + 0.03 * np.random.default_rng(1).standard_normal(3000), "regular"),
    ],
    ids=["Lorenz", "Henon", "AR(2)", "torus", "sine"],
)
def test_verdict(series, word):
    found = chaos(series, clean=False)
    assert found.verdict.word == word
    assert (found.lyapunov is None) == (word != "chaotic")
    assert str(found).startswith(word)
    if word != "chaotic":
        assert found.why_no_number


def test_the_same_seed_gives_the_same_answer(henon):
    one, two = (chaos(henon[:1500], clean=False, seed=3) for _ in range(2))
    assert one.lyapunov == two.lyapunov
    assert np.array_equal(one.surrogates.surrogates, two.surrogates.surrogates)


@pytest.mark.parametrize(
    ("series", "dt", "words"),
    [
        (np.ones(2000), 1.0, "constant"),
        (np.ones(100), 1.0, "at least 500"),
        (np.full(2000, np.nan), 1.0, "finite"),
        (np.ones((10, 200)), 1.0, "shape"),
        (np.sin(np.arange(2000.0)), 0.0, "positive"),
    ],
)
def test_what_cannot_be_used_is_refused(series, dt, words):
    with pytest.raises(BadInput, match=words):
        chaos(series, dt)


def test_drive_period():
    t = 0.01 * np.arange(5000)
    period, why = _drive_period(0.3 * np.sin(2.0 * np.pi * 1.54 * t), t.size, 0.01)
    assert period == pytest.approx(1.0 / 1.54, rel=2e-3)
    assert why is None
    assert _drive_period(rng(12).standard_normal(5000), 5000, 0.01)[0] is None
    assert _drive_period(None, 5000, 0.01)[0] is None


@pytest.mark.shared
def test_the_laser_is_chaotic_with_a_dimension_near_two(shared):
    series = np.load(shared / "real" / "santafe_laser" / "santafe_laser.npy").ravel().astype(float)
    found = chaos(series, clean=False)
    assert found.verdict.word == "chaotic"
    assert 1.8 < found.correlation.dimension < 2.6


def test_a_sweep_is_not_called_chaotic():
    t = np.arange(3000) / 200.0
    noise = 0.01 * rng(13).standard_normal(t.size)
    found = chaos(np.sin(2.0 * np.pi * 0.4 * t**2) + noise, 1.0 / 200.0, clean=False)
    assert found.verdict.word != "chaotic"
    assert kept_company(found.series, 4, 5, 30, rng()) > 0.3
    assert kept_company(HENON.series(2000, 1)[0], 2, 1, 3, rng()) < 0.15


@pytest.mark.slow
def test_verdicts_over_many_seeds():
    false = sum(
        chaos(one, clean=False, seed=k).verdict.word == "chaotic"
        for make in (ar2, torus)
        for k, one in enumerate(make(2000, 6, 20))
    )
    found = sum(
        chaos(one, clean=False, seed=k).verdict.word == "chaotic"
        for system in (HENON, ROSSLER)
        for k, one in enumerate(with_noise(system.series(4000, 4, 21), 0.02))
    )
    assert false == 0
    assert found >= 7
