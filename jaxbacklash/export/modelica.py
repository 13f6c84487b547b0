r"""Modelica: inertias, an ideal gear and an ElastoBacklash of the Modelica Standard Library, connected at their flanges.

The library's ElastoBacklash damps in contact alone, and never pulls; the damper of the joint stands beside it, so that
:math:`T = k \delta(z) + c \dot z` is kept, in the play as in contact. Dry friction is BearingFriction against the
housing; that of the joint has no exact place.

Source: Modelica Standard Library 4.0, Modelica.Mechanics.Rotational.
"""

from __future__ import annotations

from ..parameters import values
from ..system import System
from .numbers import edges, number

LAWS = ("asymmetric_gap", "coulomb_ground", "coulomb_motor", "gap_spring", "gravity", "preload")
"""Laws that have a place in the library's components."""
R = "Modelica.Mechanics.Rotational"


def modelica(system: System) -> str:
    """The text of a Modelica model of a system that `jaxbacklash.export.exported` has looked at.

    Its input is ``torque`` at the motor [N m] of a drive, else ``F`` on the link; ``link.phi`` and ``motor.phi`` are the angles.
    """
    has, (low, high) = values(system), edges(system)
    get = lambda name: number(float(has.get(name, 0.0)))  # noqa: E731
    drive, middle = system.motor is not None, 0.5 * (low + high)
    source, driven = ("torque", "motor") if drive else ("F", "link")
    parts = [
        f'Modelica.Blocks.Interfaces.RealInput {source} "N m, {"at the motor" if drive else "on the link"}"',
        f"{R}.Sources.Torque source",
        f"{R}.Components.Inertia link(J={get('inertia')})",
        # Half of the play on either side of phi_rel0.
        f"{R}.Components.ElastoBacklash contact(c={get('stiffness')}, d=0, b={number(high - low)}, phi_rel0={number(middle)})",
        f"{R}.Components.Damper damping(d={get('damping')})",
    ]
    joins = [(source, "source.tau"), ("source.flange", f"{driven}.flange_a" if drive else "link.flange_b")]
    base = "gear.flange_b"
    if drive:
        parts += [
            f"{R}.Components.Inertia motor(J={get('motor_inertia')})",
            f"{R}.Components.Damper motorDamping(d={get('motor_damping')})",
            f"{R}.Components.IdealGear gear(ratio={get('ratio')})",
        ]
        joins += [
            ("motor.flange_b", "gear.flange_a"),
            ("motor.flange_b", "motorDamping.flange_a"),
            ("motorDamping.flange_b", "held.flange"),
        ]
    else:
        base = "held.flange"
    parts += [f"{R}.Components.Fixed held"]
    beside = ["contact", "damping"]
    if "gap_spring" in system.effects:
        parts += [f"{R}.Components.Spring gapSpring(c={get('gap_spring.k1')})"]
        beside += ["gapSpring"]
    for one in beside:
        joins += [(base, f"{one}.flange_a"), (f"{one}.flange_b", "link.flange_a")]
    loads = {
        "gravity": f"{get('gravity.G')}*sin(link.phi + {get('gravity.phi0')})",
        "preload": get("preload.T0"),
    }
    for name, law in loads.items():
        if name in system.effects:
            parts += [f"{R}.Sources.Torque {name}", f"Modelica.Blocks.Sources.RealExpression {name}Law(y={law})"]
            joins += [(f"{name}Law.y", f"{name}.tau"), (f"{name}.flange", "link.flange_b")]
    for name, at in (("coulomb_motor", "motor.flange_b"), ("coulomb_ground", "link.flange_b")):
        if name in system.effects:
            own = name.replace("_", "")
            parts += [f"{R}.Components.BearingFriction {own}(tau_pos=[0, {get(name + '.Tc')}])"]
            joins += [(at, f"{own}.flange_a")]
    return "\n".join([
        'model JointWithPlay "written by jaxbacklash; angles in rad at their own shaft"',
        *(f"  {part};" for part in parts),
        "equation",
        *(f"  connect({one}, {other});" for one, other in joins),
        "end JointWithPlay;",
        "",
    ])  # fmt: skip
