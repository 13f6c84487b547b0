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
# # Find the missing effect
#
# A record came from the bench. The joint has play, a contact stiffness and damping, and something else that nobody wrote
# down. This notebook finds it, first by hand, one step at a time, and then in one call. On the way it disagrees with the
# tool once, to see what happens to somebody who is wrong.

# %%
from pathlib import Path
from runpy import run_path

import matplotlib.pyplot as plt

import jaxbacklash as jb

jb.start()

# %% [markdown]
# Two records of the same joint: one to fit, one to judge by. The inertia of the link is known, 3.16 kg m^2.

# %%
record, heldout = jb.demo_records()
print(record.summary())

# %% [markdown]
# ## 1. Fit what is known
#
# Play, stiffness and damping. One starting point is enough here; a fit of your own should keep the usual four.

# %%
base = jb.fit(record, inertia=3.16, heldout=heldout, starts=1)
print(base)

# %% [markdown]
# The prediction error is near four times the noise, on both records. Something is missing.

# %% [markdown]
# ## 2. Look where it fails
#
# Every sentence below has passed a test: what chance could have done is not told.

# %%
found = jb.where_it_fails(base)
print(found)

# %% [markdown]
# The same as pictures. Misfit and missing torque against what tells most about them:

# %%
jb.plot.where_it_fails(found)
plt.show()

# %% [markdown]
# ## 3. The missing torque
#
# The torque that would have to be added to the model for it to follow the record, with its band. It is estimated inside the
# prediction windows, not by differentiating the record twice.

# %%
jb.plot.missing_torque(found)
plt.show()

# %% [markdown]
# Against the coordinate that explains it best it is nearly a straight line through the origin: it falls with the absolute
# angle of the link, which the joint itself does not know. So it acts between the link and the ground.

# %%
jb.plot.torque_over(found)
plt.show()

# %% [markdown]
# ## 4. Which effect is it?
#
# Every effect of the catalogue is judged from the sensitivities of this one fit: what would the prediction error become, and
# how strongly does the record speak for it? Evidence is the fall of an information criterion: it charges for every
# parameter that an effect brings, and counts residuals that hang together as the few that they are. Below 0 it speaks
# against the effect.

# %%
ranking = jb.rank_effects(base)
print(ranking)

# %%
jb.plot.ranking(ranking)
plt.show()

# %% [markdown]
# Gravity and a torque ripple are far ahead of all others. Over the few degrees that this link moves, a ripple of four
# periods a turn looks much like a weight; gravity does it with one parameter instead of three. Then comes a spring inside the
# play, a long way behind.

# %% [markdown]
# ## 5. Add it by hand
#
# The best of the ranking, at the strength that was predicted for it; `effects=["gravity"]` would do as well.

# %%
print(ranking[0])
full = jb.fit(record, inertia=3.16, effects=[ranking[0].effect], heldout=heldout, starts=1)
print(full)

# %% [markdown]
# ## 6. Disagree once
#
# Suppose you know the rig, and would have sworn that there is a soft spring inside the play. The tool does not mind.

# %%
other = jb.fit(record, inertia=3.16, effects=["gap_spring"], heldout=heldout, starts=1)
print(other)

# %% [markdown]
# The error does not fall: on the record that the fit has never seen it is a little larger than without the spring. Yet
# the spring's stiffness is many standard errors away from zero. While a model misses something larger, a parameter that
# differs from zero proves nothing; the error does.

# %%
jb.plot.stages([base, other, full])
plt.show()

# %% [markdown]
# ## 7. All of it at once
#
# `refine` goes the whole way: it fits, ranks, refits the best few, adds the best, checks whether earlier additions are still
# needed, and stops when the rest is noise or nothing explains it.

# %%
refined = jb.refine(record, heldout=heldout, inertia=3.16)
refined

# %%
print(refined)

# %% [markdown]
# Read how far play, stiffness and damping moved when gravity came in. The base model was sure of its play to a hundredth
# of a milliradian, and wrong by nearly a hundred times that. The same as a program reads it:

# %%
print(refined.moved[1]["backlash"])

# %% [markdown]
# ## 8. An effect of your own
#
# Nobody's catalogue is complete. Here is a file with one class: a cable that pulls the link back to its middle. Nothing
# has to be registered, running the file is enough; on the command line it is `--laws own_effect.py`.

# %%
own = Path(record.path).with_name("own_effect.py")
print(own.read_text())

# %%
laws = run_path(own)
print(jb.rank_effects(base))

# %% [markdown]
# The cable takes part like any other law, and this record cannot tell it from gravity: y and sin(y) are the same over
# a tenth of a radian. That is an answer too. A record with wider swings would decide, or a look at the rig.
