"""What a record must be: every refusal that concerns its channels, one sentence each.

A check takes arrays and `where`, the file as the user named it, and raises `BadInput` or returns. The refusals that
concern the times alone are in `time_axis`; what is merely odd is in `suspicions`.
"""

from collections.abc import Callable

import numpy as np

from jaxbacklash.errors import BadInput

CHANNELS = ("x", "z", "y", "F", "T")
"""Base motion, relative motion, absolute motion, force on the link, transmitted force (the last two may be torques)."""

MIN_SAMPLES = 64
MIN_SECONDS = 0.5
MAX_RELATIVE_RAD = 1.0
MAX_BASE_RAD = 2 * np.pi
WANTED_CHANNELS = (
    "x with z or y (base motion), F with y or z (force), x with T (transmitted force), or z or y alone (free decay)"
)


def wrong(place: str, found: str, wanted: str) -> BadInput:
    """The error that says, in one sentence on one line, where something is wrong, what was found and what is wanted."""
    return BadInput(f"{place}: found {found}, wanted {wanted}.".replace("\n", " "))


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
    bad = np.flatnonzero(~np.isfinite(values))
    if not bad.size:
        return
    more = f" ({bad.size} such rows)" if bad.size > 1 else ""
    missing = bool(np.isnan(values[bad]).all())
    found = f"{'no number' if missing else values[bad[0]]} at {place(int(bad[0]))}{more}"
    bridge = "; short runs are bridged with --resample" if missing and name != "t" else ""
    sentence = f"{where}, column {name}: found {found}, wanted a finite number in every row{bridge}."
    raise BadInput(sentence, remedy="--resample" if bridge else "")


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
        "base_motion", "force", "free_decay" or "transmitted".

    Raises
    ------
    BadInput
        When no experiment has these channels.
    """
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
    """Refuse degrees taken for radians.

    The relative motion of a loose joint is its play and the give of its contact. Over 1 rad (57 degrees) to one side
    of its middle it is no longer a joint with play, while a degree or two read as radians exceeds it. The base may
    swing widely, but one full turn away from its middle is more than a base that shakes a joint does. Absolute motion
    y of a force-driven link is not looked at: it may be in metres, or turn freely.

    Parameters
    ----------
    channels : dict of arrays of shape (N,)
        In rad (or m, where the same bounds are wider still).
    confirmed : collection of str
        Channels whose unit the user stated: those are believed.

    Raises
    ------
    BadInput
        Naming the channel, its peak and the two ways out.
    """
    suspects = {}
    if "z" in channels:
        suspects["z"] = (_peak(channels["z"]), MAX_RELATIVE_RAD)
    elif {"x", "y"} <= set(channels) and "y" not in confirmed:
        suspects["y"] = (_peak(channels["y"] - channels["x"]), MAX_RELATIVE_RAD)
    if "x" in channels:
        suspects["x"] = (_peak(channels["x"]), MAX_BASE_RAD)
    beyond = [name for name, (peak, most) in suspects.items() if peak > most and name not in confirmed]
    if not beyond:
        return
    name = beyond[0]
    peak, most = suspects[name]
    what = {"z": "relative motion", "y": "motion y - x relative to the base", "x": "base motion"}[name]
    # When one channel is in degrees so, as a rule, is the other, though it may be too small to look wrong by itself.
    both = [each for each in ("x", "z", "y") if each in channels and each not in confirmed]
    degrees, radians = (
        ",".join(f"{each}={unit}" for each in names) for names, unit in ((both, "deg"), (beyond, "rad"))
    )
    raise wrong(
        f"{where}, column {name}",
        f"a {what} of up to {number(peak)}",
        f"radians (at most {number(most)} is believable for a joint); if it is in degrees pass --unit {degrees}, "
        f"if it truly is in radians pass --unit {radians}",
    )


def _peak(values: np.ndarray) -> float:
    """Largest distance from the middle of the range: an encoder's arbitrary zero must not count as motion."""
    return float(values.max() - values.min()) / 2
