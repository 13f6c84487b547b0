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
# # First fit
#
# Ten minutes from a measured motion to backlash, stiffness and damping, to the place where that model fails, and to a
# better one. The record comes with the package: a link hangs behind a joint with play, its base is shaken, and two
# encoders watch. Somebody forgot to mention a load on the link.

# %%
import matplotlib.pyplot as plt

import jaxbacklash as jb

# %% [markdown]
# The fits need double precision, and compiled code is worth keeping for the next time. Importing the package changes
# nothing, so a program says once that it wants both.

# %%
jb.start()

# %% [markdown]
# ## The record
#
# One row a sample: time `t` in s, base motion `x` in rad, and `z`, the motion of the link against the base, in rad.
# A second record of the same joint, shaken in another way, is kept aside for the end.

# %%
record, heldout = jb.demo_records()
print(record.summary())
print(heldout.summary())

# %%
jb.plot.record(record)
plt.show()

# %% [markdown]
# Look before you fit. The picture below shows how often the joint passes each relative position and speed. In the
# middle the link coasts from one contact to the other at almost constant speed: that is the play.

# %%
jb.plot.phase_plane(record)
plt.show()

# %% [markdown]
# ## The base model
#
# Backlash, contact stiffness and viscous damping. With base motion alone, stiffness and damping can only be told per
# unit inertia; here the inertia of the link is known, 3.16 kg m^2.

# %%
base = jb.fit(record, inertia=3.16, heldout=heldout)
print(base)

# %% [markdown]
# Read it from the top:
#
# * The **noise** of both encoders was estimated from the record; nothing was told.
# * The **prediction error** is the number to watch. Every 0.2 s the model starts afresh from an estimated state and
#   predicts what follows; 1.00 would mean that only noise is left. Here it is several times that, and so it is on the
#   **held-out** record, to which nothing was fitted.
# * The **parameters** carry standard errors. They have been widened by the misfit, but no widening makes a wrong model
#   right: as long as the first number is not near 1, the play may be off by far more than its error says.
# * The last lines say how many **starting points** came to the same answer, and give the verdict in words.
#
# By eye, nothing seems wrong. Dots are measured, lines are the model, stretch A is the worst of the record.

# %%
jb.plot.fit(base)
plt.show()

# %% [markdown]
# ## Where it fails
#
# In units of the noise the failure is plain. It is large where the base swings slowly and far, where the link stays in
# the play for long and only small torques move it. So the contact is not the first suspect; a load that acts on the
# link itself is, and the link hangs. The picture does not prove it. The next fit does.

# %%
jb.plot.residuals(base)
plt.show()

# %% [markdown]
# ## Adding what is missing
#
# Effects are added by name. These are known (your own class would appear here too):

# %%
print(", ".join(jb.catalogue()))

# %%
full = jb.fit(record, inertia=3.16, effects=["gravity"], heldout=heldout)
full

# %% [markdown]
# At the end of a cell a result shows itself as a table with its picture; `print` tells the same in words. A program takes the
# numbers one by one, or as pandas has them:

# %%
print(full.parameters["backlash"].value, full.parameters["backlash"].unit)
full.to_dataframe()

# %% [markdown]
# The error has come down to the noise, and `gravity.G` is negative: the link hangs. Look also at how far the play and
# the damping have moved, by many times the errors that the base model gave them. That is what a missing load does to a
# fit that does not know it.

# %% [markdown]
# ## The record it has never seen
#
# A model with more parameters always fits better, so the judge is the record that was kept aside. Parameters stay as
# they are; only the state at the start of each window is estimated.

# %%
jb.plot.stages([base, full])
plt.show()

# %% [markdown]
# The same in words, for any model and any record:

# %%
print(jb.compare(base.system, heldout))

# %%
print(jb.compare(full.system, heldout))

# %% [markdown]
# ## What to keep
#
# A model is a small text file, meant to be read and edited. `jaxbacklash compare` and `jaxbacklash simulate` take it.

# %%
print(jb.dump_model(full.system))

# %% [markdown]
# ## When the input is wrong
#
# Input that cannot be used is refused with one sentence: where, what was found, what is wanted. Here a column that does
# not exist, and angles in degrees that nobody converted.

# %%
try:
    jb.read_record(record.path, columns={"z": "encoder_2"})
except jb.BadInput as error:
    print(error)

# %%
try:
    jb.read_record(record.path, scales={"x": 57.3, "z": 57.3})
except jb.BadInput as error:
    print(error)

# %% [markdown]
# ## Your own record
#
# The same on the command line, with a report to look at:
#
# ```sh
# jaxbacklash fit run1.csv --inertia 3.16 --columns x=enc1,z=enc2 --unit x=deg,z=deg --out fit1
# ```
