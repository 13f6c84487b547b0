"""How motor and link of a drive go together: the gear's ratio, and an encoder mounted the other way round; and a command.

In slow motion the link follows the motor at 1/N whatever the play (`relations.slow_gain`), so that a record of both encoders
shows N, up to the play's share of the motion. A servo's motor follows its command likewise.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from jaxbacklash.records.finding import ASK, Finding
from jaxbacklash.records.options import ReadOptions

from .relations import LIKE_ONE, octave_gains, of_teeth, slow_gain

GOES_ALONG = 0.9
"""Share of the link's power that goes with the motor's from which on the two tell the gear between them."""


def drives(channels: Mapping[str, np.ndarray], options: ReadOptions) -> list[Finding]:
    """What is odd about motor and link of a drive; ``channels`` of arrays (N,), in rad and N m."""
    if not {"torque", "command"} & set(channels):
        return []
    shown = _shown(channels, "motor", "link")
    if options.ratio is None:
        if shown is None:
            what = "a drive without its gear ratio; say --ratio N, the turns of the motor for a turn of the link"
            return [Finding("no-ratio", ASK, "", what)]
        ratio = of_teeth(abs(shown))
        what = f"follows the motor at 1/{abs(shown):.4g} in slow motion, as behind a gear"
        return [Finding("no-ratio", ASK, "link", what, f"--ratio {ratio:.4g}", size=shown)]
    if shown is None:
        return _told(channels, options.ratio)
    share = abs(shown) / options.ratio
    if not 1.0 / LIKE_ONE < share < LIKE_ONE:
        inverse = 1.0 / LIKE_ONE < abs(shown) * options.ratio < LIKE_ONE
        said = f"--ratio {options.ratio:g} {'is the inverse of that' if inverse else 'says otherwise'}"
        what = f"follows the motor at 1/{abs(shown):.4g} in slow motion, and {said}; wanted turns of the motor a turn of the link"
        return [Finding("wrong-ratio", ASK, "link", what, f"--ratio {of_teeth(abs(shown)):.4g}", size=shown)]
    if shown < 0.0:
        what = "turns against the motor in slow motion, as an encoder mounted the other way round does"
        return [Finding("turned-link", ASK, "link", what, "--sign link", size=shown)]
    return _told(channels, options.ratio)


def _told(channels: Mapping[str, np.ndarray], ratio: float) -> list[Finding]:
    """A command that is not the link's position in rad: of the motor's shaft, in another unit, or the other way round."""
    followed = _shown(channels, "command", "motor")  # the command's size for one of the motor's
    if followed is None or 1.0 / LIKE_ONE < followed * ratio < LIKE_ONE:
        return []
    if -LIKE_ONE < followed * ratio < -1.0 / LIKE_ONE:
        what = "is followed by the motor the other way round"
        return [Finding("command", ASK, "command", what, "--sign command", size=followed)]
    what = (
        f"is followed by the motor at {1.0 / followed:.4g} turns a turn, and --ratio is {ratio:g}; wanted the position of the link in "
        "rad, to which one of the motor's shaft is brought by --scale command=1/N"
    )
    at_motor = 1.0 / LIKE_ONE < followed < LIKE_ONE
    return [Finding("command", ASK, "command", what, f"--scale command={1.0 / ratio:.6g}" if at_motor else "", size=followed)]


def _shown(channels: Mapping[str, np.ndarray], leads: str, follows: str) -> float | None:
    """Size of one channel for one of another that follows it in slow motion, negative where they go against each other: turns of
    the motor for a turn of the link, with these two."""
    if not {leads, follows} <= set(channels):
        return None
    found = slow_gain(octave_gains(channels[leads], channels[follows]))
    if found is not None:
        return 1.0 / found[0] if found[0] else None
    # A few sines fill no two octaves; where nearly all of the one's motion goes with the other's, that tells as well.
    motor, link = (channels[name] - np.mean(channels[name]) for name in (leads, follows))
    together = float(motor @ link)
    share = together**2 / max(float(motor @ motor) * float(link @ link), 1e-300)
    return float(motor @ motor) / together if share > GOES_ALONG else None
