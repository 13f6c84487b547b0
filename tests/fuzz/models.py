"""Model files edited by hand, and wrongly."""

from __future__ import annotations

from pathlib import Path

from tests.fuzz.case import MODEL, Case, good_model, good_record, kind, pick

NUMBERS = (
    "0", "-1.0", "nan", "inf", "-inf", "1e300", "1e-300", "1e30", "-1e9", "1e12", '"text"', "true", "[1, 2]", "{a = 1}",
    "1979-05-27", "9" * 400, "1e400",
    "0x7fffffffffffffff", "", "1_000", "5e-324",
)  # fmt: skip


def _command(rng, model: str = "m.toml") -> list[str]:
    return pick(
        rng, ["simulate", model, "--out", "s.csv", "--duration", "2"], ["simulate", model, "--out", "s.csv", "--duration", "2",
        "--excitation", "r.csv"],
        ["compare", model, "r.csv", "--out", "o"], ["compare", model, "r.csv", "--json"], ["fit", "r.csv", "--model", model],
    )  # fmt: skip


@kind("models", 6)
def a_number_changed(rng, folder: Path) -> Case:
    good_record(folder)
    lines = MODEL.splitlines()
    places = [at for at, line in enumerate(lines) if " = " in line]
    at = int(pick(rng, *places))
    lines[at] = lines[at].split(" = ")[0] + " = " + pick(rng, *NUMBERS)
    good_model(folder, "\n".join(lines) + "\n")
    return Case(_command(rng))


@kind("models", 3)
def an_effect_that_is_none(rng, folder: Path) -> Case:
    good_record(folder)
    effect = pick(
        rng, "[effects.gravty]\nG = 1.0", "[effects.gravity]\n", "[effects.gravity]\nG = 1.0\nH = 2.0",
        "[effects.dahl]\nsigma = 0.0\nFc = 0.0",
        "[effects.cubic_stiffness]\nk3 = -1e12", "[effects.stribeck]\nTc = 1.0", "[effects.sensor_delay]\ntau = 1e6",
        "[effects.torque_ripple]\nA = 1.0\nN = 1e300\nphi = 0.0",
        "[[effects.gravity]]\nG = 1.0", "effects = 5", "[effects]\ngravity = 3", "[effects.learned_torque]\n",
        "[effects.gap_drift]\nr = -1e9",
        "[effects.flexible_link]\nJ2 = 0.0\nk2 = 1.0\nc2 = 0.0",
        "[effects.lugre]\nsigma0 = 1e30\nsigma1 = 1.0\nsigma2 = 0.0\nFc = 1.0\nFs = 1.0\nvs = 0.0",
        "[effects.asymmetric_gap]\nz0 = 5.0", "[effects.bouc_wen]\nsigma = 1.0\nFc = 1.0\nn = -3.0\nbeta = 0.5",
        "[effects.quadratic_drag]\nq = -1e6",
    )  # fmt: skip
    good_model(folder, MODEL.split("[effects")[0] + effect + "\n")
    return Case(_command(rng))


@kind("models", 3)
def a_file_that_is_no_model(rng, folder: Path) -> Case:
    good_record(folder)
    text = pick(
        rng, "", "[model]\n", "[model\n", "model = 3\n", "[other]\na = 1\n", MODEL.replace("[model]", "[Model]"),
        MODEL + "\n[model]\n", "a" * 100_000,
        "x = " + "[" * 20_000 + "]" * 20_000 + "\n" + MODEL, MODEL.replace('"z"', '"q"'), MODEL.replace('"z"', "5"),
        MODEL.replace("inertia", "inertai"),
        MODEL.replace("stiffness = 13400.0\n", ""), MODEL.replace("damping", "damping.x"), "t,x,z\n0,0,0\n",
        MODEL.replace("backlash = 0.0186", "backlash = 100.0"),
        MODEL.replace("\n", "\r"), "\ufeff" + MODEL, MODEL + "\0",
    )  # fmt: skip
    (folder / "m.toml").write_bytes(
        pick(rng, text.encode(), text.encode(), text.encode(), rng.bytes(300), MODEL.encode("utf-16"))
    )
    return Case(_command(rng))


@kind("models", 1)
def no_file_at_all(rng, folder: Path) -> Case:
    good_record(folder)
    (folder / "dir.toml").mkdir()
    (folder / "link.toml").symlink_to("link.toml")
    return Case(_command(rng, str(pick(rng, "no.toml", "dir.toml", "link.toml", "r.csv", ".", "/dev/null", ""))), accepts=False)


@kind("models", 2)
def of_another_kind_than_the_record(rng, folder: Path) -> Case:
    good_record(folder)
    good_model(folder, MODEL.replace('"z"', pick(rng, '"y"', '"T"')))
    return Case(["compare", "m.toml", "r.csv", *pick(rng, [], ["--translation"], ["--window", "9"])])
