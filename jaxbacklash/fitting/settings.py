"""Every number that a fit and a search for missing laws are set by, each once, with its meaning and its unit.

What one of them is worth is a row of the table that `benchmarks.search_ablation` makes: each is halved, doubled and taken away
over records whose hidden laws are known. Weights, shares and factors have no unit. ln L is the logarithm of a likelihood.
"""

from __future__ import annotations

# ---- chance: what noise alone may do

SURE = 4.0
"""Standard errors, or times what is demanded, from which on something is no accident: noise does it once in 30 000 times."""
LIKELY = 2.4
"""Standard deviations that noise exceeds once in a hundred times: less is not told from chance while there is more to add."""
WITHIN_CHANCE = 1.92
"""Half the 95 % point of chi-square with one degree of freedom [ln L]: q = 0 is kept where the likeliest q gains no more."""
RARE = 1e-3
"""Chance with which noise alone takes a window beyond the limit that is counted."""
BEYOND, FEW = 0.05, 3
"""Windows beyond that limit, as a share and at least, that no chance explains; single ones are left to contacts that just graze
an edge, where a right model parts from the record too."""
CONFIDENCE = 0.95
"""Share of intervals that hold the truth."""

# ---- noise: how well its level is known

NOISE_KNOWN = 0.03
"""Relative error of the estimated noise level that is put down to the estimate and not to the model."""
NEAR_NOISE = 1.01
"""Root of the reduced chi-square up to which what is left counts as noise, since the noise itself is estimated."""
AT_NOISE, NEARLY, EXPLAINED = 1.05, 1.1, 1.3
"""Errors over the noise, which is itself an estimate: of the median window of a held-out record, up to which a larger error there
speaks of a few windows; up to which a fit is near the noise; and above which a model leaves more than noise."""
WHITE, LAGS = 0.2, 3
"""Correlation of residuals at so many first lags above which they are no white noise."""
ROUNDS = 3
"""How often the noise is taken from the fit and the fit from the noise: the second time changes a few percent."""
FEW_COUNTS = 10.0
"""Counts of an encoder in the play below which intervals do not hold (independent records: with four to seven, errors of three to
six standard errors; with a hundred, none but by chance)."""
SCATTERED = 0.4
"""Noise, as a share of a count, that scatters what counting does: counting alone makes 0.29 of it."""

# ---- the continuation in the torque that a model leaves out

LOOSEST, LOOSE, SHARP, JOINED, TIGHTEST = 1e-4, 1e-2, 0.1, 1.0, 100.0
"""Weights of the ties between windows. `LOOSEST`, with which a fit begins, lets a window's end miss the next one's start by two
hundred times the noise. `LOOSE` is the most with which a model is begun near a neighbour: it may lack what that one has.
From `SHARP` on dry friction is sharp, and a fit with dry friction ends there, since tighter ties make corners. `JOINED` is the
weight within a window whose error is quoted, and that beside which one trajectory has to be as likely. With `TIGHTEST` the
windows are one trajectory."""
FINER = 10.0
"""Factor by which the weight of the ties grows from one fit to the next."""
FALLEN = 3.0
"""Fall of the evidence below its highest from which on tighter ties are not tried, and below that of a model that a fit contains
from which on the fit is begun again [ln L]: a likelihood of a twentieth."""
BETWEEN, LAST = 15, 40
"""Steps of a fit with ties looser than `SHARP`, and of one with those or tighter ones; also of a score without a law that
remembers, and with one."""
ROUGHLY, CLOSELY = 0.3, 1e-2
"""How near to the minimum a fit on the way comes, and the last one [ln L]: half the square of the standard errors by which a
parameter may be off."""
SOFT, NARROWEST = 0.03, 1e-3
"""Range in which dry friction turns its sign where ties are loose, and the least to which it is narrowed before it turns at once,
as shares of the speed at which it slides."""
STABLE = 1.5
"""Product of step and rate, of the fastest decay that softened friction may make, up to which a Runge-Kutta step of fourth order
is stable (2.8), less the slope 1.5 of the softened sign and a margin for friction that grows during the fit."""
NEAR_ENOUGH = 2.5
"""How many times the noise a run along the smoothed input may miss by for the input to be let free within its noise."""

# ---- the start of a fit

WINDOWS, TIMES = 128, 3
"""Windows of the segment on which starting points are compared; a record must be so many times longer, else it is taken whole."""
WELL_KNOWN, MOST_UNCERTAIN = 0.1, 0.5
"""Standard errors: below that share of its scale a segment tells a parameter; above that share of it a value is open."""
UNLIKE_A_LOOP = 0.5
"""Share of a transmitted force that its loop may leave unexplained."""
PERIOD = 20.0
"""Samples in a period of the contact's resonance at the start, where a record of transmitted force has to tell the inertia."""
ROUNDING = 1e-9
"""What a place that is read back may be off by, as a share of what is seen."""
NEWTON = 3
"""Steps to where a measuring chain shows what it should: scales and shifts need one, a law of the user's own may need more."""

# ---- what a record can tell

SHORTEST = 2.0
"""Samples in a contact, half a period of its resonance, below which its stiffness is not determined."""
TAIL = 0.01
"""Share of the samples beyond either edge of the range that is the play: noise, and the ends of contacts."""
ONE_WITH = 0.9995
"""Correlation of two errors from which on only a combination of the two parameters is determined: it prints as 1.000."""
CORRELATED = 1.25
"""Misfit, in units of the noise, from which on what one run misses by is no noise."""

# ---- the prediction error

NEAR, CLEARLY = 1e-4, 1e-3
"""What a score may leave to gain: in each window [ln L], and as a share of what the misfit exceeds the noise by."""
FURTHER = 0.01
"""Share of half the sum of squares that a further step promises where a score has not arrived."""

# ---- the search for missing laws

MOST_LAWS = 4
"""Laws in a model at most: more small ones stand for one that the catalogue does not have."""
MOST_FITTED = 3
"""Candidates beside one model that are fitted at most, and other models that are tried with one law more."""
MOST_STEPS = 600
"""Steps of a search over all its fits: then it ends with the best it has. Counted and not timed, so that every run ends alike."""
CLEAR_SHARE = 0.1
"""Share of what a model leaves that a law must take away if more is left."""
PROMISING, CLOSE = 0.25, 0.8
"""Share of the most promising candidate's predicted gain that earns a fit; and of that of one that leaves nothing."""
SCATTER = 60.0
"""Evidence up to which two models with dry friction are begun once more before they are compared [2 ln L]."""
MEASURING = 4.0
"""Minus twice the log prior odds of a fault of the measuring chain against a law of the joint [2 ln L]: more than fits with dry
friction scatter by where both do the same to a record."""
SEEN = 10.0
"""What the weak form, or a score test, shows of a torque by chance where nothing is missing, at most: fall of its sum of squares,
in units of the noise. What shows less is neither tuned nor held against the trajectory."""
ALIKE = 0.01
"""Share of a torque, squared, that the model cannot make up for by itself: with less it is no torque of its own."""

# ---- the experiment that separates two models

SECONDS = 4.0
"""Length of the experiment [s], of which its sine grows over the first tenth."""
PARTED = 40.0
"""What the experiment must promise [2 ln L]: four times what an effect is accepted for."""
