"""Table 1 and Figures 2 and 3: the oscillator with play that a force drives, CASE 1 and CASE 2."""

from __future__ import annotations

import math
from itertools import groupby

import numpy as np

import jaxbacklash as jb
from jaxbacklash.dynamics import PaperCase, bifurcation, lyapunov_spectrum, request, run_map
from tests.independent import taylor
from tests.independent.exponents import Cell

from .item import IN_KIND, NOT, REPRODUCED, Beside, Item, figures

RANGE = (1.0, 5.0)
"""Of 1/alpha; the range of the paper's axis is not in its text."""
LEAST = 0.3
"""A largest exponent above this is chaos [1/s]: a tenth of what chaotic motions of these oscillators have."""
REGULAR = 1e-4
"""Regular exponents of two programs agree when they differ by less [1/tau]."""


def table_1(tiny: bool) -> Item:
    """Do both parameter sets respond chaotically, as the text says they do?"""
    rows: list[Beside] = []
    chaotic, nearest = [], []
    for name, (system, force), k1 in (("CASE 1", jb.case_1(), 0.0), ("CASE 2", jb.case_2(), 1000.0 / 31000.0)):
        form, printed = jb.dimensionless(system, force), float(force.amplitude)
        found = exponents(system, force, 3 if tiny else 24, tiny)
        chaotic.append(bool(np.any(found > LEAST)))
        amplitude = printed if chaotic[-1] else nearest_chaos(system, force, tiny)
        nearest.append(amplitude)
        omega_0 = float(force.omega) / form.Omega
        cell = Cell(1.0 / form.alpha, form.zeta, form.Omega, k1)
        _, growth, _ = taylor.follow(cell, 80 if tiny else 600)
        other = (growth[-1] - growth[growth.size // 2]) / (growth.size // 2) / (2.0 * np.pi / form.Omega) * omega_0
        rows += [
            Beside(f"{name}: response at {printed:g} N, 40 rad/s", "chaotic", "chaotic" if chaotic[-1] else "regular"),
            Beside(f"{name}: largest exponent, least and most over {found.size} starts", None,
                   f"{found.min():.2f} to {found.max():.2f}", "1/s"),
            Beside(f"{name}: the same from rest by a separate Taylor series", None, figures(other, 3), "1/s"),
            Beside(f"{name}: chaotic force nearest to the printed one", printed, amplitude, "N"),
            Beside(f"{name}: 2 zeta = c / sqrt(k0 m)", 0.04 if name == "CASE 1" else None, figures(2.0 * form.zeta)),
            Beside(f"{name}: alpha = A / (k0 x0)", None, figures(form.alpha)),
        ]  # fmt: skip
    close = [one is not None and abs(one / printed - 1.0) < 0.05 for one, printed in zip(nearest, (100.0, 240.0))]
    told = [f"CASE {k} is chaotic" if yes else f"CASE {k} is not: each of its attractors that was found is regular"
            + (f", though at {one:g} N some starts end in chaos" if one is not None else "")
            for k, (yes, one) in enumerate(zip(chaotic, nearest), 1)]  # fmt: skip
    return Item(
        "table_1", "Parameter sets that respond chaotically", REPRODUCED if all(chaotic) else IN_KIND if all(close) else NOT,
        "Both sets were followed exactly from edge to edge, from several starts. The paper says of both that they are chaotic; "
        "here "
        + "; ".join(told) + ". Where chaos begins and ends moves with every parameter, and those of CASE 2 are printed to two "
                            "digits.",
        tuple(rows),
        ("Equation (2.14) prints the force as alpha cos(omega t); in the dimensionless time tau = omega_0 t it is "
         "alpha cos(Omega tau) with Omega = omega / omega_0, which is 0.2 for CASE 1.",),
    )  # fmt: skip


def exponents(system: jb.System, force: jb.Harmonic, starts: int, tiny: bool) -> np.ndarray:
    """Largest exponents [1/s] from so many starts, the first one rest."""
    rng = np.random.default_rng(0)
    half = 0.5 * float(system.contact.backlash)
    begun = rng.uniform(-6.0, 6.0, (starts, 2)) * [half, half * float(force.omega)]
    begun[0] = 0.0
    periods, skip = (60, 20) if tiny else (600, 300)
    runs = (lyapunov_spectrum(system, force, count=1, periods=periods, skip=skip, y0=y, dy0=v) for y, v in begun)
    return np.array([float(run.values[0]) for run in runs])


def nearest_chaos(system: jb.System, force: jb.Harmonic, tiny: bool) -> float | None:
    """The amplitude [N], in whole newtons, nearest to the printed one at which one of four starts ends in chaos."""
    printed = float(force.amplitude)
    steps = range(1, 3) if tiny else range(1, round(0.15 * printed))
    for amplitude in (printed + sign * step for step in steps for sign in (1.0, -1.0)):
        drive = jb.Harmonic(amplitude, float(force.omega), as_force=True)
        if np.any(exponents(system, drive, 4, tiny) > LEAST):
            return amplitude
    return None


def figures_2_and_3(tiny: bool) -> list[Item]:
    """The largest exponent and the bifurcation diagram over 1/alpha, and the exponent once more by a program of its own."""
    from benchmarks.map_accuracy import by_taylor

    cells, periods, few = (9, 40, 3) if tiny else (401, 600, 33)
    inverse_alpha = np.linspace(*RANGE, cells)
    wanted = request(PaperCase(1), {"inverse_alpha": inverse_alpha}, periods=periods, skip=periods // 4, samples=1)
    found = run_map(wanted)
    exponent, error = found.lyapunov.values, found.lyapunov_stderr.values
    chosen = np.unique(np.linspace(0, cells - 1, few).round().astype(int))
    referee = by_taylor(inverse_alpha[chosen], periods, periods // 4, np.zeros((2, chosen.size)))
    same = np.sign(referee.exponent) == np.sign(exponent[chosen])
    both = 2.0 * np.hypot(referee.stderr, error[chosen])
    near = np.abs(referee.exponent - exponent[chosen]) < np.maximum(both, REGULAR)
    regions = chaotic_regions(inverse_alpha, exponent > np.maximum(3.0 * error, 1e-3))
    at_100 = int(np.argmin(np.abs(inverse_alpha - 2.0)))
    widest = sorted(regions, key=lambda ends: ends[0] - ends[1])[:4]
    beside = (
        Beside("1/alpha = 2, CASE 1 at 100 N", "chaotic", "chaotic" if exponent[at_100] > 3 * error[at_100] else "not chaotic"),
        Beside("largest exponent there", None, f"{exponent[at_100]:.4f} +- {error[at_100]:.4f}", "1/tau"),
        Beside("widest chaotic regions of 1/alpha", None, ", ".join(f"{a:.2f} to {b:.2f}" for a, b in sorted(widest))),
        Beside("share of the range that is chaotic", None, figures(100.0 * float(np.mean(exponent > 3.0 * error)), 3), "%"),
        Beside(f"sign as by a separate Taylor series, of {few} values", None, f"{int(same.sum())}"),
        Beside("exponent within two joint errors of it", None, f"{int(near.sum())}"),
    )
    kind = IN_KIND if exponent[at_100] > 3.0 * error[at_100] and same.mean() > 0.9 else NOT
    why = (
        f"{cells} values of 1/alpha from {RANGE[0]:g} to {RANGE[1]:g}, {periods} periods each from rest. The text gives no "
        "number of this figure but the chaos at 1/alpha = 2, which is there; separate chaotic regions that end at bifurcations "
        "are there too. In place of the paper's curve stands a second program, a Taylor series that shares no code with the "
        "package."
    )
    figure_2 = Item(
        "figure_02", "Largest Lyapunov exponent of CASE 1 over 1/alpha", kind, why, beside, (),
        {"inverse_alpha": inverse_alpha, "exponent": exponent, "stderr": error, "checked_at": inverse_alpha[chosen],
         "checked": referee.exponent},
    )  # fmt: skip
    return [figure_2, figure_3(tiny, regions)]


def figure_3(tiny: bool, regions: list[tuple[float, float]]) -> Item:
    """The bifurcation diagram, swept up and swept down."""
    values = np.linspace(*RANGE, 7 if tiny else 241)
    found = bifurcation(PaperCase(1), "inverse_alpha", values, settle=20 if tiny else 200, samples=8 if tiny else 20,
                        start_periods=40 if tiny else 200)  # fmt: skip
    up, down = found.swept_up.values, found.swept_down.values
    period_up, period_down = found.swept_up_period.values, found.swept_down_period.values
    differ = (period_up != period_down) & (period_up > 0) & (period_down > 0)
    seen = sorted({int(p) for p in np.concatenate([period_up, period_down]) if p > 0})
    inside = np.any([(values >= a) & (values <= b) for a, b in regions], axis=0) if regions else np.zeros(values.size, bool)
    agree = float(np.mean((period_up == 0)[inside])) if inside.any() else math.nan
    beside = (
        Beside("periods of the regular motion, in periods of the force", None, ", ".join(map(str, seen))),
        Beside("values of Figure 2's chaotic regions where the sweep is chaotic too", None, figures(100.0 * agree, 3), "%"),
        Beside("values where sweeping up and down end in different periods", None, int(differ.sum())),
    )
    return Item(
        "figure_03", "Bifurcation diagram of CASE 1", IN_KIND if agree > 0.7 else NOT,
        f"Position at whole periods of the force, in half plays, swept up and swept down through {values.size} values, 2 zeta = "
        "0.04. The text gives no numbers of the figure; it says that it is like Figure 2, and chaos and bands of it stand at "
        "the same values here.", beside, (),
        {"inverse_alpha": values, "up": up, "down": down},
    )  # fmt: skip


def chaotic_regions(x: np.ndarray, chaotic: np.ndarray) -> list[tuple[float, float]]:
    """First and last value of every unbroken run of chaotic ones, at least two long."""
    runs = [list(group) for yes, group in groupby(range(x.size), key=lambda k: bool(chaotic[k])) if yes]
    return [(float(x[run[0]]), float(x[run[-1]])) for run in runs if len(run) > 1]
