"""What a record must be: every refusal that concerns its channels, one sentence each.

A check takes arrays and `where`, the file as the user named it, and raises `BadInput` or returns. The refusals that
concern the times alone are in `time_axis`; what is odd is in `findings`.
"""

from collections.abc import Callable

import numpy as np

from jaxbacklash.errors import BadInput

from .findings.quantities import degrees

CHANNELS = ("x", "z", "y", "F", "T")
"""Base motion, relative motion, absolute motion, force on the link, transmitted force (the last two may be torques)."""
DRIVE = ("torque", "command", "motor", "link")
"""Torque at the motor of a drive, or the position command of its servo, and what its encoders show: the motor's shaft, and the
link behind the gear."""
PUSHES = ("torque", "current", "command")
"""What may drive the motor; of several in a file the first is taken, unless another is mapped."""
OF_A_DRIVE = (*PUSHES, "motor", "link")
"""What a file may have of a drive: a current in place of the torque."""

MIN_SAMPLES = 64
MIN_SECONDS = 0.5
LARGEST_SERIES = 1e60
"""The same for a series of any quantity in any unit, which is brought to its own size before it is judged."""
LARGEST = 1e12
"""No value in SI units is larger in size, and no motion or force smaller in range than its inverse: squares and fourth powers of
them, which a fit needs, stay far within double precision."""
WANTED_CHANNELS = (
    "x with z or y (base motion), F with y or z (force), x with T (transmitted force), "
    "torque or current with motor or link (drive), command with motor (its servo), or z or y alone (free decay)"
)


def wrong(place: str, found: str, wanted: str, remedy: str = "") -> BadInput:
    """The error that says, in one sentence on one line, where something is wrong, what was found and what is wanted."""
    return BadInput(f"{place}: found {found}, wanted {wanted}.".replace("\n", " "), remedy=remedy)


def number(value: float) -> str:
    """A number as a person reads it in a sentence."""
    return f"{value:.6g}"


def listed(names, limit: int = 12) -> str:
    """Names in a row, cut short so that a sentence stays a sentence."""
    names = [" ".join(str(name).split()) for name in names]
    return ", ".join(names[:limit]) + (f" and {len(names) - limit} more" if len(names) > limit else "") or "nothing"


def real_vector(values, name: str, where: str) -> np.ndarray:
    """The values of one column as float64.

    Parameters
    ----------
    values : array of shape (N,), (N, 1) or (1, N)
    name, where : str
        The column and the file, for the sentence.

    Returns
    -------
    array of shape (N,), float64

    Raises
    ------
    BadInput
        When the values are complex, text or objects, or have another shape.
    """
    values = np.asarray(values)
    if values.dtype.kind == "c":
        raise wrong(f"{where}, column {name}", "complex values", "real numbers")
    if values.dtype.kind not in "fiub":
        raise wrong(f"{where}, column {name}", "text or objects", "numbers")
    if values.ndim == 2 and 1 in values.shape:
        values = values.ravel()
    if values.ndim != 1:
        raise wrong(f"{where}, column {name}", f"an array of shape {values.shape}", "one value per sample")
    return np.ascontiguousarray(values, dtype=np.float64)


def _row(row: int) -> str:
    return f"row {row + 1}"


def finite(values: np.ndarray, name: str, where: str, place: Callable[[int], str] = _row) -> None:
    """Refuse NaN and infinity, naming the first row that has one; ``place`` says how a row (from 0) is named."""
    known = np.isfinite(values)
    if known.all():
        return
    bad = np.flatnonzero(~known)
    more = f" ({bad.size} such rows)" if bad.size > 1 else ""
    missing = bool(np.isnan(values[bad]).all())
    found = f"{'no number' if missing else values[bad[0]]} at {place(int(bad[0]))}{more}"
    bridge = "; short runs are bridged with --resample" if missing and name != "t" else ""
    sentence = f"{where}, column {name}: found {found}, wanted a finite number in every row{bridge}."
    raise BadInput(sentence, remedy="--resample" if bridge else "")


def of_computable_size(values: np.ndarray, name: str, where: str, most: float = LARGEST) -> None:
    """Refuse values (N,), finite, that are larger than ``most`` in size, or of a range below its inverse: no measurement in SI
    units is, and no fit can compute with them."""
    cure = "a measurement in SI units; is the unit right? convert with --unit or --scale"
    low, high = float(values.min()), float(values.max())
    largest, extent = max(-low, high), high - low
    if largest > most:
        raise wrong(f"{where}, column {name}", f"values of up to {number(largest)} in size", f"at most {most:g}, {cure}")
    if 0.0 < extent < 1.0 / most:
        raise wrong(f"{where}, column {name}", f"a range of {number(extent)}", f"at least {1.0 / most:g}, {cure}")


def same_length(values: np.ndarray, name: str, t: np.ndarray, where: str) -> None:
    """Refuse a column that does not have one value for each time."""
    if values.size != t.size:
        raise wrong(f"{where}, column {name}", f"{values.size} values", f"{t.size}, as many as t has")


def kind_of(names, extras, where: str) -> str:
    """Which experiment the channels describe.

    Parameters
    ----------
    names : collection of str
        The known channels present, without t.
    extras : collection of str
        The other columns; named in the refusal, since one of them may be the missing channel.

    Returns
    -------
    str
        "base_motion", "force", "free_decay", "transmitted" or "drive".

    Raises
    ------
    BadInput
        When no experiment has these channels.
    """
    if "torque" in names and ("motor" in names or "link" in names):
        return "drive"
    if "command" in names and "motor" in names:
        return "drive"
    moves = "z" in names or "y" in names
    if moves:
        return "base_motion" if "x" in names else "force" if "F" in names else "free_decay"
    if "x" in names and "T" in names:
        return "transmitted"
    if not len(names) and not len(extras):
        raise wrong(where, "only the time column t", f"{WANTED_CHANNELS} beside it")
    hint = f"; map one of the other columns ({listed(extras)}) with --columns CHANNEL=NAME" if len(extras) else ""
    raise wrong(where, f"the channels t, {listed(names)}", f"{WANTED_CHANNELS}{hint}")


def long_enough(t: np.ndarray, where: str) -> None:
    """Refuse fewer than 64 samples, the least from which noise and motion can be told apart."""
    if t.size < MIN_SAMPLES:
        raise wrong(where, f"{t.size} samples", f"at least {MIN_SAMPLES}")


def lasts_long_enough(t: np.ndarray, where: str) -> None:
    """Refuse less than half a second: fewer than a handful of swings of any joint one can build."""
    seconds = t.size * (t[-1] - t[0]) / (t.size - 1)
    if seconds < MIN_SECONDS * (1 - 1e-9):
        hint = "is t in seconds? if not, say so with --unit t=min or the like"
        raise wrong(f"{where}, column t", f"a record of {number(seconds)} s", f"at least {MIN_SECONDS} s ({hint})")


def moving(values: np.ndarray, name: str, role: str, where: str, hint: str = "") -> None:
    """Refuse a channel that says nothing because it never changes."""
    low, high = values.min(), values.max()
    if high - low > 1e-12 * max(abs(low), abs(high)):
        return
    found = "0 in every row" if low == high == 0 else f"the constant {number(low)} in every row"
    raise wrong(f"{where}, column {name}", found, f"the {role} to change over the record{hint}")


def plausible_angles(channels: dict[str, np.ndarray], confirmed, where: str) -> None:
    """Refuse degrees taken for radians: see `findings.quantities.degrees`, with whose channels (N,) and believed units.

    Raises
    ------
    BadInput
        Naming the channel, its peak and the two ways out.
    """
    for finding in degrees(channels, confirmed):
        raise BadInput(finding.sentence(where))
