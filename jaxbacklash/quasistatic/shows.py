"""Whether a slow record shows its play: the conditions of the reading, each with what was found, and the way out where it
fails."""

from __future__ import annotations

import numpy as np

from .crossing import Crossing
from .levels import Levels
from .play import Passes
from .reading import Condition, rough_noise

FEWEST = 4
"""Passes that carry the link, in both directions together: fewer leave no way to tell a drift from a play, or how far they
scatter."""
STILL, AT_EDGE, TOOK_LAG = 0.35, 0.5, 1.15
"""Slope of the link against the drive while it crosses, up to which the link stands; scatter at an edge over half the lost
motion; what a lag leaves over what play does, down to which the two are not told apart."""
DRAGGED, IN_STEP = 0.02, 0.98
"""Share of the drive's way that a link which stands in its play may be dragged; correlation with the drive of one that is
geared."""
BEYOND_NOISE, OF_MOTION = 6.0, 0.2
"""How much more than noise z may scatter about its levels where these lie close together, and what share of all that it does."""
EARLY = 0.35
"""Share of the lost motion by which z may leave its edge before the drive turns."""
OTHERWISE = 4.0
"""How far z goes, in bounds of the play, from which on something else must move it."""
SLOPE = 0.25
"""How far the link's slope against the drive may be from 1: the play, at one position of the drive, is not touched by it."""


def follows(x: np.ndarray, y: np.ndarray, counts: tuple[float, ...], ratio: float | None) -> Condition:
    """Whether the link moves at all."""
    moved, drive = float(np.ptp(y)), float(np.ptp(x))
    still = max(3.0 * counts[1], 10.0 * rough_noise(y))
    found = f"the drive ranges over {drive:.3g}, the link over {moved:.3g}"
    # A link that goes a little of the way, in step, is geared otherwise than was said; one that stands may be dragged a little.
    slope, together = moved / drive, float(abs(np.corrcoef(x, y)[0, 1])) if moved > 0.0 else 0.0
    geared = together > IN_STEP and (ratio is None or abs(slope / ratio**2 - 1.0) < 0.3)
    if moved > still and (slope > DRAGGED or geared):
        return Condition("link carried", True, found)
    why = f"edges not reached: the link stands still while its drive ranges over {drive:.4g}, so the play is at least about that"
    return Condition("link carried", False, found, why, "move the drive farther, until the link follows both ways")


def both_edges(sides: dict[float, int], found: Crossing, least: float) -> Condition:
    """Whether the link was carried both ways."""
    said = f"carried up on {sides[1.0]} passes, down on {sides[-1.0]}"
    if min(sides.values()) > 0:
        return Condition("both edges reached", True, said)
    why = f"edges not reached: the link is carried {'one way only' if max(sides.values()) else 'on no pass'}"
    return Condition("both edges reached", False, said, why, "move the drive to and fro by several times the play")


def enough_passes(count: int, what: str = "passes that carry the link", along: str = "") -> Condition:
    """Whether there are enough passes to tell a drift, and how far they scatter."""
    said = f"{count} {what}" + (f" of {along}" if along else "")
    if count >= FEWEST:
        return Condition("enough reversals", True, said)
    why = f"too few reversals: {said}, and {FEWEST} are the least that show how far they scatter"
    return Condition("enough reversals", False, said, why, "record more strokes to and fro; ten make a good interval")


def gear(slope: float, ratio: float | None, link_drives: bool) -> Condition:
    """Whether the link goes as far as its drive, once carried."""
    slope = 1.0 / slope if link_drives and slope != 0.0 else slope
    said = f"the link goes {slope:.5g} times as far as its drive"
    if abs(slope - 1.0) <= SLOPE:
        return Condition("gear ratio", True, said)
    stated = 1.0 if ratio is None else ratio
    true = stated / slope if slope != 0.0 else np.inf
    near = float(np.round(true)) if abs(true) > 0.9 and abs(true - np.round(true)) < 0.02 * abs(true) else true
    if slope < 0.0 and abs(slope + 1.0) <= SLOPE:
        return Condition("gear ratio", False, said, "the two encoders count in opposite directions", "--sign y")
    inverse = ratio is not None and abs(true * ratio - 1.0) < 0.2
    what = f"the gear's ratio is {'missing' if ratio is None else 'wrong'}"
    if inverse:
        what = f"the ratio was given as 1/N: {ratio:g}"
    return Condition("gear ratio", False, said, f"{what}; by the record it is {true:.4g}", f"--ratio {near:.6g}")


def clear_of_counts(width: float, low: float, high: float, count: float, ranges: float = 0.0) -> Condition:
    """Whether the lost motion is clear of zero and of the encoder's counts; ``ranges`` is how far z goes in all."""
    said = f"{width:.4g}, 95 % interval {low:.4g} to {high:.4g}" + (f", a count is {count:.3g}" if count else "")
    top = max(high, 0.0)
    if count > 0.0 and 0.0 < width < count:
        why = f"the play is below a count: {width:.3g} against {count:.3g}, and less than {max(top, count):.3g} in any case"
        return Condition("play above counts", False, said, why, "use a finer encoder at the link")
    if low > 0.0:
        return Condition("play above counts", True, said)
    if high <= 0.0:
        why = "the link is ahead of its drive where one that is carried lags: it is moved by its inertia, or by its weight"
        return Condition("link carried", False, said, why, "move more slowly, or fit the dynamics with jaxbacklash fit")
    why = f"the play does not show: z hardly differs between the directions, so that the play is less than {max(top, count):.3g}"
    if ranges > OTHERWISE * max(top, count):
        why += f", unless the link is moved by its inertia or its weight: z goes over {ranges:.3g} all the same"
    return Condition("play above noise", False, said, why, "record more and slower strokes, of several lengths")


def at_edges(noise: float, width: float, by_noise: float, moves: float) -> Condition:
    """Whether z stays at its two levels: averages scatter about them by ``noise``, would by ``by_noise`` for noise
    alone, and ``moves`` is the standard deviation of z itself."""
    share = noise / max(0.5 * abs(width), 1e-300)
    said = f"z scatters by {noise:.3g} about its levels, {share:.2g} of half their distance"
    if share <= AT_EDGE or noise <= max(BEYOND_NOISE * by_noise, OF_MOTION * moves):
        return Condition("z stays at an edge", True, said)
    why = "z does not stay at two levels: something else than the direction moves it, such as inertia, a varying load or a drift"
    return Condition("z stays at an edge", False, said, why, "move more slowly, or fit the dynamics with jaxbacklash fit")


def no_lag(found: Crossing, fits: Levels, step: float) -> Condition:
    """Whether it is play, not one encoder seen later than the other."""
    said = f"a lag in place of play leaves {np.sqrt(found.lagging / max(found.left, 1e-300)):.3g} times as much"
    late = fits.lag is not None and not fits.lag_open and abs(fits.lag) > 3.0 * fits.lag_stderr
    if fits.interval[0] <= 0.0 < fits.interval[1] and late and fits.lag is not None and abs(fits.lag) > step:
        why = (
            f"z goes with the speed, not with the direction: a lag of {fits.lag:.3g} s between the encoders, viscous wind-up, or "
            f"a link moved by its inertia; beside it the play is less than {max(fits.interval[1], 0.0):.3g}"
        )
        return Condition("play, not lag", False, said, why, "read both encoders at one moment, and move more slowly")
    if found.lagging > TOOK_LAG * found.left or fits.beside_lag > 0.0 or fits.interval[0] <= 0.0:
        if late:
            said += f"; beside play z goes with the speed, by {fits.lag:.3g} s"
        return Condition("play, not lag", True, said)
    why = "a lag between the two encoders, or viscous wind-up, explains z as well as play does"
    return Condition("play, not lag", False, said, why, "move at several speeds, some of them slow")


def stays_put(driver: np.ndarray, follower: np.ndarray, way: Passes, travel: float) -> Condition:
    """Whether the link stands while the play is crossed, as one that friction holds does."""
    inside = (way.travel > 0.2 * travel) & (way.travel < 0.75 * travel) & (way.number > 0)
    up = np.zeros(way.count)
    np.add.at(up, way.number[inside], 1.0)
    good = inside & (up[way.number] >= 3)
    if np.count_nonzero(good) < 12:
        return Condition("friction holds the link", None, "too few samples fall within the crossing to say")
    number = way.number[good]
    size = np.bincount(number, minlength=way.count)[number]

    def centred(values: np.ndarray) -> np.ndarray:
        return values[good] - np.bincount(number, values[good], minlength=way.count)[number] / size

    dx, dy = centred(driver), centred(follower)
    slope = float(dx @ dy / max(dx @ dx, 1e-300))
    error = float(np.std(dy - slope * dx) / np.sqrt(max(dx @ dx, 1e-300)))
    said = f"while the play is crossed the link goes {slope:.2g} of the drive's way"
    if abs(slope) < STILL + 2.0 * error:
        return Condition("friction holds the link", True, said)
    why = (
        "the link moves while the play is crossed: it is not held by friction, or contact begins softly, so its play cannot be "
        "read without dynamics"
    )
    return Condition("friction holds the link", False, said, why, "move more slowly, or fit the dynamics with jaxbacklash fit")


def at_one_edge(z: np.ndarray, way: Passes, found: Crossing, width: float) -> Condition:
    """Whether the link stays at its edge while the drive brakes: one that runs ahead is moved by its inertia.

    z at a turning point is compared with z once the play is crossed: near the same angle, so that the gear's error cancels.
    """
    jumps = []
    ends = np.append(way.starts[1:], z.size)
    for one in range(way.count - 1):
        if min(way.strokes[one], way.strokes[one + 1]) < 2.0 * found.travel:
            continue
        here, there = slice(way.starts[one], ends[one]), slice(way.starts[one + 1], ends[one + 1])
        before = z[here][way.travel[here] >= way.strokes[one] - 0.1 * found.travel]
        after = z[there][(way.travel[there] >= 1.25 * found.travel) & (way.travel[there] <= 1.75 * found.travel)]
        if before.size and after.size:
            jumps.append(float(way.signs[one] * (np.mean(after) - np.mean(before))))
    if not jumps:
        return Condition("slow", None, "no stroke is long enough to say")
    share = 1.0 - float(np.median(jumps)) / max(abs(width), 1e-300)
    said = f"when the drive turns, z has left its edge by {max(share, 0.0):.2g} of the play"
    if share <= EARLY:
        return Condition("slow", True, said)
    why = "the link runs ahead when the drive brakes: its inertia, not friction, decides where it is"
    return Condition("slow", False, said, why, "move more slowly, or fit the dynamics with jaxbacklash fit")
