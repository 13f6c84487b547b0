"""Figures 12 and 13: envelope and instantaneous frequency of base and joint, by Hilbert transform and by wavelet."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from benchmarks.peers.envelopes import scipy_hilbert
from jaxbacklash.plot.thinning import strided
from jaxbacklash.signals import frequency_grid, ridge, scalogram

from . import rig
from .item import IN_KIND, NOT, REPRODUCED, Beside, Item, figures

LOW_PASS = 0.005
"""The paper's filter, as a share of half the sample rate."""
POINTS = 500
CONTACT, FLOATING = (3.0, 15.5), (18.0, 28.0)
"""Times while z crosses the play and after that [s]."""


class Curve(NamedTuple):
    """Times [s], amplitude [rad], frequency [Hz], phase [rad]."""

    t: np.ndarray
    amplitude: np.ndarray
    frequency: np.ndarray
    phase: np.ndarray


def by_wavelet(t: np.ndarray, values: np.ndarray) -> Curve:
    """The ridge of a Morlet transform, with the amplitude and phase on it."""
    found = scalogram(t, values, frequency_grid(0.8, 40.0, 24))
    path = ridge(found)
    row = np.abs(np.log(found.frequencies[:, None] / path[None, :])).argmin(axis=0)
    on_it = found.values[row, np.arange(found.t.size)]
    return Curve(found.t, np.abs(on_it), path, np.unwrap(np.angle(on_it)))


def curves(t: np.ndarray, values: np.ndarray) -> dict[str, Curve]:
    """The paper's three: Hilbert transform as it is, low-passed, and wavelet."""
    raw, filtered = scipy_hilbert(t, values), scipy_hilbert(t, values, LOW_PASS)
    return {"hilbert": Curve(*raw), "filtered": Curve(*filtered), "wavelet": by_wavelet(t, values)}


def off(curve: Curve, span: tuple[float, float]) -> float:
    """Root mean square deviation from the frequency of the base within a span of time [Hz]."""
    inside = (curve.t > span[0]) & (curve.t < span[1])
    return float(np.sqrt(np.mean((curve.frequency[inside] - rig.SWEEP * curve.t[inside]) ** 2)))


def items() -> list[Item]:
    """Both figures, with errors against the known frequency of the base."""
    record, _ = rig.swept()
    x, z = (curves(record.t, record.channels[name]) for name in ("x", "z"))
    whole = {name: off(curve, (CONTACT[0], FLOATING[1])) for name, curve in x.items()}
    contact, floating = ({name: off(curve, span) for name, curve in z.items()} for span in (CONTACT, FLOATING))
    size = {name: amplitude_error(curve) for name, curve in x.items()}
    better = whole["wavelet"] < whole["filtered"] < whole["hilbert"]
    later = floating["wavelet"] < floating["filtered"] and floating["wavelet"] < floating["hilbert"]
    base = Item(
        "figure_12", "Envelope and instantaneous frequency of the base motion", IN_KIND if better else NOT,
        "Deviations are from the frequency and amplitude that the simulated base really had, which the paper could not know. "
        "The Hilbert transform wiggles where noise is a larger share of the motion, its low-passed curve is close until then, "
        f"and the wavelet {'keeps the frequency all along, as the paper finds' if better else 'does not keep it better'}.",
        rows("frequency off, {}, 3 to 28 s", whole, "Hz rms") + rows("envelope off, {}, 3 to 15.5 s", size, "% rms"),
        ("Equation (2.6) prints the factor of the Morlet wavelet as sqrt(pi f_b); with that the envelope would come out pi f_b "
         "times too large. It is 1 / sqrt(pi f_b).",), drawn(x),
    )  # fmt: skip
    joint = Item(
        "figure_13", "Envelope and instantaneous frequency of the motion across the joint",
        REPRODUCED if later and better else IN_KIND if later else NOT,
        "While z crosses the play the curves agree with the base's frequency; at the end of contact all of them fail; "
        "afterwards z is shifted, and there a Hilbert transform, which takes the shift for part of the motion, fails where the "
        f"wavelet {'does not' if later else 'fails too'}. "
        + ("The paper names just this as the wavelet's advantage, after 17 s." if later else "The paper finds the wavelet "
                                                                                             "better there."),
        rows("frequency off, {}, 3 to 15.5 s", contact, "Hz rms")
        + rows("frequency off, {}, 18 to 28 s", floating, "Hz rms", "best after 17 s"),
        (), drawn(z),
    )  # fmt: skip
    return [base, joint]


def rows(label: str, found: dict[str, float], unit: str, best: str | None = None) -> tuple[Beside, ...]:
    """One row a method; ``best`` is what the paper says of the wavelet."""
    told = {name: best if name == "wavelet" else None for name in found}
    return tuple(Beside(label.format(words(name)), told[name], figures(one, 2), unit) for name, one in found.items())


def amplitude_error(curve: Curve) -> float:
    """Root mean square error of the envelope of x while it is large [%]."""
    inside = (curve.t > CONTACT[0]) & (curve.t < CONTACT[1])
    return float(100.0 * np.sqrt(np.mean((curve.amplitude[inside] / rig.base_envelope(curve.t[inside]) - 1.0) ** 2)))


def words(name: str) -> str:
    """How a method is called."""
    return {"hilbert": "Hilbert transform", "filtered": "the same, low-passed at 0.5 %", "wavelet": "wavelet ridge"}[name]


def drawn(found: dict[str, Curve]) -> dict[str, np.ndarray]:
    """Thinned curves by name: times [s], amplitudes [deg], frequencies [Hz]."""
    out: dict[str, np.ndarray] = {}
    for name, curve in found.items():
        some = strided(curve.t.size, POINTS)
        out |= {f"{name}_t": curve.t[some], f"{name}_amplitude": np.degrees(curve.amplitude[some]),
                f"{name}_frequency": curve.frequency[some]}  # fmt: skip
    return out
