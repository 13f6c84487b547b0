"""What a model is handed on as, and what no target can carry: each law is written exactly, or the model is refused.

Between `jaxbacklash.model_file`, which reads the model, and `jaxbacklash.commands.export`, which writes what comes of it.
"""

from __future__ import annotations

from ..effects import Servo
from ..errors import BadInput
from ..system import System
from .mjcf import LAWS as LAWS_OF_MJCF
from .mjcf import mjcf
from .modelica import LAWS as LAWS_OF_MODELICA
from .modelica import modelica

TARGETS = {"mjcf": (mjcf, LAWS_OF_MJCF), "modelica": (modelica, LAWS_OF_MODELICA)}


def exported(system: System, target: str) -> str:
    """The text of a model file for another simulator.

    Parameters
    ----------
    system : a joint with play or a spring whose base is held, or a drive
    target : ``"mjcf"`` (MuJoCo) or ``"modelica"`` (Modelica Standard Library)

    Returns
    -------
    str
        XML of MuJoCo, or a Modelica model.

    Raises
    ------
    BadInput
        A target that is not known, or a model that it cannot carry: one whose base moves as prescribed, or with a law that has no
        exact place there.

    Examples
    --------
    >>> rig = jb.drive(4e-5, 9e-5, 50.0, inertia=0.05, backlash=0.0126, stiffness=860.0, damping=0.7)
    >>> jb.exported(rig, "mjcf").splitlines()[0]
    '<mujoco model="jaxbacklash">'
    """
    if target not in TARGETS:
        raise BadInput(f"--to {target}: not a target, wanted {' or '.join(TARGETS)}")
    write, laws = TARGETS[target]
    if system.motor is None and system.observed == "z":
        raise BadInput(
            f"--to {target}: the base of this model moves as prescribed (observed is z), and {target} has no body that moves so; "
            "wanted a drive, or a model whose observed is y, with a base that is held"
        )
    if system.observed == "T":
        raise BadInput(
            f"--to {target}: the base of this model moves as prescribed (observed is T); wanted a drive, or observed y"
        )
    if isinstance(system.motor, Servo):
        raise BadInput(
            f"--to {target}: the motor of this model follows a command by a servo (Kp, Kd), and what is handed on is driven by "
            "its torque; take them out of the model file and write the servo there, or keep to jaxbacklash simulate"
        )
    if system.contact is None:
        raise BadInput(f"--to {target}: the model has no joint (no stiffness), so that there is nothing to hand on")
    unknown = sorted(set(system.effects) - set(laws))
    if unknown:
        raise BadInput(
            f"--to {target}: {unknown[0]} has no exact place in {target}, which carries {', '.join(sorted(laws))}; take it out "
            "of the model file, or keep to jaxbacklash simulate"
        )
    return write(system)
