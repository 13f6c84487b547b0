"""Model files and simulations at the end of what can be: told in one sentence, and what is written can be read back."""

import os

import numpy as np
import pytest

from jaxbacklash import simulation
from jaxbacklash.commands.simulate import check_size, parse_excitation
from jaxbacklash.effects import Contact, CoulombJoint, Damper, Gravity, LearnedTorque
from jaxbacklash.errors import BadInput, NoAnswer
from jaxbacklash.excitation import Chirp, Multisine, Rest
from jaxbacklash.fitting import compare
from jaxbacklash.model_file import dump_model, load_model
from jaxbacklash.records import read_record
from jaxbacklash.system import System

from .hostile import MODEL, one_sentence, write_record_csv
from .test_cli import call as call


def joint(stiffness=2000.0, damping=4.0, backlash=0.02):
    return System(2.0, Contact(backlash, stiffness), Damper(damping))


HEADINGS = [
    "two\nlines\r\nand\x0bmore\x0cof\x1cthem\x85and\u2028these", "tab\tand \x00\x01\x1b\x7f control",
    "\udcff\udc80 half", "ünï ☂ 𝄞",
    "[model]", '"""\n\'\'\'\\', "\n\n", "\u202eright to left\ufeff", "inertia = 3",
]  # fmt: skip


@pytest.mark.parametrize("heading", HEADINGS)
def test_whatever_stands_above_a_model_it_is_read_back(tmp_path, heading):
    text = dump_model(joint().with_effects(Gravity(3.0)), heading=heading)
    (tmp_path / "m.toml").write_text(text, encoding="utf-8")
    again = load_model(tmp_path / "m.toml")
    assert dump_model(again) == dump_model(joint().with_effects(Gravity(3.0)))


@pytest.mark.parametrize("word", ['si"de', "si\nde", "a\\b", "\x7f", "\x00", "ünï", "\udcff"])
def test_text_within_a_law_is_read_back(tmp_path, word):
    """As in a law of the user's own that holds text."""
    table = LearnedTorque(("side", "dz"), ((-1.0, 0.0, 1.0), (-2.0, 0.1, 2.0)), (0.0,) * 9)
    text = dump_model(joint().with_effects(table)).replace('"side"', quoted(word))
    (tmp_path / "m.toml").write_text(text, encoding="utf-8")
    with pytest.raises(BadInput) as caught:  # no such coordinate: but it was read, and it is told
        load_model(tmp_path / "m.toml")
    assert "not a model file" not in str(caught.value)
    assert len(str(caught.value).splitlines()) == 1


def quoted(word):
    from jaxbacklash.model_file import _quoted

    return _quoted(word)


BAD = {
    "nested lists": ("a = " + "[" * 100_000, "nested too deep"),
    "nested tables": ("a = " + "{a = " * 5000, "nested too deep"),
    "huge whole number": (MODEL.replace("2.0", "9" * 400), "at most 1e+15"),
    "too many digits": (MODEL.replace("2.0", "9" * 5000), "not a model file"),
    "stiff": (MODEL.replace("2000.0", "1e30"), "stiffness is 1e+30"),
    "negative damping": (MODEL.replace("4.0", "-1e9"), "damping is -1e+09"),
    "negative width": (MODEL + "width = -1.0\n", "width is -1"),
    "no inertia at all": (MODEL.replace("2.0", "0"), "inertia is 0"),
    "infinite": (MODEL.replace("2.0", "inf"), "inertia is inf"),
    "effect without its values": (MODEL + "[effects.coulomb_joint]\n", "lacks Tc"),
    "effect with one of them": (MODEL + "[effects.dahl]\nFc = 3.0\n", "[effects.dahl] lacks sigma"),
    "effect out of bounds": (MODEL + "[effects.coulomb_joint]\nTc = -3.0\n", "Tc is -3"),
    "a table without rows": (MODEL + "[effects.learned_torque]\ncoordinates = []\nknots = []\ntable = []\n", "learned_torque"),
    "a table of words": (MODEL + "[effects.learned_torque]\ncoordinates = 'y'\nknots = 'a'\ntable = 1\n", "learned_torque"),
    "an array of effects": (MODEL + "[[effects]]\nname = 'gravity'\n", "effects is not a table"),
    "an array as a value": (MODEL.replace("2.0", "[2.0]"), "wanted a finite number"),
    "a date": (MODEL.replace("2.0", "2020-01-01"), "wanted a finite number"),
    "twice": (MODEL + "inertia = 3.0\n", "not a model file"),
    "null bytes": (MODEL + "\0", "not a model file"),
}


@pytest.mark.parametrize(("text", "fragment"), BAD.values(), ids=BAD)
def test_a_model_file_that_cannot_be_used(tmp_path, text, fragment):
    (tmp_path / "m.toml").write_text(text)
    with pytest.raises(BadInput) as caught:
        load_model(tmp_path / "m.toml")
    assert fragment in str(caught.value)
    assert "m.toml" in str(caught.value)
    assert len(str(caught.value)) < 400


def test_a_folder_and_a_large_file_are_no_models(tmp_path, monkeypatch):
    with pytest.raises(BadInput, match="is a folder"):
        load_model(tmp_path)
    os.mkfifo(tmp_path / "pipe.toml")
    with pytest.raises(BadInput, match="is no regular file"):
        load_model(tmp_path / "pipe.toml")
    (tmp_path / "m.toml").write_text(MODEL)
    monkeypatch.setattr("jaxbacklash.model_file.LARGEST", 10)
    with pytest.raises(BadInput, match="of at most 10"):
        load_model(tmp_path / "m.toml")


def test_a_mark_before_the_text_is_no_part_of_it(tmp_path):
    (tmp_path / "m.toml").write_text(MODEL, encoding="utf-8-sig")
    assert float(load_model(tmp_path / "m.toml").inertia) == 2.0


RNG = np.random.default_rng(0)


@pytest.mark.parametrize("text", [
    "stepped:amplitude=.1,low=1,high=5,steps=1e9", "multisine:amplitude=.1,low=1,high=5,lines=1e9",
    "harmonic:amplitude=1,frequency=-1",
    "chirp:amplitude=1e300,f0=0,f1=1", "chirp:amplitude=1,f0=nan,f1=1", "multisine:amplitude=1,low=1,high=2,lines=0.2",
    "chirp:amplitude=1,f0=1,f1=1,corner=0",
])  # fmt: skip
def test_an_excitation_out_of_range(text):
    with pytest.raises(BadInput, match="wanted a number from"):
        parse_excitation(text, False, 2.0, RNG)


@pytest.mark.parametrize(("system", "drive", "duration", "rate", "fragment"), [
    (joint(), Rest(), 1e5, 1e6, "1e+11 samples"), (joint(1e14), Rest(), 2.0, 500.0, "steps"),
    (joint(), Rest(), 2.0, 10.0, "gives 21 samples"), (joint(), Rest(), 0.1, 1e5, "wanted 0.5 s"),
    (joint(), Multisine(*(np.ones(10_000),) * 3), 1000.0, 500.0, "sines"),
])  # fmt: skip
def test_a_simulation_too_large_or_too_small_is_refused_beforehand(system, drive, duration, rate, fragment):
    with pytest.raises(BadInput) as caught:
        check_size(system, drive, duration, rate)
    assert fragment in str(caught.value)


def test_a_motion_without_bound_is_told(call, tmp_path):
    (tmp_path / "m.toml").write_text(MODEL.replace("4.0", "1e12"))
    code, _, err = call("simulate", "m.toml", "--duration", "1", "--out", "s.csv")
    assert code == 1
    assert "grows without bound" in one_sentence(err)
    assert not (tmp_path / "s.csv").exists()


@pytest.mark.slow
def test_a_comparison_without_bound_is_told(tmp_path):
    record = read_record(write_record_csv(tmp_path / "r.csv"))
    with pytest.raises(NoAnswer, match="grows without bound"):
        compare(joint(damping=1e12), record)


def test_a_long_run_in_pieces_is_the_run(monkeypatch):
    system = joint().with_effects(CoulombJoint(0.5, 0.05))
    drive = Chirp(*(np.asarray(v) for v in (0.07, 0.0, 9.0, 2.0)))
    whole = simulation.simulate(system, drive, duration=2.0, rate=500.0, t0=0.25)
    monkeypatch.setattr(simulation, "LONG", 100)
    monkeypatch.setattr(simulation, "PIECE", 300)
    parts = simulation.simulate(system, drive, duration=2.0, rate=500.0, t0=0.25)
    assert parts.t.shape == whole.t.shape
    np.testing.assert_allclose(parts.t, whole.t, rtol=1e-14)
    for one, other in zip(parts.states, whole.states):
        np.testing.assert_allclose(one, other, atol=1e-9)
