"""The joint preloaded to one side: natural frequency, damping, inertia from shock and random tests, with intervals that hold."""

import numpy as np
import pytest

import jaxbacklash as jb
from jaxbacklash.plot.drawing import svg_of

INERTIA, STIFFNESS, DAMPING, RATE = 3.16, 15095.0, 22.0, 500.0
TRUTH = {
    "natural_frequency": np.sqrt(STIFFNESS / INERTIA) / (2 * np.pi),
    "damping_ratio": DAMPING / (2 * np.sqrt(STIFFNESS * INERTIA)),
    "inertia": INERTIA,
    "stiffness": STIFFNESS,
    "damping": DAMPING,
}


def preloaded(kind, seed, seconds=60.0, force_noise=0.1, noise=2e-6):
    """A linear oscillator under a band-limited force, exact in the frequency domain, cut out of a longer motion."""
    rng, count = np.random.default_rng(seed), round((seconds + 20.0) * RATE)
    frequency, t = np.fft.rfftfreq(count, 1 / RATE), np.arange(count) / RATE
    if kind == "random":
        spectrum = np.fft.rfft(20.0 * rng.standard_normal(count)) / (1.0 + (frequency / 100.0) ** 8)
    else:
        strokes = np.arange(1.0, seconds + 9.0, 4.0)
        strokes = zip(strokes + rng.uniform(0.0, 0.3, strokes.size), rng.uniform(140.0, 260.0, strokes.size))
        spectrum = np.fft.rfft(sum(size * np.exp(-0.5 * ((t - at) / 0.006) ** 2) for at, size in strokes))
    omega = 2 * np.pi * frequency
    motion = np.fft.irfft(spectrum / (STIFFNESS - INERTIA * omega**2 + 1j * DAMPING * omega), count) + 0.0131
    cut = slice(round(5 * RATE), round((5 + seconds) * RATE))
    force, motion = np.fft.irfft(spectrum, count)[cut], motion[cut]
    channels = {
        "F": force + force_noise * rng.standard_normal(force.size),
        "y": motion + noise * rng.standard_normal(force.size),
    }
    return jb.Record(np.arange(force.size) / RATE, channels)


@pytest.mark.parametrize("kind", ["random", "shock"])
def test_values_and_intervals(kind):
    """Forty tests each: errors are a few tenths of a percent, and 95 % intervals hold the truth about as often."""
    errors, inside, told = [], [], []
    for seed in range(40):
        values = jb.frequency_response(preloaded(kind, seed), band=(4.0, 40.0)).values
        errors.append([values[name].value / truth - 1.0 for name, truth in TRUTH.items()])
        told.append([values[name].stderr / truth for name, truth in TRUTH.items()])
        inside.append([values[name].ci95[0] <= truth <= values[name].ci95[1] for name, truth in TRUTH.items()])
    rms = np.sqrt(np.mean(np.square(errors), axis=0))
    assert np.all(rms < [2e-4, 5e-3, 1e-3, 1e-3, 5e-3])
    assert np.all(np.mean(inside, axis=0) >= 0.85)
    assert np.all(np.abs(np.log(rms / np.mean(told, axis=0))) < np.log(1.5))


@pytest.mark.parametrize("segment", [2.5, 4.0, 10.0])
def test_the_window_of_the_picture_does_not_matter(segment):
    values = jb.frequency_response(preloaded("shock", 1), segment=segment, band=(4.0, 40.0)).values
    for name, truth in TRUTH.items():
        assert abs(values[name].value - truth) < 4.0 * values[name].stderr


def test_curves_and_their_picture():
    found = jb.frequency_response(preloaded("random", 2), band=(4.0, 40.0))
    omega = 2 * np.pi * found.frequency[found.used]
    exact = 1.0 / (STIFFNESS - INERTIA * omega**2 + 1j * DAMPING * omega)
    assert np.median(np.abs(found.h1[found.used] / exact - 1.0)) < 0.02
    assert np.all(np.abs(found.h2[found.used]) >= np.abs(found.h1[found.used]) * (1 - 1e-9))
    assert np.max(found.coherence) <= 1.0 + 1e-12
    assert "inertia" in str(found)
    picture = svg_of(jb.plot.frequency_response, found)
    assert picture.startswith("<svg")
    assert "mathdefault" not in picture, "decades are plain numbers"


def test_what_cannot_be_used_is_refused():
    t = np.arange(0.0, 10.0, 1e-3)
    rng = np.random.default_rng(0)
    with pytest.raises(jb.BadInput, match="wanted the force F"):
        jb.frequency_response(jb.Record(t, {"z": np.sin(9 * t)}))
    with pytest.raises(jb.NoAnswer, match="coherent"):
        jb.frequency_response(jb.Record(t, {"F": rng.standard_normal(t.size), "y": 0.01 * rng.standard_normal(t.size)}))
    with pytest.raises(jb.NoAnswer, match="no resonance"):
        jb.frequency_response(preloaded("random", 1), band=(20.0, 40.0))
