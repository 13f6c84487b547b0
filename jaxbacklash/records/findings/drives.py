"""How motor and link of a drive go together: the gear's ratio, and an encoder mounted the other way round; and a command.

In slow motion the link follows the motor at 1/N whatever the play (`relations.slow_gain`), so that a record of both encoders
shows N, up to the play's share of the motion.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from jaxbacklash.records.finding import ASK, Finding
from jaxbacklash.records.options import ReadOptions
from jaxbacklash.signals import Bump

from .relations import LIKE_ONE, octave_gains, of_teeth, slow_gain

GOES_ALONG = 0.9
"""Share of the link's power that goes with the motor's from which on the two tell the gear between them."""
UNLIKE = 0.02
"""Share of a command's power that motion does not explain from which on nothing is said of its size: its servo was limited, or it
is something else."""


def drives(t: np.ndarray, channels: Mapping[str, np.ndarray], options: ReadOptions) -> list[Finding]:
    """What is odd about motor and link of a drive at the times ``t`` (N,) [s]; ``channels`` of arrays (N,), in rad and N m."""
    if not {"torque", "command"} & set(channels):
        return []
    shown = _shown(channels)
    if options.ratio is None:
        if shown is None:
            what = "a drive without its gear ratio; say --ratio N, the turns of the motor for a turn of the link"
            return [Finding("no-ratio", ASK, "", what)]
        ratio = of_teeth(abs(shown))
        what = f"follows the motor at 1/{abs(shown):.4g} in slow motion, as behind a gear"
        return [Finding("no-ratio", ASK, "link", what, f"--ratio {ratio:.4g}", size=shown)]
    if shown is None:
        return _told(t, channels, options.ratio)
    share = abs(shown) / options.ratio
    if not 1.0 / LIKE_ONE < share < LIKE_ONE:
        inverse = 1.0 / LIKE_ONE < abs(shown) * options.ratio < LIKE_ONE
        said = f"--ratio {options.ratio:g} {'is the inverse of that' if inverse else 'says otherwise'}"
        what = f"follows the motor at 1/{abs(shown):.4g} in slow motion, and {said}; wanted turns of the motor a turn of the link"
        return [Finding("wrong-ratio", ASK, "link", what, f"--ratio {of_teeth(abs(shown)):.4g}", size=shown)]
    if shown < 0.0:
        what = "turns against the motor in slow motion, as an encoder mounted the other way round does"
        return [Finding("turned-link", ASK, "link", what, "--sign link", size=shown)]
    return _told(t, channels, options.ratio)


def _told(t: np.ndarray, channels: Mapping[str, np.ndarray], ratio: float) -> list[Finding]:
    """A command that is not the link's position in rad: of the motor's shaft, in another unit, or the other way round.

    What a servo is told is where its motor is, and beside it what is in proportion to speed and accelerations: of these the
    command is made by least squares under bumps.
    """
    if "command" not in channels or not np.ptp(channels["command"]):
        return []
    bump = Bump(t.size, float(t[-1] - t[0]) / (t.size - 1))
    told, motor = bump.against(channels["command"]), channels["motor"]
    steady = bump.against(np.ones(t.size))
    columns = [bump.against(motor), steady, bump.against(motor, 1), bump.against(motor, 2)]
    columns += [bump.against(channels["link"], 2)] if "link" in channels else []
    scales = [max(float(np.linalg.norm(column)), 1e-300) for column in columns]
    own = np.stack([column / scale for column, scale in zip(columns, scales)], axis=1)
    made = np.linalg.lstsq(own, told, rcond=None)[0]
    level = told - steady * (steady @ told) / (steady @ steady)
    rest, followed = told - own @ made, made[0] / scales[0] * ratio
    unlike = float(rest @ rest) > UNLIKE * float(level @ level)
    if unlike or 1.0 / LIKE_ONE < followed < LIKE_ONE:
        return []
    if -LIKE_ONE < followed < -1.0 / LIKE_ONE:
        what = "is followed by the motor the other way round"
        return [Finding("command", ASK, "command", what, "--sign command", size=followed)]
    what = (
        f"is {abs(followed):.4g} times the place to which the motor goes behind a gear of {ratio:g}; wanted the position of the "
        "link in rad, to which one of the motor's shaft is brought by --scale command=1/N"
    )
    remedy = f"--scale command={1.0 / ratio:.6g}" if ratio / LIKE_ONE < followed < ratio * LIKE_ONE else ""
    return [Finding("command", ASK, "command", what, remedy, size=followed)]


def _shown(channels: Mapping[str, np.ndarray]) -> float | None:
    """Turns of the motor for a turn of the link as the record shows them, negative where they turn against each other."""
    if not {"motor", "link"} <= set(channels):
        return None
    found = slow_gain(octave_gains(channels["motor"], channels["link"]))
    if found is not None:
        return 1.0 / found[0] if found[0] else None
    # A few sines fill no two octaves; where nearly all of the link's motion goes with the motor's, that tells as well.
    motor, link = (channels[name] - np.mean(channels[name]) for name in ("motor", "link"))
    together = float(motor @ link)
    share = together**2 / max(float(motor @ motor) * float(link @ link), 1e-300)
    return float(motor @ motor) / together if share > GOES_ALONG else None
