"""Files, classes and functions of the package bear terms of the field, and none of the private words that these have replaced."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[1] / "jaxbacklash"

REPLACED = {
    "Workbench", "Trial", "Tried", "Step", "Unseen", "memories", "Member", "yielding", "kin", "quick_look", "foresight",
    "under_noise", "Sounding", "either", "recall", "arriving", "reshaping", "loose", "joining", "two_for_one", "within_bounds",
    "awake", "handed_on", "led_on", "softened", "stretch", "arrow", "held", "claim", "pull", "worth", "soaks", "nibbles",
}  # fmt: skip
"""Names that need explaining where a term of the field says the same: model fitter, fitted model, screening, state propagation,
friction homotopy, score, gain."""


def names(package: Path) -> Iterator[tuple[str, str]]:
    """Names of all files, folders, classes and functions, without leading underscores, each with where it stands."""
    for path in sorted(package.rglob("*.py")):
        where = path.relative_to(package)
        yield from ((part, str(where)) for part in where.with_suffix("").parts)
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
                yield node.name.lstrip("_"), f"{where}:{node.lineno}"


def test_no_file_class_or_function_bears_a_replaced_name():
    found = [f"{where}: {name}" for name, where in names(PACKAGE) if name in REPLACED]
    assert not found, "\n".join(["names that a reader has to guess:", *found])


@pytest.mark.parametrize(
    ("file", "text", "found"),
    [
        ("stretch.py", "", {"stretch"}),
        ("held/first.py", "", {"held"}),
        ("a.py", "class _Step:\n    pass", {"Step"}),
        ("a.py", "def f():\n    async def claim():\n        pass", {"claim"}),
        ("a.py", "class A:\n    def worth(self):\n        pass", {"worth"}),
        ("a.py", "def step(held):\n    worth = held", set()),
        ("withheld.py", "def stepped():\n    pass", set()),
    ],
)
def test_a_replaced_name_is_found_wherever_it_is_defined(tmp_path, file, text, found):
    path = tmp_path / file
    path.parent.mkdir(exist_ok=True)
    path.write_text(text, encoding="utf-8")
    assert {name for name, _ in names(tmp_path) if name in REPLACED} == found
