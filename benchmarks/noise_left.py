"""What the right model leaves: the root of its reduced chi-square, against what a verdict takes for noise.

    python -m benchmarks.noise_left [--records 80] [--seed 77] [--tiny]

Clean records of random laboratory joints, four motions, four rates and lengths, noise of 3e-5 to 1e-3 rad, every third with a
coarse encoder. Each is fitted with the joint alone. A verdict of "incomplete" on one of them would be false.
The records come from a program that shares nothing with the package. It needs numba.
"""

from __future__ import annotations

import argparse

import numpy as np

from jaxbacklash.criticism.evidence import most_of_noise
from jaxbacklash.criticism.model_fitter import ModelFitter
from jaxbacklash.fitting.setup import base_system
from jaxbacklash.program import start
from jaxbacklash.records import Record
from tests.independent.generator import make_excitation, make_rig, measure, simulate_truth

SHAPES = ((250.0, 20.0), (500.0, 5.0), (500.0, 20.0), (1000.0, 10.0))  # Hz, s
MOTIONS = ("chirp", "multisine", "stepped", "modulated")


def left(seed: int, number: int) -> tuple[float, float]:
    """The misfit of the right model in units of the estimated noise, and the most that is taken for noise."""
    rng = np.random.default_rng([seed, number])
    rate, duration = SHAPES[number % len(SHAPES)]
    rig, noise = make_rig(rng), 3e-5 * 10 ** rng.uniform(0.0, 1.5)
    motion = make_excitation(rng, MOTIONS[number // len(SHAPES) % len(MOTIONS)], duration)
    truth = simulate_truth(rig, {}, motion, rate, duration)
    count = noise * rng.uniform(1.0, 6.0) if rng.random() < 1.0 / 3.0 else None
    seen = measure(truth, rng, noise * rng.uniform(0.5, 2.0), noise, count)
    record = Record(seen["t"], {name: seen[name] for name in "xz"})
    base, free, _ = base_system(record, "joint", rig.inertia)
    model = ModelFitter(record, base, free, 0.2).fit_model({})
    return model.misfit, most_of_noise(model)


def main() -> None:
    """Fit, and print the largest misfits beside their bounds."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--records", type=int, default=80)
    parser.add_argument("--seed", type=int, default=77)
    parser.add_argument("--tiny", action="store_true", help="one record")
    options = parser.parse_args()
    start(brief=options.tiny)
    # The shapes of the tiny one are those of most other records at 500 Hz, so that what was compiled for them serves again.
    found = [left(options.seed, number) for number in ([1] if options.tiny else range(options.records))]
    misfits, bounds = np.array(found).T
    print(f"{misfits.size} records: misfit {misfits.mean():.4f} +- {misfits.std():.4f}, largest {misfits.max():.4f}")
    print(f"called incomplete: {np.sum(misfits > bounds)}; closest to its bound by {np.min(bounds - misfits):.4f}")


if __name__ == "__main__":
    main()
