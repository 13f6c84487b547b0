"""Exponents under a measured drive that never repeats, from the record alone, beside those of the fitted model.

    python -m benchmarks.chaos_driven [--tiny] [--records FOLDER] [--seconds 20] [--count 12] [--keep FILE]

Records come from a generator that shares nothing with the package, or from a folder of NAME/train.csv, NAME/heldout.csv and
NAME/answer.json. The model is fitted with the effects that are known to be in the record. "model" is the exponent of its tangent
along the measured motion: short pieces, each from the state that was measured, so that model and record cannot part. "alone" is
that of its own motion under the same measured drive from some starts, with their standard deviation: from another start a
chaotic link meets the edges of the play at other times, so over one record the model by itself has no sharper one than that.
The ratio is that of record and model, for records that the model calls chaotic: a difference grows by e^10 or more. Where an
effect has a state of its own (Dahl, a flexible link) the measured motion does not hold that state, and there is no "model".
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Iterator
from pathlib import Path

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from scipy.signal import savgol_filter

import jaxbacklash as jb
from jaxbacklash.dynamics import lyapunov_spectrum
from jaxbacklash.excitation import Sampled
from jaxbacklash.simulation import measured_base
from jaxbacklash.solvers.substeps import run_panels
from jaxbacklash.timeseries import driven_exponent, mean_period

STRETCH, PANELS = 0.2, 100  # s, panels in it
SKIP = 5  # stretches in which the tangent turns to the most unstable direction
STARTS = 4
PIECE = 15  # samples that are followed from one measured state
GROWS = 10.0
Case = tuple[str, jb.Record, float, list[str]]


def made(count: int, seconds: float) -> Iterator[Case]:
    """Records of random rigs, every third with an effect."""
    from tests.independent.generator import make_effects, make_excitation, make_rig, measure, simulate_truth

    kinds = ("chirp", "multisine", "stepped", "modulated")
    extra = ("gravity", "asymmetric_gap", "cubic_stiffness", "contact_damping")
    for number in range(count):
        rng = np.random.default_rng([11, number])
        rig, kind = make_rig(rng), kinds[number % 4]
        names = [extra[number // 3 % 4]] if number % 3 == 2 else []
        truth = simulate_truth(rig, make_effects(rng, *names), make_excitation(rng, kind, seconds), 500.0, seconds)
        seen = measure(truth, rng, 3e-5, 3e-5)
        yield f"{number} {kind}", jb.Record(seen["t"], {"x": seen["x"], "z": seen["z"]}), rig.inertia, names


def kept(folder: Path) -> Iterator[Case]:
    """Records of a folder."""
    for answer in sorted(folder.glob("*/answer.json")):
        known = json.loads(answer.read_text())
        for name in ("train", "heldout"):
            record = jb.read_record(answer.parent / f"{name}.csv")
            yield f"{answer.parent.name} {name}", record, known["truth"]["J"], list(known["effects"])


def of_model(record: jb.Record, inertia: float, effects: list[str]) -> dict[str, float | None]:
    """The fitted model's exponent ``along`` the measured motion, and mean and ``spread`` over starts of its motion ``alone``
    under the measured drive [1/s]."""
    system = jb.fit(record, inertia=inertia, effects=effects).system
    drive = measured_base(record)
    along = along_record(system, record, drive) if len(system.state_names) == 2 else None
    rng, values = np.random.default_rng(0), []
    stretches = int(record.samples * record.dt / STRETCH) - 1
    for _ in range(STARTS):
        y0 = float(record.channels["z"][0] + record.channels["x"][0] + 2e-3 * rng.standard_normal())
        found = lyapunov_spectrum(system, drive, count=1, periods=stretches, skip=SKIP, period=STRETCH, panels=PANELS, y0=y0)
        values.append(float(found.values[0]))
    return {"along": along, "alone": float(np.mean(values)), "spread": float(np.std(values, ddof=1))}


def along_record(system: jb.System, record: jb.Record, drive: Sampled) -> float:
    """Largest exponent of the model's tangent over pieces of the record, each from its measured state."""
    y = record.channels["z"] + record.channels["x"]
    dy = savgol_filter(y, 9, 3, deriv=1, delta=record.dt)
    at = np.arange(PIECE, record.samples - 2 * PIECE, PIECE)
    steps = np.asarray(_tangents(system, drive, record.t[at], np.stack([y[at], dy[at]], axis=1), PIECE * record.dt))
    scale = float(np.std(dy) / np.std(y))
    frame, grown = np.array([1.0, 0.0]), 0.0
    for step in steps * np.array([[1.0, scale], [1.0 / scale, 1.0]]):
        frame = step @ frame
        size = float(np.hypot(*frame))
        grown, frame = grown + np.log(size), frame / size
    return grown / (at.size * PIECE * record.dt)


@eqx.filter_jit
def _tangents(system, drive, times, states, length):
    panels = 2 * PIECE
    h = length / panels

    def after(state, t):
        end, _ = run_panels(system, t, (state[0], state[1]), drive.grid(t, h, panels), h, panels, True)
        return jnp.stack(end)

    return jax.vmap(jax.jacfwd(after))(jnp.asarray(states), jnp.asarray(times))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tiny", action="store_true", help="one short record, without its model")
    parser.add_argument("--records", type=Path, help="a folder of records with answers")
    parser.add_argument("--only", nargs="+", default=[""], help="cases whose name contains one of these")
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--count", type=int, default=12)
    parser.add_argument("--keep", type=Path, help="the models' exponents are written here, and not found again")
    asked = parser.parse_args()
    jb.start(brief=asked.tiny)
    cases = made(1, 8.0) if asked.tiny else kept(asked.records) if asked.records else made(asked.count, asked.seconds)
    known: dict[str, dict[str, float | None]] = {}
    if asked.keep and asked.keep.exists():
        known = json.loads(asked.keep.read_text())
    print(
        f"{'record':<15}{'effects':<31}{'model':>7}{'alone':>7}{'+-':>6}{'record':>8}{'+-':>6}{'ratio':>7}{'error %':>9}{'s':>6}"
        "  word"
    )
    ratios, inside = [], 0
    for name, record, inertia, effects in cases:
        if "unknown" in effects or not any(part in name for part in asked.only):
            continue
        if name not in known and not asked.tiny:
            known[name] = of_model(record, inertia, effects)
            if asked.keep:
                asked.keep.write_text(json.dumps(known))
        model = known.get(name, {})
        z, x, begun = record.channels["z"], record.channels["x"], time.perf_counter()
        found = driven_exponent(z, x, mean_period(z), np.random.default_rng(0))
        seconds = time.perf_counter() - begun
        shown = "".join(_cell(model.get(key), width) for key, width in (("along", 7), ("alone", 7), ("spread", 6)))
        line = f"{name:<15}{','.join(effects):<31}{shown}"
        if found.value is None or found.stderr is None or found.error is None:
            print(line + f"  none: {found.why}", flush=True)
            continue
        value, error, along, ratio = found.value / record.dt, found.stderr / record.dt, model.get("along"), None
        if along is not None and along * record.samples * record.dt > GROWS:
            ratio = value / along
            ratios.append(ratio)
            inside += abs(value - along) < 1.96 * error
        numbers = f"{value:8.2f}{error:6.2f}{_cell(ratio, 7)}{100 * found.error:9.2f}{seconds:6.1f}"
        print(f"{line}{numbers}  {found.word}", flush=True)
    if ratios:
        off = np.abs(np.array(ratios) - 1.0)
        print(
            f"{len(ratios)} chaotic records: {int(np.sum(off <= 0.25))} within 25 % of the fitted model, median error "
            f"{100 * np.median(off):.0f} %; the interval holds the model's in {inside}"
        )


def _cell(value: float | None, width: int) -> str:
    return f"{'':{width}}" if value is None else f"{value:{width}.2f}"


if __name__ == "__main__":
    main()
