"""Skeletons of a record: two classical ways to play, stiffness and damping, independent of the fit by simulation."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ..errors import BadInput
from ..parameters import unit_text
from ..records import Record
from ..records.not_taken import require_encoders
from ..signals import choose_intervals, fit_spline, highest_frequency
from . import masks
from .fundamental import Fundamental, hilbert_fundamental, wavelet_fundamental
from .inversion import Inversion, Terms, invert
from .modal import modal
from .omitted import Omitted, omitted, sentence
from .result import NAMES, Skeleton, Skeletons, Value

FINEST = 100.0
"""Samples a cycle of the fastest motion beyond which neighbours are averaged: more tell nothing and cost memory."""
QUIET = 2e-3
"""Share of the largest swing below which a decay is over."""
UNITS = ("rad", "N m/rad", "N m s/rad", "kg m^2")
LOUD = 0.2
"""Noise of z over the half play from which the corner of the dead zone is blurred."""
POOR = 0.5
"""Relative standard error beyond which a value is not told."""
DRIFTED = 3.0
"""Standard errors by which lower and upper amplitudes must differ before the model is doubted and errors are widened."""
FLOOR = 1e-4
"""Relative error that sampling and filtering alone may leave: no error bar is smaller."""
NO_SWEEP = 1.15
"""Ratio of large to small amplitudes below which play and stiffness cannot be told apart."""


def skeleton(
    record: Record,
    inertia: float | None = None,
    *,
    gravity: float = 0.0,
    load: np.ndarray | None = None,
    translational: bool = False,
    progress: Callable[[str, float], None] | None = None,
) -> Skeletons:
    """Estimate play, stiffness and damping from envelopes and phases, by Hilbert transform and by wavelet.

    Assumes one frequency at a time: a sweep, steady or modulated sines, a free decay. What breaks that, and stretches that
    hold nothing about the contact, are masked and told in ``warnings``. A record that is broken throughout (multisine,
    noise, chaos) gives no values, and says why.

    Parameters
    ----------
    record : base motion (x and z or y), force (F and y) or free decay (z)
    inertia : J [kg m^2]; None: fitted to force-driven records, else values are per unit inertia
    gravity : C = m g L / J of (3.3) [1/s^2], positive upright; 0 leaves it out
    load : further known torque on the link at the samples [N m, or per unit inertia without ``inertia``], shape (N,)
    translational : units of a translating mass
    progress : told the stage in words and the share of the work done

    Returns
    -------
    `Skeletons`: prints itself; ``hilbert`` and ``wavelet`` hold ``parameters`` by name, and the curves

    Raises
    ------
    BadInput
        A record without the motion of the link, or an inertia that is not positive.

    Examples
    --------
    >>> record, heldout = jb.demo_records()
    >>> found = jb.skeleton(record, inertia=3.16)
    >>> round(found.wavelet.parameters["backlash"].value, 3)
    0.026
    """
    if inertia is not None and not (np.isfinite(inertia) and inertia > 0.0):
        raise BadInput(f"--inertia {inertia:g}: wanted a positive number of kg m^2 (kg for a translating mass)")
    tell = progress or (lambda stage, share: None)
    motion = _read(record, inertia, gravity, load)
    per_inertia = inertia is None and record.kind != "force"
    known = 1.0 if per_inertia else inertia
    units = [unit_text(unit, translational=translational, per_inertia=per_inertia) for unit in UNITS]
    tell("Hilbert transform", 0.1)
    by_phase = hilbert_fundamental(motion.t, motion.pace, decaying=not motion.driven)
    outside = None if by_phase is None else _outside(by_phase, motion)
    hilbert = _method("hilbert", by_phase, motion, known, units, outside)
    tell("wavelet transform", 0.4)
    by_atoms = wavelet_fundamental(motion.t, motion.pace)
    if by_atoms is not None and by_phase is not None and outside is not None:
        # The wavelet's carrier is rough where a sweep is too quick for its atoms; the other then may vouch for the signal.
        vouched = np.array([np.interp(by_atoms.t, by_phase.t, share) for share in outside])
        outside = np.minimum(_outside(by_atoms, motion), vouched)
    elif by_atoms is not None:
        outside = _outside(by_atoms, motion)
    wavelet = _method("wavelet", by_atoms, motion, known, units, outside)
    noise = {record.observed_name: motion.noise}
    return Skeletons(record, hilbert, wavelet, per_inertia, translational, _together(hilbert, wavelet), noise, known)


@dataclass(frozen=True)
class _Motion:
    """Signals of shape (N,): ``pace`` is what sets the frequency; ``smooth`` is z less its noise, ``noise`` what was taken off,
    ``kept_noise`` the share of its variance that stays."""

    t: np.ndarray
    z: np.ndarray
    y: np.ndarray
    torque: np.ndarray
    pace: np.ndarray
    smooth: np.ndarray
    driven: bool
    noise: float
    kept_noise: float
    force: bool


def _read(record: Record, inertia: float | None, gravity: float, load: np.ndarray | None) -> _Motion:
    """The channels as needed, fast records averaged down, noise estimated."""
    if record.kind == "transmitted":
        raise BadInput(
            f"{record.path or 'the record'}: has the base motion x and the transmitted torque T but no motion of the link; "
            "wanted z or y for a skeleton"
        )
    require_encoders([record], "skeleton")
    record = record.on_its_base()
    channels, zero = record.channels, np.zeros(record.samples)
    x, force = channels.get("x", zero), channels.get("F", zero)
    z = channels["z"] if "z" in channels else channels["y"] - x
    y = channels["y"] if "y" in channels else z + x
    torque = force + (0.0 if load is None else np.asarray(load, float)) + gravity * (inertia or 1.0) * y
    driven = record.kind != "free_decay"
    signals = [z, y, torque, {"base_motion": x, "force": force}.get(record.kind, z)]
    samples = record.samples if driven else _until_quiet(z)
    fastest = max(highest_frequency(values, record.dt, 0.99) for values in (z, signals[3]))
    group = max(1, int(record.rate_hz / (FINEST * max(fastest, 1e-9))))
    whole = samples // group * group
    t, z, y, torque, pace = (v[:whole].reshape(-1, group).mean(axis=1) for v in (record.t, *signals))
    smooth, noise, share = _denoise(t, z)
    if driven and record.kind == "base_motion":
        pace = _denoise(t, pace)[0]
    return _Motion(t, z, y, torque, pace if driven else smooth, smooth, driven, noise, share, record.kind == "force")


def _until_quiet(z: np.ndarray) -> int:
    """Samples of a decay until it stays close to where it ends."""
    away = np.abs(z - np.median(z[-max(8, z.size // 50) :]))
    return max(16, int(np.flatnonzero(away > QUIET * np.max(away))[-1]) + 1)


def _denoise(t: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, float, float]:
    window = max(0.1, 60.0 * float(t[1] - t[0]))
    fitted = fit_spline(t, values, t[0], window / choose_intervals(t, values, window))
    return fitted(t), fitted.noise, min(1.0, fitted.coefficients.size / t.size)


def _method(
    name: str,
    along: Fundamental | None,
    motion: _Motion,
    inertia: float | None,
    units: list[str],
    outside: np.ndarray | None,
) -> Skeleton:
    """One method: amplitudes along its fundamental, modal curves, masks, inversion, masks again with the play known.

    ``outside`` (2, M) is what `_outside` tells at the fundamental's points.
    """
    if along is None or outside is None:
        return _nothing(name, "no oscillation of at least eight cycles was found", units)
    terms = _terms(along, motion)
    mass = inertia or 1.0
    stiffness, damping = modal(terms.position, terms.velocity, terms.torque / mass - terms.acceleration)
    mixed, wild = outside[0] > masks.MIXED_DRIVE, outside[1] > masks.APERIODIC
    fast = masks.passes_fast(along, terms.position)
    passing = "the amplitude changes too fast, as past a resonance,"
    drive = "the drive" if motion.driven else "the motion"
    repeat = "z does not repeat with the drive's cycles" if motion.driven else "z is not one oscillation that dies away"
    found = [
        masks.make_mask("ends", along, ~along.whole, ""),
        masks.make_mask("mixed", along, mixed & along.whole, f"{drive} is not one frequency at a time"),
        masks.make_mask("aperiodic", along, wild & ~mixed & along.whole, repeat),
        masks.make_mask("fast", along, fast & ~mixed & ~wild & along.whole, passing),
    ]
    keep = along.whole & ~mixed & ~wild & ~fast & (np.abs(terms.position) > 4.0 * motion.noise * np.sqrt(motion.kept_noise))
    base = Skeleton(
        name, {}, along.t, along.omega / (2.0 * np.pi), np.abs(terms.position),
        np.abs(along.of(motion.pace)) if motion.driven else None, masks.peaks(along, motion.t, motion.smooth), stiffness, damping,
        keep, tuple(found), along=along, terms=terms,
    )  # fmt: skip
    broken = np.sum(along.whole & (mixed | wild)) > 0.5 * np.sum(along.whole)
    first = None if broken else invert(terms, keep, inertia=inertia)
    if first is None:
        return _refused(base, mixed, wild, units)
    peak = masks.peaks(along, motion.t, motion.smooth - first.centre)
    inside = keep & (peak < first.values[0])
    keep &= ~inside
    found.append(masks.make_mask("inside", along, inside, "z stays inside the play", "nothing there tells its stiffness"))
    last = invert(terms, keep, inertia=inertia) if inside.any() else first
    base = replace(base, kept=keep, masks=tuple(found), peak=peak)
    if last is None:
        return _empty(base, "z touches the edges of the play in too few cycles", units)
    final = _with_allowance(last, terms, motion, keep, inertia)
    link = motion.y - motion.z + motion.smooth
    missed = omitted(terms, keep, last, link, inertia=inertia, stderr=final.stderr)
    return _judged(base, _doubted(final, missed), missed, motion, inertia, units)


def _outside(along: Fundamental, motion: _Motion) -> np.ndarray:
    """Shares of energy that are not of the fundamental, (2, M): of the drive, and of z, which may have harmonics."""
    level = np.ones(motion.t.size)
    if not motion.driven:
        size = np.abs(along.of(motion.z))
        level = np.interp(motion.t, along.t, np.maximum(size, 1e-6 * float(np.max(size))))
    drive = masks.outside(along, motion.t, motion.pace / level, 1) if motion.driven else np.zeros(along.t.size)
    return np.stack([drive, masks.outside(along, motion.t, motion.smooth / level, masks.HARMONICS, cycles=masks.REPEATS)])


def _terms(along: Fundamental, motion: _Motion) -> Terms:
    torque = along.of(motion.torque) if np.any(motion.torque) else np.zeros(along.t.size, complex)
    return Terms(along, along.of(motion.z), along.of(motion.z, 1), along.of(motion.y, 2), torque, motion.t, motion.smooth)


def _with_allowance(found: Inversion, terms: Terms, motion: _Motion, keep: np.ndarray, inertia: float | None) -> Inversion:
    """Errors widened by what the choice of window and the rest of the noise do to the values.

    Half of what changes when the windows are doubled is added in quadrature. Noise rounds the corner of the dead zone: the
    bias grows with its variance, so the raw samples beside the smoothed ones tell how much is left; it is taken off, and
    its size added too.
    """
    variance, values = found.covariance.copy(), found.values.copy()
    wide = invert(_terms(terms.along.wider(), motion), keep, inertia=inertia)
    shifts = [] if wide is None else [0.5 * (wide.values - values)]
    if motion.noise > 0.01 * values[0]:
        raw = invert(replace(terms, z=motion.z), keep, inertia=inertia, centre=found.centre)
        if raw is not None:
            bias = (raw.values - values) * motion.kept_noise / max(1.0 - motion.kept_noise, 0.1)
            values = values - bias
            shifts.append(bias)
    shifts.append(FLOOR * np.abs(values))
    for shift in shifts:
        variance += np.diag(shift**2)
    return replace(found, values=values, covariance=variance)


def _doubted(found: Inversion, missed: Omitted | None) -> Inversion:
    """Errors widened where the model is seen to be wrong: by what a missing torque would move, and by half of what the joint's
    numbers differ between small amplitudes and large, since they should not care which amplitudes told them."""
    drift = 0.5 * np.where(np.abs(found.drift) > DRIFTED * found.drift_stderr, found.drift, 0.0)
    shift = np.zeros(drift.size) if missed is None else missed.shift
    return replace(found, covariance=found.covariance + np.diag(drift**2 + shift**2))


def _judged(
    base: Skeleton, found: Inversion, missed: Omitted | None, motion: _Motion, inertia: float | None, units: list[str]
) -> Skeleton:
    """Values in words of the interface: total play instead of half, None where a value would mislead."""
    factors = (2.0, 1.0, 1.0, 1.0)
    names = (*NAMES, "inertia") if inertia is None else NAMES
    if inertia is None:  # the curves waited for the inertia that only the inversion tells
        assert base.terms is not None
        terms, mass = base.terms, found.values[3]
        stiffness, damping = modal(terms.position, terms.velocity, terms.torque / mass - terms.acceleration)
        base = replace(base, stiffness=stiffness, damping=damping)
    reasons = _reasons(found, base)
    parameters, warnings = {}, [m.sentence for m in base.masks if m.sentence and m.name != "ends"]
    for number, name in enumerate(names):
        value, error = factors[number] * found.values[number], factors[number] * found.stderr[number]
        why = reasons.get(name, "")
        if not why and not (np.isfinite(error) and error < POOR * abs(value)):
            why = f"its standard error is {100.0 * error / max(abs(value), 1e-300):.0f} % of its value"
        ends = (float(value - found.reach * error), float(value + found.reach * error))
        unit = units[(*NAMES, "inertia").index(name)]
        parameters[name] = Value(None, None, None, unit, why) if why else Value(float(value), float(error), ends, unit)
    if motion.noise > LOUD * found.values[0]:
        share = motion.noise / found.values[0]
        warnings.append(f"the noise of z is {100 * share:.0f} % of the half play: its edges are blurred, trust the play less")
    if missed is not None:
        warnings.append(sentence(missed, NAMES, found.values, inertia or (1.0 if len(names) == 3 else found.values[3])))
    drifted = np.abs(found.drift) > DRIFTED * found.drift_stderr
    if np.any(drifted[:3]):
        worst = int(np.argmax(np.abs(found.drift[:3]) / np.maximum(found.drift_stderr[:3], 1e-300)))
        percent = 100.0 * found.drift[worst] / abs(found.values[worst])
        warnings.append(
            f"large amplitudes tell another {NAMES[worst]} than small ones ({percent:+.2g} %): "
            "the joint has more to it than play, stiffness and damping"
        )
    return replace(base, parameters=parameters, centre=found.centre, misfit=found.misfit, warnings=tuple(warnings))


def _reasons(found: Inversion, base: Skeleton) -> dict[str, str]:
    """Why a value is not told, by name."""
    half, error = found.values[0], found.stderr[0]
    if half > 0.93 * found.peak or found.values[1] <= 0.0:
        return dict.fromkeys(NAMES[:2], "z never goes beyond the play, so its contact is not seen")
    small, large = np.quantile(base.amplitude[base.kept], [0.03, 0.97])
    if large < NO_SWEEP * small:
        return dict.fromkeys(NAMES[:2], "the motion is steady: one amplitude tells play and stiffness together, not apart")
    if half < 3.0 * error or half < 2e-3 * found.peak:
        return {"backlash": "no play was seen: the stiffness does not depend on the amplitude"}
    return {}


def _refused(base: Skeleton, mixed: np.ndarray, wild: np.ndarray, units: list[str]) -> Skeleton:
    whole = max(1, int(np.sum(base.along.whole))) if base.along is not None else 1
    if np.sum(mixed) > 0.2 * whole:  # a mixed drive makes a motion that does not repeat, too
        why = "the drive holds many frequencies at once (multisine, noise); a skeleton needs one at a time"
    elif np.sum(wild) > 0.5 * whole:
        why = "the response does not repeat with the drive's cycles (chaos, impacts, or too much noise)"
        if base.drive is None:
            why = "the motion is not one oscillation that dies away slowly (too much damping, or noise)"
    else:
        why = f"only {int(np.sum(base.kept)) // 2} cycles are fit to be used, wanted 20"
    return _empty(base, why, units)


def _empty(base: Skeleton, why: str, units: list[str]) -> Skeleton:
    parameters = {name: Value(None, None, None, unit, why) for name, unit in zip(NAMES, units)}
    return replace(base, parameters=parameters, why=why, warnings=(why,), kept=np.zeros(base.t.size, bool))


def _nothing(name: str, why: str, units: list[str]) -> Skeleton:
    none = np.zeros(0)
    bare = Skeleton(name, {}, none, none, none, None, none, none, none, np.zeros(0, bool))
    return _empty(bare, why, units)


def _together(hilbert: Skeleton, wavelet: Skeleton) -> tuple[str, ...]:
    """Both methods' warnings, those about the same thing once, in the words of the method that comes first."""
    kinds = {mask.sentence: mask.name for skeleton in (hilbert, wavelet) for mask in skeleton.masks if mask.sentence}
    told: dict[str, str] = {}
    for warning in (*wavelet.warnings, *hilbert.warnings):
        told.setdefault(kinds.get(warning, " ".join(warning.split()[:2])), warning)
    return tuple(told.values())
