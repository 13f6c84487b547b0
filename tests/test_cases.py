"""The collected cases: files as people bring them and records whose misfit has a cause, each judged as its answer file says."""

import json
import re
import shlex
from dataclasses import dataclass

import pytest

from tests.in_process import CRASH, call
from tests.odd_files.draft import READ, REFUSED, SAID, Draft
from tests.odd_files.judge import judged, missed_by, sentences

pytestmark = [pytest.mark.shared, pytest.mark.slow]


@dataclass(frozen=True)
class Right:
    """What is right: how it ends, what a refusal or a word beside the answer must say (the last is the cause), which offer of
    several is true of the file, and what must be told beside an answer that is right."""

    way: str = READ
    words: tuple[str, ...] = ()
    remedy: str = ""
    beside: str = ""


CASES = {
    "wrap_pi.csv": Right(REFUSED, (r"\bx\b", r"(rows?|lines?) .*\b45[5-8]\b", r"--unwrap", r"2 ?pi|turn|6\.28"), "--unwrap"),
    "smalldeg_hdr.csv": Right(beside=r"deg"),
    "thousands.txt": Right(REFUSED, (r"\d,\d{3}", r"line|row", r"thousand|two ways|decimal"), r"decimal[ =]+'?\."),
    "zoh100.csv": Right(SAID, (r"\bz\b", r"held|hold|refresh|stay|repeat|every")),
    "drift200ppm.csv": Right(SAID, (r"clock|ppm",)),
    "comma_name.csv": Right(REFUSED, (r"--columns", r"quote|#\d|number|\"")),
    "gear10.csv": Right(SAID, (r"\b[xy]\b", r"0\.1|10", r"gear|ratio|follows"), "--ratio"),
    "signflip.csv": Right(SAID, (r"-x|sign|other way", r"--sign"), "--sign"),
    "shift4ms.csv": Right(SAID, (r"late|delay|lag",)),
    "notime.csv": Right(),
    "iso.csv": Right(),
    "tek_preamble.csv": Right(beside=r"lines?\b.*\b(9|10|11)\b"),
    "percent.csv": Right(),
    "unit_row_deg.csv": Right(beside=r"unit"),
    "sep.csv": Right(),
    "dup_cols.csv": Right(SAID, (r"Time", r"twice|more than once|first|second|#\d|clock"), beside=r"Time"),
    "quoted_comma.csv": Right(),
    "nanrun.csv": Right(beside=r"row|line"),
    "structtime.mat": Right(REFUSED, (r"signals\.values|signals", r"time")),
    "tofile.mat": Right(REFUSED, (r"3 ?(x|by|,|\u00d7|rows)|\(3, 3001\)", r"#\d|row|column")),
    "accel3.csv": Right(REFUSED, (r"accel|--columns|both|three|which",)),
    "utf16_nobom.txt": Right(),
    "zero_sentinel.csv": Right(SAID, (r"\b[xz]\b", r"row|line", r"\b0\b|sentinel|despike|stand|outl")),
    "m.xlsx": Right(SAID, (r"Time \[s\]", r"--columns")),  # its names are no channels: one command more
    "d.json": Right(SAID, (r"data", r"--columns")),  # a matrix without names
    "ref.csv.gz": Right(),
}


@pytest.mark.parametrize("name", CASES)
def test_a_file_as_people_bring_it(shared, name):
    folder = shared / "cases"
    case = next(each for each in json.loads((folder / "cases.json").read_text()) if each["file"] == name)
    right = CASES[name]
    truth = {{"gravity": "gravity.G"}.get(key, key): value for key, value in (case["truth"] or {}).items()}
    words = ["fit", name, *shlex.split(case["arguments"])]
    draft = Draft([], None, right=right.way, words=[right.words] if right.words else [], remedy=right.remedy, truth=truth)
    verdict = judged(draft, folder, words, full=True)
    assert not verdict.failed, f"{verdict.found}: {verdict.command}\n{verdict.detail}"
    if verdict.found == READ and right.beside:
        told = call([*words, "--json"], folder).err
        assert re.search(right.beside, told, re.I), told


# ---- Records whose misfit has a cause ----


def answered(shared, name):
    """The result of a case's command, exit code, and all that a person is told."""
    folder = shared / "cases" / "physics"
    words = shlex.split((folder / f"{name}.cmd").read_text())[1:]
    outcome = call([*words, "--json"], folder)
    assert outcome.code in (0, 1, 2)
    assert outcome.code != CRASH
    assert "Traceback" not in outcome.err
    result = json.loads(outcome.out) if outcome.code == 0 else {}
    return result, outcome.err + "\n" + "\n".join(sentences(result))


def missed(result, **truth):
    """Sentences of the intervals that exclude the truth."""
    parameters = result["stages"][-1]["parameters"]
    return [text for name, value in truth.items() if (text := missed_by(parameters.get(name, {}), value, name))]


SMALL = {"backlash": 0.012, "stiffness": 300.0, "damping": 0.4}
"""The truth of two of them."""


def test_x_in_the_wrong_unit(shared):
    result, told = answered(shared, "f05_ratio")
    assert not result or not missed(result, **SMALL) or re.search(r"gain|ratio|unit|1\.5", told)


def test_z_with_the_wrong_sign(shared):
    result, told = answered(shared, "f06_signflip")
    assert not result or not missed(result, **SMALL) or re.search(r"sign|turned|other way", told)


def test_an_inertia_ten_times_off(shared):
    result, told = answered(shared, "f08_inertia10")
    assert re.search(r"inertia", told)
    assert re.search(r"0\.3[45]", told)
    assert not result or not missed(result, backlash=0.02, stiffness=600.0, damping=1.1) or "0.035" in told


def test_a_contact_shorter_than_the_sampling(shared):
    result, _ = answered(shared, "f14_impact")
    assert result
    assert not missed(result, backlash=0.02, stiffness=6.32e6)


def test_a_heavily_damped_decay_without_play(shared):
    result, _ = answered(shared, "f15_heavedecay")
    assert not result or not missed(result, stiffness=55.5, damping=1.877)
    play = (result or {"stages": [{"parameters": {"backlash": {}}}]})["stages"][-1]["parameters"]["backlash"]
    assert not play.get("ci95") or play["ci95"][0] is None or play["ci95"][0] <= 1e-4


def test_a_link_that_is_held_at_first(shared):
    result, told = answered(shared, "f17_hold")
    named = re.search(r"held|hold|at rest|release|1\.[45]\d* s", told)
    assert named or not missed(result, backlash=0.05, stiffness=900.0, damping=1.2)


def test_gravity_of_a_tilted_link(shared):
    result, _ = answered(shared, "f18_pose")
    assert "gravity" in str(result["effects"])
    zero = result["stages"][-1]["parameters"].get("gravity.phi0")
    assert result["verdict"] == "incomplete" or zero or re.search(r"preload|offset", str(result["effects"]))


def test_a_record_at_50_hz(shared):
    result, _ = answered(shared, "f21b_50hz")
    assert not missed(result, backlash=0.04, stiffness=12.0, damping=0.15)
    assert result["noise"]["y"] == pytest.approx(4e-4, rel=0.2)


def test_y_alone_is_late(shared):
    result, told = answered(shared, "f24_delay")
    assert re.search(r"late|delay|lag", told + str(result.get("effects"))) or result["verdict"] == "incomplete"


def test_spikes_are_no_physics(shared):
    result, told = answered(shared, "f33b_glitch")
    assert not result or result["effects"] == []
    assert re.search(r"row|spike|sample|despike", told)


def test_a_drift_before_surrogates(shared):
    result, told = answered(shared, "c16_lorenz_trend")
    assert result["verdict"] == "chaotic" or (result["verdict"] == "undecided" and re.search(r"drift|trend", told))
    if result["verdict"] == "chaotic":
        assert not missed_by(result["lyapunov"], 0.906, "exponent")
