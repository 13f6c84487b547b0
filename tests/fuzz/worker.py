"""A warm process that runs commands one after the other: a line of JSON in, a line of JSON out."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path

from tests.in_process import call


def main() -> None:
    """Answer until stdin ends. The answers have a pipe of their own, so that nothing a command prints gets between them."""
    with os.fdopen(os.dup(1), "w") as answers:
        os.dup2(2, 1)
        for line in sys.stdin:
            told = json.loads(line)
            outcome = call(told["words"], Path(told["folder"]))
            answers.write(json.dumps([outcome.code, outcome.out, outcome.err, outcome.seconds]) + "\n")
            answers.flush()


if __name__ == "__main__":
    main()
