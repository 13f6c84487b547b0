"""Table 2 and Figures 15 and 16: the joint at 1.54 Hz and eight amplitudes of the base, regular and chaotic."""

from __future__ import annotations

from typing import Any

import numpy as np

import jaxbacklash as jb
from benchmarks.table2_twin import BIT, NOISE, PATTERN, tangents
from tests.drive_levels import AMPLITUDES, FREQUENCY, PAPER, Twin

from .item import IN_KIND, NOT, Beside, Item, figures

RATE, SHORT_RATE = 500.0, 250.0  # samples per second
PAPER_DELAY = 174  # samples
SHOWN, PER_PERIOD = 30, 48
"""Periods of the base, and points in each, that a phase plot shows."""
CHOSEN = (
    "The joint is simulated with the paper's 11 Hz, 3.16 kg m^2 and 1.5 deg; damping (2 %) and weight (90 N m, hanging) are not "
    "printed and were chosen so that the regimes come out (benchmarks.table2_twin --search: 7 % of the joints that fit the "
    "paper's other numbers do the same, so this does not name the paper's rig)."
)


def items(tiny: bool) -> tuple[list[Item], list[Any]]:
    """The table, both figures, and number, noisy series, true series and analysis of each level for what follows."""
    twin = Twin()
    value, error = tangents(twin, *((2, 60, 20) if tiny else (8, 1000, 300)))
    exponent = BIT * np.where(value > np.maximum(3.0 * error, 0.02), value, 0.0)
    rate, seconds = (SHORT_RATE, 12.0) if tiny else (RATE, 60.0)
    rows = [heard(twin, k, seconds, rate) for k in ((3,) if tiny else range(PAPER.size))]
    return [table(exponent, rows), figure_15(twin, rate, tiny), figure_16(twin, rows, rate, tiny)], rows


def heard(twin: Twin, k: int, seconds: float, rate: float) -> tuple[int, np.ndarray, np.ndarray, jb.ChaosReport]:
    """A level's number, its series with noise and without [rad], and what `jaxbacklash.chaos` says of the noisy one."""
    rng = np.random.default_rng(100 + k)
    record, truth = twin.series(AMPLITUDES[k], seconds=seconds, rate=rate, noise=0.0, rng=rng)
    noisy = truth + NOISE * truth.std() * rng.standard_normal(truth.size)
    return k, noisy, truth, jb.chaos(noisy, 1.0 / rate, drive=record.channels["x"], clean=False)


def table(exponent: np.ndarray, rows: list[Any]) -> Item:
    """Exponents of the model and of the noisy series beside the paper's."""
    series, ends = np.full(PAPER.size, np.nan), np.full((PAPER.size, 2), np.nan)
    words = [""] * PAPER.size
    for k, _, _, found in rows:
        words[k] = found.verdict.word
        if found.lyapunov is not None and found.interval is not None:
            series[k], ends[k] = BIT * found.lyapunov / FREQUENCY, BIT * np.array(found.interval) / FREQUENCY
    beside = []
    for k, one in enumerate(exponent.T):
        said = f"{one.mean():.3f} ({one.min():.3f} to {one.max():.3f})" if one.any() else "0"
        if words[k]:
            said += f"; series: {words[k]}" + (f", {series[k]:.2f}" if np.isfinite(series[k]) else "")
        beside.append(Beside(f"largest exponent at {np.degrees(AMPLITUDES[k]):.2f} deg", float(PAPER[k]), said, "bit/period"))
    whole = bool(np.all((exponent > 0.0) == PATTERN))
    mean = exponent.mean(axis=0)[PATTERN]
    off = {name: np.sqrt(np.mean((factor * mean / PAPER[PATTERN] - 1.0) ** 2)) for name, factor in
           (("bit per period", 1.0), ("bit per second", FREQUENCY), ("1 per period", 1.0 / BIT))}  # fmt: skip
    nearest = min(off, key=lambda name: off[name])
    label = "rms difference of the four chaotic levels, the paper's read as " + nearest
    beside.append(Beside(label, None, figures(100.0 * off[nearest], 2), "%"))
    told = [k for k in range(PAPER.size) if words[k]]
    right = sum((words[k] == "chaotic") == bool(PATTERN[k]) for k in told)
    return Item(
        "table_2", "Largest Lyapunov exponents over the drive level", IN_KIND if whole else NOT,
        "The pattern regular, regular, four chaotic, regular, regular "
        f"{'comes out from' if whole else 'does not come out from'} every one of {exponent.shape[0]} starts by the model's own "
        f"tangent, and {right} of {len(told)} verdicts on series with {100 * NOISE:.0f} % noise are the paper's. The "
        f"exponents are of its size but not its numbers. {CHOSEN}",
        tuple(beside),
        ("The exponents are given in 'bit/time' without a unit of time; read as bit per period of the drive, per second or per "
         "sample they differ by factors of 1.54 and more.",),
        {"amplitude": np.degrees(AMPLITUDES), "paper": PAPER, "tangent": exponent, "series": series, "interval": ends,
         "chaotic": np.array([word == "chaotic" for word in words], dtype=int)},
    )  # fmt: skip


def figure_15(twin: Twin, rate: float, tiny: bool) -> Item:
    """The response at 2.68 deg for some periods."""
    record, z = twin.series(AMPLITUDES[2], seconds=12.0, rate=rate, noise=0.0, rng=np.random.default_rng(0),
                            settle=10.0 if tiny else 60.0)  # fmt: skip
    t = np.arange(z.size) / rate
    turn = round(rate / FREQUENCY)
    lines = np.array([z[k : k + turn] for k in range(0, z.size - turn, turn)])
    spread = float(np.sqrt(np.mean(np.var(lines, axis=0)) / np.var(z)))
    step = max(1, round(rate / 125.0))
    return Item(
        "figure_15", "Response at 1.54 Hz and 2.68 deg", IN_KIND if spread > 0.2 else NOT,
        "The motion across the joint does not repeat with the base, as in the paper; a chaotic motion cannot be the same curve "
        f"as the measured one. {CHOSEN}",
        (Beside("frequency of the base", 1.54, FREQUENCY, "Hz"), Beside("amplitude of the base", 2.68, 2.68, "deg"),
         Beside("part of the motion that differs from one period to the next", "aperiodic", figures(100 * spread, 2), "%"),
         Beside("largest z", None, figures(np.degrees(np.abs(z).max()), 3), "deg")), (),
        {"t": t[::step], "z": np.degrees(z[::step]), "x": np.degrees(record.channels["x"][::step])},
    )  # fmt: skip


def figure_16(twin: Twin, rows: list[Any], rate: float, tiny: bool) -> Item:
    """Phase plots of all levels at one delay."""
    delays = [found.delay.samples for *_, found in rows]
    delay = int(np.median(delays))
    levels = {k: truth for k, _, truth, _ in rows}
    period, seconds = rate / FREQUENCY, 12.0 if tiny else 30.0
    count = round(min(SHOWN, seconds * FREQUENCY - 2) * PER_PERIOD)
    at = np.arange(count) * period / PER_PERIOD
    now, later = np.empty((PAPER.size, count)), np.empty((PAPER.size, count))
    for k in range(PAPER.size):
        z = levels[k] if k in levels else twin.series(AMPLITUDES[k], seconds=seconds, rate=rate, noise=0.0,
                                                      rng=np.random.default_rng(k), settle=10.0 if tiny else 60.0)[1]  # fmt: skip
        grid = np.arange(z.size)
        now[k], later[k] = (np.degrees(np.interp(at + shift, grid, z)) for shift in (0.0, delay))
    return Item(
        "figure_16", "Phase plots at eight drive levels", IN_KIND,
        "Closed curves at the regular levels and bands that fill at the chaotic ones, one delay for all. The delay is the first "
        "minimum of the average mutual information, as in the paper, whose sample rate is not printed: its 174 samples are a "
        f"quarter of a period at about {174 * 4 * FREQUENCY:.0f} samples a second. {CHOSEN}",
        (Beside("delay", float(PAPER_DELAY), float(delay), "samples"),
         Beside("delay as a share of the period", None, figures(100.0 * delay / period, 3), "%"),
         Beside("samples per second", "not printed", rate)), (),
        {"amplitude": np.degrees(AMPLITUDES), "chaotic": PATTERN.astype(int), "delay": np.array([delay]), "now": now,
         "later": later},
    )  # fmt: skip
