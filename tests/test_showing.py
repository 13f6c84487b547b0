"""Results show themselves: printed, as a table for `rich`, as a table with its picture in a notebook, as pandas and xarray."""

import re
import sys
from html.parser import HTMLParser
from types import SimpleNamespace

import numpy as np
import pytest

import jaxbacklash as jb
from jaxbacklash.dynamics import Attractor, Basins, Exponents
from jaxbacklash.dynamics.sections import Section
from jaxbacklash.report.cards import html, table
from jaxbacklash.second_opinion import CrossCheck
from jaxbacklash.showing import Shown

from . import made_up
from .test_package import fresh
from .test_plot_dynamics import chaotic as chaotic  # the fixtures of small real results
from .test_plot_dynamics import skeletons as skeletons
from .test_signature import AMPLITUDES, windowed
from .test_signature import made_up as made_up_map
from .test_signature_figures import levels

pandas = pytest.importorskip("pandas")
xarray = pytest.importorskip("xarray")


def cause():
    return jb.Cause("delay", "z", 0.004, 1e-5, "s", 12.9, 1.02, 800.0, "z lags x by 4.00 ms", "--delay z=0.004")


def exponents():
    return Exponents(np.array([0.3, -0.34]), np.array([0.01, 0.01]), 400.0, np.arange(3.0), np.zeros((3, 2)))


def basins():
    ends = [Attractor(1, -0.02, np.array([0.3]), np.array([0.1]), 0.75), Attractor(0, 0.1, np.arange(3.0), np.arange(3.0), 0.25)]
    return Basins(np.array([-1.0, 1.0]), np.array([0.0, 1.0]), np.array([[0, 1], [0, 0]]), ends, "half play")


def motion():
    return jb.simulate(made_up.joint(), jb.Harmonic(0.05, 10.0), duration=0.4, rate=100.0)


def match():
    row = windowed().exponent[0]
    map_ = made_up_map(np.stack([row, -row]), {"linear_gravity.G": np.array([-60.0, 0.0])})
    return jb.signature.match_pattern(map_, AMPLITUDES, np.ones(8, bool), np.radians([1.4, 1.6]))


RESULTS = {
    "fit": (lambda: made_up.fit(), "total play b", 1),
    "compare": (made_up.comparison, "made_up.csv", 1),
    "score": (lambda: made_up.fit().score, "0.2 s", 0),
    "cause": (cause, "--delay z=0.004", 0),
    "refine": (made_up.refinement, "preload", 1),
    "rank": (made_up.ranking, "812", 1),
    "fails": (made_up.findings, "The torque falls with y.", 2),
    "explained": (made_up.adequate, "What is left is noise.", 1),
    "missing": (made_up.latent, "N m rms is missing", 1),
    "surface": (made_up.surface, "98.0 %", 1),
    "loop": (made_up.loop_fit, "total play b", 1),
    "silent": (lambda: CrossCheck(None, None, "Nobody can judge this.", "so"), "Nobody can judge this.", 0),
    "exponents": (exponents, "0.3 ± 0.01", 0),
    "basins": (basins, "75.0 %", 1),
    "motion": (motion, "41 samples", 1),
    "play": (lambda: jb.signature.play_from_exponents(windowed(), levels()), "exponent per drive period", 1),
    "expected_precision": (
        lambda: jb.signature.expected_precision(windowed(), AMPLITUDES, (0.021, 0.045), experiments=3),
        "3 imagined experiments",
        1,
    ),
    "curve": (windowed, "401 ratios", 1),
    "pattern": (match, "linear_gravity.G", 1),
}


class Tags(HTMLParser):
    """What is opened and closed, and the texts between."""

    def __init__(self, text):
        super().__init__()
        self.open, self.seen, self.texts = [], [], []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.seen.append((tag, dict(attributes)))
        self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        self.seen.append((tag, dict(attributes)))

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, text):
        self.texts.append(text)


def in_terminal(result):
    from rich.console import Console

    console = Console(width=140, record=True, file=SimpleNamespace(write=lambda text: None, flush=lambda: None))
    console.print(result)
    return console.export_text()


def check(result, words, pictures):
    """Every way to show a result says the words; HTML closes what it opens and has that many pictures."""
    assert str(result) != object.__repr__(result)
    shown = result._repr_html_()
    tags = Tags(shown)
    assert not tags.open
    assert shown.startswith('<div class="jaxbacklash">')
    assert sum(tag == "svg" for tag, _ in tags.seen) == pictures
    assert not {"script", "style", "link"} & {tag for tag, _ in tags.seen}
    ids = [a["id"] for _, a in tags.seen if "id" in a]
    assert set(re.findall(r"url\(#([^)]+)\)", shown)) <= set(ids)
    text = in_terminal(result)
    for told in ("".join(tags.texts), text):
        assert " ".join(words.split()) in " ".join(told.split())
    seen = []
    result._repr_pretty_(SimpleNamespace(text=seen.append), False)
    assert seen == [str(result)]


@pytest.mark.parametrize("name", RESULTS)
def test_every_result_shows_itself(name):
    make, words, pictures = RESULTS[name]
    check(make(), words, pictures)


def test_real_results_show_themselves(skeletons, chaotic):
    check(skeletons, "Hilbert transform", 1)
    check(skeletons.wavelet, "viscous damping c", 0)
    check(chaotic, "largest Lyapunov exponent", 1)
    check(CrossCheck(skeletons, True, "They agree."), "They agree.", 1)


def test_every_result_of_a_public_function_is_among_them():
    from jaxbacklash.report.card import card_of

    shown = {one.__name__ for one in card_of.registry}
    data = {"Record", "MeasuredSeries", "System", "Instant"}  # what is put in, not what comes out
    results = {name for name in jb.__all__ if isinstance(getattr(jb, name), type)} - data
    without = {name for name in results if "_repr_html_" not in dir(getattr(jb, name))}
    effects = {cls.__name__ for cls in (jb.AbstractEffect, *jb.catalogue().values(), jb.LearnedTorque, jb.LinearGravity)}
    drives = {"Chirp", "Harmonic", "HeldTorque", "MotorTorque", "Multisine", "Rest", "Sampled", "SteppedSine"}
    parts = {"Contact", "Damper", "LimitedServo", "Motor", "Servo", "Spring"}
    assert without <= effects | drives | parts | {"BadInput", "NoAnswer", "Ranked", "Estimate"}
    assert results - without <= shown


def test_texts_of_a_user_are_text():
    fit = made_up.fit()
    shown = fit._repr_html_()
    assert "the link &lt;never&gt; moves" in shown
    with pytest.raises(jb.BadInput, match="no result"):
        html(3)
    with pytest.raises(jb.BadInput, match="no result"):
        table("text")


def test_two_cards_share_no_ids():
    both = made_up.findings()._repr_html_() + made_up.findings()._repr_html_()
    ids = re.findall(r'\bid="([^"]+)"', both)
    assert ids
    assert len(ids) == len(set(ids))


# ---- numbers as pandas and xarray have them ----


def test_a_fit_as_a_frame_and_a_dataset():
    fit = made_up.fit(0.0)
    frame = fit.to_dataframe()
    assert list(frame.index) == ["backlash", "stiffness", "damping"]
    one = fit.parameters["backlash"]
    assert frame.loc["backlash", ["value", "stderr"]].to_list() == [one.value, one.stderr]
    assert frame.loc["backlash", ["low", "high"]].to_list() == list(one.ci95)
    assert frame.loc["backlash", "unit"] == "rad"
    assert np.isnan(frame.loc["damping", "value"])
    assert frame.loc["damping", "why"] == "the link <never> moves"
    wrong = made_up.fit(4e-4).to_dataframe()
    assert wrong.loc["backlash", "stderr"] == one.stderr
    assert wrong[["low", "high"]].isna().all().all(), "an interval that would hold only if the model were right"
    for number, score in enumerate(fit.scores):
        seen = fit.to_dataset(record=number)
        assert seen.measured.attrs["units"] == "rad"
        np.testing.assert_array_equal(seen.t, score.t)
        np.testing.assert_array_equal(seen.predicted, score.predicted)
        np.testing.assert_array_equal(seen.residual, score.residual)
        np.testing.assert_array_equal(seen.window_rms, score.window_rms)
        assert seen.attrs["rms_over_noise"] == score.rms
    other = made_up.comparison()
    np.testing.assert_array_equal(other.to_dataset().measured, other.score.measured)


def test_what_is_missing_as_frames():
    found = made_up.refinement()
    frame = found.to_dataframe()
    assert frame.added.to_list() == ["", "gravity"]
    assert frame.dropped.to_list() == ["", "coulomb_joint"]
    assert frame.rms_over_noise.to_list() == [stage.fit.score.rms for stage in found.stages]
    assert frame.heldout_rms_over_noise.to_list() == [stage.fit.heldout.rms for stage in found.stages]
    assert np.isnan(frame.loc[0, "gravity.G"])
    assert frame.loc[1, "gravity.G"] == made_up.GRAVITY.value
    assert frame.attrs["units"]["gravity.G"] == "N m"
    ranking = made_up.ranking().to_dataframe()
    assert ranking.loc["gravity", ["rms_over_noise", "evidence"]].to_list() == [1.02, 812.0]
    assert np.isnan(ranking.loc["dahl", "evidence"])
    asked = made_up.findings().to_dataframe()
    assert asked.loc[("y", "value"), "strength"] == 0.8
    latent = made_up.latent()
    np.testing.assert_array_equal(latent.to_dataframe().torque, latent.torque)
    surface = made_up.surface(coordinates=("y", "z"))
    over = surface.to_dataset()
    assert over.torque.dims == ("y", "z")
    np.testing.assert_array_equal(over.torque.values.ravel(), surface.table)
    np.testing.assert_array_equal(over.z, surface.knots[1])


def test_every_result_gives_its_numbers():
    results = [*Shown.__subclasses__()]
    assert len(results) > 15
    for one in results:
        results += one.__subclasses__()
    assert [one.__name__ for one in results if not hasattr(one, "to_dataframe") and not hasattr(one, "to_dataset")] == []


def test_a_cause_as_a_frame():
    lag = jb.Cause("delay", "z", 0.004, 1e-5, "s", 12.9, 1.02, 800.0, "z lags", "--delay z=0.004", parameters={"damping": None})
    frame = lag.to_dataframe()
    assert frame.loc["delay", ["channel", "size", "unit"]].to_list() == ["z", 0.004, "s"]
    assert frame.loc["delay", ["rms_over_noise", "rms_over_noise_without"]].to_list() == [12.9, 1.02]
    assert frame.damping.isna().all()
    assert frame.attrs["remedy"] == "--delay z=0.004"


def test_motions_and_models_as_frames():
    run = motion()
    frame = run.to_dataframe()
    np.testing.assert_array_equal(frame.index, run.t)
    np.testing.assert_allclose(frame.z, frame.y - frame.x, atol=1e-15)
    assert exponents().to_dataframe().value.to_list() == [0.3, -0.34]
    found = basins()
    np.testing.assert_array_equal(found.to_dataset().number, found.number)
    assert found.to_dataset().y.attrs["units"] == "half play"
    assert found.to_dataframe().share.to_list() == [0.75, 0.25]
    points = Section(np.arange(3.0), np.ones(3), np.zeros(3))
    assert points.to_dataframe().z.to_list() == [1.0] * 3
    assert "3 points" in str(points)
    map_ = windowed()
    np.testing.assert_array_equal(map_.to_dataset().exponent, map_.exponent)
    play = jb.signature.play_from_exponents(map_, levels())
    np.testing.assert_array_equal(play.to_dataset().density, play.density)
    precision = jb.signature.expected_precision(map_, AMPLITUDES, (0.021, 0.045), experiments=3)
    np.testing.assert_array_equal(precision.to_dataframe().play, precision.play)
    pattern = match()
    np.testing.assert_array_equal(pattern.to_dataset().chance, pattern.chance)


def test_skeletons_and_chaos_as_frames(skeletons, chaotic):
    frame = skeletons.to_dataframe()
    for method in skeletons.methods:
        for name, value in method.parameters.items():
            row = frame.loc[(method.method, name)]
            assert row["value"] == value.value if value.value is not None else np.isnan(row["value"]) and row["why"]
        np.testing.assert_array_equal(method.to_dataframe().amplitude, method.amplitude)
    assert CrossCheck(skeletons, True, "").to_dataframe().equals(frame)
    assert len(CrossCheck(None, None, "").to_dataframe()) == 0
    told = chaotic.to_dataframe()
    assert told.loc["lyapunov", "value"] == chaotic.lyapunov
    assert told.loc["lyapunov", ["low", "high"]].to_list() == list(chaotic.interval)
    assert told.loc["lyapunov_per_period", "why"]
    curves = chaotic.to_dataset()
    np.testing.assert_array_equal(curves.kantz, chaotic.curve.kantz)
    np.testing.assert_array_equal(curves.sums, chaotic.correlation.sums)


@pytest.mark.parametrize(
    ("library", "of"), [("pandas", lambda: made_up.fit().to_dataframe()), ("xarray", lambda: made_up.fit().to_dataset())]
)
def test_a_library_that_is_absent_is_named_in_a_sentence(monkeypatch, library, of):
    monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(jb.BadInput, match=rf'needs {library}, which is not installed: pip install "jaxbacklash\[frames\]"'):
        of()


def test_a_terminal_table_waits_for_no_library_of_pictures():
    code = """
import sys
from rich.console import Console
from tests import made_up
found = made_up.fit()
with open("/dev/null", "w") as nowhere:
    Console(file=nowhere).print(found)
print("matplotlib" in sys.modules)
"""
    assert fresh(code).split() == ["False"]
