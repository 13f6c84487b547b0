"""The page: its parts laid out, and looked at again whenever the session has changed."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from typing import Any

import panel as pn
import panel_material_ui as pmui

from .figures import Gallery
from .parts.compare import ComparePart
from .parts.failure import FailurePart
from .parts.keep import KeepPart
from .parts.missing import MissingPart
from .parts.model import ModelPart
from .parts.part import WIDE, Desk
from .parts.record import RecordPart
from .parts.status import StatusPart
from .parts.values import ValuesPart
from .preference import Preference
from .session import Session

PARTS = (RecordPart, ModelPart, FailurePart, MissingPart, ValuesPart, ComparePart, KeepPart)
EVERY = 100
"""Milliseconds between two looks at whether there is something new."""
NAMELESS = {"& .MuiLinearProgress-root": {"display": "none"}}
"""The toolkit's own sign of work has no name for a screen reader; `StatusPart` tells what is computed."""
TABS = {
    "& .MuiTabs-list, & .MuiTabs-flexContainer": {"flexWrap": "wrap"}, "& .MuiTabs-indicator": {"display": "none"},
    "& .MuiTab-root": {"borderBottom": "2px solid transparent"},
    "& .MuiTab-root.Mui-selected": {"borderBottomColor": "currentColor"},
}  # fmt: skip
"""Names of parts go on in a second line where the window is narrow; the toolkit would let them run out of it."""
SIDE = {"flex": "1 1 260px", "min-width": "0", "max-width": "100%"}
MAIN = {"flex": "4 1 620px", "min-width": "0", "max-width": "100%"}


def page(session: Session, gallery: Gallery, aside: ThreadPoolExecutor) -> Any:
    """The page of one tab: another tab, or the same one loaded anew, shows the same session."""
    desk = Desk(session, gallery, aside)
    status, parts = StatusPart(desk), [kind(desk) for kind in PARTS]
    tabs = pmui.Tabs(*((part.title, part.content) for part in parts), dynamic=True, sx=TABS, **WIDE)
    seen: dict[str, Any] = {}

    def look() -> None:
        status.tick()
        now = session.version, tabs.active
        if seen.get("now") != now:
            seen["now"] = now
            status.refresh()
            parts[tabs.active].refresh()

    tabs.param.watch(lambda _: look(), "active")
    look()
    # In the background: else Panel tells the browser at each look that it is busy, and that it is not.
    pn.io.PeriodicCallback(callback=look, period=EVERY, background=True).start()
    preference: Any = Preference(width=0, height=0, margin=0)
    side = pn.Column(status.content, preference, styles=SIDE)
    main = pn.Column(tabs, styles=MAIN)
    both = pn.FlexBox(side, main, **WIDE)
    whole: Any = pmui.Page(title="jaxbacklash studio", main=[both], sx=NAMELESS)
    preference.param.watch(lambda event: setattr(whole, "dark_theme", event.new), "dark")
    preference.ask()
    return whole
