"""Records of joints that the independent simulator makes, and what goes wrong with records when they are taken and handed on.

Each fault takes a generator and a record, and returns the record as it is then with the rows that it spoilt, or None for all.
"""

import numpy as np

from tests.independent.generator import force_record, make_effects, make_excitation, make_rig, measure, simulate_truth

NOISE = 3e-5


def good(seed: int, kind: str = "multisine", rate: float = 250.0, observed: str = "z", effects=(), quantum=None):
    """A record as measured, of a joint drawn by the seed."""
    rng = np.random.default_rng(seed)
    rig, seconds = make_rig(rng), 6.0
    values, excitation = make_effects(rng, *effects), make_excitation(rng, kind, seconds)
    if kind.startswith("force"):
        return force_record(rig, values, excitation, rate, seconds, rng, 0.1, NOISE, quantum)
    record = measure(simulate_truth(rig, values, excitation, rate, seconds), rng, NOISE, NOISE, quantum)
    if kind == "free_decay":
        return {"t": record["t"], "z": record["z"]}
    if observed == "y":
        return {"t": record["t"], "x": record["x"], "y": record["x"] + record["z"]}
    return record


def some(rng, record, count, edge=20):
    """Rows, apart from one another and from the ends."""
    return np.sort(rng.choice(np.arange(edge, record["t"].size - edge, 5), count, replace=False))


def wrapped(rng, record):
    x = record["x"] - np.quantile(record["x"], rng.uniform(0.3, 0.7))
    return record | {"x": np.mod(x, 2 * np.pi)}, None


def at_pi(rng, record):
    x = record["x"] + np.pi - 0.02
    return record | {"x": x - 2 * np.pi * (x > np.pi)}, None


def wrapped_counts(rng, record):
    """A counter of 14 bits, scaled by somebody to another unit than rad."""
    counts = np.round((record["x"] - np.quantile(record["x"], 0.4)) / (2 * np.pi) * 2**14)
    return record | {"x": np.mod(counts, 2**14) * 1e-4}, None


def lost_counts(rng, record):
    row = int(rng.integers(300, 1200))
    return record | {"y": record["y"] + 0.05 * (np.arange(record["t"].size) > row)}, [row]


def coded(rng, record):
    rows, z = some(rng, record, 12), record["z"].copy()
    z[rows] = -9999.0
    return record | {"z": z}, rows


def zeroed(rng, record):
    far = np.flatnonzero(np.abs(record["z"]) > 0.004)
    rows, z = np.sort(rng.choice(far[(far > 20) & (far < 1400)][::7], 12, replace=False)), record["z"].copy()
    z[rows] = 0.0
    return record | {"z": z}, rows


def spiked(rng, record):
    rows, y = some(rng, record, 6), record["y"].copy()
    y[rows] += rng.choice((-1.0, 1.0), rows.size) * rng.uniform(0.05, 0.5, rows.size)
    return record | {"y": y}, rows


def refreshed_seldom(rng, record):
    every = int(rng.integers(3, 8))
    return record | {"z": np.repeat(record["z"][::every], every)[: record["t"].size]}, None


def stale(rng, record):
    rows, z = some(rng, record, 15), record["z"].copy()
    z[rows] = z[rows - 1]
    return record | {"z": z}, rows


def filled_up(rng, record):
    rows = np.arange(record["t"].size)
    at = np.where(rows % 300 > 290, rows // 300 * 300 + 290, rows)
    return {name: values if name == "t" else values[at] for name, values in record.items()}, None


def clipped(rng, record):
    limit = np.quantile(np.abs(record["z"]), 0.9)
    return record | {"z": np.clip(record["z"], -limit, limit)}, None


def clipped_force(rng, record):
    limit = 0.6 * np.max(np.abs(record["F"]))
    return record | {"F": np.clip(record["F"], -limit, limit)}, None


def geared(rng, record):
    return record | {"x": record["x"] * rng.choice((1.5, 3.0, 10.0))}, None


def turned(rng, record):
    return record | {"y": -record["y"]}, None


def turned_z(rng, record):
    return record | {"y": record["x"] + record["z"], "z": -record["z"]}, None


def absolute(rng, record):
    return record | {"z": record["x"] + record["z"]}, None


def contradictory(rng, record):
    return record | {"y": record["x"] + 0.6 * record["z"]}, None


def three_axes(rng, record):
    noise = rng.normal(0.0, 0.05, (3, record["t"].size)) + np.array([[0.0], [0.0], [1.0]])
    return record | dict(zip("xyz", noise, strict=True)), None


def in_degrees(rng, record):
    return record | {name: np.rad2deg(record[name]) for name in ("x", "z")}, None


def in_counts(rng, record):
    return record | {name: np.round(record[name] / (2 * np.pi) * 2**16) for name in ("x", "z")}, None


def unanswered(rng, record):
    return record | {"z": rng.normal(0.0, NOISE, record["t"].size)}, None


def below_a_count(rng, record):
    return record | {"z": np.where(rng.random(record["t"].size) < 0.1, 1e-3, 0.0)}, None


def held_at_first(rng, record):
    rows = int(rng.integers(150, 400))
    held = record["z"][0] + rng.normal(0.0, NOISE, rows)
    return {"t": np.arange(rows + record["t"].size) / 250.0, "z": np.concatenate([held, record["z"]])}, None


def grown(rng, record):
    """The answer to a chirp, without what drives it."""
    return {"t": record["t"], "z": record["z"]}, None


def late_at_first(rng, record):
    """Channel y by a delay of three samples, whose buffer held the first value of a motion under way."""
    fast = int(np.argmax(np.abs(np.diff(record["y"][:700])))) + 30
    y = record["y"][fast:]
    y = np.concatenate([y[:1] + rng.normal(0.0, NOISE / 3, 3), y[:-3]])
    return {"t": record["t"][: y.size], "x": record["x"][fast:], "y": y}, [0, 1, 2, 3]


def going_back(rng, record):
    t = record["t"].copy()
    t[700:] -= t[700]
    return record | {"t": t}, [699]


def in_bursts(rng, record):
    rows = np.arange(record["t"].size)
    return record | {"t": (rows // 16) * 16 / 250.0}, None


def in_milliseconds(rng, record):
    return record | {"t": 1e3 * record["t"]}, None
