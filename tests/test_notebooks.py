"""Every notebook runs from top to bottom in a kernel of its own, as a user's Jupyter would run it."""

import ast
import os
import re
from pathlib import Path
from types import ModuleType

import pytest

import jaxbacklash as jb

ROOT = Path(__file__).resolve().parents[1]
NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.py"))
MINUTES = 5


def test_there_are_notebooks():
    assert NOTEBOOKS


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_holds_only_calls_and_words(path):
    jupytext = pytest.importorskip("jupytext")
    notebook = jupytext.read(path)
    assert notebook.metadata["kernelspec"]["name"] == "python3"
    code = "\n".join(cell.source for cell in notebook.cells if cell.cell_type == "code")
    for word in ("def ", "class ", "lambda"):
        assert word not in code, f"{path.name} defines something: {word.strip()}"
    words = sum(cell.cell_type == "markdown" for cell in notebook.cells)
    assert words >= 0.4 * len(notebook.cells)


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_uses_public_names_alone(path):
    """One import, of the package as jb, and nothing of it that its lists do not name."""
    code = ast.parse(path.read_text(encoding="utf-8"))
    for node in ast.walk(code):
        if isinstance(node, ast.ImportFrom):
            assert not (node.module or "").startswith("jaxbacklash"), ast.unparse(node)
        elif isinstance(node, ast.Import):
            assert [one.asname for one in node.names if one.name.startswith("jaxbacklash")] in ([], ["jb"]), ast.unparse(node)
    chains = re.findall(r"\bjb((?:\.\w+)+)", ast.unparse(code))
    assert chains
    for chain in chains:
        within = jb
        for name in chain.strip(".").split("."):
            listed = getattr(within, "__all__", None)
            within = getattr(within, name)
            assert name in listed if listed is not None else not name.startswith("_"), f"jb{chain}"
            assert listed is not None or not isinstance(within, ModuleType), f"jb{chain}"


@pytest.mark.slow
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_runs(path, tmp_path):
    jupytext = pytest.importorskip("jupytext")
    nbclient = pytest.importorskip("nbclient")
    notebook = jupytext.read(path)
    client = nbclient.NotebookClient(
        notebook, timeout=60 * MINUTES, kernel_name="python3", resources={"metadata": {"path": str(tmp_path)}}
    )
    search = os.pathsep.join(filter(None, [str(ROOT), os.environ.get("PYTHONPATH")]))
    client.execute(env=os.environ | {"JAXBACKLASH_TINY": "1", "PYTHONPATH": search})
    # An exception has already failed the test; warnings are for users to act on, so a notebook must not raise any.
    said = [
        output.text
        for cell in notebook.cells
        for output in cell.get("outputs", [])
        if output.output_type == "stream" and output.name == "stderr"
    ]
    assert not said
