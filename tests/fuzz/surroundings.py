"""The process's surroundings: signals, caches of compiled programs that were tampered with, limits, a full disk, no home."""

from __future__ import annotations

import os
import time
from pathlib import Path

from tests.fuzz.case import FIT, Case, good_model, good_record, kind, pick

MAP = ["map", "--inverse-alpha", "1:5:40", "--zeta", "0.005:0.03:20", "--periods", "400", "--skip", "100", "--out", "m.nc"]


@kind("signals", 3, alone=True)
def interrupted(rng, folder: Path) -> Case:
    good_record(folder)
    good_model(folder)
    words = pick(
        rng, ["refine", "r.csv", "--inertia", "2.94", "--out", "o"], ["fit", "r.csv", "--inertia", "2.94", "--out", "o"], MAP,
        ["chaos", "r.csv", "--out", "o"],
        ["diagnose", "r.csv", "--inertia", "2.94", "--out", "o"], ["simulate", "m.toml", "--out", "s.csv", "--duration", "500"],
            ["look", "r.csv"],
        ["skeleton", "r.csv", "--out", "o"],
    )  # fmt: skip
    first = float(rng.uniform(0.3, 12.0))
    return Case(words, alone=True, interrupts=pick(rng, [first], [first], [first, first + 0.3]), lost=("m.nc.tiles/",))


def _programs(folder: Path) -> Path:
    programs = folder / "cache" / "programs"
    programs.mkdir(parents=True)
    return programs


@kind("caches", 3, alone=True)
def a_cache_that_is_none(rng, folder: Path) -> Case:
    good_record(folder)
    choice = int(rng.integers(8))
    cache, env = folder / "cache", {"JAXBACKLASH_CACHE": str(folder / "cache")}
    if choice == 0:
        cache.write_text("a file")
    elif choice == 1:
        cache.symlink_to(pick(rng, "nowhere", "cache", "/dev/null", "/dev/full"))
    elif choice == 2:
        (cache / "programs").mkdir(parents=True)
        os.chmod(cache / "programs", 0o777)
        (cache / "programs" / "mine.txt").write_text("mine\n")
    elif choice == 3:
        programs = _programs(folder)
        for name in ("fit.list", "fit", "fit.json", "last", "fit.txt"):
            (programs / name).write_text("../../r.csv\n/etc/passwd\n\0\n")
    elif choice == 4:
        old = _programs(folder) / pick(rng, "mine.txt", "thesis.tex", "notes", "photo.jpg")
        old.write_text("mine\n")
        os.utime(old, (time.time() - 4e8,) * 2)
    elif choice == 5:
        env = {"JAXBACKLASH_CACHE": "/proc/nothing"}
    elif choice == 6:
        env = {"JAXBACKLASH_CACHE": "", "HOME": "/proc/nothing", "XDG_CACHE_HOME": None}
    else:
        os.mkfifo(_programs(folder) / "fifo")
    return Case(["fit", "r.csv", *FIT], alone=True, env=env)


@kind("surroundings", 3, alone=True)
def limits_and_streams(rng, folder: Path) -> Case:
    good_record(folder)
    good_model(folder)
    words = pick(
        rng,
        ["fit", "r.csv", *FIT, "--out", "o"],
        ["fit", "r.csv", *FIT, "--json"],
        ["look", "r.csv"],
        ["simulate", "m.toml", "--out", "s.csv", "--duration", "3"],
    )
    choice = int(rng.integers(8))
    case = Case(words, alone=True)
    if choice == 0:
        case.env = {"HOME": None, "XDG_CACHE_HOME": None, "JAXBACKLASH_CACHE": None}
        case.before = ["env"]
    elif choice == 1:
        case.stdout = "/dev/full"
        case.accepts = False
    elif choice == 2:
        case.env = {"JAX_PLATFORMS": pick(rng, "cuda", "tpu", "nonsense")}
    elif choice == 3:
        case.before = ["bash", "-c", 'ulimit -f 8; exec "$@"', "bash"]
    elif choice == 4:
        case.env = {"LANG": "C", "LC_ALL": "C", "PYTHONIOENCODING": "ascii"}
    elif choice == 5:
        case.before = ["bash", "-c", 'exec "$@" <&- >&-', "bash"]
        case.silent = True
    elif choice == 6:
        case.before = ["bash", "-c", '"$@" | true; exit ${PIPESTATUS[0]}', "bash"]
        case.silent = True
    else:
        case.before = ["bash", "-c", f'ulimit -v {int(pick(rng, 4, 8))}000000; exec "$@"', "bash"]
    return case
