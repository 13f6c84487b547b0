"""The page of `jaxbacklash studio` in a real browser: begun as a user begins it, and used by keyboard alone.

What is looked for on it: faults that axe finds for people who cannot see or use a mouse, and whatever a window cuts off.
"""

import os
import re
import shutil
import subprocess
import sys
import time
from contextlib import contextmanager

import pytest

LONG = 600.0
"""Seconds that are never needed; a computation may wait for other work of the machine."""
NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
HEADINGS = {
    "Record": "Which record?", "Model": "Compare the model with the record", "Where it fails": "Where does the model fail?",
    "What is missing": "Which effect is missing?", "Compare": "Compare two models", "Save": "Keep it",
    "Move parameters": "Move a parameter, and see the model move against the record",
}  # fmt: skip
"""What stands at the head of each part of the page."""
SIZES = ((1280, 800), (420, 800))

CLIPPED = """() => {
  const found = []
  const note = (what, part, box) => {
    if (part.width > 1 && part.height > 1 && box && (part.left < box[0] - 1 || part.right > box[1] + 1)) {
      found.push(`${what.slice(0, 60)}: from ${Math.round(part.left)} to ${Math.round(part.right)} in ${box.map(Math.round)}`)
    }
  }
  const inside = (node) => node.shadowRoot ? node.shadowRoot.childNodes
    : node.tagName === "SLOT" ? node.assignedNodes({flatten: true}) : node.childNodes
  const walk = (node, box) => {
    if (node.nodeType === Node.TEXT_NODE) {
      const range = document.createRange()
      range.selectNodeContents(node)
      if (node.data.trim()) { for (const part of range.getClientRects()) { note(node.data.trim(), part, box) } }
      return
    }
    if (node.nodeType !== Node.ELEMENT_NODE || ["STYLE", "SCRIPT", "LINK", "OPTION"].includes(node.tagName)) { return }
    const style = getComputedStyle(node)
    if (style.display === "none" || style.visibility === "hidden" || node.ariaHidden === "true") { return }
    const own = node.getBoundingClientRect()
    if (["INPUT", "SELECT", "BUTTON", "svg", "PROGRESS", "CANVAS"].includes(node.tagName)) { note(node.outerHTML, own, box) }
    if (node.tagName === "svg" || node.tagName === "SELECT") { return }
    if (node.tagName === "INPUT" && node.scrollWidth > node.clientWidth + 1) { found.push(`cut: ${node.value}`) }
    let next = box
    if (box && style.overflowX !== "visible") {
      // What a keyboard can scroll is not cut off; the page as a whole must not need it.
      const scrolls = ["auto", "scroll"].includes(style.overflowX) && node.tabIndex >= 0
      next = scrolls ? null : [Math.max(box[0], own.left), Math.min(box[1], own.right)]
    }
    for (const child of inside(node)) { walk(child, next) }
  }
  walk(document.body, [0, document.documentElement.clientWidth])
  return found
}"""

PLACES = """() => {
  const all = [document.getAnimations().some((one) => one instanceof CSSTransition && one.playState === "running")]
  const walk = (root) => {
    for (const one of root.querySelectorAll(":not([class*=Ripple])")) {  // the ring around what has the focus never rests
      const box = one.getBoundingClientRect()
      all.push(box.right, box.bottom)
      if (one.shadowRoot) { walk(one.shadowRoot) }
    }
  }
  walk(document)
  return all
}"""

FOCUSED = """node => {
  let at = document.activeElement
  while (at && at.shadowRoot && at.shadowRoot.activeElement) { at = at.shadowRoot.activeElement }
  return at === node
}"""


@contextmanager
def browser():
    """A Chromium without a window; a test is skipped where there is none."""
    api = pytest.importorskip("playwright.sync_api", reason="playwright is not here: pip install .[dev]")
    path = next((found for name in NAMES if (found := shutil.which(name))), None)
    if path is None:
        pytest.skip(f"no browser is here, wanted one of {', '.join(NAMES)}")
    with api.sync_playwright() as play:
        one = play.chromium.launch(executable_path=path, args=["--no-sandbox"])
        try:
            yield one
        finally:
            one.close()


def settled(page, seconds=20.0):
    """Wait until what the window shows keeps its place and its colour."""
    end, before = time.monotonic() + seconds, None
    while time.monotonic() < end:
        now = page.evaluate(PLACES)
        if now == before and not now[0]:
            return
        before = now
        page.wait_for_timeout(150)


def cut_off(page):
    """What the window cuts off."""
    return page.evaluate(CLIPPED)


def serious(page):
    """Faults for people who cannot see or use a mouse, of those that axe calls serious or critical."""
    axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="axe is not here: pip install .[dev]")
    for _ in range(2):  # a button may have become active meanwhile: its colour on the way there is no fault
        violations = axe.Axe().run(page).response["violations"]
        found = [
            f"{one['id']}: {node['html'][:160]}"
            for one in violations if one["impact"] in ("serious", "critical") for node in one["nodes"]
        ]  # fmt: skip
        if not found:
            break
        settled(page)
    return found


@contextmanager
def studio(folder, *words, cache=None):
    """`jaxbacklash studio` for a folder, in a process of its own; the address of its page."""
    own = {} if cache is None else {"JAXBACKLASH_CACHE": str(cache)}
    command = [sys.executable, "-m", "jaxbacklash.cli", "studio", "--no-browser", "--folder", str(folder), *words]
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stdout=pipe, stderr=pipe, text=True, env={**os.environ, **own}) as process:
        try:
            said = process.stdout.readline()
            assert "the page is at http://127.0.0.1:" in said, process.stderr.read()
            yield said.split()[-1]
        finally:
            process.terminate()
            errors = process.stderr.read()
    assert "Traceback" not in errors, errors


class Hand:
    """A tab of the browser at the page, with nobody's hand on a mouse."""

    def __init__(self, browser, url, *, width=1280, height=800, scheme="light"):
        self.context = browser.new_context(viewport={"width": width, "height": height}, color_scheme=scheme)
        self.context.set_default_timeout(1000.0 * LONG)
        self.page = self.context.new_page()
        self.faults = []
        self.page.on("pageerror", lambda error: self.faults.append(str(error)))
        self.page.goto(url)
        self.shown("heading", "Which record?")

    def one(self, role, name):
        """What has a role and a name, where it can be seen."""
        return self.page.get_by_role(role, name=name, exact=True).locator("visible=true").first

    def shown(self, role, name):
        """Wait until it can be seen."""
        self.one(role, name).wait_for()

    def says(self, words):
        """Wait until the page says this."""
        self.page.get_by_text(words).locator("visible=true").first.wait_for()

    def gone(self, words):
        """Wait until the page says this no longer."""
        self.page.get_by_text(words, exact=True).wait_for(state="detached")

    def drawn(self, name, after=""):
        """Wait for the drawing of this name, another one than ``after``; its text."""
        place, end = self.one("group", re.compile(f"^{name}")).locator("svg"), time.monotonic() + LONG
        place.first.wait_for()
        while (now := place.first.inner_html()) == after:
            assert time.monotonic() < end
            self.page.wait_for_timeout(20)
        return now

    def idle(self):
        """Wait until nothing is being computed."""
        self.says("Nothing is being computed.")

    def to(self, role, name):
        """Go to a control with the key Tab alone."""
        wanted = self.one(role, name)
        wanted.wait_for()
        for _ in range(200):
            if wanted.evaluate(FOCUSED):
                return
            self.page.keyboard.press("Tab")
        raise AssertionError(f"the key Tab does not come to the {role} {name!r}")

    def push(self, name):
        """Press a button, once it can be pressed."""
        from playwright.sync_api import expect

        expect(self.one("button", name)).to_be_enabled(timeout=1000.0 * LONG)
        self.to("button", name)
        self.page.keyboard.press("Enter")

    def choose(self, name, option):
        """Choose from a list by typing the beginning of what is wanted."""
        self.to("combobox", name)
        self.page.keyboard.type(option)
        assert self.one("combobox", name).evaluate("list => list.selectedOptions[0].text").startswith(option)

    def write(self, name, words):
        """Write into a field."""
        self.to("textbox", name)
        self.page.keyboard.press("Control+A")
        self.page.keyboard.type(words)
        self.page.keyboard.press("Tab")

    def part(self, name):
        """Go to one of the parts of the page."""
        self.to("tab", self.page.get_by_role("tab", selected=True).text_content())
        for _ in range(10):
            if self.one("tab", name).evaluate(FOCUSED):
                self.page.keyboard.press("Enter")
                self.shown("heading", HEADINGS[name])
                return
            self.page.keyboard.press("ArrowRight")
        raise AssertionError(f"the arrow keys do not come to the part {name!r}")

    def listen(self):
        """What the page is sent from its next load on, as a list that grows."""
        frames = []
        self.page.on("websocket", lambda one: one.on("framereceived", lambda frame: frames.append(frame)))
        return frames

    def models(self):
        """The models at the side, as they are told."""
        return self.page.get_by_role("radio").evaluate_all("all => all.map(one => one.closest('label').innerText)")

    def sound(self):
        """Nothing is cut off in a wide window and in a narrow one, and axe finds nothing serious."""
        size = self.page.viewport_size
        for width, height in SIZES:
            self.page.set_viewport_size({"width": width, "height": height})
            self.settled()
            clipped = cut_off(self.page)
            assert not clipped, f"cut off at {width}: {clipped}"
            found = serious(self.page)
            assert not found, f"axe at {width}: {found}"
        self.page.set_viewport_size(size)
        assert self.faults == []

    def settled(self):
        """Wait until what the window shows keeps its place and its colour."""
        settled(self.page)
