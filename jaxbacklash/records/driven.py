"""From the columns of a drive to its channels: a current becomes a torque where the motor's torque for an ampere is known."""

from __future__ import annotations

import numpy as np

from .checks import number
from .options import ReadOptions


def as_torque(channels: dict[str, np.ndarray], options: ReadOptions, where: str) -> tuple[dict[str, np.ndarray], list[str]]:
    """The channels with a torque in the place of a current, and what is to be said of that.

    Parameters
    ----------
    channels : of arrays (N,) in SI; those without a current stay as they are
    options : its ``kt`` [N m/A]; without it the current itself stands for the torque, and all torques and inertias are per kt
    where : the file, for a sentence
    """
    if "current" not in channels:
        return channels, []
    kt = 1.0 if options.kt is None else options.kt
    found = {"torque": kt * channels["current"]} | {name: values for name, values in channels.items() if name != "current"}
    if options.kt is not None:
        return found, [f"the current is taken as a torque of {number(options.kt)} N m for an ampere"]
    return found, ["the current stands for the torque: inertias, stiffness and torques are per kt; say --kt N m/A to have them"]
