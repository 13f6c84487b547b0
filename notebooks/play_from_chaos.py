# ---
# jupyter:
#   jupytext:
#     text_representation:
#       extension: .py
#       format_name: percent
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---

# %% [markdown]
# # The play from chaos
#
# Shake the base of a loose joint at one frequency and raise the amplitude step by step. The motion is regular at first, then
# chaotic, then regular again, and how fast small differences grow depends on the amplitude. Does that say how large the play
# is? It does, within limits that this tour shows: compare it with a fit before trusting it with anything.

# %%
import os

import matplotlib.pyplot as plt
import numpy as np

import jaxbacklash as jb

jb.start()
TINY = bool(os.environ.get("JAXBACKLASH_TINY"))  # set by the tests, to be quick

# %% [markdown]
# ## One curve for every play
#
# The joint: a hanging link like the source paper's, 11 Hz in contact, 2 % damping, its base moving at 1.54 Hz. Where all laws but
# the play are linear, amplitude and play enter the motion as their ratio alone. So the exponent per drive period is one curve
# over amplitude / play, and another play shifts it along. Several starts are followed at each place: where blue and grey dots
# stand one above the other, attractors coexist and the rig may sit on either.

# %%
inertia, frequency, omega_0 = 3.16, 1.54, 2 * np.pi * 11.0
stiffness, damping = inertia * omega_0**2, 2 * 0.02 * inertia * omega_0
joint = jb.two_link(inertia, np.radians(1.5), stiffness, damping, -60.0, linearised=True)
size = {"starts": 2, "periods": 60, "skip": 30} if TINY else {"starts": 4, "periods": 300, "skip": 150}
curve = jb.signature.exponent_map(joint, frequency, (0.6, 5.0, 60 if TINY else 640), **size)
jb.plot.exponent_over_drive(curve)
plt.show()

# %% [markdown]
# ## Is it worth measuring?
#
# Before anything is measured, imagine it: joints whose play is drawn between 1.2 and 2.1 degrees, verdicts and exponents with
# the errors that a real series leaves, and the play inferred from them. Each dot is one such experiment.

# %%
amplitudes = np.radians([1.34, 2.07, 2.68, 3.41, 3.65, 3.78, 4.87, 5.73])
possible = (np.radians(1.2), np.radians(2.1))
experiments = 20 if TINY else 200
few = jb.signature.expected_precision(curve, amplitudes[[0, 3, 6]], possible, experiments=experiments)
many = jb.signature.expected_precision(curve, amplitudes, possible, experiments=experiments)
print(few)
print(many)

# %%
jb.plot.expected_precision({"three levels": few, "eight levels": many})
plt.show()

# %% [markdown]
# ## An experiment
#
# A joint of 1.7 degrees that the inference does not know, simulated, with 1 % noise. Each series goes through the analysis of
# "Is it chaos?", which knows no model: a verdict and, for chaos, an exponent.

# %%
play = np.radians(1.7)
rig = jb.two_link(inertia, play, stiffness, damping, -60.0, linearised=True)
rate, seconds = 250.0, 25.0 if TINY else 60.0
chosen = amplitudes[[0, 6]] if TINY else amplitudes
drives = [jb.Harmonic(float(a), 2 * np.pi * frequency) for a in chosen]
runs = [jb.simulate(rig, drive, duration=30.0 + seconds, rate=rate) for drive in drives]
clean = [np.asarray(run.z)[round(30 * rate) :] for run in runs]
noisy = [z + 0.01 * z.std() * np.random.default_rng(k).standard_normal(z.size) for k, z in enumerate(clean)]

# %%
reports = [jb.chaos(z, 1 / rate, clean=False) for z in noisy]
levels = [jb.signature.Level.measured(float(a), report, frequency) for a, report in zip(chosen, reports)]
for level in levels:
    print(f"{np.degrees(level.amplitude):.2f} deg: {level.word}, exponent per period {level.exponent}")

# %% [markdown]
# ## The play
#
# What each level says alone is little: a regular motion excludes some plays, an exponent allows several. Together they leave an
# interval, sometimes in pieces.

# %%
found = jb.signature.play_from_exponents(curve, levels, plays=possible)
print(found)

# %%
jb.plot.play_likelihood(found, truth=float(play))
plt.show()

# %% [markdown]
# On the curve, the levels stand where the play that came out puts them; the bar across is the play's interval.

# %%
jb.plot.exponent_over_drive(curve, found)
plt.show()

# %% [markdown]
# ## When the curve is wrong
#
# Everything rests on the curve, and that on stiffness, damping and weight. With a damping taken 40 % too high, six of ten
# intervals hold the truth instead of 95 in a hundred; with a weight taken 22 % too low, four of ten
# (`benchmarks.play_from_exponents`). Where they are not known, give `exponent_map` their possible values with `over`: the
# interval then allows for them, and is two to three times wider.

# %% [markdown]
# ## Beside the fit
#
# The same series, fitted: one of them alone determines the play far better, and stiffness, damping and weight with it, which the
# exponents have to be told. That is the honest comparison. What exponents have over a fit: they do not change when the sensor's
# gain is unknown, or when what is measured is a speed, an acceleration or a sound instead of the angle. Only the drive's
# amplitudes must be known. Then, and only where the drive levels reach across edges of chaotic regions, they are worth measuring.

# %%
middle = len(runs) // 2
t, base = np.asarray(runs[middle].t)[: noisy[0].size], np.asarray(runs[middle].x)[round(30 * rate) :]
encoder = 3e-5 * np.random.default_rng(99).standard_normal(t.size)
record = jb.Record(t, {"x": base + encoder, "z": noisy[middle]})
print(jb.fit(record, inertia=inertia, effects=["gravity"]))
