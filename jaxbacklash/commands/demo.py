"""``jaxbacklash demo``."""

from __future__ import annotations

import json
from importlib import resources
from pathlib import Path

from ..criticism import refine
from ..records import Record
from ..shipped import demo_records
from .common import out_folder, progress
from .refine import deliver


def shipped() -> tuple[Record, Record, float]:
    """The demo's record, its held-out record, and the inertia [kg m^2] its user is told."""
    told = resources.files("jaxbacklash") / "data" / "demo.json"
    return *demo_records(), float(json.loads(told.read_text(encoding="utf-8"))["told"]["inertia"])


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
