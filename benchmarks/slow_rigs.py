"""Random rigs whose slow records show a play, and rigs whose records do not: what `benchmarks.lost_motion` reads.

Every draw is of what such rigs have in common, not of one rig: gears of 8 to 120, plays of 1 to 30 mrad, three to fourteen
strokes, encoders of 12 to 18 bits, noise up to a twentieth of the play, errors once a turn as large as the play, slow drifts.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

import jaxbacklash as jb
from tests.independent.slow_links import carried, loop, played

SHOWN = ("gear", "tendon", "servo", "loop")
HIDDEN = (
    "too few reversals", "edges not reached", "below a count", "moved by its inertia", "lag alone", "loaded to one side",
    "ratio as 1/N", "opposite encoders", "pulled one way", "pulled too shortly", "loaded one way",
)  # fmt: skip
FINE = 2.5e-4
"""Step of the simulation [s]."""


@dataclass(frozen=True)
class Rig:
    """A record, the truth (lost motion at the link), the gear's ratio, and, where it does not show, words of the right reason."""

    name: str
    kind: str
    record: jb.Record
    truth: float
    ratio: float | None = None
    words: tuple[str, ...] = ()


def strokes(t: np.ndarray, draw: np.random.Generator, amplitude: float, period: float) -> np.ndarray:
    """A slow motion to and fro: sines, straight lines, smooth strokes with rests, or two tones; (N,)."""
    phase = t / period
    kind = draw.integers(4)
    if kind == 0:
        return amplitude * np.sin(2.0 * np.pi * phase)
    triangle = 2.0 * np.abs(2.0 * ((phase + 0.25) % 1.0) - 1.0) - 1.0
    if kind == 1:
        width = max(3, int(0.03 * period / (t[1] - t[0])))  # a profile turns round with a finite acceleration
        return amplitude * np.convolve(np.pad(triangle, width, mode="edge"), np.ones(width) / width, "same")[width:-width]
    if kind == 2:
        part = np.clip(1.4 * (0.5 * (triangle + 1.0)) - 0.2, 0.0, 1.0)
        return amplitude * (2.0 * (10 * part**3 - 15 * part**4 + 6 * part**5) - 1.0)
    return amplitude * (0.7 * np.sin(2.0 * np.pi * phase) + 0.3 * np.sin(2.0 * np.pi * 0.37 * phase + draw.uniform(0, 6)))


def measured(
    t: np.ndarray,
    x: np.ndarray,
    y: np.ndarray,
    draw: np.random.Generator,
    play: float,
    ratio: float,
    *,
    counts: float | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """What two encoders read: counts, noise, an encoder off its centre, the gear's error, drift, part of a sample of lag."""
    y = y + draw.uniform(0.0, 0.7) * play * np.sin(ratio * x + draw.uniform(0, 6))
    y = y + draw.uniform(0.0, 1.0) * play * np.sin(x + draw.uniform(0, 6))
    slow = np.cumsum(draw.standard_normal(t.size)) / np.sqrt(t.size) * draw.uniform(0.0, 0.15)
    y = y + play * (slow + draw.uniform(-0.3, 0.3) * t / t[-1] + draw.uniform(-0.2, 0.2) * np.log1p(t))
    # Part of a sample of lag; a record in which that alone is as large as the play is not slow.
    late = min(draw.uniform(0.0, 1.0) * (t[1] - t[0]), 0.15 * play / np.max(np.abs(np.gradient(x, t))))
    y = np.interp(t - late, t, y)
    noise = play * 10.0 ** draw.uniform(-3.5, -1.3)
    y = y + noise * draw.standard_normal(t.size)
    count = play / draw.uniform(2.5, 60.0) if counts is None else counts
    motor = 2.0 * np.pi / 2.0 ** draw.integers(10, 15) / ratio
    return np.round(x / motor) * motor, np.round(y / count) * count


def gears(
    count: int, draw: np.random.Generator, *, friction_share: tuple[float, float] = (0.01, 0.2), seconds: float = 0.0
) -> list[Rig]:
    """Gears and cables that carry a link with inertia and friction: the largest acceleration takes a share of the friction."""
    step_rate, rigs = 1.0 / FINE, []
    plays = 10.0 ** draw.uniform(-3.0, -1.5, count)
    longest, xs, meant = 40.0, [], []
    fine = np.arange(0.0, longest, FINE)
    for play in plays:
        amplitude = max(draw.uniform(0.1, 1.5), 3.0 * play)
        period = longest / draw.uniform(2.6, 7.0)
        xs.append(strokes(fine, draw, amplitude, period))
        meant.append(int(draw.choice([2, 4, 8, 20, 40])))
    x = np.stack(xs, axis=1)
    fastest = np.quantile(np.abs(np.diff(x, 2, axis=0)) * step_rate**2, 0.99, axis=0)
    share = np.exp(draw.uniform(*np.log(friction_share), count))
    friction = np.ones(count)
    inertia = share * friction / np.maximum(fastest, 1e-9)
    wind = draw.uniform(0.002, 0.08, count)
    stiffness = 2.0 * friction / (wind * plays)
    damping = 0.6 * np.sqrt(stiffness * inertia)
    y = carried(x, FINE, inertia=inertia, friction=friction, play=plays, stiffness=stiffness, damping=damping, keep=2)
    for index in range(count):
        every = 2 * meant[index]
        t = fine[::every]
        ratio = float(np.round(np.exp(draw.uniform(np.log(8.0), np.log(120.0)))))
        a, b = measured(t, x[::every, index], y[:: every // 2, index], draw, plays[index], ratio)
        truth = plays[index] * (1.0 + wind[index])
        rigs.append(Rig(f"gear {index}", "gear", jb.Record(t, {"x": a, "y": b}), float(truth), ratio))
    return rigs


def tendons(count: int, draw: np.random.Generator) -> list[Rig]:
    """Tendons in sheaths: several contacts one after the other, creep, long strokes."""
    rigs = []
    for index in range(count):
        play = 10.0 ** draw.uniform(-2.3, -0.9)
        rate = draw.choice([50.0, 100.0, 200.0, 500.0])
        t = np.arange(0.0, draw.uniform(30.0, 90.0), 1.0 / rate)
        x = strokes(t, draw, max(draw.uniform(0.3, 2.0), 4.0 * play), t[-1] / draw.uniform(2.6, 8.0))
        half = 0.5 * play * np.array([0.85, 0.93, 1.0, 1.05]) if draw.random() < 0.6 else 0.5 * play * np.ones(1)
        weights = draw.dirichlet(np.full(half.size, 4.0))
        a, b = measured(t, x, played(x, half, weights), draw, play, draw.uniform(1.0, 6.0))
        rigs.append(Rig(f"tendon {index}", "tendon", jb.Record(t, {"x": a, "y": b}), float(2.0 * weights @ half)))
    return rigs


def servos(
    count: int, draw: np.random.Generator, *, quickest: tuple[float, float] = (0.5, 10.0), settled: bool = True
) -> list[Rig]:
    """Servos that hold while their link is pulled both ways by a force of which only the sign is written down."""
    longest, rigs = 12.0, []
    fine = np.arange(0.0, longest, FINE)
    plays = 10.0 ** draw.uniform(-3.0, -1.5, count)
    often = np.exp(draw.uniform(*np.log(quickest), count))
    signs = np.where((fine[:, None] * often) % 1.0 < 0.5, 1.0, -1.0)
    size = 1.0 + 0.1 * draw.standard_normal((int(longest * 10.0 * 2) + 2, count))
    which = np.floor(2.0 * fine[:, None] * often).astype(int) % size.shape[0]
    force = signs * np.take_along_axis(size, which, axis=0) * draw.uniform(2.0, 6.0, count)
    friction = np.ones(count)
    wind = draw.uniform(0.002, 0.04, count)
    stiffness = 2.0 * np.abs(force).mean(axis=0) / (wind * plays)
    # The way across takes a tenth to a quarter of a pull, or, where it is not to settle, more than all of it.
    share = draw.uniform(0.05, 0.2, count) if settled else draw.uniform(1.2, 2.0, count)
    inertia = (np.abs(force).mean(axis=0) - friction) * (share * 0.5 / often) ** 2 / (2.0 * plays)
    hunting = 0.05 * plays * np.sin(2.0 * np.pi * draw.uniform(0.2, 0.5, count) * fine[:, None])
    y = carried(hunting, FINE, inertia=inertia, friction=friction, play=plays, stiffness=stiffness,
                damping=1.2 * np.sqrt(stiffness * inertia), force=force, keep=2)  # fmt: skip
    for index in range(count):
        every = 2 * int(draw.choice([2, 4, 10]))
        t, s = fine[::every], signs[::every, index]
        x, clean = hunting[::every, index], y[:: every // 2, index]
        share_of = (fine[::every] * 2.0 * often[index]) % 1.0
        z = clean - x
        truth = float(z[(share_of > 0.8) & (s > 0)].mean() - z[(share_of > 0.8) & (s < 0)].mean())
        play = plays[index]
        noise = play * 10.0 ** draw.uniform(-3.0, -1.0)
        z = z + noise * draw.standard_normal(t.size) + play * draw.uniform(-0.3, 0.3) * t / t[-1]
        count_of_z = play / draw.uniform(2.5, 60.0)
        z = np.round(z / count_of_z) * count_of_z
        channels = {"z": z, "F": s} if draw.random() < 0.5 else {"x": x, "z": z, "F": s}
        rigs.append(Rig(f"servo {index}", "servo", jb.Record(t, channels), truth))
    return rigs


def loops(count: int, draw: np.random.Generator) -> list[Rig]:
    """Slow loops of torque over angle, with errors in both columns."""
    rigs = []
    for index in range(count):
        play = 10.0 ** draw.uniform(-3.5, -2.0)
        t = np.arange(0.0, draw.uniform(30.0, 80.0), 0.02)
        load = draw.uniform(5.0, 200.0)
        stiffness = load / play * 2.0 ** draw.uniform(-1.0, 2.0) * draw.uniform(0.8, 1.25, 2)
        friction = draw.uniform(0.01, 0.08) * load
        ends = 0.5 * play + load / stiffness
        phase = 2.0 * np.pi * t * draw.uniform(2.6, 8.0) / t[-1]
        shape = np.sin(phase) if draw.random() < 0.5 else 2.0 / np.pi * np.arcsin(np.sin(phase))
        z = np.where(shape > 0.0, ends[0], ends[1]) * shape
        torque = loop(z, play, (stiffness[0], stiffness[1]), friction, draw.choice([0.0, 0.3]) / max(load / stiffness))
        z = (
            z
            + play * 10.0 ** draw.uniform(-3.0, -1.3) * draw.standard_normal(t.size)
            + 0.1 * play * draw.uniform(-1, 1) * t / t[-1]
        )
        torque = torque + load * 10.0 ** draw.uniform(-3.5, -2.0) * draw.standard_normal(t.size)
        count_of_z = play / draw.uniform(5.0, 100.0)
        rigs.append(Rig(f"loop {index}", "loop", jb.Record(t, {"T": torque, "z": np.round(z / count_of_z) * count_of_z}), play))
    return rigs


def shown_rigs(count: int, seed: int) -> list[Rig]:
    """Rigs whose records show their play: two fifths gears, a fifth each of the others."""
    draw = np.random.default_rng([seed, 1])
    parts = [count - 3 * (count // 5), count // 5, count // 5, count // 5]
    return [*gears(parts[0], draw), *tendons(parts[1], draw), *servos(parts[2], draw), *loops(parts[3], draw)]


def hidden_rigs(each: int, seed: int) -> list[Rig]:
    """Rigs whose records do not show their play: so many of each kind of `HIDDEN`."""
    draw = np.random.default_rng([seed, 2])
    found: list[Rig] = []

    def add(kind: str, record: jb.Record, words: tuple[str, ...], ratio: float | None = None) -> None:
        found.append(Rig(f"{kind} {len(found)}", kind, record, 0.0, ratio, words))

    for _ in range(each):
        play = 10.0 ** draw.uniform(-2.5, -1.5)
        t = np.arange(0.0, 40.0, 0.01)
        one, sure = np.ones(1), frozenset("xyz")
        x = 0.6 * np.sin(2.0 * np.pi * t * draw.uniform(0.5, 1.2) / t[-1])
        a, b = measured(t, x, played(x, 0.5 * play * one, one), draw, play, 20.0)
        add("too few reversals", jb.Record(t, {"x": a, "y": b}), ("too few reversals", "one way only"), 20.0)
        x = draw.uniform(0.2, 0.45) * play * np.sin(2.0 * np.pi * t * 5.0 / t[-1])
        count = play / 50.0
        link = np.round(1e-3 * play * draw.standard_normal(t.size) / count) * count
        add("edges not reached", jb.Record(t, {"x": x, "y": link + 1e-9 * np.sin(t)}), ("edges not reached",), 20.0)
        x = 0.6 * np.sin(2.0 * np.pi * t * 5.0 / t[-1])
        a, b = measured(t, x, played(x, 0.5 * play * one, one), draw, play, 20.0, counts=play / draw.uniform(0.1, 0.6))
        add("below a count", jb.Record(t, {"x": a, "y": b}), ("below a count", "does not show"), 20.0)
        a, b = measured(t, x, np.interp(t - draw.uniform(3.0, 8.0) * 0.01, t, x), draw, play, 20.0)
        add("lag alone", jb.Record(t, {"x": a, "y": b}), ("lag",), 20.0)
        a, b = measured(t, x, x - 0.5 * play, draw, play, 20.0)
        add("loaded to one side", jb.Record(t, {"x": a, "y": b}), ("does not show", "below a count"), 20.0)
        a, b = measured(t, x, played(x, 0.5 * play * one, one), draw, play, 20.0)
        add("ratio as 1/N", jb.Record(t, {"x": a * 400.0, "y": b}, confirmed=sure), ("ratio",), 1.0 / 20.0)
        add("opposite encoders", jb.Record(t, {"x": a, "y": -b}, confirmed=sure), ("opposite",), 20.0)
        pull = np.where(t % 1.0 < 0.5, 1.0, 0.0)
        add(
            "pulled one way",
            jb.Record(t, {"F": pull, "z": 0.5 * play * pull + 0.01 * play * draw.standard_normal(t.size)}),
            ("one way",),
        )
        angle = play * np.clip(1.5 * np.sin(t), 0.0, None)
        torque = loop(angle, play, (1e3, 1e3), 0.02 * play * 1e3)
        noisy = angle + 0.01 * play * draw.standard_normal(t.size)
        add("loaded one way", jb.Record(t, {"T": torque, "z": noisy}), ("edges not reached", "one"))
    for rig in gears(each, draw, friction_share=(2.0, 6.0)):
        found.append(Rig(rig.name, "moved by its inertia", rig.record, 0.0, rig.ratio, ("inertia", "not held by friction")))
    for rig in servos(each, draw, quickest=(4.0, 10.0), settled=False):
        found.append(Rig(rig.name, "pulled too shortly", rig.record, 0.0, None, ("edges not reached", "does not stay")))
    return found
