"""How motor and link of a drive go together: the gear's ratio, and an encoder mounted the other way round.

In slow motion the link follows the motor at 1/N whatever the play (`relations.slow_gain`), so that a record of both encoders
shows N, up to the play's share of the motion.
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
    if "torque" not in channels:
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
        return []
    share = abs(shown) / options.ratio
    if not 1.0 / LIKE_ONE < share < LIKE_ONE:
        inverse = 1.0 / LIKE_ONE < abs(shown) * options.ratio < LIKE_ONE
        said = f"--ratio {options.ratio:g} {'is the inverse of that' if inverse else 'says otherwise'}"
        what = f"follows the motor at 1/{abs(shown):.4g} in slow motion, and {said}; wanted turns of the motor a turn of the link"
        return [Finding("wrong-ratio", ASK, "link", what, f"--ratio {of_teeth(abs(shown)):.4g}", size=shown)]
    if shown < 0.0:
        what = "turns against the motor in slow motion, as an encoder mounted the other way round does"
        return [Finding("turned-link", ASK, "link", what, "--sign link", size=shown)]
    return []


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
