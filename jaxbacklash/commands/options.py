"""Options that several commands share, as typer reads them: `jaxbacklash.cli` declares its commands with them.

Nothing here waits for a library: ``--help`` is quick.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from ..errors import BadInput


def there(found: Any) -> Any:
    """The path or paths given, if there is something: a wrong name need not wait for libraries to load."""
    from .doors import state_of

    for path in found if isinstance(found, list) else [found]:
        if path is not None and state_of(path) is None:
            raise BadInput(f"{path}: found no such file, wanted a record.")
    return found


def there_or_each(context: typer.Context, found: Any) -> Any:
    """`there`; of many records a missing one is a row of the table and stops nothing."""
    return found if context.params.get("each") else there(found)


def only_with_each(each: bool, of_each: dict[str, Any], of_one: dict[str, Any]) -> bool:
    """``each``, once it is seen that no option was given that means nothing with or without it."""
    odd = next((name for name, given in (of_one if each else of_each).items() if given not in (None, False)), None)
    if odd is not None:
        raise BadInput(f"{odd}: {'is not for many records' if each else 'is for many records, each by itself'}; "
                       f"leave it out, or {'--each' if each else 'add --each'}")  # fmt: skip
    return each


def one_record(records: list[Path]) -> Path:
    """The record of a command that takes one."""
    if len(records) > 1:
        raise BadInput(f"{records[1]}: is a second record, wanted one, or --each for many, each by itself")
    return records[0]


EFFECTS = (
    "asymmetric_gap, asymmetric_stiffness, bouc_wen, clock_drift, cogging, contact_damping, contact_exponent, "
    "coulomb_ground, coulomb_joint, coulomb_motor, cubic_stiffness, dahl, damping_drift, disturbance, flexible_link, "
    "friction_drift, gap_drift, gap_spring, gravity, hunt_crossley, learned_torque, linear_gravity, load_friction, lugre, "
    "preload, quadratic_drag, relaxation, second_play, sensor_delay, sensor_filter, sensor_gain, sensor_offset, "
    "stiffness_drift, stribeck, torque_ripple, transmission_error"
)
"""What ``jaxbacklash.catalogue()`` lists, for a help that waits for no library; a test compares the two."""
MODELS = "joint (play, contact stiffness, damping), linear (a spring without play), free (damping alone), or a file FILE.toml"
Model = Annotated[str, typer.Option("--model", help=f"What the fit begins with: {MODELS}")]
Inertia = Annotated[
    float | None,
    typer.Option("--inertia", help="Inertia of the link about its joint [kg m^2; kg]; without it values are per unit inertia"),
]
Out = Annotated[Path | None, typer.Option("--out", help="Folder for result.json, model.toml and report.html")]
Json = Annotated[bool, typer.Option("--json", help="Print the machine-readable result and nothing else")]
Seed = Annotated[int, typer.Option("--seed", help="Seed of everything random")]
NoSeed = Annotated[int, typer.Option("--seed", help="Changes nothing: this search draws nothing at random")]
Window = Annotated[
    float | None,
    typer.Option(
        "--window", help="Length of the windows whose prediction error is quoted [s]; default 0.2 s, or 32 samples if longer"
    ),
]
Translation = Annotated[bool, typer.Option("--translation", help="The record is of a translating mass: m, kg, N")]
Laws = Annotated[Path | None, typer.Option("--laws", help="A Python file with effect classes of your own")]
Heldout = Annotated[
    Path | None, typer.Option("--heldout", callback=there, help="A record to predict with the fitted parameters frozen")
]
Each = Annotated[
    bool,
    typer.Option("--each", is_eager=True, help="Each record by itself, all cores; a folder stands for its files. See --out"),
]
Cluster = Annotated[
    str | None, typer.Option("--cluster", help="With --each: address of a dask scheduler whose workers do it, as tcp://host:8786")
]
Workers = Annotated[int | None, typer.Option("--workers", help="With --each: processes of this machine; default one a core")]
SlowRecord = Annotated[
    Path,
    typer.Argument(
        callback=there,
        help="A slow record: t with x and z, y or link (two positions), F and z (pulled, F of -1, 0, 1), or T and z (a loop)",
    ),
]
WindUp = Annotated[
    float | None,
    typer.Option("--wind-up", help="Elastic wind-up in the lost motion, both ways together [rad; m], where known"),
]
Excitation = Annotated[
    str,
    typer.Option(
        "--excitation",
        help="harmonic:amplitude=,frequency= | chirp:amplitude=,f0=,f1= | multisine:amplitude=,low=,high=,lines= | "
        "stepped:amplitude=,low=,high=,steps= | rest | FILE of a record whose x or F is used; amplitudes in rad, "
        "or in N m with --force",
    ),
]
