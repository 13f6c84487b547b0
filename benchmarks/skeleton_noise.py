"""Where skeletons stop being trustworthy: noise, offsets and damping, and whether masks and warnings say so.

    python -m benchmarks.skeleton_noise [--rigs 12] [--tiny]

Twins of the paper's experiment (tests/twin.py) with white noise on both channels at 60 to 10 dB of each channel's own rms, an
offset of z up to 1.5 half plays, and damping up to 20 % of critical. "trusted" counts answers within 2 % of the play and 5 % of
the stiffness; "covered" intervals of play and stiffness that both hold the truth; "told" records with a value that is refused or
a warning of noise, drift, a torque left out, or masks beyond a half; "silent" answers outside their intervals without such a
word, of which 5 to 10 % would be chance; "wrong" the silent ones that are not to be trusted either: there should be none.
The last lines are free decays of a joint, on which damping leaves ever fewer cycles. It needs numba.
"""

from __future__ import annotations

import argparse
from functools import lru_cache

import numpy as np

import jaxbacklash as jb
from tests.independent import free_play
from tests.independent.rigs import Rig
from tests.twin import twin

METHODS = ("hilbert", "wavelet")


def judged(rig: Rig, found: jb.Skeletons, method: str) -> tuple[float, bool, bool, bool]:
    """Relative error of the play (NaN: refused), trusted, covered by the intervals of play and stiffness, told."""
    skeleton = getattr(found, method)
    play, stiffness = (skeleton.parameters[name] for name in ("backlash", "stiffness"))
    words = ("noise", "large amplitudes", "left out")
    told = play.value is None or skeleton.masked_fraction > 0.5 or any(w in s for s in skeleton.warnings for w in words)
    if play.value is None:
        return float("nan"), False, True, told
    error = play.value / rig.backlash - 1.0
    near = abs(error) < 0.02 and stiffness.value is not None and abs(stiffness.value / rig.stiffness - 1.0) < 0.05
    pairs = [(play, rig.backlash), (stiffness, rig.stiffness)]
    return error, near, all(v.value is None or v.ci95[0] <= truth <= v.ci95[1] for v, truth in pairs), told


def line(label: str, rows: dict[str, list[tuple[float, bool, bool, bool]]], total: dict[str, np.ndarray]) -> str:
    """One line of the table for both methods; ``total`` counts records, silent and wrong answers."""
    cells = []
    for method in METHODS:
        errors, near, covered, told = (np.array(column, float) for column in zip(*rows[method]))
        given = np.isfinite(errors)
        middle = f"{100 * np.median(np.abs(errors[given])):7.3f}" if given.any() else "   none"
        silent = (covered == 0) & (told == 0)
        counts = (given.sum(), near.sum(), covered.sum(), told.sum(), silent.sum(), (silent & (near == 0)).sum())
        total[method] += np.array([len(told), counts[4], counts[5]])
        cells.append(middle + "".join(f" {int(number):3d}" for number in counts))
    return f"{label:<18}" + "   ".join(cells)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rigs", type=int, default=12)
    parser.add_argument("--tiny", action="store_true", help="one rig of 15 s")
    options = parser.parse_args()
    jb.start(brief=options.tiny)
    count, seconds = (1, 15.0) if options.tiny else (options.rigs, 30.0)
    total = {method: np.zeros(3, int) for method in METHODS}
    rigs = lru_cache(maxsize=None)(lambda seed, spread: twin(seed, seconds=seconds, damping=spread))
    print("per method: median error of the play [%], answers, trusted, covered, told, silent, wrong")
    print(f"{'':<18}{'hilbert':<32}   wavelet   (of {count})")
    cases = [(f"{level} dB", level, 0.0, None) for level in (60, 50, 40, 30, 25, 20, 15, 10)]
    cases += [(f"offset {share:g} h", None, share, None) for share in (0.25, 0.5, 1.0, 1.5)]
    cases += [(f"damping {100 * zeta:g} %", None, 0.0, zeta) for zeta in (0.02, 0.05, 0.1, 0.15, 0.2)]
    for label, level, share, zeta in cases[:: 6 if options.tiny else 1]:
        rows: dict[str, list[tuple[float, bool, bool, bool]]] = {method: [] for method in METHODS}
        for seed in range(1, count + 1):
            rig, record, truth = rigs(seed, (0.03, 0.07) if zeta is None else (zeta, zeta))
            if level is not None:
                rng, quieter = np.random.default_rng(seed), 10.0 ** (-level / 20)
                moved = {"x": truth["x"], "z": truth["z"]}
                noisy = {n: v + quieter * np.std(v) * rng.standard_normal(v.size) for n, v in moved.items()}
                record = jb.Record(truth["t"], noisy)
            record = record.replace(z=record.channels["z"] + share * 0.5 * rig.backlash)
            found = jb.skeleton(record, rig.inertia)
            for method in METHODS:
                rows[method].append(judged(rig, found, method))
        print(line(label, rows, total), flush=True)
    for method, (number, silent, wrong) in total.items():
        print(f"{method}: of {number} records {silent} silently outside their intervals, {wrong} wrong")
    print("\nfree decays from 15 half plays: error of the play [%], or why there is none")
    for zeta in (0.001, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2)[:: 4 if options.tiny else 1]:
        omega, half = 2 * np.pi * 10.0, 0.0131
        t = np.arange(0.0, max(2.0, min(60.0, 6.0 / (zeta * omega))), 2e-3)
        z = free_play.decay(t, 15 * half, half, omega, zeta) + 3e-5 * np.random.default_rng(1).standard_normal(t.size)
        found = jb.skeleton(jb.Record(t, {"z": z}))
        said = []
        for method in METHODS:
            play = getattr(found, method).parameters["backlash"]
            error = None if play.value is None else f"{100 * (play.value / (2 * half) - 1):+.3f} +- {50 * play.stderr / half:.3f}"
            said.append(error or play.why)
        print(f"{'damping ' + format(100 * zeta, 'g') + ' %':<18}{said[0]:<28}   {said[1]}")


if __name__ == "__main__":
    main()
