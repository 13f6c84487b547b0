"""Options of every command with values at and beyond their ends."""

from __future__ import annotations

from pathlib import Path

from tests.fuzz.case import FIT, Case, good_model, good_record, kind, pick
from tests.odd_files.good import INERTIA

ENDS = ("0", "-1", "nan", "inf", "-inf", "1e300", "1e-300", "1e400", "abc", "", "1,5", "0x10", "9" * 40, "1e-320", " ", "-0")
WHOLE = ("-1", "0", "1.5", "nan", "9" * 30, "1000000000", "1e6", "abc", "", "-9223372036854775809", "18446744073709551616")
PAIRS = (
    "x", "x=", "=x", "q=1", "x=1,x=2", "x=nan", "x=0", "x=1e400", "x=-inf", ",", "", "x=1,,z=1", "t=abc", "x=deg", "x=\u2400",
    "x==", "x='", 'x="', "#1", "x=#0", "x=#99", "x=#-1", "x=#1.5", "t=x,x=t", "x=z,z=x", "t=" + "a" * 5000,
)  # fmt: skip
LISTS = ("q", "", ",", "x,x", "t", "x,y,z,F,T", "x z", "-x", "xx", "#1")

FLOATS = {
    "fit": ("--inertia", "--window", "--resample-rate", "--rate", "--ratio"),
    "diagnose": ("--inertia", "--window", "--resample-rate", "--rate"),
    "refine": ("--inertia", "--window", "--resample-rate", "--ratio"),
    "skeleton": ("--inertia", "--gravity", "--resample-rate", "--rate"),
    "chaos": ("--rate", "--resample-rate"),
    "look": ("--rate", "--resample-rate", "--ratio"),
    "simulate": ("--duration", "--rate", "--noise", "--y0", "--dy0"),
}
INTEGERS = {
    "fit": ("--starts", "--seed", "--skip"),
    "diagnose": ("--starts", "--seed"),
    "refine": ("--seed", "--skip"),
    "skeleton": ("--skip",),
    "chaos": ("--surrogate-count", "--seed", "--skip"),
    "look": ("--skip",),
    "simulate": ("--seed",),
}
COMMANDS = tuple(FLOATS)


def command(name: str, folder: Path) -> list[str]:
    """A command with its good files, which the options then spoil."""
    good_record(folder)
    good_model(folder)
    return {
        "fit": ["fit", "r.csv", *FIT],
        "diagnose": ["diagnose", "r.csv", "--inertia", str(INERTIA)],
        "refine": ["refine", "r.csv", "--inertia", str(INERTIA)],
        "skeleton": ["skeleton", "r.csv"],
        "chaos": ["chaos", "r.csv"],
        "look": ["look", "r.csv"],
        "simulate": ["simulate", "m.toml", "--out", "s.csv", "--duration", "2"],
    }[name]


@kind("options", 6)
def numbers(rng, folder: Path) -> Case:
    name = str(pick(rng, *COMMANDS, "simulate", "fit", "look"))
    words = command(name, folder)
    return Case([*words, pick(rng, *FLOATS[name]), pick(rng, *ENDS)])


@kind("options", 4)
def whole_numbers(rng, folder: Path) -> Case:
    name = str(pick(rng, *COMMANDS))
    return Case([*command(name, folder), pick(rng, *INTEGERS[name]), pick(rng, *WHOLE)])


@kind("options", 4)
def pairs(rng, folder: Path) -> Case:
    name = str(pick(rng, "fit", "diagnose", "skeleton", "chaos", "look"))
    return Case([*command(name, folder), pick(rng, "--columns", "--unit", "--scale"), pick(rng, *PAIRS)])


@kind("options", 3)
def lists_of_channels(rng, folder: Path) -> Case:
    name = str(pick(rng, "fit", "diagnose", "skeleton", "look"))
    return Case([*command(name, folder), pick(rng, "--unwrap", "--sign", "--despike"), pick(rng, *LISTS)])


@kind("options", 3)
def names_of_models_and_effects(rng, folder: Path) -> Case:
    words = [*command(str(pick(rng, "fit", "diagnose")), folder)[:2], "--inertia", str(INERTIA)]
    effects = pick(
        rng, "gravty", "gravity,gravity", "", ",", "gravity,,", "Gravity", "gravity coulomb_joint", "a" * 3000,
        "gravity,linear_gravity",
        "learned_torque", "../x", "stribeck,coulomb_joint,dahl,lugre",
    )  # fmt: skip
    model = pick(rng, "cubic", "", "no.toml", "r.csv", "m.toml", ".", "joint ", "JOINT")
    return Case([*words, *pick(rng, ["--effects", effects], ["--model", model])])


@kind("options", 2)
def where_to_write(rng, folder: Path) -> Case:
    name = str(pick(rng, "fit", "diagnose", "skeleton", "chaos", "look", "simulate"))
    words = command(name, folder)
    (folder / "kept").mkdir()
    (folder / "kept" / "mine.txt").write_text("mine\n")
    target = pick(
        rng,
        "r.csv",
        "m.toml",
        "r.csv/o",
        "/proc/o",
        "/dev/null",
        "",
        "a" * 300,
        "/dev/null/x",
        "\u00e9/\u00fc",
        "o" + "/o" * 1000,
    )
    if name == "simulate":
        words = ["simulate", "m.toml", "--duration", "2"]
        target = pick(rng, target, "r.csv/s.csv", "kept", "kept/mine.txt", "s.xyz", "s", "/proc/s.csv", "kept/s.npz", "no/s.mat")
    return Case([*words, "--out", target])


@kind("options", 3)
def excitations(rng, folder: Path) -> Case:
    good_model(folder)
    good_record(folder)
    text = pick(
        rng, "chirp:amplitude=1e300,f0=0,f1=1", "chirp:amplitude=.1", "chirp:amplitude=.1,f0=0,f1=1e9",
        "harmonic:amplitude=nan,frequency=1", "", "chirp",
        "harmonic:amplitude=.1,frequency=-1", "multisine:amplitude=.1,low=5,high=1,lines=3",
        "multisine:amplitude=.1,low=1,high=5,lines=1e9",
        "stepped:amplitude=.1,low=1,high=5,steps=1e9", "stepped:amplitude=.1,low=1,high=5,steps=0", "rest:x=1", "no.csv",
        "r.csv", "m.toml", ".",
        "harmonic:amplitude=.1,frequency=1,phase=inf", "chirp:amplitude=.1,f0=0,f1=1,amplitude=2", "saw:amplitude=1",
        "multisine:amplitude=.1,low=1,high=5,lines=2.5",
        "harmonic:amplitude=.1,frequency=0",
    )  # fmt: skip
    out = "r.csv" if text == "r.csv" and pick(rng, True, False) else "s.csv"
    words = ["simulate", "m.toml", "--out", out, "--excitation", text, "--duration", "2"]
    return Case(words + pick(rng, [], [], ["--force"]))


@kind("options", 4)
def maps(rng, folder: Path) -> Case:
    words = ["map", "--inverse-alpha", "1:5:6", "--zeta", "0.01:0.03:3", "--periods", "40", "--skip", "10", "--out", "m.nc"]
    flag = str(
        pick(rng, "--inverse-alpha", "--zeta", "--omega", "--periods", "--skip", "--samples", "--start", "--case", "--out")
    )
    values = {
        "--periods": ("0", "-1", "5", "100000000", "1e3", "9" * 30), "--skip": ("-1", "40", "41", "9" * 30), "--case": ("0", "3",
        "x"),
        "--samples": ("0", "-5", "31", "100000000000"), "--start": ("1", "nan,0", "1e300,0", "a,b", "1,2,3", ""),
        "--out": ("m.csv", ".", "/proc/m.nc", "a/b/m.nc", "a" * 300 + ".nc", "r.csv"),
    }  # fmt: skip
    ranges = (
        "1:5",
        "5:1:3",
        "1:5:0",
        "1:5:-3",
        "0:5:4",
        "1:5:99999999999999999999",
        "nan:5:4",
        "1:inf:4",
        "1:1e300:3",
        "",
        "a",
        "1:5:4:3",
        "1:5:3000",
        "1e-300:2:3",
    )
    value = str(pick(rng, *values.get(flag, ranges)))
    if flag in words and flag != "--out":
        at = words.index(flag)
        words[at : at + 2] = []
    return Case([*words, flag, value])


@kind("options", 2)
def words_of_the_command_line(rng, folder: Path) -> Case:
    words = command(str(pick(rng, *COMMANDS)), folder)
    spoilt = pick(
        rng, [], ["fit"], ["no"], ["--help", "--no"], [*words, "--no-such"], [*words, "r.csv", "r.csv"], [words[0]], [*words,
        "--json", "--json=1"],
        ["--version"], [*words, "--inertia"], [words[0].upper(), *words[1:]], [*words, "-x"], ["fit", ""], ["fit", "--",
            "-r.csv"],
    )  # fmt: skip
    return Case([*spoilt], accepts=True)


@kind("options", 2)
def channels_of_chaos(rng, folder: Path) -> Case:
    words = command("chaos", folder)
    extra = pick(
        rng, ["--channel", "t"], ["--channel", "q"], ["--channel", ""], ["--channel", "z", "--rate", "100"], ["--surrogates",
        "no"],
        ["--surrogate-count", "1"], ["--channel", "x,z"], ["--channel", "z", "--resample-rate", "0"], ["--channel", "#2"],
            ["--channel", "z "],
    )  # fmt: skip
    return Case([*words, *extra, *pick(rng, [], ["--out", "o"])])
