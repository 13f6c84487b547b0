"""The report of every command in a real browser, dark and light, wide and narrow: nothing cut off, nothing serious for axe."""

import numpy as np
import pytest

import jaxbacklash as jb
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
    "compare": ["compare", "model.toml", HELD, "--from", "0", "--to", "4"],
    "lost-motion": ["lost-motion", "slow.csv"],
    "map": ["map", "--inverse-alpha", "1:5:12", "--zeta", "0.005:0.03:6"],
}


def dragged():
    """A link that friction holds until its play is crossed, moved slowly to and fro."""
    t = np.arange(0.0, 60.0, 0.01)
    base, link = 0.6 * np.sin(0.7 * t), np.zeros_like(t)
    for i in range(1, t.size):
        link[i] = np.clip(link[i - 1], base[i] - 0.006, base[i] + 0.006)
    return jb.Record(t, {"x": base, "y": link + 1e-4 * np.random.default_rng(0).standard_normal(t.size)})


@pytest.fixture(scope="module")
def chromium():
    with browser() as one:
        yield one


@pytest.mark.slow
@pytest.mark.parametrize("command", COMMANDS)
def test_a_report_can_be_read_by_everybody(chromium, tmp_path, command):
    words = COMMANDS[command]
    joint = jb.base_motion_joint(inertia=3.16, backlash=0.026, stiffness=13000.0, damping=12.0)
    (tmp_path / "model.toml").write_text(jb.dump_model(joint))
    jb.write_record(dragged(), tmp_path / "slow.csv")
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
