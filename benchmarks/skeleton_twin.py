"""The paper's experiment on a hundred simulated rigs: how far off are the skeletons, and do their error bars hold the truth?

    python -m benchmarks.skeleton_twin [--rigs 100] [--tiny] [--no-fit]

Each rig is a twin of the paper's (tests/twin.py): linear chirp 0 to 12 Hz in 30 s, play 1.2 to 1.8 deg, servo roll-off that loses
the motion on the way, encoder counts and noise on both channels; the simulation is non-smooth and shares nothing with the
package. In the table, beside each method, the ablation: the same amplitudes read by the describing function of a sine, and by the
paper's straight line through the restoring force (3.7), through all points that count and through the upper half of
amplitudes, where the curve looks straight: the paper does not say which it took. Then the paper's own way from the samples on,
low-passed envelopes and plain differences in (3.6), and the fit by simulation on the same records. It needs numba.

"per stated" is the rms error over the rms standard error that the method itself tells: 1 is honest, 0.3 is three times too
cautious, 3 a lie. A method is given the inertia and the record, nothing of the truth or of the fit.
"""

from __future__ import annotations

import argparse
import time

import numpy as np

import jaxbacklash as jb
from benchmarks.peers.envelopes import scipy_hilbert
from benchmarks.skeleton_peers import through
from jaxbacklash.skeletons.describing_function import axis_crossing
from jaxbacklash.skeletons.inversion import invert
from jaxbacklash.skeletons.modal import base_motion
from tests.independent.rigs import Rig
from tests.twin import twin

NAMES = ("backlash", "stiffness", "damping")
Row = tuple[np.ndarray, np.ndarray | None, np.ndarray | None]
"""Relative errors, whether intervals hold the truth, relative standard errors; of play, stiffness, damping."""


def table_line(label: str, rows: list[Row]) -> str:
    """rms and largest error in percent of play, stiffness, damping; rms error per stated error; intervals that hold the truth."""
    whole = [row for row in rows if np.isfinite(row[0][0])]
    errors = np.array([row[0] for row in whole])
    rms = np.sqrt(np.mean(errors**2, axis=0))
    largest = np.max(np.abs(errors), axis=0)
    cells = [f"{100 * r:8.3f} {100 * m:8.3f}" if np.isfinite(r) else " " * 17 for r, m in zip(rms, largest)]
    tail = ""
    if whole and whole[0][1] is not None:
        stated = rms / np.sqrt(np.mean(np.array([row[2] for row in whole]) ** 2, axis=0))
        held = np.mean([row[1] for row in whole], axis=0)
        tail = "  " + " ".join(f"{s:5.2f}" for s in stated) + "  " + " ".join(f"{100 * h:4.0f} %" for h in held)
    return f"{label:<56}{len(whole):4d} " + " ".join(cells) + tail


def against(truth: np.ndarray, values: np.ndarray, stderr: np.ndarray, reach: float = 1.96) -> Row:
    """One answer with its errors."""
    return values / truth - 1.0, np.abs(values - truth) <= reach * stderr, stderr / truth


def straight(truth: np.ndarray, inertia: float, amplitude: np.ndarray, force: np.ndarray) -> Row:
    """The paper's regression: play and stiffness from where the line through f_s(A) cuts, and its slope."""
    slope, crossing = axis_crossing(amplitude, force)
    return np.array([2.0 * crossing, inertia * slope, np.nan]) / truth - 1.0, None, None


def readings(rig: Rig, record: jb.Record, found: jb.Skeletons, truth: np.ndarray) -> dict[str, Row]:
    """All rows that need no fit."""
    rows: dict[str, Row] = {}
    for method in found.methods:
        values = [method.parameters[name] for name in NAMES]
        if any(v.value is None for v in values):
            continue
        reach = (values[0].ci95[1] - values[0].value) / values[0].stderr
        told = (np.array([getattr(v, of) for v in values]) for of in ("value", "stderr"))
        rows[f"{method.method}: of the measured motion"] = against(truth, *told, reach)
        upper = method.kept & (method.amplitude > np.median(method.amplitude[method.kept]))
        for points, which in ((method.kept, "all"), (upper, "upper half")):
            other = invert(method.terms, points, inertia=rig.inertia, way="sine")
            if other is not None:
                scale = np.array([2.0, 1.0, 1.0])
                answer = against(truth, scale * other.values, scale * other.stderr, other.reach)
                rows[f"{method.method}: describing function of a sine, {which}"] = answer
            curve = method.amplitude[points], method.restoring_force[points]
            rows[f"{method.method}: straight line, {which}"] = straight(truth, rig.inertia, *curve)
    inside = np.interp(record.t, found.hilbert.t, found.hilbert.kept.astype(float)) > 0.5
    for share in (0.005, 0.01):
        (z, dz, ddz), (_, _, ddx) = (through(scipy_hilbert(record.t, record.channels[name], share)) for name in ("z", "x"))
        size, square = np.abs(z), base_motion(z, dz, ddz, ddx)[0]
        good = inside & (np.abs(square) < 10.0 * rig.stiffness / rig.inertia)
        for points, which in ((good, "all"), (good & (size > np.median(size[good])), "upper half")):
            curve = size[points], (size * square)[points]
            rows[f"paper's Hilbert, {100 * share:g} %: straight line, {which}"] = straight(truth, rig.inertia, *curve)
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rigs", type=int, default=100)
    parser.add_argument("--tiny", action="store_true", help="two rigs of 15 s")
    parser.add_argument("--no-fit", action="store_true", help="without the fit by simulation")
    options = parser.parse_args()
    jb.start(brief=options.tiny)
    count, seconds = (2, 15.0) if options.tiny else (options.rigs, 30.0)
    rows: dict[str, list[Row]] = {}
    clock, lost, left_out = {"skeleton": 0.0, "fit": 0.0}, {"hilbert": 0, "wavelet": 0}, 0
    for seed in range(1, count + 1):
        rig, record, _ = twin(seed, seconds=seconds)
        truth = np.array([getattr(rig, name) for name in NAMES])
        begin = time.perf_counter()
        found = jb.skeleton(record, rig.inertia)
        clock["skeleton"] += time.perf_counter() - begin
        left_out += any("left out" in sentence for sentence in found.warnings)
        for method in found.methods:
            lost[method.method] += any(value.value is None for value in method.parameters.values())
        for key, answer in readings(rig, record, found, truth).items():
            rows.setdefault(key, []).append(answer)
        if not options.no_fit:
            begin = time.perf_counter()
            fit = jb.fit(record, inertia=rig.inertia, starts=1)
            clock["fit"] += time.perf_counter() - begin
            values = [fit.parameters[name] for name in NAMES]
            if all(v.value is not None for v in values):
                told = (np.array([getattr(v, of) for v in values]) for of in ("value", "stderr"))
                rows.setdefault("fit by simulation", []).append(against(truth, *told))
    print("error in percent, rms and largest, of play, stiffness, damping; rms per stated; 95 % intervals that hold the truth")
    for key in sorted(rows):
        print(table_line(key, rows[key]))
    print(f"without an answer: {lost}; falsely told that a torque was left out: {left_out}; seconds a record: ", end="")
    print(", ".join(f"{k} {v / count:.2f}" for k, v in clock.items()))


if __name__ == "__main__":
    main()
