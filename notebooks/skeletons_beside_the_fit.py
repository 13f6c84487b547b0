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
# # Skeletons beside the fit
#
# Before there were fits by simulation, a joint was read from its envelopes: how large it swings, how fast, and how both
# go together. That way is independent of the fit, quick, and full of pictures. It has traps, too. This notebook takes a
# sweep like the one in the source paper through both, falls into the best-known trap on purpose, and ends with a record
# for which the classical way has no answer.

# %%
import os

import matplotlib.pyplot as plt
import numpy as np

import jaxbacklash as jb

jb.start()
seconds = 15.0 if os.environ.get("JAXBACKLASH_TINY") else 30.0

# %% [markdown]
# ## A record whose answer we know
#
# A link of 3.16 kg m^2 behind a joint with a play of 1.5 degrees, 11 Hz in contact. The base sweeps from 0 to 12 Hz, and
# the servo loses amplitude as it goes. Both encoders are noisy.

# %%
joint = jb.base_motion_joint(3.16, np.radians(1.5), 15095.0, 22.0)
t = np.arange(0.0, seconds, 0.002)
chirp = jb.Chirp(0.045, 0.0, 12.0, seconds, 1.0)
motion = jb.simulate(joint, chirp, duration=seconds, rate=500.0)
rng = np.random.default_rng(1)
x = np.asarray(motion.drive.x) + 3e-5 * rng.standard_normal(motion.t.size)
z = np.asarray(motion.observed) + 3e-5 * rng.standard_normal(motion.t.size)
record = jb.Record(np.asarray(motion.t), {"x": x, "z": z})
print(record.summary())

# %% [markdown]
# ## Two skeletons
#
# One call. The Hilbert transform turns each channel into an envelope and a phase; the wavelet transform does the same along
# its ridge. Both smooth with the cycles, so harmonics and offsets drop out, and no sample is ever differenced.

# %%
found = jb.skeleton(record, inertia=3.16)
print(found)

# %% [markdown]
# Read the notes first. They say where the record holds nothing: where the amplitude falls past the resonance within a few
# cycles, and where the link then stays inside its play and the contact is not felt at all. The paper met both, at 16.25 s.

# %%
jb.plot.envelopes(found)
plt.show()

# %%
jb.plot.instantaneous_frequency(found)
plt.show()

# %% [markdown]
# Lines are what the base does; marks are what the joint is, its natural frequency at the amplitude of that moment. The joint
# gets stiffer as it swings further, since less and less of each cycle is spent inside the play.

# %% [markdown]
# ## The trap
#
# Amplitude times stiffness is the restoring force of the paper's equation (3.7). It looks like a straight line that cuts the axis
# at the edge of the play. It does not: for a pure sine the line cuts at 4/pi of the half play.

# %%
print(f"a straight line far out cuts the axis at {4 / np.pi:.3f} half plays")
jb.plot.skeleton(found)
plt.show()

# %% [markdown]
# How much that costs is quickly seen: the same amplitudes, read in three ways. The third is what `skeleton` uses. It takes the
# describing function not of a sine but of the motion that was measured, with all the harmonics that the contacts make. A line
# through all points instead of the upper half comes out closer: it misses the straight part, and two errors cancel a little.

# %%
wavelet = found.wavelet
upper = wavelet.kept & (wavelet.amplitude > np.median(wavelet.amplitude[wavelet.kept]))
slope, offset = np.polyfit(wavelet.amplitude[upper], wavelet.restoring_force[upper], 1)
sine, measured = wavelet.inverted("sine", inertia=3.16), wavelet.inverted("waveform", inertia=3.16)
print(f"straight line, upper half            {np.degrees(-2 * offset / slope):.4f} deg")
print(f"describing function of a sine        {np.degrees(2 * sine.values[0]):.4f} deg")
print(f"describing function of the motion    {np.degrees(2 * measured.values[0]):.4f} deg; the truth is 1.5")

# %% [markdown]
# ## Beside the fit
#
# The fit by simulation knows nothing of envelopes, and the skeletons nothing of simulation. When they agree, both have a
# point. The same comparison stands in every report of `jaxbacklash fit` and `refine`.

# %%
fit = jb.fit(record, inertia=3.16, starts=1)
print(fit)

# %%
print(jb.cross_check(fit))

# %% [markdown]
# ## When there is no skeleton
#
# A multisine swings at many frequencies at once. It has no envelope that means anything, and `skeleton` says so instead of
# giving a number. The fit does not mind.

# %%
many = 0.004 * np.sin(2 * np.pi * np.outer(record.t, np.linspace(0.7, 9.0, 19)) + np.arange(19.0) ** 2).sum(axis=1)
print(jb.skeleton(record.replace(x=many, z=0.6 * np.roll(many, 30)), inertia=3.16))

# %% [markdown]
# ## At the edge of the play
#
# The paper checks its numbers once more, in a way that knows no play: a soft spring holds the link against one contact, a
# hammer or a shaker moves it a little, and the joint is linear. Force and motion then give a frequency response, the paper's
# Figure 11. Here a random force of many lines pushes a link that 120 N m hold down.

# %%
held = joint.with_effects(jb.Preload(120.0))
lines = np.arange(2.0, 60.0, 0.11)
phases = np.random.default_rng(3).uniform(0.0, 2.0 * np.pi, lines.size)
push = jb.Multisine(np.full(lines.size, 1.0), 2.0 * np.pi * lines, phases, as_force=True)
shaken = jb.simulate(held, push, duration=2.0 * seconds, rate=500.0, y0=np.radians(0.75) + 120.0 / 15095.0)
noise = 2e-6 * np.random.default_rng(4).standard_normal(shaken.t.size)
test = jb.Record(np.asarray(shaken.t), {"F": np.asarray(shaken.drive.force), "y": np.asarray(shaken.y) + noise})

# %%
response = jb.frequency_response(test, segment=4.0, band=(4.0, 40.0))
print(response)

# %%
jb.plot.frequency_response(response)
plt.show()

# %% [markdown]
# Stiffness, damping and inertia, to be set beside those of the sweep; the play it cannot know. H1 and H2 are what every analyser
# draws; the numbers come from the spectra of the whole record, since a window blunts the resonance.

# %% [markdown]
# Two pictures of the sweep are left: its backbone with the damping, and the ridge that the wavelet's path follows. All of them
# stand on the page that `jaxbacklash skeleton sweep.csv --inertia 3.16 --out skeleton1` writes.

# %%
jb.plot.backbone(found)
jb.plot.ridge(found)
plt.show()
