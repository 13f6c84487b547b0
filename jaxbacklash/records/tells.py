"""What a drive's record can tell and what it cannot, from its columns alone: said as it is read, before anything is fitted.

After a fit `jaxbacklash.fitting.estimates` says the same again of each parameter, from the record's own values.
"""

from __future__ import annotations

from collections.abc import Collection

_BOTH = "it tells inertia and friction of the motor, inertia of the link, stiffness, damping and the play"
_TOLD = {
    frozenset({"torque", "motor", "link"}): f"torque and both encoders: {_BOTH}, and at which of them friction acts",
    frozenset({"torque", "motor"}): (
        f"torque and the motor's encoder: {_BOTH}, as the motor feels them; in slow motion it does not tell friction of the "
        "motor from that of the joint, for which an encoder on the link is needed"
    ),
    frozenset({"torque", "link"}): (
        f"torque and the link's encoder: {_BOTH}, ten to a hundred times less sharply than with the motor's encoder, and not at "
        "which of them friction acts"
    ),
}
_COMMAND = (
    "a command in the place of a torque: the servo's gains, friction, inertia of the link, stiffness and damping are told per "
    "unit of the motor's inertia, the play as it is; no torque of a known size is in the record"
)


def tells(channels: Collection[str]) -> list[str]:
    """What the columns of a drive tell, one sentence; none of a record that is no drive's.

    Parameters
    ----------
    channels : names of a record's channels

    Examples
    --------
    >>> tells(["x", "z"])
    []
    >>> tells(["torque", "motor", "link"])[0][:25]
    'torque and both encoders:'
    """
    own = frozenset(channels)
    if "command" in own:
        return [_COMMAND]
    return [_TOLD[own]] if own in _TOLD else []
