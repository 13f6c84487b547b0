r"""Frequency and phase of a law that repeats, read off the spectrum of the missing torque.

A law says by its `jaxbacklash.mechanics.Wave` of which coordinate it is a sine: of time, as a hum that nobody recorded, or of the
angle of link or base, as the teeth of a gear. Its frequency is then no matter of guesses. Over an angle (`read_off`), the torque
that a model leaves, averaged under the bumps of the weak form, is regressed on sine and cosine of each frequency that the record
can tell; the one that takes most of it away is the likeliest (Lomb 1976, Scargle 1982), and the two sizes give amplitude and
phase. Over time (`lines`), the scores of a torque along a fitted trajectory are transformed, which noise hides far less than the
measured motion's second derivative.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ..effects.scales import FURTHEST
from ..mechanics import AbstractEffect, canonical_name
from ..parameters import Spec
from ..system import System
from .along_motion import own_torques
from .weak_form import WeakForm, whitener

Pair = Callable[[float], np.ndarray]


def read_off(
    form: WeakForm, system: System, free: tuple[str, ...], law: type[AbstractEffect], *, finer: int = 4, most: int = 512,
    rounds: int = 2,
) -> AbstractEffect:  # fmt: skip
    """The law at the frequency, phase and amplitude that are likeliest in what a model leaves.

    Parameters
    ----------
    form : the record
    system, free : a model and the parameters in which it can still move
    law : a class with a `Wave` over an angle
    finer : steps of an order to the width of a line
    most : frequencies over an angle, at most
    rounds : times the noise is judged anew, without the line that was found
    """
    wave = law.wave
    assert wave is not None
    fields: dict[str, Any] = {f.name: f.metadata["spec"] for f in law.__dataclass_fields__.values() if "spec" in f.metadata}
    scale = fields[wave.strength].scale or 1.0
    still = {} if wave.frequency is None else {wave.frequency: 0.0}
    unit = law(**{wave.strength: scale, wave.phase: 0.5 * np.pi, **still})
    weight = own_torques([unit], system, form.motion)[0] / scale
    if wave.frequency is None:
        weight = np.ones_like(weight)
    over = np.asarray(getattr(form.motion, wave.over))

    def pair(frequency: float) -> np.ndarray:
        """Sine and cosine under the bumps (R, 2)."""
        angle = frequency * over
        return form.average(np.stack([weight * np.sin(angle), weight * np.cos(angle)])).T

    left, by = form.missing(system, free)
    rest, frequency, sizes = left - by @ np.linalg.lstsq(by, left, rcond=None)[0], 1.0, np.zeros(2)
    spec, step = fields.get(wave.frequency or ""), 0.0
    for _ in range(rounds):
        white = whitener(rest)
        basis = np.linalg.qr(white(by))[0]

        def own(rows: np.ndarray, white: Any = white, basis: np.ndarray = basis) -> np.ndarray:
            rows = white(rows)
            return np.asarray(rows - basis @ (basis.T @ rows))

        if spec is not None:
            seen = own(left)
            known = form.kept(canonical_name(law), lambda: _over_angle(pair, over, spec, finer, most, wave.whole))
            frequency, step = _of_angle(known, seen, own)
            step = 0.0 if wave.whole else step

            def height(frequency: float, own: Any = own, seen: np.ndarray = seen) -> float:
                return _fall(own(pair(frequency)), seen)

            frequency = _sharpened(height, frequency, step, spec)
        design = np.column_stack([by, pair(frequency)])
        found = np.linalg.lstsq(white(design), white(left), rcond=None)[0]
        rest, sizes = left - design @ found, found[-2:]
    amplitude, phase = float(np.hypot(*sizes)), float(np.arctan2(sizes[1], sizes[0]))
    if abs(phase) > 0.5 * np.pi:  # half a period on with the other sign
        amplitude, phase = -amplitude, phase - np.sign(phase) * np.pi
    told = {} if wave.frequency is None else {wave.frequency: frequency}
    return law(**{wave.strength: amplitude, wave.phase: phase, **told})


def lines(times: np.ndarray, scores: np.ndarray, most: int, *, beside: int = 60, periods: float = 3.0) -> list[float]:
    """Angular frequencies [rad/s] of the highest lines over time in the scores of a torque, at most so many, the highest first.

    The score of a sine is the transform of the scores, and its variance where nothing is missing is its information, smooth in
    the frequency. So a line is what stands far above what is beside it; what another law leaves is high and wide.

    Parameters
    ----------
    times, scores : (W, K) as `jaxbacklash.shooting.score_columns.torque_scores` tells them
    most : lines that are told
    beside : steps of frequency on either side, a quarter of a line's width each, whose median is what a line stands above
    periods : in the record at least; what is slower goes with a drift
    """
    spacing = float(times[0, 1] - times[0, 0])
    at = np.rint((times.ravel() - times.min()) / spacing).astype(int)
    course = np.bincount(at, scores.ravel())
    least = int(np.ceil(4.0 * periods))  # steps of a spectrum padded to four times its length
    spectrum = np.abs(np.fft.rfft(course * np.hanning(course.size), 4 * course.size)) ** 2
    around = np.lib.stride_tricks.sliding_window_view(np.pad(spectrum, beside, mode="reflect"), 2 * beside + 1)
    above = spectrum / np.maximum(np.median(around, axis=1), 1e-300)
    top = (spectrum > np.roll(spectrum, 1)) & (spectrum >= np.roll(spectrum, -1))
    top[:least] = False
    order = [int(k) for k in np.argsort(np.where(top, -above, np.inf))[:most] if top[k]]
    left, high, right = (np.log(np.maximum(np.roll(spectrum, by), 1e-300)) for by in (1, 0, -1))
    between = 0.5 * (left - right) / (left - 2.0 * high + right - 1e-300)  # where a parabola through three is highest
    return [2.0 * np.pi * float(k + between[k]) / (4 * course.size * spacing) for k in order]


def _over_angle(
    pair: Pair, over: np.ndarray, spec: Spec, finer: int, most: int, whole: bool
) -> tuple[np.ndarray, np.ndarray]:  # fmt: skip
    """Frequencies over an angle that a record can tell (K,), or ``whole`` ones, and their sines and cosines under the bumps
    (R, K, 2)."""
    if whole:
        frequencies = np.arange(np.ceil(spec.lower), FURTHEST + 1.0)
        return frequencies, np.stack([pair(float(f)) for f in frequencies], axis=1)
    swing = max(0.5 * float(np.subtract(*np.quantile(over, (0.98, 0.02)))), 1e-9)
    step = 4.0 / (finer * swing)
    least = max(spec.lower, min(1.0 / swing, 0.5 * FURTHEST))
    count = int(np.clip((FURTHEST - least) / step + 1.0, 2, most))
    frequencies = least + step * np.arange(count)
    return frequencies, np.stack([pair(float(f)) for f in frequencies], axis=1)


def _of_angle(known: tuple[np.ndarray, np.ndarray], seen: np.ndarray, own: Any) -> tuple[float, float]:
    frequencies, rows = known
    columns = own(rows.reshape(rows.shape[0], -1)).reshape(-1, frequencies.size, 2)
    falls = [_fall(columns[:, k], seen) for k in range(frequencies.size)]
    return float(frequencies[int(np.argmax(falls))]), float(frequencies[1] - frequencies[0])


def _fall(columns: np.ndarray, seen: np.ndarray) -> float:
    """By how much the sum of squares of rows (R,) falls with two columns (R, 2)."""
    gram, score = columns.T @ columns, columns.T @ seen
    return float(score @ np.linalg.pinv(gram, rcond=1e-9, hermitian=True) @ score)


def _sharpened(fall: Callable[[float], float], begin: float, step: float, spec: Spec, *, halvings: int = 6) -> float:
    """The frequency near ``begin`` with the largest fall, to a small share of a step."""
    best, height = begin, fall(begin)
    for _ in range(halvings):
        for other in (best - step, best + step):
            if spec.lower <= other <= spec.upper and (tried := fall(other)) > height:
                best, height = other, tried
        step *= 0.5
    return best
