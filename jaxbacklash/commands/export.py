"""``jaxbacklash export``."""

from __future__ import annotations

import sys
from pathlib import Path

from ..errors import BadInput
from ..export import TARGETS, exported
from ..model_file import load_model
from .common import json_text, write_text


def run(model: Path, *, to: str, out: Path | None, as_json: bool) -> None:
    """Read the model, write what another simulator reads: to a file, or to the standard output where none is named."""
    if not to:
        raise BadInput(f"--to: names no target, wanted {' or '.join(TARGETS)}")
    text = exported(load_model(model), to)
    if out is not None:
        write_text(out, text)
    if as_json:
        found = {"schema": 1, "command": "export", "to": to, "out": None if out is None else str(out), "text": text}
        sys.stdout.write(json_text(found))
    else:
        print(f"written: {out}" if out is not None else text, end="\n" if out is not None else "")
