"""``jaxbacklash demo``: the whole loop on the record that ships with the package, or on that of a drive made here."""

from __future__ import annotations

import json
from importlib import resources
from pathlib import Path

import numpy as np

from ..criticism import refine
from ..excitation import HeldTorque
from ..fitting import fit
from ..models import drive
from ..records import Record
from ..shipped import demo_records
from ..simulation import simulate
from .common import out_folder, progress
from .fit import deliver as deliver_fit
from .refine import deliver


def shipped() -> tuple[Record, Record, float]:
    """The demo's record, its held-out record, and the inertia [kg m^2] its user is told."""
    told = resources.files("jaxbacklash") / "data" / "demo.json"
    return *demo_records(), float(json.loads(told.read_text(encoding="utf-8"))["told"]["inertia"])


GEAR, PLAY = 50.0, 0.012
"""Turns of the motor for a turn of the link, and play [rad], of the drive of the second demo."""
RIG = drive(6e-5, 1.5e-4, GEAR, inertia=0.08, backlash=PLAY, stiffness=1500.0, damping=0.8)
"""The drive of the second demo: a geared axis with 0.7 degree of play [SI]."""
SECONDS, RATE, BITS, NOISE = 12.0, 1000.0, 14, 0.002
"""Length [s] and rate [Hz] of its record, bits of the motor's encoder, noise of the torque as a share of its size."""


def driven(seed: int = 0) -> Record:
    """A record of that drive, t, torque and motor: a torque of many sines that a controller holds, an encoder that counts."""
    rng = np.random.default_rng(seed)
    t = np.arange(round(SECONDS * RATE) + 1) / RATE
    hertz = np.arange(0.3, 12.0, 0.37)
    angle = 2.0 * np.pi * (np.outer(t, hertz) + rng.uniform(0.0, 1.0, hertz.size))
    torque = np.sin(angle) @ (0.012 * np.sqrt(hertz))
    motion = simulate(RIG, HeldTorque(0.0, 1.0 / RATE, torque), duration=SECONDS, rate=RATE)
    count = 2.0 * np.pi / 2**BITS
    motor = np.round(np.asarray(motion.observed)[:, 0] / count) * count
    read = torque + NOISE * np.std(torque) * rng.standard_normal(t.size)
    return Record(t, {"torque": read, "motor": motor}, "the demo's drive", ratio=GEAR)


def run_drive(*, out: Path, as_json: bool) -> None:
    """Make a record of a drive, leave the encoder of its link away, and find the play all the same."""
    folder = out_folder(out)
    assert folder is not None
    with progress(as_json) as tell:
        if not as_json:
            print(
                "A motor turns a link through a gear and a joint with play. Only the motor has an encoder. How large is the play"
            )
            print("that nobody sees? The record is made here, and fitted without a word of what it was made with.\n", flush=True)
        found = fit(driven(), starts=1, progress=tell)
        deliver_fit(found, folder, as_json, tell)
    if not as_json:
        play = found.parameters["backlash"]
        told = "was not found" if play.value is None else f"was found as {play.value:.6f} +- {play.stderr:.1g} rad"
        print(f"\nThe play that the record was made with is {PLAY} rad; from the motor alone it {told}.")


def run(*, out: Path, as_json: bool) -> None:
    """Run the whole loop on the shipped record: fit the base model, see where it fails, add what is hidden, check, report."""
    folder = out_folder(out)
    assert folder is not None
    record, heldout, inertia = shipped()
    with progress(as_json) as tell:
        if not as_json:
            print("A link behind a loose joint, its base shaken; one physical effect is hidden in the record. The base model")
            print("is backlash, stiffness and damping. What else does the record need? This takes about a minute.\n", flush=True)
        found = refine(record, heldout=heldout, inertia=inertia, progress=tell)
        deliver(found, folder, as_json, tell)
    if not as_json:
        print(f"\nOpen {folder}/report.html to see where the base model fails and how the error falls.")
