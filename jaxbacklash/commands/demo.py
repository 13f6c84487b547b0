"""``jaxbacklash demo``."""

from __future__ import annotations

import json
from importlib import resources
from pathlib import Path

from ..effects import Gravity
from ..fitting import fit as fit_records
from ..records import Record, read_record
from .common import out_folder, progress
from .fit import deliver


def shipped() -> tuple[Record, Record, float]:
    """The demo's record, its held-out record, and the inertia [kg m^2] its user is told."""
    data = resources.files("jaxbacklash") / "data"
    told = json.loads((data / "demo.json").read_text(encoding="utf-8"))["told"]
    with resources.as_file(data / "demo_train.csv") as path, resources.as_file(data / "demo_heldout.csv") as other:
        return read_record(path), read_record(other), float(told["inertia"])


def run(*, out: Path, as_json: bool) -> None:
    """Fit the shipped record with the base model, see that it fails, add what is hidden in it, and see the error fall."""
    folder = out_folder(out)
    assert folder is not None
    record, heldout, inertia = shipped()
    with progress(as_json) as tell:
        if not as_json:
            print("1. The base model, backlash + stiffness + damping, on a record of a hanging link:\n")
        base = fit_records(record, inertia=inertia, heldout=heldout, progress=tell)
        deliver(base, out_folder(folder / "base-model"), False, tell, silent=as_json)
        if not as_json:
            print("\n2. The same with the weight of the link (--effects gravity):\n")
        full = fit_records(record, inertia=inertia, effects=[Gravity(0.0)], heldout=heldout, progress=tell)
        deliver(full, folder, as_json, tell)
    if not as_json:
        print(f"\nOpen {folder}/base-model/report.html to see where the base model fails, then {folder}/report.html.")
