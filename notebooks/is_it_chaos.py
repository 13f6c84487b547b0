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
# # Is it chaos?
#
# From a file with one measured channel to a verdict, and to the number behind it. A joint with play, shaken at one
# frequency, may answer in a motion that never repeats. Is that noise, is it several frequencies at once, or is it chaos?
# The series here is simulated, so that the answer is known; the last cells show what to change for one's own.

# %%
import os
from pathlib import Path
from tempfile import mkdtemp

import matplotlib.pyplot as plt
import numpy as np

import jaxbacklash as jb

jb.start()
TINY = bool(os.environ.get("JAXBACKLASH_TINY"))  # set by the tests, to be quick

# %% [markdown]
# ## A series
#
# The forced oscillator of the source paper, CASE 1: a mass between two stops, pushed with 100 N at 40 rad/s. Forty samples a
# period, and noise of 2 % of the motion, as a sensor might add. It goes into a file, as a measurement would come.

# %%
period = 2 * np.pi / 40.0
periods = 60 if TINY else 150
system, force = jb.case_1()
motion = jb.simulate(system, force, duration=periods * period, rate=40 / period)
position = np.asarray(motion.y)
noisy = position + 0.02 * position.std() * np.random.default_rng(0).standard_normal(position.size)
file = Path(mkdtemp()) / "mass.csv"
np.savetxt(file, np.column_stack([motion.t, noisy]), delimiter=",", header="t,position", comments="")

# %%
source = jb.read_series(file, "position")
print(source.summary())
plt.figure(figsize=(9, 2.5), layout="constrained")
plt.plot(source.t[-1200:], 1e3 * source.values[-1200:], lw=0.8)
plt.xlabel("time [s]")
plt.ylabel("position [mm]")
plt.show()

# %% [markdown]
# ## The verdict
#
# One call. Delay, dimension and neighbourhoods are chosen from the series by rules that the report states.

# %%
found = jb.chaos(source.values, source.dt)
print(found)

# %% [markdown]
# ## Why believe it?
#
# Four witnesses, and the verdict needs all of them. First the state, one delay apart. A thin folded sheet speaks for few
# degrees of freedom, a cloud for noise.

# %%
jb.plot.attractor(found, "m")
plt.show()

# %% [markdown]
# Then how neighbours part. In chaos the mean logarithm of their distance rises along a straight line until they are as far
# apart as any two states; in noise it jumps there at once; in regular motion it stays low.

# %%
jb.plot.stretching(found)
plt.show()

# %% [markdown]
# Then surrogates: series with the same values and the same spectrum, otherwise random. If the series were linear noise, seen
# through whatever static curve, it would be as badly predicted as they are. Beside them is the walk of the 0-1 test, which
# circles for regular motion and wanders for chaos.

# %%
jb.plot.surrogates(found)
plt.show()

# %% [markdown]
# ## What was chosen
#
# The delay is where the mutual information first has a minimum. The dimension is where Cao's E1 stops changing; with the noise
# taken off fewer coordinates are enough.

# %%
jb.plot.delay(found)
plt.show()

# %%
jb.plot.dimension(found)
plt.show()

# %% [markdown]
# ## When it is not chaos
#
# Coloured noise, which looks irregular too. No exponent is given: there is none to give.

# %%
noise = np.convolve(np.random.default_rng(1).standard_normal(3000), np.exp(-np.arange(60) / 12.0), "valid")
print(jb.chaos(noise, source.dt, clean=False))

# %% [markdown]
# ## One's own series
#
# Any table with even times will do; name the column. Without a time column, give the rate.
#
# ```sh
# jaxbacklash chaos mass.csv --channel position --out chaos1
# jaxbacklash chaos laser.csv --channel intensity --rate 12.5e6 --out chaos2
# ```
#
# How long must it be? Some hundred swings, and a record over which differences would grow by e^10 many times over. Below 500
# samples the answer is a refusal. A few thousand samples at 20 to 50 a swing are a good start; more samples a swing add little.
