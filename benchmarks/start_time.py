"""How long a command takes in a fresh process, by how its compiled programs are kept: three ways in turns.

    python -m benchmarks.start_time [--tiny] [--runs 5]

* machine code: what `jaxbacklash.compiled` does. The code itself is kept under a name that is told without tracing.
* jax.export: the same names, but what is kept is the program as `jax.export` writes it down; its machine code lies in JAX's own
  persistent cache.
* JAX's cache alone: every process traces every program anew, and finds its machine code there.

Every run is a process of its own, so that all counts that a user waits for. Commands: `fit` and `refine` of a record of a few
seconds, and `demo`. A cold run finds nothing kept, a warm one what the cold one left. Told is the least of the warm runs, in
seconds on the clock and of the processor: the second is what can be compared on a machine that is busy with something else.
Python keeps its byte code, as it does where the package is installed. A second table says where a warm `fit` spends its time.
"""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

WAYS = ("machine code", "jax.export", "JAX's cache alone")


def keep_exported_programs() -> None:
    """Have this process keep programs as `jax.export` writes them down, instead of their machine code."""
    import pickle

    import jax
    from jax.sharding import Mesh, NamedSharding, PartitionSpec

    from jaxbacklash import compiled, program_file, read_ahead
    from jaxbacklash.private_files import make_private_folder
    from jaxbacklash.whole_file import write_whole

    written: dict[str, bytes] = {}

    def ready(content: bytes, options: Any) -> Any:
        exported = jax.export.deserialize(bytearray(content))
        # Programs that are dealt out keep off the first device: see `jaxbacklash.sharing`.
        devices = jax.devices()[-exported.nr_devices :] if exported.nr_devices > 1 else jax.devices()[:1]
        spread = NamedSharding(Mesh(devices, ("cores",)), PartitionSpec())
        shapes = [jax.ShapeDtypeStruct(a.shape, a.dtype, sharding=spread) for a in exported.in_avals]
        arguments, _ = jax.tree.unflatten(exported.in_tree, shapes)
        return jax.jit(exported.call).lower(*arguments).compile(options)

    def make(function: Any, args: Any, name: str, lasting: bool) -> Any:
        lowered: dict[str, Any] = {}
        original = jax.jit

        class Exporting:
            """What `compiled._make` takes for a jitted function: lowering exports."""

            def __init__(self, flat: Any) -> None:
                flat.__name__ = function.__name__
                self.jitted = original(flat)

            def lower(self, arrays: Any) -> Any:
                lowered["content"] = bytes(jax.export.export(self.jitted)(arrays).serialize())
                return self

            def compile(self, options: Any) -> Any:
                return ready(lowered["content"], options)

        compiled_jit, compiled_forget = compiled.jax.jit, compiled._forget_origins
        compiled.jax = _Namespace(jax, jit=Exporting)  # type: ignore[assignment]
        compiled._forget_origins = lambda lowered: None
        try:
            made = original_make(function, args, name, lasting)
        finally:
            compiled.jax, compiled._forget_origins = jax, compiled_forget
            assert jax.jit is compiled_jit
        written[name] = pickle.dumps((lowered["content"], compiled.LASTING if lasting else None))
        return made

    def write(path: Path, call: Any, frame: Any) -> None:
        if make_private_folder(path.parent):
            content = pickle.dumps((pickle.dumps(frame), written[path.name]))
            write_whole(path, program_file._head(path.name) + program_file._check(content) + content, private=True)

    def read(path: Path) -> Any:
        return ready(*pickle.loads(pickle.loads(program_file._content(path))[1]))

    original_make = compiled._make
    compiled._make, compiled.write, program_file.read = make, write, read
    assert read_ahead.program_file is program_file


class _Namespace:
    """A module with some of its names replaced."""

    def __init__(self, module: Any, **replaced: Any) -> None:
        self.__dict__.update(module.__dict__ | replaced)


def trace_every_program() -> None:
    """Have this process keep no programs of its own."""
    from jaxbacklash import compiled

    compiled._name = _foreign


def _foreign(*args: Any) -> str:
    from jaxbacklash import compiled

    raise compiled._Foreign("nothing is kept")


def run_command(way: str, words: list[str]) -> None:
    """A command of jaxbacklash in this process."""
    from jaxbacklash.cli import main

    if way == WAYS[1]:
        keep_exported_programs()
    elif way == WAYS[2]:
        trace_every_program()
    sys.argv = ["jaxbacklash", *words]
    main()


def seconds(way: str, words: list[str], cache: Path) -> tuple[float, float]:
    """Wall time of a fresh process, and its processor's."""
    before, begin = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    _fresh(["--way", way, "--", *words], cache)
    spent, after = time.perf_counter() - begin, resource.getrusage(resource.RUSAGE_CHILDREN)
    return spent, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def _fresh(words: list[str], cache: Path) -> str:
    """This module in a process of its own: what it says on stderr."""
    own = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    command = [sys.executable, "-m", "benchmarks.start_time", *words]
    ran = subprocess.run(command, env=own | {"JAXBACKLASH_CACHE": str(cache)}, capture_output=True, text=True)
    if ran.returncode:
        raise SystemExit(f"{' '.join(words)}: {ran.stderr.strip()[-2000:]}")
    return ran.stderr


def tell_stages(begun: float, words: list[str]) -> None:
    """`fit` in this process, and on stderr when each of its stages ended, in seconds since ``begun`` by the system's clock."""
    reached: list[tuple[str, float, float]] = []

    def note(stage: str) -> None:
        reached.append((stage, time.time() - begun, time.process_time()))

    def ended(stage: str, function: Any) -> Any:
        def call(*args: Any, **more: Any) -> Any:
            found = function(*args, **more)
            note(stage)
            return found

        return call

    def imported(name: str, module: Any) -> None:
        note(name)
        if name == "the fit's modules":
            module.fit_records = ended("the fit", module.fit_records)
            module.find_causes = ended("causes of misfit", module.find_causes)
            module.result_of = ended("the cross-check by skeletons", module.result_of)

    note("Python")
    import importlib.util

    from jaxbacklash import cli
    from jaxbacklash.commands import reading

    note("the parser")
    reading.Reading.record = ended("the record", reading.Reading.record)
    whole = {"jax": "the command's words and jax", "jaxbacklash.commands.fit": "the fit's modules"}

    class Finder:
        """Says when a module has been loaded."""

        def find_spec(self, name: str, path: Any = None, target: Any = None) -> Any:
            if name not in whole:
                return None
            stage = whole.pop(name)
            found = importlib.util.find_spec(name)
            loader: Any = found.loader if found else None
            load = loader.exec_module
            loader.exec_module = lambda module: (load(module), imported(stage, module))
            return found

    sys.meta_path.insert(0, Finder())  # type: ignore[arg-type]
    sys.argv = ["jaxbacklash", *words]
    try:
        cli.main()
    finally:
        note("what is printed")
        print("stages", *(f"{stage}:{at:.4f}:{spent:.4f}" for stage, at, spent in reached), sep="|", file=sys.stderr)


def where(words: list[str], runs: int, cache: Path) -> None:
    """The table of a warm fit's stages: the median over the runs of each, with what the cache holds."""
    stages: dict[str, list[tuple[float, float]]] = {}
    for _ in range(runs):
        begun, last, used = time.time(), 0.0, 0.0
        said = _fresh(["--begun", repr(begun), "--", *words], cache)
        whole = time.time() - begun
        for told in next(line for line in said.splitlines() if line.startswith("stages|")).split("|")[1:]:
            stage, at, spent = told.split(":")
            stages.setdefault(stage, []).append((float(at) - last, float(spent) - used))
            last, used = float(at), float(spent)
        stages.setdefault("the end of the process", []).append((whole - last, 0.0))
    print(f"\nWhere a warm fit spends its time, median of {runs} runs, until the end of{'s':>20}{'(processor)':>12}")
    for stage, spent in stages.items():
        clock, own = (sorted(column)[len(spent) // 2] for column in zip(*spent))
        print(f"  {stage:<79}{clock:9.2f}{own:12.2f}", flush=True)


def table(commands: dict[str, list[str]], ways: tuple[str, ...], runs: int, folder: Path) -> None:
    """Cold and warm times of every command, the ways in turns."""
    print(f"\n{'':10}{'':20}{'cold, s':>9}{'(processor)':>12}{'warm, s':>9}{'(processor)':>12}{'kept, MB':>10}")
    for command, words in commands.items():
        caches = {way: folder / f"{command}-{number}" for number, way in enumerate(ways)}
        cold = {way: seconds(way, words, caches[way]) for way in ways}
        warm: dict[str, list[tuple[float, float]]] = {way: [] for way in ways}
        for _ in range(runs):
            for way in ways:
                warm[way].append(seconds(way, words, caches[way]))
        for way in ways:
            least = [min(column) for column in zip(*warm[way])]
            size = sum(path.stat().st_size for path in caches[way].rglob("*") if path.is_file()) / 1e6
            told = f"{cold[way][0]:9.1f}{cold[way][1]:12.1f}{least[0]:9.2f}{least[1]:12.2f}{size:10.0f}"
            print(f"  {command:<8}{way:<20}{told}", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--tiny", action="store_true", help="one command, two ways, one warm run")
    parser.add_argument("--runs", type=int, default=5, help="warm runs")
    parser.add_argument("--way", choices=WAYS, help=argparse.SUPPRESS)
    parser.add_argument("--begun", type=float, help=argparse.SUPPRESS)
    parser.add_argument("--commands", nargs="+", choices=("fit", "refine", "demo"), default=("fit", "refine", "demo"))
    parser.add_argument("words", nargs="*", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.way:
        return run_command(given.way, given.words)
    if given.begun:
        return tell_stages(given.begun, given.words)
    # A run of a command loads none of this.
    from benchmarks.fit_speed import RIG, make_record
    from jaxbacklash.records import write_record

    inertia = "--inertia", str(RIG.inertia)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        path = folder / "record.csv"
        write_record(make_record(6.0), path)
        commands = {
            "fit": ["fit", str(path), *inertia],
            "refine": ["refine", str(path), *inertia],
            "demo": ["demo", "--out", str(folder / "demo")],
        }
        chosen = ("fit",) if given.tiny else given.commands
        ways, runs = (WAYS[:2], 1) if given.tiny else (WAYS, given.runs)
        table({name: commands[name] for name in chosen}, ways, runs, folder)
        if "fit" in chosen:
            where(commands["fit"], runs, folder / "fit-0")  # the first way's


if __name__ == "__main__":
    main()
