"""Write the records that `jaxbacklash demo` ships: a hanging link behind a loose joint, gravity left for it to find.

    python -m benchmarks.make_demo_record

writes jaxbacklash/data/demo_train.csv (a chirp whose amplitude falls as a servo's does), demo_heldout.csv (a multisine)
and demo.json: what the demo is told (the inertia), and the truth it should find. The seed fixes every digit.
It needs numba: pip install "jaxbacklash[dev]".
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from tests.independent.generator import make_excitation, measure, simulate_truth
from tests.independent.motions import Chirp
from tests.independent.rigs import Excitation, Rig

SEED = 20
RATE, DURATION, SIGMA = 500.0, 12.0, 3e-5  # Hz, s, rad on both channels
RIG = Rig(inertia=3.16, backlash=0.02618, stiffness=13000.0, damping=12.0)
EFFECTS = {"gravity": {"G": -45.0}}
DATA = Path(__file__).resolve().parents[1] / "jaxbacklash" / "data"


def excitations(rng) -> dict[str, Excitation]:
    """A chirp from 1 to 9 Hz, 0.075 rad rolled off above 4 Hz, and a multisine to be judged by."""
    chirp = Chirp(amplitude=0.075, f0=1.0, rate=8.0 / DURATION, corner=4.0, ramp=0.5)
    return {"train": Excitation("chirp", chirp), "heldout": make_excitation(rng, "multisine", DURATION, scale=0.8)}


def both_sides(contact, samples: int = 250) -> float:
    """The share of stretches of `samples` samples in which the link touches both sides; contact (n,) of -1, 0, +1."""
    stretches = contact[: len(contact) // samples * samples].reshape(-1, samples)
    return float(np.mean((stretches == 1).any(axis=1) & (stretches == -1).any(axis=1)))


def main() -> None:
    rng = np.random.default_rng(SEED)
    DATA.mkdir(parents=True, exist_ok=True)
    for name, excitation in excitations(rng).items():
        truth = simulate_truth(RIG, EFFECTS, excitation, RATE, DURATION)
        record = measure(truth, rng, SIGMA, SIGMA)
        path = DATA / f"demo_{name}.csv"
        table = np.column_stack([record["t"], record["x"], record["z"]])
        np.savetxt(path, table, delimiter=",", header="t,x,z", comments="", fmt=["%.3f", "%.7f", "%.7f"])
        share = both_sides(truth["contact"])
        print(f"{path.name}: {path.stat().st_size / 1e3:.0f} kB, both sides touched in {share:.0%} of its half seconds")
    facts = {
        "told": {"inertia": RIG.inertia, "unit": "kg m^2"},
        "records": {"train": "demo_train.csv", "heldout": "demo_heldout.csv", "rate_hz": RATE, "duration_s": DURATION},
        "truth": {
            "backlash": RIG.backlash,
            "stiffness": RIG.stiffness,
            "damping": RIG.damping,
            "effects": EFFECTS,
            "noise": {"x": SIGMA, "z": SIGMA},
        },
        "note": "SI units; backlash is the total play; T = G sin(y) with G < 0 for a hanging link",
        "seed": SEED,
        "made_by": "python -m benchmarks.make_demo_record",
    }
    (DATA / "demo.json").write_text(json.dumps(facts, indent=2) + "\n")


if __name__ == "__main__":
    main()
