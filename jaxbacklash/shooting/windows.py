"""A record cut into shooting windows, as arrays of fixed shapes.

Window w covers samples w M ... (w+1) M - 1 and ends on the first sample of the next. All windows share one basis for the
measured input (base motion, or a force that is smooth): a quintic spline whose knots divide the window, so that window w
needs its own m coefficients and the first five of window w + 1. Records are laid one behind the other with an empty window
after each, which holds the trailing coefficients; the number of windows is rounded up to a bucket, so that another record
length does not compile anew.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import equinox as eqx
import numpy as np

from ..compiled import lane
from ..errors import BadInput
from ..records import Record
from ..records.force import force_edges, way
from ..sharing import sharing
from ..signals import DEGREE, NEGLIGIBLE, SPAN, choose_intervals, curve, fit_spline, knots, noise_level, noise_of_differences
from .chunks import CHUNK
from .lengths import LONGEST_PANEL
from .torque_input import channel_noise, held_basis, torque_noise

Array = Any
LEAST_INTERVALS = 8
"""Spline intervals that a window of `SPAN` or longer has room for at least, a shorter one for its share of them; those
that its input does not need are joined."""
HELD = 30.0
"""How many times more firmly than by the samples a spline is held to have no corner at a knot that its input does not need."""
SPEED = 0.2
"""Share of a window over which a jump of the speed where windows join makes the jump of place that counts as much."""
LEAST_ROOM = 512
"""Windows that the smallest compiled program has room for."""
ROOMS = (32, 64, 96, 128, 192, 256, 384, 512, 768, 1024)
"""The same, where many records are worked on side by side."""
SIZES = (8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256)
"""Samples that a window may have: few sizes, so that records of many rates run in the same compiled program."""
PARTS = (1, 2, 3, 4, 6, 8, 12, 16)
"""Panels that the time between two samples may be divided into, few for the same reason."""


class Windows(eqx.Module):
    """Arrays of W windows with M samples and P panels each, and m spline coefficients per window (m = 0: no input, or a
    rough force that is taken as exact, straight between its samples, or the command of a servo, likewise exact, and held).

    ``t0`` (W,) start times [s]; ``measured`` (W, M); ``weight`` (W, M), 1/noise or 0 where there is no sample; ``tie`` (W,), 1
    where the window runs on into the next; ``input`` (W, R) measured input and ``input_weight`` (W, R), R = M samples and m - 1
    knots where its spline is to have no corner; ``shown`` (R, m+5) what the coefficients come to there; ``force`` (W, P+1) exact
    force at panel edges, ``command`` (W, P+1) that of a servo, (W, 0) without; ``coefficients`` (W, m) start of the spline;
    ``basis`` (6, P+1, m+5) the splines and their derivatives at panel edges; ``starts`` (2, W) position and speed of the link
    from the smoothed data; ``drop`` (2,) how sharply ends tie to starts [1/rad, s/rad]; ``used`` how many windows, the first
    ones, hold data; ``told`` () how much of the variance that ``input_weight`` stands for the input shows, 1 but for one as good
    as exact, which is given a little noise; ``by_force`` True when the spline is of the force, ``by_torque`` when it is of the
    torque at the motor of a drive: then it is of degree 0, one coefficient a sample, for as long as the controller holds the
    torque; ``by_command`` where there is a command; ``at_motor`` where ``force`` acts on the motor of a drive that is pushed by
    a torque, not on its link. Of C channels ``measured`` and ``weight`` are (W, M C), the channels of a sample together;
    ``starts`` and ``drop`` then have the motor's position and speed behind those of the link.
    """

    t0: Array
    measured: Array
    weight: Array
    tie: Array
    input: Array
    input_weight: Array
    force: Array
    command: Array
    coefficients: Array
    basis: Array
    shown: Array
    starts: Array
    drop: Array
    panel: Array
    used: Array
    told: Array
    every: int = eqx.field(static=True)
    by_force: bool = eqx.field(static=True)
    by_torque: bool = eqx.field(static=True, default=False)
    by_command: bool = eqx.field(static=True, default=False)
    at_motor: bool = eqx.field(static=True, default=False)

    @property
    def count(self) -> int:
        return self.measured.shape[0]

    @property
    def samples(self) -> int:
        return (self.force.shape[1] - 1) // self.every

    @property
    def intervals(self) -> int:
        return self.coefficients.shape[1]

    def noisier(self, factor: float) -> Windows:
        """The same with the noise of the measured channel, and what the ties allow, ``factor`` times as large."""
        return eqx.tree_at(lambda w: (w.weight, w.drop), self, (np.asarray(self.weight) / factor, np.asarray(self.drop) / factor))


class Layout(eqx.Module):
    """Where each record sits among the windows, and what its noise is; plain numbers for reports.

    ``channels`` names of the measured channels where there are several, as they lie in a sample; ``beside``, per record, the
    noise of the other encoder of a drive that has two [rad].
    """

    first: tuple[int, ...] = eqx.field(static=True)
    windows: tuple[int, ...] = eqx.field(static=True)
    samples: tuple[int, ...] = eqx.field(static=True)
    noise: tuple[float, ...] = eqx.field(static=True)  # of the channel that `Record.observed_name` names
    input_noise: tuple[float, ...] = eqx.field(static=True)
    dt: float = eqx.field(static=True)
    length: int = eqx.field(static=True)
    channels: tuple[str, ...] = eqx.field(static=True, default=())
    beside: tuple[float, ...] = eqx.field(static=True, default=())


def bucket(count: int) -> int:
    """Room for ``count`` windows: 512, 1024, 2048, ... (or a little more on odd numbers of cores).

    Chunks that hold no data are skipped, so that room costs little, and a record of another length hardly ever compiles anew.
    """
    together = CHUNK * len(sharing())
    if lane.ask is not None:  # records of like length side by side: room costs them more than a program does
        return next((size for size in ROOMS if size >= count and size % together == 0), together * -(-count // together))
    size = -(-LEAST_ROOM // together) * together
    while size < count:
        size *= 2
    return size


def cut(
    records: Sequence[Record], window: float, *, longest_panel: float = LONGEST_PANEL, least: int = 0
) -> tuple[Windows, Layout]:
    """Cut one or more records of the same rate and kind into shooting windows.

    Parameters
    ----------
    records : records with the same channels and sample spacing
    window : wished length of a window [s]; the nearest of `SIZES` in samples is taken
    longest_panel : longest integration panel [s]
    least : smallest number of spline intervals a window, where there is a spline

    Raises
    ------
    BadInput
        Records of different kinds or rates.
    """
    lead = records[0]
    for other in records[1:]:
        if (other.kind, other.input_name, other.observed_name) != (lead.kind, lead.input_name, lead.observed_name):
            raise BadInput(
                f"{other.path}: has channels of a {other.kind} record ({' '.join(other.channels)}), {lead.path} of a "
                f"{lead.kind} record ({' '.join(lead.channels)}); fit them apart"
            )
        if abs(other.dt - lead.dt) > 1e-6 * lead.dt:
            raise BadInput(
                f"{other.path}: sampled at {other.rate_hz:g} Hz, {lead.path} at {lead.rate_hz:g} Hz; "
                f"give --resample-rate {lead.rate_hz:g} to bring them to one rate"
            )
    dt = lead.dt
    length = min(SIZES, key=lambda size: abs(np.log(size * dt / window)))
    wanted = int(np.ceil(dt / longest_panel - 1e-9))
    every = next((size for size in PARTS if size >= wanted), wanted)
    driver = _driver(records)
    intervals = 0
    needed = 0
    if driver == "torque":
        intervals = length  # what the controller holds for each sample is a number of its own
    elif driver is not None:
        needed = max(choose_intervals(r.t, r.channels[driver], length * dt) for r in records)
        # A step of four keeps the number of compiled shapes small.
        # No fewer than a window shares with the one before.
        room = max(round(LEAST_INTERVALS * min(length * dt / SPAN, 1.0)), DEGREE + 1)
        step = 4 if room >= LEAST_INTERVALS else 2
        intervals = -(-max(needed, room, least) // step) * step
        needed = next(n for n in range(needed, intervals + 1) if intervals % n == 0)
    drive = lead.kind == "drive"
    cut_one = _cut_drive if drive else _cut_one
    parts = [cut_one(r, length, every, intervals, needed, driver) for r in records]
    total = bucket(sum(p["measured"].shape[0] for p in parts))
    stacked: dict[str, np.ndarray] = {}
    for key in parts[0]:
        if key in ("noise", "input_noise", "told", "drop", "beside"):
            continue
        joined = np.concatenate([p[key] for p in parts])
        stacked[key] = np.pad(joined, [(0, total - joined.shape[0])] + [(0, 0)] * (joined.ndim - 1))
    counts = [p["measured"].shape[0] for p in parts]
    noise = tuple(float(p["noise"]) for p in parts)
    drop = 50.0 / np.mean(noise) * np.array([1.0, SPEED * max(length * dt, SPAN)])
    if drive:
        drop = np.mean([p["drop"] for p in parts], axis=0)
    starts = np.ascontiguousarray(stacked.pop("starts").T)
    panel = dt / every
    windows = Windows(
        basis=held_basis(length, every) if driver == "torque" else _basis(length, every, intervals, panel),
        shown=np.eye(length) if driver == "torque" else _shown(length, intervals, needed), drop=drop,
        panel=np.asarray(panel), every=every, starts=starts,
        used=np.asarray(sum(counts)), told=np.mean([p["told"] for p in parts]), by_force=driver == "F",
        by_torque=driver == "torque", by_command=lead.input_name == "command", at_motor=False, **stacked,
    )  # fmt: skip
    layout = Layout(
        first=tuple(int(v) for v in np.cumsum([0, *counts[:-1]])),
        windows=tuple(c - 1 for c in counts),
        samples=tuple(r.samples for r in records),
        noise=noise,
        input_noise=tuple(float(p["input_noise"]) for p in parts),
        dt=dt,
        length=length,
        channels=lead.observed_names if drive else (),
        beside=tuple(p["beside"] for p in parts if "beside" in p),
    )
    return windows, layout


def _driver(records: Sequence[Record]) -> str | None:
    """The measured input that gets a spline and shares in the misfit: base motion, a force where it is smooth, or the torque that
    the controller of a drive holds. The command of a servo is followed exactly."""
    if records[0].kind == "drive":
        return "torque" if records[0].input_name == "torque" else None
    if "x" in records[0].channels:
        return "x"
    if "F" in records[0].channels and all(way(r) == "smooth" for r in records):
        return "F"
    return None


@lru_cache(maxsize=32)
def _basis(length: int, every: int, intervals: int, panel: float) -> np.ndarray:
    edges = panel * np.arange(length * every + 1)
    if intervals == 0:
        return np.zeros((DEGREE + 1, edges.size, 0))
    spacing = edges[-1] / intervals
    count = intervals + DEGREE
    # The last edge belongs to the next window's first interval; just inside it the value is the same.
    inside = np.minimum(edges, edges[-1] * (1.0 - 1e-12))
    own = knots(0.0, spacing, count), np.eye(count), DEGREE
    return np.stack([curve(inside, *own, order) for order in range(DEGREE + 1)])


@lru_cache(maxsize=32)
def _shown(length: int, intervals: int, needed: int) -> np.ndarray:
    """What a window's coefficients come to at its samples, and at the knots inside it the corners that are not to be.

    With fewer knots than a window has room for, noise in the input has fewer ways into its rate: dry friction, which changes its
    sign with that, is smeared by what the rate is wrong by, and read too large, at the expense of the damping.
    """
    if intervals == 0:
        return np.zeros((0, 0))
    corners = np.zeros((intervals - 1, intervals + DEGREE))
    for row, own in enumerate(corners):
        own[row : row + DEGREE + 2] = np.diff(np.eye(DEGREE + 2), DEGREE + 1, axis=0)[0]
    finest = 2.0 * np.sin(0.5 * np.pi * needed / intervals)  # of what the needed knots can show, by one difference
    return np.concatenate([_basis(length, 1, intervals, 1.0)[0, :-1], HELD / finest ** (DEGREE + 1) * corners])


def _cut_one(record: Record, length: int, every: int, intervals: int, needed: int, driver: str | None) -> dict[str, Any]:
    dt, samples = record.dt, record.samples
    count = -(-samples // length)
    rows = count + 1
    observed = record.channels[record.observed_name]
    noise = observed_noise(record)
    t0 = record.t[0] + length * dt * np.arange(rows)
    weight = _rows(np.full(samples, 1.0 / noise), rows, length)
    part: dict[str, Any] = {
        "t0": t0,
        "measured": _rows(observed, rows, length),
        "weight": weight,
        "tie": np.concatenate([np.ones(count - 1), np.zeros(2)]),
        "noise": noise,
        "input_noise": 0.0,
        "told": 1.0,
    }
    motion = np.zeros(samples)
    part["input"] = part["input_weight"] = np.zeros((rows, 0))
    part["coefficients"] = np.zeros((rows, intervals))
    if driver is not None:
        values = record.channels[driver]
        fitted = fit_spline(record.t, values, record.t[0], length * dt / needed)
        part["input_noise"] = max(fitted.noise, NEGLIGIBLE * float(np.std(values)))
        part["told"] = (fitted.noise / part["input_noise"]) ** 2 if part["input_noise"] > 0.0 else 1.0
        smooth = np.arange(1, intervals) * needed % intervals != 0
        held = np.outer(np.arange(rows) < count, smooth)
        seen = _rows(np.ones(samples), rows, length)
        part["input"] = np.pad(_rows(values, rows, length), [(0, 0), (0, intervals - 1)])
        part["input_weight"] = np.concatenate([seen, held], axis=1) / part["input_noise"]
        part["coefficients"] = _rows(fitted.refined(intervals // needed), rows, intervals)
        if driver == "x":
            motion = fitted(record.t)
    force = np.zeros(1) if driver == "F" else force_edges(record, every)
    part["force"] = _force_rows(force, rows, length * every)
    part["command"] = np.zeros((rows, 0))
    part["starts"] = _starts(record, motion, observed, length, t0)
    return part


def _cut_drive(record: Record, length: int, every: int, *_: Any) -> dict[str, Any]:
    """As `_cut_one`, of a drive: one or two encoders, and the torque or command that is held for each sample."""
    dt, samples, channels = record.dt, record.samples, record.observed_names
    count = -(-samples // length)
    rows = count + 1
    t0 = record.t[0] + length * dt * np.arange(rows)
    noise = {name: channel_noise(record, name) for name in channels}
    seen = np.stack([record.channels[name] for name in channels], axis=1)
    weight = np.stack([np.full(samples, 1.0 / noise[name]) for name in channels], axis=1)
    told = record.input_name == "command"
    own = 0.0 if told else torque_noise(record)
    pushed = record.channels["command" if told else "torque"]
    torque = np.zeros((rows, 0)) if told else _rows(pushed, rows, length)
    at_motor = noise.get("motor", record.ratio * noise.get("link", 0.0))
    at_link = noise.get("link", at_motor / record.ratio)
    sharp = np.array([1.0, SPEED * max(length * dt, SPAN)])
    part: dict[str, Any] = {
        "t0": t0,
        "measured": _rows(seen.ravel(), rows, length * len(channels)),
        "weight": _rows(weight.ravel(), rows, length * len(channels)),
        "tie": np.concatenate([np.ones(count - 1), np.zeros(2)]),
        "noise": noise[record.observed_name],
        "input": torque,
        "input_weight": torque if told else _rows(np.full(samples, 1.0 / own), rows, length),
        "input_noise": own,
        "told": 1.0,
        "coefficients": torque,
        "force": _force_rows(np.zeros(1), rows, length * every),
        "command": _force_rows(np.repeat(pushed, every), rows, length * every) if told else np.zeros((rows, 0)),
        "drop": 50.0 * np.concatenate([sharp / at_link, sharp / at_motor]),
        "starts": _drive_starts(record, length * dt, t0),
    }
    if len(channels) > 1:
        part["beside"] = noise["motor"]
    return part


def _drive_starts(record: Record, window: float, t0: np.ndarray) -> np.ndarray:
    """Position and speed (W, 4) of link and motor where windows begin; one that has no encoder goes with the other."""
    found = {}
    for name in record.observed_names:
        values = record.channels[name]
        smooth = fit_spline(record.t, values, record.t[0], window / choose_intervals(record.t, values, window))
        inside = np.clip(t0, record.t[0], record.t[-1])
        found[name] = np.stack([smooth(inside), smooth(inside, 1)], axis=1)
    link = found.get("link", found.get("motor", 0.0) / record.ratio)
    return np.concatenate([link, found.get("motor", link * record.ratio)], axis=1)


def observed_noise(record: Record) -> float:
    """Standard deviation of the noise of the measured channel, in its unit."""
    values = record.channels[record.observed_name]
    noise = noise_level(record.t, values)
    # A force has corners where the contact begins; both estimates err upwards.
    return min(noise, noise_of_differences(values)) if record.observed_name == "T" else noise


def crossing_time(record: Record, play: float, span: float) -> float:
    """Time [s] in which the fastest relative motion of a record crosses a play [rad]; infinite where there is none.

    A panel finds the first edge that the link meets, so that none may hold both. ``span`` [s] is the time over which the
    motion is differenced: short beside a period in contact, long enough that noise is no speed.
    """
    motion = record.relative
    if motion is None:  # of a link that is not seen, its base tells the pace
        motion = next(record.channels[name] for name in ("x", "motor", "link") if name in record.channels)
        motion = motion / (record.ratio if "motor" in record.channels else 1.0)
    apart = min(max(1, int(span / record.dt)), record.samples - 1)
    fastest = float(np.max(np.abs(motion[apart:] - motion[:-apart]))) / (apart * record.dt)
    return play / fastest if play > 0.0 and fastest > 0.0 else np.inf


def _rows(values: np.ndarray, rows: int, length: int) -> np.ndarray:
    padded = np.zeros(rows * length)
    n = min(values.size, padded.size)
    padded[:n] = values[:n]
    return padded.reshape(rows, length)


def _force_rows(edges: np.ndarray, rows: int, panels: int) -> np.ndarray:
    held = np.pad(edges, (0, max(rows * panels + 1 - edges.size, 0)), mode="edge")
    return held[(panels * np.arange(rows))[:, None] + np.arange(panels + 1)]


def _starts(record: Record, motion: np.ndarray, observed: np.ndarray, length: int, t0: np.ndarray) -> np.ndarray:
    # What the torque does to the link is not seen: it is taken to follow its base.
    link = {"T": motion, "z": observed + motion, "y": observed}[record.observed_name]
    window = length * record.dt
    smooth = fit_spline(record.t, link, record.t[0], window / choose_intervals(record.t, link, window))
    inside = np.clip(t0, record.t[0], record.t[-1])
    return np.stack([smooth(inside), smooth(inside, 1)], axis=1)
