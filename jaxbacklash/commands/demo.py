"""``jaxbacklash demo``."""

from __future__ import annotations

import json
from importlib import resources
from pathlib import Path

from ..effects import Gravity
from ..fitting import fit as fit_records
from ..records import read_record
from .common import out_folder, progress
from .fit import deliver


def run(*, out: Path, as_json: bool) -> None:
    """Fit the shipped record with the base model, see that it fails, add what is hidden in it, and see the error fall."""
    folder = out_folder(out)
    assert folder is not None
    data = resources.files("jaxbacklash") / "data"
    told = json.loads((data / "demo.json").read_text(encoding="utf-8"))["told"]
    with resources.as_file(data / "demo_train.csv") as path, resources.as_file(data / "demo_heldout.csv") as other:
        record, heldout = read_record(path), read_record(other)
    with progress(as_json) as tell:
        base = fit_records(record, inertia=told["inertia"], heldout=heldout, progress=tell)
        if not as_json:
            print("1. The base model, backlash + stiffness + damping, on a record of a hanging link:\n")
        deliver(base, out_folder(folder / "1-base"), as_json=False, tell=tell) if not as_json else None
        full = fit_records(record, inertia=told["inertia"], effects=[Gravity(0.0)], heldout=heldout, progress=tell)
        if not as_json:
            print("\n2. The same with the weight of the link (--effects gravity):\n")
        deliver(full, folder, as_json, tell, command="fit")
    if not as_json:
        print(f"\nOpen {folder}/report.html, and {folder}/1-base/report.html to see where the base model fails.")
