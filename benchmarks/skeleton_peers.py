"""Envelope, frequency and the play they tell: the usual tools and the skeletons on the same signals.

    python -m benchmarks.skeleton_peers [--twins 6] [--tiny]

Three signals with known answers: a swept sine with harmonics, noise and an offset; a free decay of a joint with play; and
twins of the paper's experiment (tests/twin.py, needs numba). Peers are those of benchmarks/peers/envelopes.py, each with the
settings that its users would try; whoever likes may take the best of them. For the twins each peer's envelopes go through
the paper's (3.6) with plain differences, and the play is read by fitting the describing function of a sine, which is kinder than
the paper's straight line. It is told which moments to use: those that our masks leave. So that one sees what the skeleton is
worth and what the reading, our own curves are read in that way, too. A peer that is not installed is left out.
"""

from __future__ import annotations

import argparse
import warnings

import numpy as np
from scipy.optimize import least_squares

import jaxbacklash as jb
from benchmarks.peers.envelopes import PEERS, Track
from jaxbacklash.signals import frequency_grid
from jaxbacklash.skeletons.describing_function import describing_function, free_play_frequency
from jaxbacklash.skeletons.estimate import Skeletons
from jaxbacklash.skeletons.modal import base_motion
from tests.independent import free_play


def compare(ours: Skeletons, peers: dict[str, Track | None], exact: tuple, inner: tuple[float, float]) -> None:
    """Print the median and 95th percentile of the relative errors of frequency and amplitude between two times [s]."""
    t, frequency, amplitude = exact[0], *exact[1]
    tracks = {f"skeleton, {m.method}": (m.t, m.amplitude, m.frequency) for m in ours.methods}
    tracks |= {name: track[:3] for name, track in peers.items() if track is not None}
    for name, (at, size, pace) in tracks.items():
        inside = (at > inner[0]) & (at < inner[1])
        pairs = ((pace, frequency), (size, amplitude))
        off = [np.abs(found[inside] / np.interp(at[inside], t, truth) - 1.0) for found, truth in pairs]
        cells = [f"{100 * np.median(e):8.3f} {100 * np.quantile(e, 0.95):8.3f}" for e in off]
        print(f"  {name:<36} frequency {cells[0]} %   amplitude {cells[1]} %", flush=True)


def exact_decay(t: np.ndarray, clean: np.ndarray, half: float, omega: float) -> tuple[np.ndarray, np.ndarray]:
    """Frequency [Hz] and amplitude of the fundamental at each moment of a free decay without noise.

    Both belong to the undamped motion with the same peak: its period in closed form, its fundamental from one period of it.
    """
    size = np.abs(clean)
    tops = np.flatnonzero((size[1:-1] >= size[:-2]) & (size[1:-1] > size[2:]) & (size[1:-1] > half)) + 1
    below, here, above = (size[tops + shift] for shift in (-1, 0, 1))
    peak = np.exp(np.interp(t, t[tops], np.log(here - 0.125 * (above - below) ** 2 / (below - 2.0 * here + above))))
    ratios, shares = np.geomspace(1.02, 30.0, 80), []
    for ratio in ratios:
        turn = np.arange(512) / 512
        wave = free_play.decay(turn * free_play.period(ratio, 1.0, 1.0), ratio, 1.0, 1.0)
        shares.append(2.0 * abs(np.mean(wave * np.exp(2j * np.pi * turn))) / ratio)
    return free_play_frequency(peak, half, omega) / (2.0 * np.pi), peak * np.interp(peak / half, ratios, shares)


def through(track: Track) -> tuple[np.ndarray, ...]:
    """Complex amplitude of a peer's track and of its first and second derivatives, by plain differences as the paper has them."""
    t, a, _, phase = track
    with np.errstate(all="ignore"):
        rate = np.gradient(np.log(np.maximum(a, 1e-300)), t) + 1j * np.gradient(phase, t)
        z = a * np.exp(1j * phase)
        return z, rate * z, (rate**2 + np.gradient(rate, t)) * z


def play_of(amplitude: np.ndarray, force: np.ndarray) -> float:
    """The total play whose describing function of a sine fits a restoring force best."""
    good = np.isfinite(force)
    amplitude, force = amplitude[good], force[good]
    slope = float(np.max(force) / np.max(amplitude))

    def misfit(v: np.ndarray) -> np.ndarray:
        half = abs(v[1]) * float(np.median(amplitude))
        return v[0] * amplitude * describing_function(amplitude, half) - force / slope

    v = least_squares(misfit, [1.2, 0.5], loss="soft_l1", f_scale=0.05 * float(np.median(amplitude))).x
    return 2.0 * abs(v[1]) * float(np.median(amplitude))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--twins", type=int, default=6)
    parser.add_argument("--tiny", action="store_true", help="shorter signals, one twin")
    options = parser.parse_args()
    jb.start(brief=options.tiny)
    warnings.simplefilter("ignore")
    grid = frequency_grid(0.8, 40.0, 12)
    seconds = 12.0 if options.tiny else 30.0
    rng = np.random.default_rng(1)
    t = np.arange(0.0, seconds, 2e-3)
    phase, size = 2 * np.pi * (2.0 + 4.0 * t / seconds) * t, 0.03 * (1.0 + 0.3 * np.cos(0.4 * t))
    wave = size * (np.cos(phase) + 0.25 * np.cos(3 * phase + 1.0)) + 0.01 + 3e-4 * rng.standard_normal(t.size)
    print("a swept sine with 25 % third harmonic, an offset of a third and noise of 1 %; median and 95 % of the errors")
    exact = (t, (2.0 + 8.0 * t / seconds, size))
    found = jb.skeleton(jb.Record(t, {"x": wave, "z": wave}))
    compare(found, {name: peer(t, wave, grid) for name, peer in PEERS.items()}, exact, (4.0, seconds - 3.0))

    omega, half, zeta = 2 * np.pi * 10.0, 0.0131, 0.0015
    clean = free_play.decay(t, 15 * half, half, omega, zeta)
    z = clean + 3e-5 * rng.standard_normal(t.size)
    found = jb.skeleton(jb.Record(t, {"z": z}))
    exact = (t, exact_decay(t, clean, half, omega))
    print("a free decay in a dead zone from 15 half plays")
    compare(found, {name: peer(t, z, grid) for name, peer in PEERS.items()}, exact, (2.0, 0.6 * seconds))

    from tests.twin import twin

    errors: dict[str, list[float]] = {}
    for seed in range(1, 2 if options.tiny else 1 + options.twins):
        rig, record, _ = twin(seed, seconds=seconds)
        found = jb.skeleton(record, rig.inertia)
        for method in found.methods:
            value, kept = method.parameters["backlash"].value, method.kept
            errors.setdefault(f"skeleton, {method.method}", []).append(np.nan if value is None else value / rig.backlash - 1.0)
            play = play_of(method.amplitude[kept], method.restoring_force[kept])
            errors.setdefault(f"skeleton, {method.method}, read so too", []).append(play / rig.backlash - 1.0)
        inside = np.interp(record.t, found.wavelet.t, found.wavelet.kept.astype(float)) > 0.5
        for name, peer in PEERS.items():
            tracks = [peer(record.t, record.channels[c], grid) for c in ("z", "x")]
            if None in tracks:
                continue
            (a, da, dda), (_, _, ddx) = (through(track) for track in tracks)
            force = np.abs(a) * base_motion(a, da, dda, ddx)[0]
            sane = inside & (np.abs(force) < 10.0 * rig.stiffness / rig.inertia * np.abs(a))
            errors.setdefault(name, []).append(play_of(np.abs(a)[sane], force[sane]) / rig.backlash - 1.0)
    print("the play of the paper's twins: median and largest error in percent")
    for name, off in errors.items():
        print(f"  {name:<36} {100 * np.nanmedian(np.abs(off)):8.2f} {100 * np.nanmax(np.abs(off)):8.2f}")


if __name__ == "__main__":
    main()
