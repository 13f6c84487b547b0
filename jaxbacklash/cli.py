"""The command line: ``jaxbacklash COMMAND``. Declares the commands and turns errors into exit codes.

0 done; 2 bad input, with one sentence; 1 it ran and could not reach an answer. What a command does is in
`jaxbacklash.commands`, imported only when it is called, so that ``--help`` is quick.
"""

from __future__ import annotations

import functools
from pathlib import Path
from typing import Annotated

import typer

from .commands.checked import Checked, Computation
from .commands.options import (
    EFFECTS,
    Cluster,
    Each,
    Excitation,
    Heldout,
    Inertia,
    Json,
    Laws,
    Model,
    NoSeed,
    Out,
    Seed,
    SlowRecord,
    Translation,
    Window,
    WindUp,
    Workers,
    one_record,
    only_with_each,
    there,
    there_or_each,
)
from .commands.reading import AS_IT_IS, Reading, reads

app = typer.Typer(
    name="jaxbacklash",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    epilog="Begin with: jaxbacklash look YOUR_FILE. Each command has --help, with an example.",
)
computes = functools.partial(app.command, cls=Computation)


def tell_version(asked: bool) -> None:
    """Print name and version, and end."""
    if asked:
        from . import __version__

        print(f"jaxbacklash {__version__}")
        raise typer.Exit


@app.callback()
def program(
    version: Annotated[
        bool, typer.Option("--version", callback=tell_version, is_eager=True, help="Print the version and end")
    ] = False,
) -> None:
    """Find backlash, stiffness, damping and the missing physics of a loose joint from measured motion."""


@app.command(cls=Checked, epilog="Example: jaxbacklash look run1.csv")
@reads
def look(
    file: Annotated[Path, typer.Argument(callback=there, help="Any file with measurements")],
    reading: Reading = AS_IT_IS,
    out: Annotated[Path | None, typer.Option("--out", help="Folder for result.json and report.html")] = None,
    json: Json = False,
) -> None:
    """Look at a file: what is in it, what it seems to be, what is odd, and the command to go on with."""
    from .commands import look as command

    command.run(file, out=out, as_json=json, reading=reading)


@computes(epilog="Example: jaxbacklash fit run1.csv --inertia 3.16 --effects gravity --out fit1")
@reads
def fit(
    records: Annotated[
        list[Path],
        typer.Argument(callback=there_or_each, help="Records: CSV, npz or mat; see the README for columns"),
    ],
    inertia: Inertia = None,
    model: Model = "joint",
    effects: Annotated[str | None, typer.Option("--effects", help=f"Effects to add, some of: {EFFECTS}")] = None,
    laws: Laws = None,
    heldout: Heldout = None,
    out: Out = None,
    json: Json = False,
    reading: Reading = AS_IT_IS,
    window: Window = None,
    starts: Annotated[int, typer.Option("--starts", help="How many starting points are tried")] = 4,
    profile: Annotated[bool, typer.Option("--profile", help="Intervals from the profile likelihood (slower)")] = False,
    translation: Translation = False,
    seed: Seed = 0,
    each: Each = False,
    cluster: Cluster = None,
    workers: Workers = None,
) -> None:
    """Fit backlash, stiffness and damping (and effects you name) to one or more records: all as one, or each by itself."""
    if only_with_each(each, {"--cluster": cluster, "--workers": workers}, {"--profile": profile}):
        from .commands import each as many

        many.run(
            "fit", records, inertia=inertia, model=model, effects=effects, laws=laws, heldout=heldout, out=out, as_json=json,
            reading=reading, window=window, starts=starts, translational=translation, seed=seed, cluster=cluster, workers=workers,
        )  # fmt: skip
        return
    from .commands import fit as command
    from .commands.common import load_laws

    load_laws(laws)
    command.run(
        records, inertia=inertia, model=model, effects=effects, heldout=heldout, out=out, as_json=json,
        reading=reading, window=window, starts=starts, profile=profile,
        translational=translation, seed=seed,
    )  # fmt: skip


@computes(epilog="Example: jaxbacklash compare fit1/model.toml run2.csv --out compare2")
@reads
def compare(
    model: Annotated[Path, typer.Argument(help="A model file (TOML), as written by fit")],
    record: Annotated[Path, typer.Argument(callback=there, help="A record")],
    laws: Laws = None,
    out: Out = None,
    json: Json = False,
    reading: Reading = AS_IT_IS,
    window: Window = None,
    translation: Translation = False,
    seed: Seed = 0,
) -> None:
    """Compare a model with a record it may never have seen: where does it fail, and by how many noises?"""
    from .commands import compare as command
    from .commands.common import load_laws

    load_laws(laws)
    command.run(
        model, record, out=out, as_json=json, reading=reading,
        window=window, translational=translation,
    )  # fmt: skip


@computes(epilog="Example: jaxbacklash diagnose run1.csv --inertia 3.16 --out why1")
@reads
def diagnose(
    record: Annotated[Path, typer.Argument(callback=there, help="A record: CSV, npz or mat")],
    inertia: Inertia = None,
    model: Model = "joint",
    effects: Annotated[str | None, typer.Option("--effects", help=f"Effects the model has already, some of: {EFFECTS}")] = None,
    laws: Laws = None,
    out: Out = None,
    json: Json = False,
    reading: Reading = AS_IT_IS,
    window: Window = None,
    starts: Annotated[int, typer.Option("--starts", help="How many starting points are tried")] = 4,
    translation: Translation = False,
    seed: Seed = 0,
) -> None:
    """Fit a model, say where it fails, and show the torque it misses and what that depends on."""
    from .commands import diagnose as command
    from .commands.common import load_laws

    load_laws(laws)
    command.run(
        record, inertia=inertia, model=model, effects=effects, out=out, as_json=json,
        reading=reading, window=window, starts=starts, translational=translation, seed=seed,
    )  # fmt: skip


@computes(epilog="Example: jaxbacklash refine run1.csv --heldout run2.csv --inertia 3.16 --out found1")
@reads
def refine(
    records: Annotated[list[Path], typer.Argument(callback=there_or_each, help="A record: CSV, npz or mat; with --each, many")],
    heldout: Heldout = None,
    inertia: Inertia = None,
    model: Model = "joint",
    laws: Laws = None,
    out: Out = None,
    json: Json = False,
    reading: Reading = AS_IT_IS,
    window: Window = None,
    translation: Translation = False,
    seed: NoSeed = 0,
    each: Each = False,
    cluster: Cluster = None,
    workers: Workers = None,
) -> None:
    """Find the effects a record needs beyond the base model, add them one by one, and say what is left."""
    if only_with_each(each, {"--cluster": cluster, "--workers": workers}, {}):
        from .commands import each as many

        many.run(
            "refine", records, inertia=inertia, model=model, laws=laws, heldout=heldout, out=out, as_json=json,
            reading=reading, window=window, translational=translation, seed=seed, cluster=cluster, workers=workers,
        )  # fmt: skip
        return
    record = one_record(records)
    from .commands import refine as command
    from .commands.common import load_laws

    load_laws(laws)
    command.run(
        record, heldout=heldout, inertia=inertia, model=model, out=out, as_json=json,
        reading=reading, window=window, translational=translation, seed=seed,
    )  # fmt: skip


@computes(epilog="Example: jaxbacklash skeleton sweep1.csv --inertia 3.16 --out skeleton1")
@reads
def skeleton(
    record: Annotated[
        Path, typer.Argument(callback=there, help="A record of a sweep, a steady or modulated sine, or a free decay")
    ],
    inertia: Inertia = None,
    gravity: Annotated[float, typer.Option("--gravity", help="m g L / J of the link [1/s^2], positive upright")] = 0.0,
    out: Annotated[Path | None, typer.Option("--out", help="Folder for result.json and report.html")] = None,
    json: Json = False,
    reading: Reading = AS_IT_IS,
    translation: Translation = False,
    seed: Seed = 0,
) -> None:
    """Play, stiffness and damping from envelopes and phases: Hilbert transform and wavelet, which stand beside the fit."""
    from .commands import skeleton as command

    command.run(
        record, inertia=inertia, gravity=gravity, out=out, as_json=json, reading=reading, translational=translation,
    )  # fmt: skip


@app.command("lost-motion", cls=Checked, epilog="Example: jaxbacklash lost-motion slow1.csv --ratio 35 --out slow1")
@reads
def lost_motion(
    record: SlowRecord,
    wind_up: WindUp = None,
    out: Annotated[Path | None, typer.Option("--out", help="Folder for result.json and report.html")] = None,
    json: Json = False,
    reading: Reading = AS_IT_IS,
    translation: Translation = False,
) -> None:
    """Read the play of a slow record without dynamics: where friction carries the link, a force pulls it, or a torque loads
    it."""
    from .commands import lost_motion as command

    command.run(record, wind_up=wind_up, out=out, as_json=json, reading=reading, translational=translation)


@computes(epilog="Example: jaxbacklash chaos run1.csv --channel z --out chaos1")
@reads
def chaos(
    record: Annotated[
        Path, typer.Argument(callback=there, help="A table with even times and the channel to judge: CSV, npz or mat")
    ],
    channel: Annotated[str | None, typer.Option("--channel", help="The channel or column to judge; default z, else y")] = None,
    out: Annotated[Path | None, typer.Option("--out", help="Folder for result.json and report.html")] = None,
    json: Json = False,
    reading: Reading = AS_IT_IS,
    surrogates: Annotated[str, typer.Option("--surrogates", help="Kind of surrogates: iaaft, aaft or fourier")] = "iaaft",
    count: Annotated[int, typer.Option("--surrogate-count", help="How many surrogates; 39 reach p = 0.025")] = 39,
    clean: Annotated[bool, typer.Option("--clean/--no-clean", help="Take noise off as well, for dimension and exponent")] = True,
    seed: Seed = 0,
) -> None:
    """Is a measured series chaotic, how much, and why does it look so? Verdict, exponent with interval, pictures."""
    from .commands import chaos as command

    command.run(
        record, channel=channel, out=out, as_json=json,
        reading=reading, surrogates=surrogates, count=count, clean=clean, seed=seed,
    )  # fmt: skip


@computes(epilog="Example: jaxbacklash simulate fit1/model.toml --excitation chirp:amplitude=0.07,f0=0,f1=12 --out sim.csv")
def simulate(
    model: Annotated[Path, typer.Argument(help="A model file (TOML)")],
    out: Annotated[Path, typer.Option("--out", help="Record to write: .csv, .npz or .mat")],
    excitation: Excitation = "chirp:amplitude=0.07,f0=0,f1=12",
    laws: Laws = None,
    force: Annotated[bool, typer.Option("--force", help="The excitation is a force or torque on the link")] = False,
    duration: Annotated[float, typer.Option("--duration", help="Length [s]")] = 30.0,
    rate: Annotated[float, typer.Option("--rate", help="Samples per second [Hz]")] = 500.0,
    noise: Annotated[float, typer.Option("--noise", help="Noise added to every motion channel, std [rad]")] = 0.0,
    y0: Annotated[float | None, typer.Option("--y0", help="Start of the link [rad]; default: at the base")] = None,
    dy0: Annotated[float | None, typer.Option("--dy0", help="Start speed of the link [rad/s]")] = None,
    json: Json = False,
    seed: Seed = 0,
) -> None:
    """Simulate a model and write what a measurement of it would look like."""
    from .commands import simulate as command
    from .commands.common import load_laws

    load_laws(laws)
    command.run(
        model, out=out, excitation=excitation, as_force=force, duration=duration, rate=rate, noise=noise, y0=y0, dy0=dy0,
        as_json=json, seed=seed,
    )  # fmt: skip


@app.command(cls=Checked, epilog="Example: jaxbacklash export drive1/model.toml --to mjcf --out joint.xml")
def export(
    model: Annotated[Path, typer.Argument(help="A model file (TOML)")],
    to: Annotated[str, typer.Option(help="mjcf (MuJoCo) or modelica")],
    out: Annotated[Path | None, typer.Option(help="File to write; default the standard output")] = None,
    json: Json = False,
) -> None:
    """Hand a fitted model on to another simulator, or say what that one cannot carry."""
    from .commands.export import run

    run(model, to=to, out=out, as_json=json)


@computes("map", epilog="Example: jaxbacklash map --inverse-alpha 1:5:256 --zeta 0.005:0.03:64 --out case1.nc")
def map_(
    case: Annotated[int, typer.Option("--case", help="The paper's CASE 1 or 2, in dimensionless form")] = 1,
    inverse_alpha: Annotated[
        str | None, typer.Option("--inverse-alpha", help="k_0 x_0 / A: FROM:TO:COUNT, or one value; default: the case's own")
    ] = None,
    zeta: Annotated[str | None, typer.Option("--zeta", help="Damping ratio c / (2 m omega_0), likewise")] = None,
    omega: Annotated[str | None, typer.Option("--omega", help="Drive frequency over omega_0, likewise")] = None,
    periods: Annotated[int, typer.Option("--periods", help="Periods of the drive that are followed")] = 400,
    skip: Annotated[int, typer.Option("--skip", help="Of these, how many to leave out as transient")] = 100,
    samples: Annotated[int | None, typer.Option("--samples", help="Stroboscopic samples kept, the last ones; default 32")] = None,
    start: Annotated[str, typer.Option("--start", help="Position and speed at tau = 0 in half plays: P,V")] = "0,0",
    out: Annotated[Path, typer.Option("--out", help="netCDF file to write; a page and a picture go beside it")] = Path("map.nc"),
    json: Json = False,
    seed: Seed = 0,
) -> None:
    """Map the largest Lyapunov exponent and the period of the motion over backlash, damping and drive frequency."""
    from .commands import map as command

    command.run(
        case, inverse_alpha=inverse_alpha, zeta=zeta, omega=omega, periods=periods, skip=skip, samples=samples, start=start,
        out=out, as_json=json,
    )  # fmt: skip


@app.command(cls=Checked, epilog="Example: jaxbacklash studio run1.csv --heldout run2.csv --inertia 3.16")
@reads
def studio(
    record: Annotated[
        Path | None, typer.Argument(callback=there, help="A record to begin with; others of its folder are chosen on the page")
    ] = None,
    folder: Annotated[
        Path | None,
        typer.Option("--folder", help="The one folder that the page reads and saves in; default the record's, or this one"),
    ] = None,
    heldout: Heldout = None,
    inertia: Inertia = None,
    model: Annotated[str, typer.Option("--model", help="What the fit begins with: joint, linear or free")] = "joint",
    reading: Reading = AS_IT_IS,
    translation: Translation = False,
    port: Annotated[int, typer.Option("--port", help="Port on this machine; 0 takes a free one")] = 0,
    browser: Annotated[bool, typer.Option("--browser/--no-browser", help="Open the page in a browser")] = True,
) -> None:
    """Work at a page in the browser, on this machine alone: fit, see what is missing, add it, undo, compare, save."""
    from .commands import studio as command

    command.run(
        record, folder=folder, heldout=heldout, inertia=inertia, model=model, translational=translation, reading=reading,
        port=port, browser=browser,
    )  # fmt: skip


@computes(epilog="Example: jaxbacklash demo --out demo")
def demo(
    out: Annotated[Path, typer.Option("--out", help="Folder for what the demo makes")] = Path("jaxbacklash-demo"),
    drive: Annotated[bool, typer.Option("--drive", help="A geared motor instead: the play from its own encoder alone")] = False,
    json: Json = False,
) -> None:
    """Find what is hidden in the record that ships with the package: fit, see where it fails, add it, watch the error fall."""
    from .commands import demo as command

    (command.run_drive if drive else command.run)(out=out, as_json=json)


@computes(epilog="Example: jaxbacklash check")
def check(json: Json = False) -> None:
    """See within two minutes whether this installation computes what it should, and which extras it has."""
    from .commands import check as command

    command.run(as_json=json)


def main() -> None:
    """Run the command line; every error ends in one sentence and an exit code, see `commands.outcome`."""
    from .commands.ending import run

    run(app)


if __name__ == "__main__":
    main()
