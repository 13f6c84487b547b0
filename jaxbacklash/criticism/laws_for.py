"""Which laws of the catalogue a search may propose: those that can act in the joint, and that make sense for how its link moves.

The one place where the catalogue of a search is made; `model_builder` compiles a program with these laws, the search
proposes them.
"""

from __future__ import annotations

from ..mechanics import AbstractEffect, canonical_name, catalogue, motion_of
from ..system import System


def laws_for(base: System, *, translational: bool | None = None) -> dict[str, type[AbstractEffect]]:
    """Laws that may be missing in a joint, by canonical name.

    Parameters
    ----------
    base : the joint
    translational : whether its link is a translating mass; None where it may turn or slide

    Returns
    -------
    dict
        Every law of `catalogue` that is not kept out by ``catalogued``, that `applicable` does not refuse, and whose ``motions``
        hold that of the link.

    Examples
    --------
    >>> from jaxbacklash.criticism.laws_for import laws_for
    >>> joint = jb.base_motion_joint(inertia=3.16, backlash=0.026, stiffness=15000.0, damping=20.0)
    >>> set(laws_for(joint)) - set(laws_for(joint, translational=True))
    {'gravity'}
    """
    found = {name: law for name, law in catalogue().items() if law.catalogued and applicable(law, base)}
    if translational is None:
        return found
    return {name: law for name, law in found.items() if motion_of(translational) in law.motions}


def applicable(law: type[AbstractEffect], base: System) -> bool:
    """Whether a law can act in a joint like this one, and does what the joint alone does not.

    Laws of the motor act in a drive only, whose measuring chain is taken as it is so far, and of which no law that remembers is
    proposed. Where the transmitted force is measured, friction that sticks in the joint is no
    function of the motion, the gain of the force sensor is one with the size of everything, and a low-pass remembers motion
    alone.
    """
    scaled = canonical_name(law) in ("sensor_gain", "sensor_filter")
    if base.observed == "T" and ((law.slides and law.port == "joint") or scaled):
        return False
    if law.port == "motor" and base.motor is None:
        return False
    if base.motor is not None and (law.states or law.observe is not AbstractEffect.observe or law.lag is not AbstractEffect.lag):
        return False
    kind = "free" if base.contact is None else "play" if base.has_play else "spring"
    return kind in law.joints
