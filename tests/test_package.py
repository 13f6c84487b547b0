"""The house itself: what an import does, what the papers at the door say, and what must not lie about in the files."""

import json
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from jaxbacklash.program import cores

ROOT = Path(__file__).resolve().parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
README = (ROOT / "README.md").read_text(encoding="utf-8")
LONGEST = 500
REGISTRIES = (("pypi", "org"), ("pythonhosted", "org"), ("anaconda", "org"))
PROSE = {".py", ".md", ".toml", ".j2", ".css", ".js", ".sh", ""}

EFFECTS = {
    "asymmetric_gap", "asymmetric_stiffness", "bouc_wen", "contact_damping", "coulomb_ground", "coulomb_joint",
    "cubic_stiffness", "dahl", "flexible_link", "gap_drift", "gap_spring", "gravity", "hunt_crossley", "lugre", "preload",
    "quadratic_drag", "sensor_delay", "sensor_gain", "sensor_offset", "stiffness_drift", "stribeck", "torque_ripple",
}  # fmt: skip


def fresh(code: str) -> str:
    """What a new interpreter prints when it runs this code in the project's folder."""
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    return done.stdout


def text_files() -> list[Path]:
    """The files of the repository that hold text, whatever else was made beside them; without git, those below its folders."""
    if (ROOT / ".git").exists() and shutil.which("git"):
        command = ["git", "ls-files", "-z", "--cached"]
        listed = subprocess.run(command, cwd=ROOT, capture_output=True, check=True).stdout.decode()
        found = [ROOT / name for name in listed.split("\0") if name]
    else:
        folders = ("jaxbacklash", "tests", "benchmarks", "notebooks")
        found = [path for folder in folders for path in (ROOT / folder).rglob("*") if "__pycache__" not in path.parts]
        found += ROOT.glob("*")
    return [path for path in found if path.is_file() and b"\0" not in path.read_bytes()]


def test_importing_changes_nothing():
    code = """
import os, sys, warnings
import diffrax, equinox, jax, lineax, numpy, optimistix, scipy.interpolate, scipy.special
before = dict(os.environ), jax.config.values.copy(), list(warnings.filters), numpy.geterr(), sys.excepthook
import jaxbacklash
every = [getattr(jaxbacklash, name) for name in jaxbacklash.__all__]
after = dict(os.environ), jax.config.values.copy(), list(warnings.filters), numpy.geterr(), sys.excepthook
names = ["environment", "jax settings", "warnings", "numpy errors", "excepthook"]
changed = [name for name, a, b in zip(names, before, after) if a != b]
assert not changed, changed
assert not jax.config.jax_enable_x64
loaded = [name for name in ("matplotlib", "rich", "typer", "jinja2", "jaxbacklash.commands") if name in sys.modules]
assert not loaded, loaded
"""
    assert fresh(code) == ""


@pytest.mark.skipif(not Path("/proc/self/task").is_dir() or cores() < 2, reason="counts threads, of which one core has one")
def test_a_program_that_has_started_gives_linear_algebra_one_thread_unless_told_otherwise():
    code = """
import os
os.environ.pop("OPENBLAS_NUM_THREADS", None)
os.environ.update({})
from jaxbacklash.cli import app
from jaxbacklash.program import start
start(cache=False)
import scipy.linalg
print(len(os.listdir("/proc/self/task")))
"""
    one, two = (int(fresh(code.replace("{}", chosen))) for chosen in ("{}", "{'OPENBLAS_NUM_THREADS': '2'}"))
    assert two - one == 2  # one more for NumPy's library and one for SciPy's


def test_pictures_touch_no_settings():
    code = """
import sys, matplotlib
before = matplotlib.rcParams.copy()
import jaxbacklash.plot.fits
assert matplotlib.rcParams.copy() == before
assert "matplotlib.pyplot" not in sys.modules
"""
    assert fresh(code) == ""


def test_names_are_loaded_when_asked_for_and_no_folder_hides_one():
    code = """
import sys, types
import jaxbacklash
assert "jax" not in sys.modules
assert len(jaxbacklash.catalogue()) > 20
import jaxbacklash.cli, jaxbacklash.commands.refine, jaxbacklash.report.map_report
names = {name: getattr(jaxbacklash, name) for name in jaxbacklash.__all__}
assert len(names) > 50 and set(names) <= set(dir(jaxbacklash))
assert sorted(name for name, value in names.items() if isinstance(value, types.ModuleType)) == ["dynamics", "plot", "signature"]
"""
    assert fresh(code) == ""


def test_a_command_whose_programs_are_kept_waits_for_no_library_that_only_traces():
    code = """
import sys
import jaxbacklash.commands.refine, jaxbacklash.commands.fit, jaxbacklash.commands.diagnose
late = {"diffrax", "optimistix", "lineax", "scipy.signal", "scipy.stats", "matplotlib"} & set(sys.modules)
assert not late, late
"""
    assert fresh(code) == ""


@pytest.mark.parametrize("words", [["refine", "nothere.csv"], ["fit", "nothere.csv", "--seed", "3"], ["fit", "--inertai", "3"]])
def test_a_mistake_that_names_alone_can_tell_waits_for_no_library(words):
    code = f"""
import io, sys
sys.stderr = io.StringIO()
sys.argv = ["jaxbacklash", *{words!r}]
from jaxbacklash.cli import main
try:
    main()
except SystemExit as end:
    print(end.code, "jax" in sys.modules, sys.stderr.getvalue().count(chr(10)))
"""
    assert fresh(code).split() == ["2", "False", "1"]


def test_version():
    import jaxbacklash

    assert jaxbacklash.__version__ == PROJECT["project"]["version"]
    assert f"[{jaxbacklash.__version__}]" in (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")


def test_catalogue_is_complete_after_import():
    found = set(json.loads(fresh("import json, jaxbacklash; print(json.dumps(list(jaxbacklash.catalogue())))")))
    assert found >= EFFECTS, f"missing after a plain import: {sorted(EFFECTS - found)}"
    conventions = (ROOT / "CONVENTIONS.md").read_text(encoding="utf-8")
    untold = sorted(name for name in found if f"| `{name}` |" not in conventions)
    assert not untold, f"no row in CONVENTIONS.md: {untold}"


def test_readme_says_the_two_commands():
    assert "\npip install . && jaxbacklash demo\n" in README
    assert '\npip install ".[test]" && pytest\n' in README


def test_readme_and_command_line_agree():
    import typer.main

    from jaxbacklash.cli import app

    commands = typer.main.get_command(app).commands
    shown = re.findall(r"^(?:pip install \. && )?jaxbacklash ([\w-]+)(.*)$", README, flags=re.MULTILINE)
    assert {name for name, _ in shown} == set(commands)
    for name, rest in shown:
        known = {option for parameter in commands[name].params for option in parameter.opts}
        used = set(re.findall(r"--[a-z0-9-]+", rest.split("#")[0]))
        assert used <= known, f"the README gives {name} the options {sorted(used - known)}"
    everywhere = {option for command in commands.values() for parameter in command.params for option in parameter.opts}
    assert set(re.findall(r"(?<![\w-])--[a-z][a-z-]+", README)) <= everywhere | {"--help", "--version"}


def test_links_lead_somewhere():
    for page in ROOT.glob("*.md"):
        for target in re.findall(r"\]\(([^)#]+)\)", page.read_text(encoding="utf-8")):
            assert "://" in target or (ROOT / target).exists(), f"{page.name} links to {target}"


def test_both_pictures_of_the_layers_are_one():
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    drawn = text.split("<!-- layers -->")[1].split("<!-- end -->")[0].split("\n")
    contracts = PROJECT["tool"]["importlinter"]["contracts"]
    held = next(contract for contract in contracts if contract["type"] == "layers")["layers"]
    assert [line.strip() for line in drawn if line.strip()] == held


def test_constraints_are_names_and_versions_only():
    lines = (ROOT / "constraints.txt").read_text(encoding="utf-8").splitlines()
    pinned = re.compile(r"#.*|[a-z0-9-]+==[0-9][0-9a-z.]*")
    assert [line for line in lines if not pinned.fullmatch(line)] == []


def test_no_file_is_longer_than_it_should_be():
    long = {}
    for path in text_files():
        if path.suffix in PROSE and "data" not in path.parts:
            count = len(path.read_text(encoding="utf-8").splitlines())
            if count > LONGEST:
                long[str(path.relative_to(ROOT))] = count
    assert not long


def test_no_machine_path_and_no_download_address():
    # Put together from pieces, so that this file does not find itself.
    folders = "|".join("/" + name + "/" for name in ("home", "Users", "root", "work", "opt", "mnt", "srv"))
    hosts = "|".join(re.escape(".".join(name)) for name in REGISTRIES)
    path = re.compile(rf"(?<![\w.<])(?:{folders})\w|[A-Z]:\\Users\\|" + re.escape(str(ROOT)))
    address = re.compile(rf"https?://\S*(?:/simple/|\.whl|\.tgz|\.tar\.gz)|{hosts}|--(?:extra-)?index-url")
    found = []
    for file in text_files():
        if file == Path(__file__).resolve():
            continue
        for number, line in enumerate(file.read_text(encoding="utf-8", errors="replace").splitlines(), 1):
            hit = path.search(line) or address.search(line)
            if hit:
                found.append(f"{file.relative_to(ROOT)}:{number}: {hit.group()}")
    assert not found


def test_import_contracts():
    linter = shutil.which("lint-imports")
    if linter is None:
        pytest.skip("import-linter is not installed")
    done = subprocess.run([linter, "--no-cache"], cwd=ROOT, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stdout


@pytest.mark.slow
def test_readme_code_runs(tmp_path):
    blocks = re.findall(r"```python\n(.*?)```", README, flags=re.DOTALL)
    assert len(blocks) >= 2
    for name, shipped in (("run1", "train"), ("run2", "heldout")):
        shutil.copy(ROOT / "jaxbacklash" / "data" / f"demo_{shipped}.csv", tmp_path / f"{name}.csv")
    for number, block in enumerate(blocks):
        (tmp_path / f"block{number}.py").write_text(f"import sys\nsys.path.insert(0, {str(ROOT)!r})\n{block}")
        done = subprocess.run([sys.executable, f"block{number}.py"], cwd=tmp_path, capture_output=True, text=True, timeout=300)
        assert done.returncode == 0, done.stderr
        assert "gravity" in done.stdout
