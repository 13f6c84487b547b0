"""Sound files (.wav), as vibration recorders write them, through SciPy."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..checks import wrong
from ..table import Column, Table
from .guard import bounded, guarded


def read(path: Path) -> Table:
    """The channels of a sound file, "channel 1" and so on, in the numbers of the file, and times from its rate.

    Parameters
    ----------
    path : Path

    Returns
    -------
    Table

    Raises
    ------
    BadInput
        The file is damaged, cut off or of a packed kind.
    """
    with guarded(path, "a file that is damaged or no plain sound file", "a complete .wav file, not packed"):
        from scipy.io import wavfile

        size = path.stat().st_size
        bounded(8 * size, str(path))
        rate, values = wavfile.read(path)
        values = values if values.ndim == 2 else values[:, None]
        with open(path, "rb") as file:
            head = file.read(8)
        announced = int.from_bytes(head[4:8], "big" if head[:4] == b"RIFX" else "little") + 8
        if announced > size + 1:
            raise wrong(str(path), f"{size} of {announced} bytes", "a complete file; copy it again")
    columns = values.astype(np.float64).T
    channels = tuple(Column(f"channel {number}", each) for number, each in enumerate(columns, start=1))
    times = Column("t", np.arange(len(values)) / rate, "s")
    return Table((times, *channels), "wav", {"numbers": str(values.dtype)}, (), float(rate))
