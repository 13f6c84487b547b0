"""What is odd in a record but may be meant: Python warnings, one sentence each."""

import warnings

import numpy as np

CLIPPED_RUN = 5
CLIPPED_RUNS = 3
HELD_ROWS = 4


def warn_of_oddities(channels: dict[str, np.ndarray], extras: dict[str, np.ndarray], where: str) -> None:
    """Warn of clipped sensors, of rows held while samples were lost, and of x, y and z that contradict each other.

    Parameters
    ----------
    channels, extras : dict of arrays of shape (N,)
    where : str
        The file, for the sentences.
    """
    sentences = [_clipped(values, name) for name, values in channels.items() if name != "F"]
    sentences += [_held(list(channels.values())), _contradicting(channels, extras)]
    for sentence in sentences:
        if sentence:
            warnings.warn(f"{where}{sentence}", UserWarning, stacklevel=3)


def _clipped(values: np.ndarray, name: str) -> str | None:
    """A sensor at its stop returns one value for as long as the motion is beyond it, again and again.

    A coarse encoder also repeats its largest count at each crest, but no oftener than a few times the count next to it.
    """
    for limit, word in ((values.max(), "largest"), (values.min(), "smallest")):
        at_limit = values == limit
        lengths = _run_lengths(at_limit)
        if np.count_nonzero(lengths >= CLIPPED_RUN) < CLIPPED_RUNS:
            continue
        inside = values[~at_limit]
        quantum = np.min(np.abs(inside - limit), initial=np.inf)
        beside = np.count_nonzero(np.abs(inside - limit) <= 1.5 * quantum)
        if at_limit.sum() > 5 * beside:
            return (
                f", column {name}: the {word} value {limit:.6g} comes {at_limit.sum()} times, up to {lengths.max()} "
                f"in a row; the sensor looks clipped, and what lies beyond its range is lost."
            )
    return None


def _held(columns: list[np.ndarray]) -> str | None:
    """Samples lost and filled with the last one: all channels stand still together, then jump by more than one step."""
    still = np.all([np.diff(values) == 0 for values in columns], axis=0)
    ends = np.flatnonzero(still[:-1] & ~still[1:])
    if not ends.size:
        return None
    lengths = _run_lengths(still)[: ends.size] + 1
    jumps = np.zeros(ends.size, dtype=bool)
    for values in columns:
        steps = np.abs(np.diff(values))
        moved = steps[steps > 0]
        if moved.size:
            # An encoder at a turning point also stands still, but leaves it by one count.
            jumps |= steps[ends + 1] > 3 * np.median(moved)
    held = np.flatnonzero(jumps & (lengths >= HELD_ROWS))
    if not held.size:
        return None
    first = held[0]
    return (
        f": {held.size} stretches of up to {lengths[held].max()} equal rows end in a jump, the first at row "
        f"{ends[first] - lengths[first] + 3}; samples look lost and filled with the last value."
    )


def _contradicting(channels: dict[str, np.ndarray], extras: dict[str, np.ndarray]) -> str | None:
    """With x, y and z all measured, z must be y - x up to an offset."""
    y = extras.get("y")
    if y is None or "x" not in channels or "z" not in channels:
        return None
    z = channels["z"]
    share = np.std(y - channels["x"] - z) / np.std(z)
    if share <= 0.1:
        return None
    return f", column z: differs from y - x by {100 * share:.0f} % of its own size; z is used and y is left aside."


def _run_lengths(flags: np.ndarray) -> np.ndarray:
    """Lengths of the runs of True in a 1-D array, in order."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], flags.astype(np.int8), [0]))))
    return edges[1::2] - edges[::2]
