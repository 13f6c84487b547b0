"""The report of every command in a real browser, dark and light, wide and narrow: nothing cut off, nothing serious for axe."""

import pytest

from tests.browser import LONG, SIZES, browser, cut_off, serious, settled
from tests.in_process import call
from tests.test_studio_page import DATA

RECORD, HELD = str(DATA / "demo_train.csv"), str(DATA / "demo_heldout.csv")
SHORT = ["--inertia", "3.16", "--from", "0", "--to", "4"]
COMMANDS = {
    "look": ["look", RECORD],
    "fit": ["fit", RECORD, "--heldout", HELD, *SHORT],
    "diagnose": ["diagnose", RECORD, *SHORT],
    "refine": ["refine", RECORD, "--heldout", HELD, *SHORT],
    "skeleton": ["skeleton", RECORD, "--inertia", "3.16"],
    "chaos": ["chaos", RECORD, "--channel", "z"],
    "map": ["map", "--inverse-alpha", "1:5:12", "--zeta", "0.005:0.03:6"],
}


@pytest.fixture(scope="module")
def chromium():
    with browser() as one:
        yield one


@pytest.mark.slow
@pytest.mark.parametrize("command", COMMANDS)
def test_a_report_can_be_read_by_everybody(chromium, tmp_path, command):
    words = COMMANDS[command]
    out = tmp_path / ("out.nc" if command == "map" else "out")
    done = call([*words, "--out", str(out)], tmp_path)
    assert done.code == 0, done.err
    (path,) = tmp_path.rglob("*.html")
    for scheme in ("light", "dark"):
        context = chromium.new_context(color_scheme=scheme)
        context.set_default_timeout(1000.0 * LONG)
        page = context.new_page()
        faults = []
        page.on("pageerror", lambda error, faults=faults: faults.append(str(error)))
        page.goto(path.as_uri())
        for width, height in SIZES:
            page.set_viewport_size({"width": width, "height": height})
            settled(page)
            where = f"{command}, {scheme}, {width} wide"
            assert not cut_off(page), f"{where}: cut off: {cut_off(page)}"
            assert not serious(page), f"{where}: {serious(page)}"
        assert faults == []
        context.close()
