"""Build the site: ``python -m website``. What is made from the package, then the pages without a warning, then the links.

The site lies in ``site/`` afterwards; open ``site/index.html``. Needs ``pip install ".[docs]"``.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

from . import benchmarks, catalogue, commands, links, paper

ROOT = Path(__file__).resolve().parents[1]
DOCS, SITE = ROOT / "docs", ROOT / "site"


def write_pages() -> None:
    """The pages that are made from the package and from the papers at the door."""
    made = {"commands": commands.page(), "catalogue": catalogue.page(), "benchmarks": benchmarks.page(), "paper": paper.page()}
    for name, at_the_door in (("conventions", "CONVENTIONS.md"), ("changes", "CHANGELOG.md")):
        made[name] = (ROOT / at_the_door).read_text(encoding="utf-8")
    for name, text in made.items():
        (DOCS / f"{name}.md").write_text(text, encoding="utf-8")


def main() -> int:
    """Build, and say what is wrong."""
    write_pages()
    shutil.rmtree(SITE, ignore_errors=True)
    builder = shutil.which("zensical", path=os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")]))
    if builder is None:
        print('website: zensical is not installed: pip install ".[docs]"', file=sys.stderr)
        return 2
    done = subprocess.run([builder, "build", "--strict", "--clean"], cwd=ROOT, stdin=subprocess.DEVNULL)
    if done.returncode:
        return done.returncode
    wrong = [f"leads nowhere: {link}" for link in links.broken(SITE)]
    wrong += [f"asks another address: {link}" for link in links.asked_elsewhere(SITE)]
    print(
        "\n".join(wrong)
        if wrong
        else f"{len(list(SITE.rglob('*.html')))} pages, every link leads somewhere: {SITE / 'index.html'}"
    )
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
