"""How x, y and z go together: what a gear, a turned encoder or a column taken for another leaves in slow motion.

A link on a joint with play and springs follows its base in slow motion, y = x: above the play and far below the resonance. What
is y = g x there, with g the same over an octave and more and no lag, is no joint but a gear, a turned encoder or another unit.
Where the record holds no such motion these checks are silent, and only a fit can tell (`causes`).
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping

import numpy as np

from jaxbacklash.records.finding import ASK, WARN, Finding

CONTRADICTS, ANOTHER = 0.1, 0.7
"""Share of z's own size by which y - x may miss it before it is said, and from which on the three are no one joint's. A sensor's
gain or delay stays well below; two unrelated channels come to 1 and more."""
COHERENT = 0.98
"""Coherence of a band that counts: y holds hardly anything that x does not explain."""
IN_STEP = 0.15
"""Largest lag of such a band [rad]; play that rubs lags by more where it makes y follow at less than half."""
FLAT = 1.25
"""Largest ratio of the gains of two octaves: above a resonance they differ by four, near one by more than this."""
LIKE_ONE = 1.3
"""Gains between 1/1.3 and 1.3 are how a link follows its base."""
NEAR = 0.015
"""Share by which the factor of slow motion may miss the true one: near a resonance the link already follows a little more."""
UNITS = {
    180.0 / np.pi: "x=deg",
    np.pi / 180.0: "y=deg",
    0.5 / np.pi: "x=rev",
    2.0 * np.pi: "y=rev",
    1e3: "x=mrad",
    1e-3: "y=mrad",
}
"""What x over y is where one of the two is in another unit."""
GOES_WITH, AGAINST = 0.75, 0.4
"""Coherence from which on, and lag from -x [rad] up to which, z goes against x; play in the joint keeps it from more."""
GROWS = (1.5, 8.0)
"""Growth of z over an octave below the resonance: four without play."""
SAMPLES = 32768
"""Samples that are enough to see slow motion; from a longer record its first ones."""

FAST = 512
"""Samples are taken in whole numbers of so many: a Fourier transform whose length has large prime factors is ten times slower."""

Gain = tuple[int, float, complex]
"""First line, coherence and gain of an octave, see `octave_gains`."""


def relations(channels: Mapping[str, np.ndarray], extras: Mapping[str, np.ndarray]) -> list[Finding]:
    """Contradictions between x, y and z, and a y or z that follows x as no joint lets it."""
    x, z, y = channels.get("x"), channels.get("z"), channels.get("y", extras.get("y"))
    if x is None:
        return []
    if z is not None and y is not None and y.dtype.kind == "f" and np.isfinite(y).all():
        return _three(x, y, z)
    if y is not None and "y" in channels:
        return _following(octave_gains(x, y))
    if z is None:
        return []
    gains = octave_gains(x, z)
    return _taken_for_y(gains) or _turned(gains)


def before_sizes(channels: Mapping[str, np.ndarray], extras: Mapping[str, np.ndarray]) -> list[Finding]:
    """What is asked of x, y and z before the size of their motion is judged.

    A gear, a turned encoder or a y taken for z stays what it is when all channels are in degrees, while each of them changes the
    size of y - x, by which degrees are told from radians.
    """
    return [one for one in relations(channels, extras) if one.action != WARN]


def _three(x: np.ndarray, y: np.ndarray, z: np.ndarray) -> list[Finding]:
    """With x, y and z all measured, z must be y - x up to an offset."""
    size = np.std(z)
    share = float(np.std(y - x - z) / size) if size > 0 else 0.0
    if share <= CONTRADICTS:
        return []
    if share <= ANOTHER:
        what = f"differs from y - x by {100 * share:.0f} % of its own size; z is used and y is left aside"
        return [Finding("contradiction", WARN, "z", what, size=share)]
    if np.std(y - x + z) < CONTRADICTS * size:
        return [Finding("sign", ASK, "z", "is x - y where y - x is wanted", "--sign z", size=-1.0)]
    what = (
        f"is not y - x, which it misses by {100 * share:.0f} % of its own size, so x, y and z do not look like base, link and "
        "relative motion but like three axes of one sensor (an accelerometer?)"
    )
    return [Finding("axes", ASK, "z", what, size=share)]


def _following(gains: list[Gain]) -> list[Finding]:
    """A y that follows x in slow motion, but smaller, larger or the other way; ``octave_gains`` are those from x to y."""
    gain, open_ = slow_gain(gains) or (1.0, 0.0)
    if 1 / LIKE_ONE < gain < LIKE_ONE:
        return []
    if -LIKE_ONE < gain < -1 / LIKE_ONE:
        what = "follows -x in slow motion, as an encoder that is mounted the other way round"
        return [Finding("sign", ASK, "y", what, "--sign y", size=gain)]
    ratio = 1.0 / gain
    what = f"follows x at {gain:.3g}, to within {100 * open_:.0f} %, in slow motion, as behind a gear or in another unit"
    gear = f"--ratio {of_teeth(ratio):.4g}"
    unit = next((said for per_radian, said in UNITS.items() if abs(ratio / per_radian - 1.0) < NEAR), "")
    if unit:
        return [Finding("gear", ASK, "y", what, f"--unit {unit}", size=gain, otherwise=gear)]
    return [Finding("gear", ASK, "y", what, gear, size=gain)]


def of_teeth(ratio: float) -> float:
    """The simplest ratio of a gear near a measured one: whole before halves (5:2), thirds (4:3) and quarters."""
    for parts in range(1, 5):
        simple = round(parts * ratio) / parts
        if abs(ratio - simple) < NEAR * abs(ratio):
            return simple
    return float(round(ratio)) if abs(ratio) > 1.5 and abs(ratio / round(ratio) - 1) < 0.1 else ratio


def _taken_for_y(gains: list[Gain]) -> list[Finding]:
    """A z that follows x as the link itself does; ``octave_gains`` are those from x to z."""
    gain, _ = slow_gain(gains) or (0.0, 0.0)
    if not 1 / LIKE_ONE < gain < LIKE_ONE:
        return []
    what = "follows x one to one in slow motion, as the link's own motion y does and relative motion z = y - x does not"
    return [Finding("absolute", ASK, "z", what, "--columns y=z", size=gain)]


def _turned(gains: list[Gain]) -> list[Finding]:
    """A z that grows against x with the frequency; ``octave_gains`` are those from x to z.

    Below the resonance z = y - x goes with x and grows as the square of the frequency. Above it, or where the link floats in its
    play, it goes against x but falls towards -x.
    """
    bands = [(low, gain) for low, coherence, gain in gains if coherence > GOES_WITH and abs(np.angle(-gain)) < AGAINST]
    for (low, gain), (next_low, next_gain) in itertools.pairwise(bands):
        grows = abs(next_gain / gain)
        if next_low == 2 * low and GROWS[0] < grows < GROWS[1] and abs(next_gain) < 0.8:
            what = "grows against x with the frequency, as x - y does and y - x does not"
            return [Finding("sign", ASK, "z", what, "--sign z", size=-1.0)]
    return []


def slow_gain(gains: list[Gain]) -> tuple[float, float] | None:
    """The factor by which y follows x in the slowest motion there is, and how well it is known; None where it does not follow.

    Two neighbouring bands of an octave, from the slowest on that holds a hundredth of x's power, must be coherent, in step, and
    show the same factor. The share by which they differ, at least `NEAR`, is what play and resonance leave open.
    """
    bands = gains[:2]
    if len(bands) < 2 or bands[1][0] != 2 * bands[0][0]:
        return None
    for _, coherence, gain in bands:
        lag = abs(np.angle(gain if gain.real > 0 else -gain))
        if coherence < COHERENT or lag > IN_STEP:
            return None
    slow, next_ = bands[0][2], bands[1][2]
    if not 1 / FLAT < abs(next_ / slow) < FLAT or slow.real * next_.real < 0:
        return None
    return float(slow.real), max(NEAR, abs(float(next_.real / slow.real) - 1.0))


def octave_gains(x: np.ndarray, y: np.ndarray) -> list[Gain]:
    """First line, coherence and gain from x to y of every octave that holds a hundredth of x's power."""
    size = min(x.size, SAMPLES)
    size -= size % FAST if size > 4 * FAST else 0
    window = np.hanning(size)
    fx, fy = (np.fft.rfft(window * (values[:size] - np.mean(values[:size]))) for values in (x, y))
    power, other = np.abs(fx) ** 2, np.abs(fy) ** 2
    least = 0.01 * float(np.sum(power[2:]))
    found = []
    low = 3  # the lines below hold what the window makes of a mean and a trend
    while 2 * low < fx.size:
        band = slice(low, 2 * low)
        mine, its = float(np.sum(power[band])), float(np.sum(other[band]))
        if mine > least and its > 0.0:
            cross = complex(np.sum(fy[band] * np.conj(fx[band])))
            found.append((low, abs(cross) ** 2 / (mine * its), cross / mine))
        low *= 2
    return found
