"""The paper's experiment on a hundred simulated rigs: how far off are the skeletons, and do their error bars hold the truth?

    python -m benchmarks.skeleton_twin [--rigs 100] [--tiny] [--no-fit]

Each rig is a twin of the paper's (tests/twin.py): linear chirp 0 to 12 Hz in 30 s, play 1.2 to 1.8 deg, servo roll-off that loses
the motion on the way, encoder counts and noise on both channels; the simulation is non-smooth and shares nothing with the
package. In the table, beside each method, the ablation: the same amplitudes read by the paper's axis crossing, by the
describing function of a sine, and by that of the measured motion, from all points that count and from the upper half of
amplitudes, where the curve looks straight; and the fit by simulation on the same records. It needs numba.
"""

from __future__ import annotations

import argparse
import time

import numpy as np

import jaxbacklash as jb
from jaxbacklash.skeleton.inversion import WAYS, invert
from tests.twin import twin

NAMES = ("backlash", "stiffness", "damping")
WORDS = {"axis": "straight line (the paper's)", "sine": "describing function of a sine", "waveform": "of the measured motion"}


def row(label: str, errors: np.ndarray, inside: np.ndarray | None) -> str:
    """One line: rms and largest error in percent of play, stiffness, damping; share of intervals that hold the truth."""
    errors = errors[np.all(np.isfinite(errors), axis=1)]
    cells = [f"{100 * np.sqrt(np.mean(e**2)):8.3f} {100 * np.max(np.abs(e)):8.3f}" for e in errors.T]
    cover = "" if inside is None else "  " + " ".join(f"{100 * share:5.0f} %" for share in np.mean(inside, axis=0))
    return f"{label:<56}{errors.shape[0]:4d} " + " ".join(cells) + cover


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rigs", type=int, default=100)
    parser.add_argument("--tiny", action="store_true", help="two rigs of 15 s")
    parser.add_argument("--no-fit", action="store_true", help="without the fit by simulation")
    options = parser.parse_args()
    jb.start()
    count, seconds = (2, 15.0) if options.tiny else (options.rigs, 30.0)
    errors: dict[str, list[np.ndarray]] = {}
    inside: dict[str, list[np.ndarray]] = {}
    clock = {"skeleton": 0.0, "fit": 0.0}
    lost = {"hilbert": 0, "wavelet": 0}
    for seed in range(1, count + 1):
        rig, record, _ = twin(seed, seconds=seconds)
        truth = np.array([getattr(rig, name) for name in NAMES])
        begin = time.perf_counter()
        found = jb.skeleton(record, rig.inertia)
        clock["skeleton"] += time.perf_counter() - begin
        for method in found.methods:
            values = [method.parameters[name] for name in NAMES]
            if any(value.value is None for value in values):
                lost[method.method] += 1
                continue
            key = f"{method.method}: {WORDS['waveform']}"
            errors.setdefault(key, []).append(np.array([v.value for v in values]) / truth - 1.0)
            inside.setdefault(key, []).append(np.array([v.ci95[0] <= x <= v.ci95[1] for v, x in zip(values, truth)]))
            upper = method.kept & (method.amplitude > np.median(method.amplitude[method.kept]))
            for way, points, which in [(w, k, n) for w in WAYS for k, n in ((method.kept, "all"), (upper, "upper half"))]:
                if way == "waveform" and which == "all":
                    continue
                other = invert(method.terms, points, inertia=rig.inertia, way=way)
                if other is not None:
                    key = f"{method.method}: {WORDS[way]}, {which}"
                    half, ends = other.values * [2, 1, 1], other.reach * other.stderr * [2, 1, 1]
                    errors.setdefault(key, []).append(half / truth - 1.0)
                    inside.setdefault(key, []).append(np.abs(half - truth) <= ends)
        if not options.no_fit:
            begin = time.perf_counter()
            fit = jb.fit(record, inertia=rig.inertia, starts=1)
            clock["fit"] += time.perf_counter() - begin
            values = [fit.parameters[name] for name in NAMES]
            if all(v.value is not None for v in values):
                errors.setdefault("fit by simulation", []).append(np.array([v.value for v in values]) / truth - 1.0)
                held = [v.ci95[0] <= x <= v.ci95[1] for v, x in zip(values, truth)]
                inside.setdefault("fit by simulation", []).append(np.array(held))
    print("error in percent, root mean square and largest, of play, stiffness, damping; 95 % intervals that hold the truth")
    for key in sorted(errors):
        print(row(key, np.array(errors[key]), np.array(inside[key]) if key in inside else None))
    print(f"without an answer: {lost}; seconds a record: " + ", ".join(f"{k} {v / count:.2f}" for k, v in clock.items()))


if __name__ == "__main__":
    main()
