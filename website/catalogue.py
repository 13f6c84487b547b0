"""The page of effects: each law with its parameters and its picture, from the package, CONVENTIONS.md and `website.pictures`."""

from __future__ import annotations

import dataclasses
import json
import re
from pathlib import Path

import jaxbacklash as jb
from jaxbacklash.mechanics import told_apart

ROOT = Path(__file__).resolve().parents[1]
LAWS = Path(__file__).with_name("laws")
PORTS = {
    "joint": "between link and base, across the joint", "ground": "between link and surroundings",
    "motor": "on the motor of a drive, before its gear", "play": "it changes the play", "sensor": "it changes what is measured",
}  # fmt: skip
GROUPS = {
    "Loads on the link": ("gravity", "linear_gravity", "preload", "torque_ripple", "disturbance", "quadratic_drag"),
    "Shape of the play and of the contact": (
        "gap_spring",
        "asymmetric_gap",
        "transmission_error",
        "asymmetric_stiffness",
        "cubic_stiffness",
        "contact_exponent",
    ),
    "Wear and warming": ("gap_drift", "stiffness_drift", "damping_drift", "friction_drift"),
    "Damping of the contact": ("contact_damping", "hunt_crossley", "relaxation"),
    "Dry friction": ("coulomb_joint", "coulomb_ground", "stribeck", "load_friction"),
    "Friction that gives before it slips": ("dahl", "lugre", "bouc_wen"),
    "Structure": ("flexible_link", "second_play"),
    "The motor of a drive": ("coulomb_motor", "cogging"),
    "The measuring chain": ("sensor_delay", "clock_drift", "sensor_filter", "sensor_gain", "sensor_offset"),
    "A law from data": ("learned_torque",),
}
HEAD = """# Effects

What a joint may do beyond play, contact stiffness and damping. Add one by name, `--effects gravity`, or let
[`refine`](refine.md) look for it. `T` is the torque on the link, as in the [conventions](conventions.md); `jaxbacklash fit
--help` and `jaxbacklash.catalogue()` list the names.

Each picture is of one joint (inertia 3.16 kg m^2, play 0.026 rad, stiffness 13000 N m/rad, damping 12 N m s/rad) with that
law in it, shaken as the demo's was for 8 s. **Left**, the restoring torque without the law (grey) and with it, the damper
left out; where the law acts between link and surroundings, over y with the joint in the middle of its play. **Right**, the
torque that the base model misses once play, stiffness and damping have been fitted without the law: what its absence leaves.
The numbers under it say how large that error is, and how far the fitted play, stiffness and damping are off because of it.
`python -m website.pictures` makes them all.
"""


def page() -> str:
    """The page as Markdown, pictures within it so that they take the colours of the page."""
    rows, numbers = conventions(), json.loads((LAWS / "numbers.json").read_text(encoding="utf-8"))
    parts = [HEAD]
    for group, names in GROUPS.items():
        parts.append(f"## {group}\n")
        parts += [section(name, rows[name], numbers.get(name)) for name in names]
    return "\n".join(parts)


def conventions() -> dict[str, list[str]]:
    """The rows of the table of effects in CONVENTIONS.md by name: what it is, law, parameters, port."""
    text = (ROOT / "CONVENTIONS.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| `(\w+)` \|(.*)\|$", text, flags=re.MULTILINE)
    return {name: [cell.strip().replace("\\|", "|") for cell in re.split(r"(?<!\\)\|", rest)] for name, rest in rows}


def section(name: str, row: list[str], numbers: dict[str, float | None] | None) -> str:
    """One law: what it is, the law, its parameters, its picture and the numbers under it."""
    what, law, _, port = row
    acts = f". It acts {PORTS[port]}.\n" if port in ("joint", "ground", "motor") else f": {PORTS[port]}.\n"
    text = [f"### {name}\n", f"{what[:1].upper()}{what[1:]}{acts}", f"`{law}`\n"]
    only = jb.catalogue()[name].motions
    if len(only) == 1:
        text.append(f"Only for a {only[0]} link: `refine` and `diagnose` do not propose it for any other.\n")
    text.append(parameters(name))
    text.append(taken_for(name))
    picture = LAWS / f"{name}.svg"
    if picture.exists():
        opening = f'<figure class="law" tabindex="0" role="group" aria-label="Picture of {name}">'  # a keyboard can scroll it
        text.append(f"{opening}\n{picture.read_text(encoding='utf-8')}</figure>\n")
    if numbers:
        text.append(f'<p class="law-numbers">{left_over(numbers)}</p>\n')
    return "\n".join(text)


def taken_for(name: str) -> str:
    """For which laws a law is taken or which are taken for it, and what a record must hold to tell them apart."""
    laws = jb.catalogue()
    pairs = {other: apart for other in laws if (apart := told_apart(name, other)) is not None}
    if not pairs:
        return ""
    rows = [f"| `{other}` | {apart} |" for other, apart in pairs.items()]
    return "\n".join(["| is taken for, or taken instead of | to tell them apart a record needs |", "|---|---|", *rows]) + "\n"


def parameters(name: str) -> str:
    """The parameters of a law with unit and the value at which it vanishes."""
    law = jb.catalogue()[name]
    rows = []
    for field in dataclasses.fields(law):
        if (spec := field.metadata.get("spec")) is not None:
            null = "none: it gives the law its shape" if spec.null is None else f"{spec.null:g}"
            if spec.usual is not None:
                null = f"none: held at {spec.usual:g} unless a model has another value"
            rows.append(f"| `{name}.{field.name}` | {spec.unit} | {'stated, never fitted' if spec.fixed else null} |")
    if not rows:
        return ""
    return "\n".join(["| parameter | unit | vanishes at |", "|---|---|---|", *rows]) + "\n"


def left_over(numbers: dict[str, float | None]) -> str:
    """What is left without the law, as a sentence."""
    moved = ", ".join(
        f"{name} {numbers[name]:+.2g} %" if numbers[name] is not None else f"{name} not determined"
        for name in ("backlash", "stiffness", "damping")
    )
    return (
        f"Without it the prediction error is {numbers['rms_over_noise']:.3g} times the noise; fitted values are off by: {moved}."
    )
