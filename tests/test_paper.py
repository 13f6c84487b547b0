"""The paper item by item: files that come back as written, a page that shows them, and where the paper contradicts itself."""

import json

import numpy as np
import pytest

from benchmarks.paper.draw import DRAWN, page_of
from benchmarks.paper.item import IN_KIND, NOT, REPRODUCED, Beside, Item, read
from jaxbacklash.plot.drawing import to_svg
from website import paper

KEYS = {"table_1", "table_2", "figure_02", "figure_03", *(f"figure_{n:02d}" for n in range(8, 19))}


def made():
    curves = {"t": np.linspace(0.0, 1.0, 7), "low": np.array([-1.0, np.nan, 0.123456789, 2.0, 3e-9, 4e12, 5.0])}
    beside = (Beside("play", 1.48, 1.5002, "deg"), Beside("regime", "chaotic", "regular"), Beside("scatter", None, None))
    return Item("figure_08", "A series", IN_KIND, "It is made up.", beside, ("It says two things.",), curves)


def test_an_item_comes_back_as_it_was_written(tmp_path):
    item = made()
    again = read(item.write(tmp_path))
    assert (again.key, again.name, again.beside, again.disagrees) == ("figure_08", "Figure 8", item.beside, item.disagrees)
    for name, values in item.curves.items():
        np.testing.assert_allclose(again.curves[name], values, rtol=1e-3)
    told = json.loads((tmp_path / "figure_08.json").read_text())
    assert told["curves"]["low"][1] is None
    assert told["curves"]["low"][2] == 0.1235


def test_every_item_is_kept_with_a_verdict_and_a_reason():
    kept = {item.key: item for item in paper.items()}
    assert set(kept) == KEYS
    for item in kept.values():
        assert item.verdict in (REPRODUCED, IN_KIND, NOT)
        assert len(item.why) > 40
        assert item.beside
    assert {item.key for item in kept.values() if item.curves} == set(DRAWN)


@pytest.mark.parametrize("key", sorted(DRAWN))
def test_every_picture_is_drawn_from_its_file(key):
    svg = to_svg(page_of(read(paper.KEPT / f"{key}.json")))
    assert svg.startswith("<svg")
    assert "currentColor" in svg


def test_the_page_shows_where_the_paper_disagrees_with_itself():
    page = paper.page()
    for words in ("15,095 N m/rad", "13,566", "9.39 Hz", "2.30 kg m^2", "3.16", "2.84", "Omega = omega / omega_0", "bit/time"):
        assert words in page, words
    assert page.count("<svg") == len(DRAWN)
    for item in paper.items():
        assert page.count(f"#{item.key.replace('_', '-')} }}") == 1


def test_the_sums_of_the_disagreement_are_right():
    omega = 2.0 * np.pi * 11.0
    rows = {row.what: row.ours for row in read(paper.KEPT / "figure_11.json").beside}
    assert rows["stiffness that 11 Hz and 3.16 kg m^2 need"] == pytest.approx(3.16 * omega**2, rel=1e-4)
    lower = np.sqrt(11000 / 3.16) / (2.0 * np.pi)
    assert rows["frequency that 11,000 N m/rad and 3.16 kg m^2 give"] == pytest.approx(lower, rel=1e-3)
    assert rows["inertia that 11 Hz and 11,000 N m/rad give"] == pytest.approx(11000.0 / omega**2, rel=2e-3)


def test_the_straight_line_reads_the_papers_numbers_from_a_joint_of_another_stiffness():
    rows = {row.what: row.ours for row in read(paper.KEPT / "figure_14.json").beside}
    for method in ("Hilbert, 1 %", "Hilbert, 0.5 %", "wavelet"):
        assert rows[f"play, line through the upper half, {method}"] == pytest.approx(1.48, rel=0.05)
        assert rows[f"stiffness, line through the upper half, {method}"] == pytest.approx(11000.0, rel=0.1)
    assert rows["true stiffness of the simulated joint"] == pytest.approx(15095.0, rel=1e-4)
