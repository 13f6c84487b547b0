"""Results as the package finds them, made up in an instant: a record, a fit of it, what it misses, stages and a ranking."""

import numpy as np

import jaxbacklash as jb
from jaxbacklash.criticism import Ranked, Ranking, Refinement, Stage
from jaxbacklash.criticism.verdict import Verdict
from jaxbacklash.fitting import Comparison, Estimate, Fit, Score
from jaxbacklash.residuals import Dependence, Findings, Latent, Surface

INERTIA, PLAY, STIFFNESS, DAMPING = 3.16, 0.026, 12000.0, 20.0
NOISE, RATE, WINDOW = 3e-5, 250.0, 0.2


def joint(**words):
    return jb.base_motion_joint(inertia=INERTIA, backlash=PLAY, stiffness=STIFFNESS, damping=DAMPING, **words)


def record(seconds=4.0, seed=0):
    """A base that sways and a link that swings across its play, as smooth curves with the noise of encoders."""
    t = np.arange(0.0, seconds, 1.0 / RATE)
    rng = np.random.default_rng(seed)
    x = 0.05 * np.sin(2.0 * np.pi * 1.5 * t) + NOISE * rng.standard_normal(t.size)
    z = 0.03 * np.sin(2.0 * np.pi * (1.0 + 0.2 * t) * t) + NOISE * rng.standard_normal(t.size)
    return jb.Record(t, {"x": x, "z": z}, path="made_up.csv")


def score(of, miss=4e-4, seed=1):
    """The score of a model that misses by a slow sine."""
    measured = of.channels[of.observed_name]
    residual = miss / NOISE * np.sin(40.0 * of.t) + np.random.default_rng(seed).standard_normal(of.samples)
    starts = np.arange(0.0, of.t[-1], WINDOW)
    inside = [(of.t >= a) & (of.t < a + WINDOW) for a in starts]
    rms = np.array([np.sqrt(np.mean(residual[rows] ** 2)) for rows in inside])
    return Score(
        rms=float(np.sqrt(np.mean(residual**2))), median=float(np.median(rms)), window_rms=rms, window_times=starts, t=of.t,
        measured=measured, predicted=measured - NOISE * residual, residual=residual, length=WINDOW, observed=of.observed_name,
    )  # fmt: skip


def fit(miss=4e-4, effects=(), heldout=None, of=None, more=()):
    """A fit with errors in all its parameters; what could not be found has no value."""
    of = record() if of is None else of
    system = joint().with_effects(*effects)
    found = {
        "backlash": Estimate("backlash", PLAY, 1.1e-5, "rad", label="total play b"),
        "stiffness": Estimate("stiffness", STIFFNESS, 2.5, "N m/rad", label="contact stiffness k"),
        "damping": Estimate("damping", None, None, "N m s/rad", "not determined", "the link <never> moves", "viscous damping c"),
        **{one.name: one for one in more},
    }
    second = () if of.observed_name == "T" else (record(seed=5),)
    records = (of, *second)
    return Fit(
        system=system, free=tuple(found), parameters=found, scores=tuple(score(one, miss, k) for k, one in enumerate(records)),
        heldout=heldout, records=records, noise=(NOISE,) * len(records), input_noise=(NOISE,) * len(records),
        covariance=np.diag(np.full(len(found), 1e-10)), agreeing=2, tried=2, tied=True, cost=1.0, steps=7, start=None,
        model="joint", per_inertia=False, translational=False, noise_open=({},) * len(records),
    )  # fmt: skip


def loop_fit():
    """A fit of a record of transmitted force."""
    t = np.arange(0.0, 4.0, 1.0 / RATE)
    x = 0.02 * np.sin(2.0 * np.pi * t)
    force = 30.0 * np.tanh(400.0 * np.gradient(x, t)) + np.random.default_rng(2).standard_normal(t.size)
    return fit(of=jb.Record(t, {"x": x, "T": force}))


def comparison():
    of = record(seed=3)
    return Comparison(joint(), of, score(of, 0.0), NOISE, False)


GRAVITY = Estimate("gravity.G", -45.2, 0.12, "N m", label="weight G")


def refinement():
    """Gravity was missing, and friction went again."""
    held = score(record(seed=9), 5e-4)
    first, second = fit(heldout=held), fit(0.0, [jb.Gravity(-45.2)], heldout=score(record(seed=9), 0.0), more=[GRAVITY])
    stages = (Stage(None, (), first, (), {}), Stage("gravity", ("coulomb_joint",), second, (), {}))
    return Refinement(stages, (("preload",),), Verdict(True, "Missing in the base model: gravity.", True), {"search": 1.5})


def ranking():
    """Three absent effects; one was fitted, one cannot be judged."""
    words = {"moved": {}, "why": ""}
    return Ranking(
        (
            Ranked("gravity", jb.Gravity(-45.2), 1.2, 812.0, True, refitted_rms_over_noise=1.02, **words),
            Ranked("preload", jb.Preload(1.0), 3.5, -4.0, False, **words),
            Ranked("dahl", jb.Gravity(0.0), float("nan"), float("nan"), False, moved={}, why="not evaluated"),
        ),
        12.9,
    )


def latent(seconds=4.0):
    """A missing torque that goes with y, of two records."""
    t = np.tile(np.arange(0.0, seconds, 0.02), 2)
    rng = np.random.default_rng(4)
    y = 0.08 * np.sin(2.0 * np.pi * 0.7 * t)
    torque = -45.0 * np.sin(y) + 0.2 * rng.standard_normal(t.size)
    zero = np.zeros(t.size)
    return Latent(
        t=t, record=np.repeat([0, 1], t.size // 2), torque=torque, stderr=np.full(t.size, 0.2), y=y, dy=np.gradient(y), x=0.5 * y,
        dx=zero, z=0.5 * y, dz=zero, deflection=zero, side=np.sign(y), evidence=900.0, converged=True, system=joint(),
        moved={"backlash": (PLAY, 0.0262, 1e-5)}, unit="N m", records=(record(), record(seed=5)), inside=None,
    )  # fmt: skip


def surface(of=None, coordinates=("y",)):
    """The missing torque as a table over one or two of its coordinates."""
    of = latent() if of is None else of
    rows = {"y": np.linspace(-0.08, 0.08, 7), "z": np.linspace(-0.04, 0.04, 5), "side": np.array([-1.0, 0.0, 1.0]),
            "dz": np.linspace(-1.0, 1.0, 5)}  # fmt: skip
    values = np.stack([getattr(of, name) for name in coordinates], axis=1)
    knots = tuple(tuple(rows[name]) for name in coordinates)
    table = -45.0 * np.add.outer(*(np.sin(rows[name]) for name in coordinates)) if len(knots) == 2 else -45.0 * np.sin(knots[0])
    table = np.ravel(table)
    return Surface(
        coordinates=coordinates, knots=knots, table=table, stderr=np.full(table.size, 0.1), share=0.98,
        tried=((coordinates, 0.98, 900.0), (("z",), 0.4, 300.0)), moved={"backlash": (PLAY, 0.0262)}, torque=of.torque + 0.1,
        fitted=-45.0 * np.sin(of.y), coordinate_values=values, system=joint(), unit="N m",
    )  # fmt: skip


def dependence(coordinate, label, names=(), strength=0.8, p=1e-9):
    edges = np.linspace(-0.08, 0.08, 6)
    misfit = np.array([3.0, 2.0, 1.0, 2.5, 4.0])
    return Dependence(
        coordinate, label, "" if names else "rad", "value", edges, names, misfit, mean=np.array([3.0, 1.5, 0.0, -1.5, -3.0]),
        error=np.full(5, 0.1), rms=np.full(5, 2.0), share=np.full(5, 0.2), time=np.full(5, 0.2), strength=strength,
        trend=-1.0, p=p,
    )  # fmt: skip


def findings():
    """What `where_it_fails` tells of the made-up fit."""
    from jaxbacklash.residuals.failures import PLACES

    seen = latent()
    asked = (
        dependence("y", "absolute angle y"), dependence("place", "position across the play", PLACES),
        dependence("dz", "relative speed z'", strength=0.01, p=0.4),
    )  # fmt: skip
    return Findings(("The model misses the record.", "The torque falls with y."), asked, seen, surface(seen), 12.9, 11.8)


def adequate():
    """What `where_it_fails` tells of a model that misses nothing."""
    seen = latent()
    return Findings(("What is left is noise.",), (), seen, None, 1.0, 1.0)
