"""Law files of a user's own that are wrong in every way that Python allows."""

from __future__ import annotations

from pathlib import Path

from tests.fuzz.case import Case, good_model, good_record, kind, pick

HEAD = "import jax.numpy as jnp\nimport jaxbacklash as jb\n"
LAW = """

class Mine(jb.AbstractEffect):
    r\"\"\"T = a f(y).\"\"\"

    a: float = jb.param(unit="N m", null=0.0)

    def torque(self, now):
        return {body}
"""
BODIES = (
    "self.a * jnp.nan * now.y", "self.a * jnp.inf", "'text'", "None", "self.a * float(now.y)", "self.a if now.y > 0 else 0.0",
    "self.a * 1j * now.y",
    "[self.a, now.y]", "{'a': now.y}", "jnp.stack([self.a, now.y])", "1 / 0", "self.b * now.y", "now.nothing",
    "self.torque(now)", "now.y > 0",
    "self.a * __import__('math').sin(now.y)", "self.a * __import__('numpy').sin(now.y)", "__import__('sys').exit(0)",
    "__import__('sys').exit(5)",
    "self.a * jnp.sqrt(-1.0 - now.y**2)", "self.a * 1e300 * now.y * 1e300", "self.a / (now.y - now.y)",
    "self.a * now.y.astype('int32')",
    "jnp.asarray(now.y, dtype='float16') * self.a", "open('r.csv', 'a').name", "self.a * now.y[0]", "self.a, now.y", "lambda: 0",
    "...", "jnp.where(now.y)",
)  # fmt: skip
FILES = (
    "", "x = 3\n", "def f(:\n", "import no_such_module\n", "raise RuntimeError('no')\n", "import sys\nsys.exit(0)\n",
    "import sys\nsys.exit(5)\n", "1 / 0\n",
    "raise SystemExit\n", "raise KeyboardInterrupt\n", "import os\nos._exit(3) if False else None\n", "\0",
    "import jaxbacklash as jb\nclass Mine(jb.AbstractEffect):\n    pass\n",
    "from __future__ import annotations\n" + HEAD + LAW.format(body="self.a * now.y"),
    HEAD + LAW.format(body="self.a * now.y").replace("N m", "N\\nm"),
    HEAD + LAW.format(body="self.a * now.y").replace("null=0.0", "null='x'"),
        HEAD + LAW.format(body="self.a * now.y").replace("class Mine", "class Gravity"),
    HEAD + LAW.format(body="self.a * now.y").replace("(self, now)", "(self)"),
        HEAD + LAW.format(body="self.a * now.y").replace("def torque", "def other"),
    HEAD + LAW.format(body="self.a * now.y").replace("unit=", "uint="),
        HEAD + LAW.format(body="self.a * now.y").replace("a: float", "a: str"),
    "def f():\n    return f()\nf()\n", HEAD + LAW.format(body="self.a * now.y").replace("class Mine", "class M\u00efne"),
    "raise ValueError('one\\ntwo\\nthree')\n",
)  # fmt: skip


def _command(rng) -> list[str]:
    fit = ["fit", "r.csv", "--inertia", "2.94", "--laws", "laws.py", "--effects", pick(rng, "mine", "mine", "gravity,mine")]
    return pick(rng, fit, fit, [*fit, "--out", "o"], ["diagnose", "r.csv", "--inertia", "2.94", "--laws", "laws.py"],
                ["refine", "r.csv", "--inertia", "2.94", "--laws", "laws.py"])  # fmt: skip


@kind("laws", 4, alone=True)
def a_law_that_cannot_be_computed(rng, folder: Path) -> Case:
    good_record(folder)
    (folder / "laws.py").write_text(HEAD + LAW.format(body=pick(rng, *BODIES)))
    return Case(_command(rng), alone=True, accepts=True)


@kind("laws", 3, alone=True)
def a_file_that_defines_none(rng, folder: Path) -> Case:
    good_record(folder)
    (folder / "laws.py").write_text(pick(rng, *FILES))
    return Case(_command(rng), alone=True)


@kind("laws", 1, alone=True)
def no_file_of_laws(rng, folder: Path) -> Case:
    good_record(folder)
    good_model(folder)
    (folder / "dir.py").mkdir()
    (folder / "laws.py").write_bytes(rng.bytes(500))
    path = str(pick(rng, "no.py", "dir.py", "laws.py", "r.csv", "m.toml", "", "/dev/null"))
    return Case(["fit", "r.csv", "--inertia", "2.94", "--laws", path], accepts=False, alone=True)
