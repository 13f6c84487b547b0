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
_MOTION = (
    "motor and link without a torque: it tells the play, and stiffness and damping per unit of the link's inertia unless "
    "--inertia gives it; nothing of the motor"
)


def tells(channels: Collection[str], *, geared: bool) -> list[str]:
    """What the columns of a drive tell, one sentence; none of a record that is no drive's.

    Parameters
    ----------
    channels : names of a record's channels
    geared : whether a gear's ratio is known, which makes base and link of a record of base motion a motor and its link

    Examples
    --------
    >>> tells(["x", "z"], geared=False)
    []
    >>> tells(["x", "y"], geared=True)[0]
    'motor and link without a torque: it tells the play, and stiffness and damping per unit ...'
    """
    own = frozenset(channels)
    if "command" in own:
        return [_COMMAND]
    if geared and own == {"x", "y"}:
        return [_MOTION]
    return [_TOLD[own]] if own in _TOLD else []
