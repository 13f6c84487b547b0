"""How a force goes on between its samples is one rule: what `fit` takes it for, `simulate` does from the model written."""

import json

import numpy as np
import pytest
from scipy.signal import lsim

import jaxbacklash as jb
from jaxbacklash.excitation import Sampled
from jaxbacklash.model_file import input_between
from jaxbacklash.records.force import way
from jaxbacklash.shooting.levenberg import Levenberg, minimise
from tests.in_process import call

RATE, FINE, NOISE = 400.0, 32, 2e-6  # Hz, points a sample, m
MASS, DAMPING, STIFFNESS = 0.5, 4.0, 12000.0


def driven(between, *, seed=1, seconds=8.0):
    """A mass on a spring at 25 Hz, from rest, under a force that goes on as said between its samples; exact (lsim)."""
    rng = np.random.default_rng(seed)
    samples = round(seconds * RATE)
    fine = np.arange(samples * FINE) / (RATE * FINE)
    if between in ("smooth", "curved"):
        highest = 0.12 if between == "smooth" else 0.35  # of the sampling rate
        hertz = np.linspace(2.0, highest * RATE, 60)
        force = sum(np.sin(2 * np.pi * (f * fine + rng.uniform())) for f in hertz)
    else:
        values = rng.standard_normal(samples)
        held = np.repeat(values, FINE)
        force = held if between == "held" else np.interp(fine, fine[::FINE], values)
    force *= 20.0 / np.std(force)
    _, motion, _ = lsim(([1.0], [MASS, DAMPING, STIFFNESS]), force, fine, interp=between != "held")
    y = motion[::FINE] + NOISE * rng.standard_normal(samples)
    return jb.Record(fine[::FINE], {"F": force[::FINE], "y": y})


def free_run(found):
    """The trajectory at which a fit in one piece has ended."""
    predicted = minimise(found.problem, found.unknowns, Levenberg(limit=1)).stats["predicted"].motion
    return np.asarray(predicted)[np.asarray(found.problem.windows.weight) > 0.0]


@pytest.mark.parametrize(
    "between", ["held", "straight", *(pytest.param(how, marks=pytest.mark.slow) for how in ("smooth", "curved"))]
)
def test_simulate_runs_the_force_as_fit_has_taken_it(between, tmp_path):
    record = driven(between)
    assert way(record) == between
    jb.write_record(record, tmp_path / "rec.csv")
    fitted = call(["fit", "rec.csv", "--model", "linear", "--translation", "--starts", "1", "--out", "fit", "--json"], tmp_path)
    assert fitted.code == 0, fitted.err
    assert json.loads(fitted.out)["stages"][0]["rms_over_noise"] < 1.2
    assert input_between(tmp_path / "fit/model.toml") == between
    own = jb.fit(jb.read_record(tmp_path / "rec.csv"), model="linear", starts=1, translational=True)
    assert own.tied
    y0, dy0 = (repr(float(v)) for v in np.asarray(own.unknowns.starts)[:2, 0])
    words = ["simulate", "fit/model.toml", "--excitation", "rec.csv", "--rate", str(RATE), "--out", "sim.csv"]
    assert call([*words, f"--y0={y0}", f"--dy0={dy0}"], tmp_path).code == 0
    again = jb.read_record(tmp_path / "sim.csv")
    error = np.std(again.channels["y"] - record.channels["y"])
    # The spline of a smooth force is fitted too, and follows a little of the noise: that run is nearer than a free one can be.
    near = 0.1 if between == "smooth" else 0.02
    assert error == pytest.approx(np.std(free_run(own) - record.channels["y"]), rel=near)
    assert error == pytest.approx(NOISE, rel=0.05)
    # What drove is what was measured, not what stands for it between the samples.
    assert np.std(again.channels["F"] - record.channels["F"]) < 1e-3 * np.std(record.channels["F"])


def test_a_model_says_how_a_rough_force_goes_on_and_a_file_without_it_asks_the_record(tmp_path):
    record = driven("held")
    text = jb.dump_model(jb.System(MASS, None, None, {}, "y"), between="held")
    (tmp_path / "m.toml").write_text(text)
    assert input_between(tmp_path / "m.toml") == "held"
    assert jb.load_model(tmp_path / "m.toml").observed == "y"
    assert way(record, "straight") == "straight"
    assert way(driven("smooth"), "straight") == "smooth"
    assert way(driven("curved"), "smooth") == "curved"
    (tmp_path / "m.toml").write_text(text.replace('"held"', '"holed"'))
    with pytest.raises(jb.BadInput, match=r"\[input\] force is 'holed', wanted one of smooth, straight, held, curved"):
        jb.load_model(tmp_path / "m.toml")
    (tmp_path / "m.toml").write_text(text.replace("force =", "forse ="))
    with pytest.raises(jb.BadInput, match=r"\[input\] has an entry forse"):
        jb.load_model(tmp_path / "m.toml")


def test_a_smooth_sampled_force_is_a_curve_through_values_and_rates():
    t = np.arange(40) / 10.0
    drive = Sampled(0.0, 0.1, 0.0 * t, 0.0 * t, np.sin(3 * t), 3 * np.cos(3 * t))
    at = drive.at(1.234)
    assert float(at.force) == pytest.approx(np.sin(3.702), abs=1e-4)
    assert float(at.dforce) == pytest.approx(3 * np.cos(3.702), abs=1e-2)
