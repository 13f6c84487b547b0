"""The page: says everything, stands alone, runs nobody else's code, and works in a browser."""

import json
import re
import shutil
import subprocess
from html.parser import HTMLParser

import pytest
from matplotlib.image import imread

from jaxbacklash import BadInput
from jaxbacklash.plot.drawing import on_page, svg_of, to_png_data_uri, to_svg
from jaxbacklash.plot.models import error_by_stage
from jaxbacklash.report.facts import _sentence
from jaxbacklash.report.html import Panel, render, write_report
from jaxbacklash.report.summary import candidate_tables, summarise

from .report_samples import HOSTILE, all_figures, motion, result, stages


@pytest.fixture(scope="module")
def page():
    t, measured, model, starts, residual, _ = motion()
    series = {"t": t, "measured": measured, "model": model, "residual_over_noise": residual}
    drawn = {name: to_svg(figure) for name, figure in all_figures().items()}
    panels = [Panel(name, f"What {name} shows.", svg, name) for name, svg in drawn.items()]
    return render(result(HOSTILE), panels, series | {"window_starts": starts, "label": "z", "unit": "rad"})


class Tags(HTMLParser):
    """Every start tag of a page with its attributes."""

    def __init__(self, text):
        super().__init__()
        self.found = []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.found.append((tag, dict(attributes)))


def test_page_tells_everything(page):
    for words in [
        "Gravity was missing; with it, noise alone is left.",
        "0.026180 ± 0.000011 rad",
        "1.5000 ± 0.0006 deg",
        "13003.8 ± 2.3 N m/rad",
        "not determined: z stays inside &lt;the&gt; play",
        "✓ found",
        "+1.5 %",
        "preload + asymmetric_gap",
        "The methods agree.",
        "none: too short",
        "jaxbacklash refine bench/arm.csv --inertia 3.16",
        "3000 at 500 Hz, 6 s",
        "3×10⁻⁵ rad",
        "What phase shows.",
    ]:
        assert words in page, words


def test_page_stands_alone_and_is_small(page):
    assert "http" not in page
    assert len(page) < 3_000_000
    for tag, attributes in Tags(page).found:
        assert tag not in ("link", "iframe", "object", "embed") or attributes.get("href") == "data:,"
        for name in ("src", "href", "data", "action"):
            address = attributes.get(name) or "#"
            assert address.startswith(("#", "data:")), (tag, address)


def test_ids_are_unique_and_references_resolve(page):
    ids = [a["id"] for _, a in Tags(page).found if "id" in a]
    assert len(ids) == len(set(ids))
    references = set(re.findall(r'href="#([^"]+)"', page)) | set(re.findall(r"url\(#([^)]+)\)", page))
    assert references <= set(ids)


def test_hostile_names_are_text(page):
    tags = Tags(page).found
    assert [a.get("type") for tag, a in tags if tag == "script"] == ["application/json", None]
    assert not [a for tag, a in tags if tag == "img"]
    assert not [a for _, a in tags if any(name.startswith("on") for name in a)]
    assert "&lt;/script&gt;&lt;script&gt;alert(" in page
    panel = Panel("<b>title", 'a "quoted" <i>', svg_of(error_by_stage, []), '"><script>', "<u>detail")
    text = render({"record": {"path": "a"}}, [panel, panel])
    assert not {"b", "i", "u"} & {tag for tag, attributes in Tags(text).found if not attributes}
    assert 'id="figure-script"' in text
    assert 'id="figure-script-2"' in text


@pytest.mark.parametrize("command", ["fit", "refine", "compare"])
def test_page_of_a_bare_result(command):
    text = render({"command": command, "record": {}, "stages": [], "cross_check": None}, [])
    assert "<h1>record</h1>" in text
    one = {"command": command, "record": {"path": "a"}, "stages": stages()[:1], "verdict": "incomplete"}
    text = render(one, [])
    assert "Stage by stage" not in text
    assert "rms over noise 12.9" in text


def test_nothing_is_said_twice_and_what_comes_next_is():
    one = result() | {"verdict_text": "A torque is missing.", "findings": ["A torque is missing.", "It falls with y."]}
    text = render(one | {"next": "jaxbacklash refine 'my arm.csv'"}, [])
    assert text.count("A torque is missing.") == 1
    assert "It falls with y." in text
    assert "Next, to find what is missing: <code>jaxbacklash refine &#39;my arm.csv&#39;</code>" in text
    assert "Next, to find" not in render(one, [])
    listed = [{"name": f"law_{n}", "evidence": 1.0, "why": "predicted from sensitivities, not refitted"} for n in range(9)]
    listed.append({"name": "dahl", "why": "refitted"})
    shown = candidate_tables([stages()[0] | {"candidates": listed}])[0]
    assert [row["why"] for row in shown["rows"]] == [""] * 9 + ["refitted"]
    assert shown["reasons"]


def test_the_table_of_stages_has_a_column_for_each_error_and_the_share_below(page):
    text = " ".join(page.split())
    assert '<th scope="col">rms over noise</th><th scope="col">held out</th>' in text
    assert "<td>12.9<code>2.1 % of the motion, median window 11.8</code></td>" in text
    assert "<td>13.4<code>2.2 % of the motion, median window 12.0</code></td>" in text
    assert "<td>1.01<code>0.16 % of the motion, median window 0.990</code></td><td>–</td>" in text


def test_a_panel_takes_an_image_and_refuses_the_rest():
    image = to_png_data_uri(on_page(error_by_stage, []), 20)
    assert f'<img class="paper" src="{image}"' in render({}, [Panel("t", "s", image, "a")])
    with pytest.raises(ValueError, match="figure_svg"):
        render({}, [Panel("t", "s", "<script>", "a")])


def test_report_is_written_whole_or_not_at_all(tmp_path):
    where = write_report(tmp_path / "report.html", result(), [])
    assert where.read_text(encoding="utf-8").startswith("<!doctype html>")
    with pytest.raises(BadInput, match="cannot be written"):
        write_report(tmp_path / "missing" / "report.html", result(), [])
    assert [p.name for p in tmp_path.iterdir()] == ["report.html"]


BROWSER = ["--headless", "--no-sandbox", "--disable-gpu", "--enable-logging=stderr", "--v=0", "--window-size=1100,1600"]
QUIET = ["quic", "background-networking", "component-update", "sync"]

# A browser without a screen may paint no frames, and the view draws in frames.
FRAMES = "<script>window.requestAnimationFrame = (draw) => setTimeout(draw, 1);</script>"

# Uses the view as a person would, and writes down what came of it.
HANDS = """
<script>
const root = document.getElementById("look-closer"), canvas = root.querySelector("canvas"), seen = [];
const wait = () => new Promise((done) => setTimeout(done, 50));
(async () => {
  await wait();
  seen.push(root.dataset.view);
  for (const name of ["in", "right", "worst", "whole"]) {
    root.querySelector(`[data-do=${name}]`).click();
    await wait();
    seen.push(root.dataset.view);
  }
  const box = canvas.getBoundingClientRect();
  const at = { clientX: box.left + 300, clientY: box.top + 50, bubbles: true, cancelable: true };
  canvas.dispatchEvent(new WheelEvent("wheel", { ...at, deltaY: -300 }));
  await wait();
  seen.push(root.dataset.view);
  canvas.dispatchEvent(new PointerEvent("pointermove", at));
  canvas.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowRight" }));
  await wait();
  seen.push(root.dataset.view, root.querySelector(".readout").textContent);
  canvas.dispatchEvent(new MouseEvent("dblclick", at));
  await wait();
  seen.push(root.dataset.view);
  document.title = JSON.stringify(seen);
})();
</script>
"""


def browse(page, profile, *flags):
    chromium = shutil.which("chromium")
    if chromium is None:
        pytest.skip("chromium is not on PATH, so the page cannot be opened")
    command = [
        chromium,
        *BROWSER,
        "--no-first-run",
        *(f"--disable-{name}" for name in QUIET),
        f"--user-data-dir={profile}",
        *flags,
        page.as_uri(),
    ]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=True)
    console = [line for line in done.stderr.splitlines() if "CONSOLE" in line]
    assert not console, console
    return done.stdout


@pytest.mark.slow
def test_page_in_a_browser(page, tmp_path):
    used = tmp_path / "report.html"
    used.write_text(page.replace("<head>", "<head>" + FRAMES).replace("</body>", HANDS + "</body>"), encoding="utf-8")
    dom = browse(used, tmp_path / "first", "--virtual-time-budget=5000", "--dump-dom")
    tags = Tags(dom).found
    assert sum(tag == "svg" and a.get("role") == "img" for tag, a in tags) == 7
    assert any(a.get("id") == "look-closer" and int(a["data-drawn"]) > 1000 for _, a in tags)
    seen = json.loads(re.search(r"<title>(.*?)</title>", dom).group(1))
    views = [tuple(map(float, v.split())) for v in seen if not v.startswith("t ")]
    whole, closer, later, worst, again, wheeled, moved, reset = views
    assert whole == again == reset == pytest.approx((0.0, 5.998))
    assert closer[1] - closer[0] == pytest.approx(0.5 * whole[1])
    assert later[0] > closer[0]
    assert worst[1] < 4.0
    assert wheeled[1] - wheeled[0] < whole[1]
    assert moved[0] > wheeled[0]
    assert re.match(r"t [\d.]+ s: measured \S+ rad, model \S+ rad, residual \S+ times the noise", seen[-2])

    for scheme, name in enumerate(("dark", "light")):
        shot = tmp_path / f"{name}.png"
        flag = f"--blink-settings=preferredColorScheme={scheme}"
        browse(used, tmp_path / name, flag, f"--screenshot={shot}")
        corner = imread(shot)[5, 5, :3].mean()
        assert corner > 0.9 if name == "light" else corner < 0.2


def test_a_sentence_begins_large_and_a_symbol_stays_small():
    assert _sentence("a torque is missing") == "A torque is missing."
    assert _sentence("z does not repeat with the drive's cycles!") == "z does not repeat with the drive's cycles!"


def test_a_card_gives_no_error_that_would_hold_only_if_the_model_were_right():
    sure = result()
    doubted = sure | {"intervals_note": "only if the model is right: it is not, see the verdict"}
    tiles = [{tile["label"]: tile["value"] for tile in summarise(one)["tiles"]} for one in (sure, doubted)]
    assert "±" in tiles[0]["total play b"]
    assert "±" not in "".join(tiles[1].values())
    assert summarise(doubted)["no_intervals"]
