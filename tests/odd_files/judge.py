"""What a command made of an odd file: read right, refused rightly, said beside the answer, or wrong.

The quick way stops after reading and compares the columns with what was written; the full way fits and compares the intervals,
widened from 95 % to 4.5 standard errors, so that chance alone makes no row. Text to paste is followed, up to three times.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from tests.in_process import CRASH, Outcome, call, read_only
from tests.odd_files.draft import READ, REFUSED, SAID, Draft
from tests.odd_files.paste import offers, pasted, shell

WRONG, UNREAD, MESSAGE, PASTE, CRASHED, OPEN = "WRONG", "UNREAD", "MESSAGE", "PASTE", "CRASH", "open"
"""A wrong answer without a word; refused though it can be read; a refusal that lacks what it must name; text to paste that does
not work; a traceback; and, after reading alone, nothing said yet of what only a fit can see."""
FAILURES = (WRONG, UNREAD, MESSAGE, PASTE, CRASHED)
WIDER = 4.5 / 1.96
"""Of some 200 independent numbers one is beyond 4.5 standard errors in every tenth run, and beyond 4.5 in one of 700."""
HOPS = 3
KNOWN = {"HZ": "500"}


@dataclass(frozen=True)
class Verdict:
    """What was found, the last command run, and the sentence or numbers behind it."""

    found: str
    command: str
    detail: str = ""

    @property
    def failed(self) -> bool:
        """Whether this must not be."""
        return self.found in FAILURES


def judge(draft: Draft, folder: Path, full: bool = False) -> Verdict:
    """Write a draft into a folder, run its command, and judge."""
    draft.write(folder)
    return judged(draft, folder, draft.command(), full)


def judged(draft: Draft, folder: Path, words: Sequence[str], full: bool, hop: int = 0) -> Verdict:
    """The same for a file that is there, with the words of a command."""
    outcome = call([*words, "--json"], folder) if full else read_only(words, folder)
    command = shell(words)
    if outcome.code == CRASH or re.search("Traceback|internal error", outcome.err):
        return Verdict(CRASHED, command, outcome.last)
    if outcome.code == 0:
        right, detail = numbers_right(draft, outcome) if full else columns_right(draft, outcome, "--resample" in words)
        if right:
            return Verdict(READ, command, outcome.last)
        if draft.right != READ and told(draft, outcome):
            return Verdict(SAID, command, outcome.last)
        # Once what one kind is refused for is answered, what another shows to a fit alone is still open.
        right = SAID if hop and SAID in draft.rights else draft.right
        return Verdict(OPEN if right == SAID and not full else WRONG, command, detail)
    if len(outcome.sentences) != 1:
        return Verdict(MESSAGE, command, f"{len(outcome.sentences)} sentences: {outcome.err[-300:]}")
    sentence = outcome.sentences[0]
    if outcome.code == 1:
        return Verdict(SAID if draft.right != READ else UNREAD, command, sentence)
    if draft.right == READ:
        return Verdict(UNREAD, command, sentence)
    if hop == 0 and not any(all(re.search(word, sentence, re.I) for word in words_of_one) for words_of_one in draft.words):
        return Verdict(MESSAGE, command, f"wanted {draft.words} in: {sentence}")
    return _followed(draft, folder, words, full, hop, sentence)


def _followed(draft: Draft, folder: Path, words: Sequence[str], full: bool, hop: int, sentence: str) -> Verdict:
    """What comes of a refusal's text to paste."""
    command, texts = shell(words), offers(sentence)
    if not draft.truth:  # nothing can be made of this file
        return Verdict(REFUSED, command, sentence)
    true = [text for text in texts if draft.remedy and re.search(draft.remedy, text)]
    if not texts or hop == HOPS:
        return Verdict(PASTE, command, ("still refused: " if texts else "nothing to paste in: ") + sentence)
    if "second needs the count" in draft.kinds:
        return Verdict(REFUSED, command, sentence)
    try:
        second = pasted(words, (true or texts)[0], folder, KNOWN)
    except ValueError as why:
        return Verdict(PASTE, command, str(why))
    verdict = judged(draft, folder, second, full, hop + 1)
    if verdict.found in (UNREAD, MESSAGE):
        return Verdict(PASTE, verdict.command, verdict.detail)
    return verdict if verdict.failed else Verdict(REFUSED, verdict.command, sentence)


def told(draft: Draft, outcome: Outcome) -> bool:
    """Whether a word about the cause stands beside an answer."""
    beside = outcome.err
    if outcome.out.lstrip().startswith("{"):
        beside += "\n" + "\n".join(sentences(json.loads(outcome.out)))
    return any(re.search(words[-1], beside, re.I) for words in draft.words)


def sentences(result: Any) -> Iterator[str]:
    """The texts of a result that a person is shown; names of candidates and the command itself tell nothing."""
    if isinstance(result, dict):
        for key, value in result.items():
            if key not in ("candidates", "command", "command_line", "record", "parameters"):
                yield from sentences(value)
    elif isinstance(result, list):
        for value in result:
            yield from sentences(value)
    elif isinstance(result, str):
        yield result


def numbers_right(draft: Draft, outcome: Outcome) -> tuple[bool, str]:
    """Whether the printed intervals hold the truth, and those that do not."""
    parameters = json.loads(outcome.out)["stages"][-1]["parameters"]
    if not draft.truth:
        sure = [name for name in ("backlash", "stiffness") if parameters.get(name, {}).get("ci95")]
        return not sure, f"{', '.join(sure)} of a record that tells none"
    missed = [missed_by(parameters.get(name, {}), truth, name) for name, truth in draft.truth.items()]
    return not any(missed), "; ".join(filter(None, missed))


def missed_by(parameter: dict[str, Any], truth: float, name: str) -> str:
    """The sentence of an interval that excludes the truth, empty where it does not or none was given."""
    value, interval = parameter.get("value"), parameter.get("ci95")
    if value is None or not interval or None in interval:
        return ""
    low, high = (value + WIDER * (end - value) for end in interval)
    slack = 1e-9 * abs(truth)
    return "" if low - slack <= truth <= high + slack else f"{name} {value:.6g} in [{low:.6g}, {high:.6g}], truth {truth:.6g}"


def columns_right(draft: Draft, outcome: Outcome, resampled: bool) -> tuple[bool, str]:
    """Whether the record read is the one written, to within the rounding of the file; and where it is not."""
    reference = draft.reference
    if reference is None or not outcome.records:
        return False, "no record of this file is right as it stands"
    record = outcome.records[0]
    t = np.asarray(record.t) - record.t[0]
    rate, wanted = (t.size - 1) / t[-1], (reference.t.size - 1) / (reference.t[-1] - reference.t[0])
    slack = 2e-3 if resampled else 2e-6  # where stamps are rounded, the grid's rate is an estimate; the values are still those
    if abs(rate / wanted - 1.0) > slack:
        return False, f"rate {rate:.6g} Hz for {wanted:.6g} Hz"
    for name, values in reference.channels.items():
        if name not in record.channels:
            return False, f"channels {', '.join(record.channels)} without {name}"
        seen = np.asarray(record.channels[name])
        miss = seen - np.interp(t, reference.t, values)
        if "zero is lost" in draft.kinds:  # a counter that overflows tells how far something went, not from where
            miss -= np.median(miss)
        if np.max(np.abs(miss)) > draft.tolerance:
            row = int(np.argmax(np.abs(miss)))
            return False, f"column {name} is off by {miss[row]:.3g} at row {row + 1}"
    return True, ""
