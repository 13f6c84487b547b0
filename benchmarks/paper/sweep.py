"""Figures 8, 9 and 10: the base, the link and the motion across the joint under the chirp."""

from __future__ import annotations

import numpy as np

from jaxbacklash.plot.thinning import envelope

from . import rig
from .item import IN_KIND, NOT, Beside, Item, figures

BINS = 700
"""Stretches of time, each drawn from its least to its largest value."""
CHOSEN = (
    "The record is simulated: damping, the amplitude of the base, sample rate and noise are not printed and were chosen (see "
    "benchmarks/paper/rig.py)."
)


def items() -> list[Item]:
    """The three time series."""
    record, _ = rig.swept()
    t, x, z = record.t, record.channels["x"], record.channels["z"]
    fall = rig.last_outside()
    return [
        Item("figure_08", "Oscillation measured by encoder 1", IN_KIND,
             f"The base motion, whose amplitude falls as the frequency rises. {CHOSEN}",
             (Beside("frequency at the end", 12.0, 12.0, "Hz"), Beside("duration", 30.0, 30.0, "s"),
              Beside("largest amplitude", None, figures(np.degrees(np.abs(x).max()), 3), "deg")), (), drawn(t, x)),
        Item("figure_09", "Oscillation measured by encoder 2", IN_KIND,
             f"Taken as the motion of the link against the ground, y = x + z, since Figure 10 is z. {CHOSEN}",
             (Beside("largest amplitude", None, figures(np.degrees(np.abs(x + z).max()), 3), "deg"),),
             ("Section 3.1 says that encoder 2 measures the motion of the link relative to the first link, which is z, and once "
              "more that Figure 9 is the relative motion; Figure 10 is then introduced as the relative motion too, formed from "
              "both encoders. If encoder 2 measured z, Figures 9 and 10 would be the same.",), drawn(t, x + z)),
        across(t, z, fall),
    ]  # fmt: skip


def across(t: np.ndarray, z: np.ndarray, fall: float) -> Item:
    """Figure 10: z, the edges of the play, and where z falls inside for good."""
    half = 0.5 * rig.RIG.backlash
    rest = z[t > fall + 1.0]
    before = float(np.abs(z[t < fall]).max())
    middle, swing = float(np.mean(rest)), float(0.5 * np.ptp(rest))
    shifted = abs(middle) > 0.25 * swing
    beside = (
        Beside("z outside the play for the last time", rig.FALL, figures(fall), "s"),
        Beside("frequency of the base there", 6.5, figures(rig.SWEEP * fall, 3), "Hz"),
        Beside("largest z before, above the half play of 0.75", "higher than the play", figures(np.degrees(before), 3), "deg"),
        Beside("middle of z afterwards", "shifted", figures(np.degrees(middle), 2), "deg"),
        Beside("amplitude of z afterwards", None, figures(np.degrees(swing), 2), "deg"),
    )
    good = before > half and shifted and abs(fall - rig.FALL) < 1.0
    return Item(
        "figure_10", "Relative motion between both links, z", IN_KIND if good else NOT,
        f"Contact ends when the base no longer gives the energy, and the link then floats inside the play"
        f"{', off its middle, as the paper sees after 17 s' if shifted else ''}. The time is that of the paper because the "
        f"corner of the base's amplitude was chosen for it. {CHOSEN}", beside,
        ("The text calls the amplitude at 16.25 s too low and, on the next page, says that 16 to 17 s is the resonance of the "
         "system; at 6.5 Hz a joint of 11 Hz is in resonance at one amplitude only, since its natural frequency falls with the "
         "amplitude.",),
        drawn(t, z) | {"edges": np.degrees([-half, half])},
    )  # fmt: skip


def drawn(t: np.ndarray, values: np.ndarray) -> dict[str, np.ndarray]:
    """A series as its least and largest values over short stretches [s, deg]."""
    at, low, high = envelope(t, np.degrees(values), BINS)
    return {"t": at, "low": low, "high": high}
