"""What the user asked to be mended in a channel: sign, gear ratio, jumps by a turn, spikes; before anything is compared or bridged."""

from __future__ import annotations

import numpy as np

from .checks import listed, wrong
from .findings import mend
from .options import ReadOptions


def mended(channels: dict[str, np.ndarray], options: ReadOptions, where: str) -> dict[str, np.ndarray]:
    """The channels (N,) as `--sign`, `--ratio`, `--unwrap` and `--despike` ask for.

    Raises
    ------
    BadInput
        When an option names a channel that the record does not have.
    """
    for option, named in (("--sign", options.sign), ("--unwrap", options.unwrap), ("--despike", options.despike)):
        absent = sorted(named - set(channels))
        if absent:
            raise wrong(where, f"no channel {absent[0]}, which {option} names", f"one of {listed(channels)}")
    if options.ratio is not None and "x" not in channels:
        raise wrong(where, "no channel x, of which --ratio gives the turns", f"one beside {listed(channels)}")
    mended = dict(channels)
    for name in options.unwrap:
        mended[name] = mend.unwrap(mended[name])
    for name in options.despike:
        mended[name] = mend.despiked(mended[name])
    if options.ratio is not None:
        mended["x"] = mended["x"] / options.ratio
    for name in options.sign:
        mended[name] = -mended[name]
    return mended
