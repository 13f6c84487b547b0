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
# # Maps and chaos
#
# A loose joint that is shaken harmonically need not move harmonically. It may take two, three, ... periods of the drive for
# one of its own, or never repeat. This tour follows the paper's oscillator (CASE 1) and shows where it does which.

# %%
import os

import matplotlib.pyplot as plt
import numpy as np

import jaxbacklash as jb

# %% [markdown]
# `start` switches to double precision, which everything needs, and tells the compiler what maps and fits gain from.

# %%
jb.start()
tiny = bool(os.environ.get("JAXBACKLASH_TINY"))

# %% [markdown]
# ## One motion
#
# In units of the half play and of the contact's own time, p'' + 2 zeta p' + F(p) = alpha cos(Omega tau). Looked at once a
# period of the drive, a periodic motion is a few points. This one is not.

# %%
case = jb.dynamics.PaperCase(1)
system, force = case.build({})
points = jb.dynamics.stroboscopic(system, force, points=100 if tiny else 4000)

# %%
figure, ax = plt.subplots(figsize=(6, 4), layout="constrained")
ax.plot(points.z, points.dz, ".", ms=2)
ax.set(xlabel="p [half plays]", ylabel="p' [half plays per unit of tau]", title="CASE 1 once a period, 1/alpha = 2")
plt.show()

# %% [markdown]
# ## Lyapunov exponents
#
# They say how fast a small difference grows, or dies away. A positive one means chaos. The error bar tells how far a longer run
# would still move the number. All exponents together sum to the rate at which volumes shrink, here -2 zeta = -0.04.

# %%
exponents = jb.dynamics.lyapunov_spectrum(system, force, periods=60 if tiny else 2000, skip=20 if tiny else 100)
print(exponents)
print("sum", exponents.values.sum())

# %% [markdown]
# Any system of the package has exponents, dry friction and dampers of the contact included. Between its edges this one is
# linear, so it was followed exactly; with friction it goes by located steps. Friction calms it:

# %%
with_friction = system.with_effects(jb.CoulombGround(0.05))
print(jb.dynamics.lyapunov_spectrum(with_friction, force, count=1, periods=30 if tiny else 400, skip=5 if tiny else 100))

# %% [markdown]
# ## Figures 2 and 3 of the paper
#
# The largest exponent and the bifurcation diagram against 1/alpha: to the right the force falls, or the play grows.

# %%
inverse_alpha = np.linspace(1.0, 5.0, 24 if tiny else 800)
periods, skip = (50, 10) if tiny else (600, 200)
line = jb.dynamics.paper_map(1, {"inverse_alpha": inverse_alpha, "zeta": [0.02]}, periods=periods, skip=skip).isel(zeta=0)
jb.plot.exponents(line)
plt.show()

# %% [markdown]
# ## Swept up, swept down
#
# Where two motions are possible, the past decides. A sweep goes on from where the last value left the motion.

# %%
values = np.linspace(3.8, 4.8, 6 if tiny else 120)
sweeps = jb.dynamics.bifurcation(
    case, "inverse_alpha", values, settle=10 if tiny else 60, samples=20, start_periods=40 if tiny else 300
)
jb.plot.bifurcation(sweeps)
plt.show()

# %% [markdown]
# ## Basins of attraction
#
# At 1/alpha = 3 three motions stand side by side: one of period 1 and two of period 3 that mirror one another. Which one a
# joint ends on depends on where it starts.

# %%
side = np.linspace(-3.0, 3.0, 12 if tiny else 200)
found = jb.dynamics.basins(case, {"inverse_alpha": 3.0}, side, side, periods=120 if tiny else 300)
print(*found.attractors, sep="\n")
jb.plot.basins(found)
plt.show()

# %% [markdown]
# ## Two parameters at once
#
# A map is a labelled dataset. `jaxbacklash map` writes the same as netCDF.

# %%
axes = {"inverse_alpha": np.linspace(1.0, 5.0, 8 if tiny else 256), "zeta": np.linspace(0.005, 0.03, 4 if tiny else 64)}
plane = jb.dynamics.paper_map(1, axes, periods=periods, skip=skip)
jb.plot.map(plane)
plt.show()

# %% [markdown]
# Over the frequency of the drive and its force:

# %%
axes = {"Omega": np.linspace(0.1, 0.6, 8 if tiny else 200), "inverse_alpha": np.linspace(1.0, 5.0, 4 if tiny else 80)}
plane = jb.dynamics.paper_map(1, axes, periods=periods, skip=skip)
jb.plot.map(plane)
plt.show()

# %% [markdown]
# ## Your own joint
#
# The same for a joint in SI units, over any of its parameters and those of the drive. With `store=` the tiles go to a folder and
# a run that is stopped goes on there; with `client=` they are computed by a dask cluster.

# %%
joint = jb.base_motion_joint(inertia=3.16, backlash=0.026, stiffness=11000.0, damping=20.0)
shaken = jb.Harmonic(0.05, 2.0 * np.pi * 1.54)
family = jb.dynamics.NamedParameters(joint, shaken)
axes = {
    "drive.amplitude": np.radians(np.linspace(1.0, 6.0, 6 if tiny else 60)),
    "drive.frequency": np.linspace(1.0, 3.0, 4 if tiny else 40),
}
own = jb.dynamics.run_map(jb.dynamics.request(family, axes, periods=periods, skip=skip))
print(own.lyapunov.dims, own.lyapunov.attrs["units"], own.attrs["solver"])
jb.plot.map(own, degrees=True)
plt.show()

# %% [markdown]
# ## With everything the catalogue has
#
# The weight of the link (as sin y), a contact that hardens, dry friction: such a joint is not linear between its edges, so the
# exact steps do not apply, and small steps that end at every edge and every rest take over by themselves. The attribute `solver`
# tells which way was taken. These take some ten times longer. How does the amplitude of the base decide what this joint does?

# %%
real = joint.with_effects(jb.Gravity(28.0), jb.CubicStiffness(3e7), jb.CoulombJoint(1.0))
values = np.radians(np.linspace(2.0, 5.0, 3 if tiny else 60))
swept = jb.dynamics.bifurcation(
    jb.dynamics.NamedParameters(real, shaken),
    "drive.amplitude",
    values,
    settle=10 if tiny else 60,
    samples=20,
    start_periods=30 if tiny else 200,
    starts=[(0.0, 0.0), (0.02, 0.0)],
)
print(swept.attrs["solver"])
jb.plot.bifurcation(swept, degrees=True, play=(-0.013, 0.013))
plt.show()

# %% [markdown]
# ## Along a motion that never repeats
#
# A chirp, or a measured base motion (`jb.measured_base(record)`), has no period: give the time between two
# samples instead. The exponent is then that of this one stretch. Where it is positive, no simulation of the whole stretch can be
# trusted, however good the model, and a fit must look through short windows.

# %%
chirp = jb.Chirp(amplitude=0.06, f0=0.5, f1=6.0, duration=20.0)
plays = np.linspace(0.01, 0.05, 5 if tiny else 120)
wanted = jb.dynamics.request(
    jb.dynamics.NamedParameters(joint, chirp), {"backlash": plays}, period=0.25, periods=40 if tiny else 80, skip=4, samples=16
)
stretch = jb.dynamics.run_map(wanted)
print(stretch.attrs["solver"])
jb.plot.exponents(stretch, samples=False, degrees=True)
plt.show()
