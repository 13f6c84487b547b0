"""For mkdocstrings: what stands behind the colon of a parameter in this package is words, its type is the annotation."""

from __future__ import annotations

import re
from typing import Any

import griffe

SECTION = re.compile(r"^(\w[\w ]*)\n-{3,}\n", flags=re.MULTILINE)


class PlainWords(griffe.Extension):
    """Moves the words to where a page shows descriptions."""

    def on_function(self, *, func: griffe.Function, **_: Any) -> None:
        """Rewrite the docstring of a function before it is parsed."""
        if func.docstring is not None:
            func.docstring.value = rewritten(func.docstring.value, str(func.returns or "None"))

    on_function_instance = on_function


def rewritten(text: str, returns: str) -> str:
    """The docstring with names alone at the margin and words below them; a section's words of what comes back below the type.

    Examples
    --------
    >>> print(rewritten("Fit.\\n\\nParameters\\n----------\\nrate : samples per second\\n", "Fit"))
    Fit.
    <BLANKLINE>
    Parameters
    ----------
    rate
        samples per second
    <BLANKLINE>
    """
    begins = [*SECTION.finditer(text)]
    out = text[: begins[0].start()] if begins else text
    for here, following in zip(begins, [*begins[1:], None]):
        body = text[here.end() : following.start() if following else len(text)]
        if here.group(1) == "Parameters":
            body = re.sub(r"^(\*{0,2}\w[\w, *]*) : (.*)$", r"\1\n    \2", body, flags=re.MULTILINE)
        elif here.group(1) == "Returns" and not re.match(r"\S.*\n {4}\S", body):
            words = "\n".join(f"    {line.strip()}" for line in body.strip().splitlines())
            body = f"{returns}\n{words}\n\n"
        out += here.group() + body
    return out
