"""What a message offers to paste, taken out as a person would, and split into words by bash itself."""

from __future__ import annotations

import re
import shlex
import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path

NO_VALUE = ("--resample", "--translation", "--profile", "--json", "--no-clean", "--force")
# A word of a shell: quoted pieces, escaped characters and plain ones.
_WORD = r"(?:'[^']*'|\"(?:[^\"\\]|\\.)*\"|\\.|[^\s'\"\\;])+"
_OPTION = re.compile(rf"(?<![\w'\"-])(--[a-z][a-z-]*)(?:[ =]({_WORD}))?")
_CHANNEL_LIST = r"[txzyFT](,[txzyFT])*"
_VALUES = {
    "--columns": r"\W*[txzyFT]=.+", "--unit": r"\W*[txzyFT]=.+", "--scale": r"\W*[txzyFT]=.+",
    "--rate": r"[\d.eE+-]+|HZ", "--ratio": r"[\d.eE+-]+|N", "--skip": r"\d+|N", "--resample-rate": r"[\d.]+|HZ",
    "--unwrap": _CHANNEL_LIST, "--sign": _CHANNEL_LIST, "--despike": _CHANNEL_LIST, "--decimal": r"['\"]?[.,]['\"]?|comma|point",
}  # fmt: skip


def offers(message: str) -> list[str]:
    """The texts to paste: whole commands first, then groups of options that stand together."""
    whole = [found.rstrip(" .") for found in re.findall(r"\bjaxbacklash (?:fit|look|refine|diagnose|chaos)\b [^\n]*", message)]
    groups: list[str] = []
    end = -9
    for found in _OPTION.finditer(message):
        flag, value = found[1], found[2]
        text, stop = flag, found.end(1)
        if flag not in NO_VALUE:
            cleaned = (value or "") if flag == "--decimal" else (value or "").rstrip(".,:)")
            if value is None or not re.fullmatch(_VALUES.get(flag, r".+"), cleaned):
                continue
            text, stop = f"{flag} {cleaned}", found.start(2) + len(cleaned)
        if found.start() - end == 1 and groups:
            groups[-1] += " " + text
        else:
            groups.append(text)
        end = stop
    return whole + groups


def bash_words(text: str, folder: Path) -> list[str]:
    """The words that bash makes of a text.

    Raises
    ------
    ValueError
        Where bash does not take it for a plain list of words.
    """
    script = f"words() {{ printf '%s\\0' \"$@\"; }}; words {text}"
    run = subprocess.run(["bash", "-c", script], cwd=folder, capture_output=True, timeout=10, check=False)
    if run.returncode or run.stderr:
        raise ValueError(f"bash does not take {text!r}: {run.stderr.decode().strip()}")
    return run.stdout.decode().split("\0")[:-1]


def pasted(words: Sequence[str], offer: str, folder: Path, known: Mapping[str, str]) -> list[str]:
    """The command with an offer followed: a whole command replaces it, options replace those of their name or are added.

    ``known`` says what a person puts for the words in capitals that an offer leaves open.
    """
    for blank, value in known.items():
        offer = re.sub(rf"(?<![A-Za-z]){blank}(?![A-Za-z])", value, offer)
    given = bash_words(offer, folder)
    if given[0] == "jaxbacklash":
        return given[1:]
    new = list(words)
    for place, flag in enumerate(given):
        if flag not in ("--columns", "--unit", "--scale") or flag not in new or place + 1 == len(given):
            continue
        at = new.index(flag)
        kept = [pair for pair in _pairs(new[at + 1]) if pair[:2] not in {each[:2] for each in _pairs(given[place + 1])}]
        new[at : at + 2] = [flag, ",".join(kept)] if kept else []
    if "--resample" in given and "--resample" in new:
        new.remove("--resample")
    return new + given


def _pairs(value: str) -> list[str]:
    """The pairs CHANNEL=VALUE of an option; commas within a value stay with it."""
    return re.split(r",(?=[txzyFT]=)", value)


def shell(words: Sequence[str]) -> str:
    """A command as one line of a shell."""
    return "jaxbacklash " + shlex.join(words)
