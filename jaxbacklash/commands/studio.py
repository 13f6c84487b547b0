"""``jaxbacklash studio``: a page on this machine to work in."""

from __future__ import annotations

import shlex
from pathlib import Path

from ..errors import BadInput
from .reading import Reading


def run(
    record: Path | None, *, folder: Path | None, heldout: Path | None, inertia: float | None, model: str, translational: bool,
    reading: Reading, port: int, browser: bool,
) -> None:  # fmt: skip
    """Serve the page until the command is ended."""
    from ..program import start
    from ..studio.choice import Choice
    from ..studio.folder import Folder
    from ..studio.serving import Server, open_browser
    from ..studio.session import Session
    from ..studio.work import Setup

    root = Folder(folder or (record.parent if record is not None else Path.cwd()))
    options = reading.options()
    names = [None if path is None else _within(root.root, path) for path in (record, heldout)]
    setup = Setup(model, inertia, translational)
    session = Session(root)  # its process loads its libraries while this one does
    try:
        start(brief=True, devices=1)
        session.choose(setup)
        if names[0] is not None:
            session.open(Choice(names[0], options))
        if names[1] is not None:
            session.open_heldout(Choice(names[1], options))
        server = Server(session, port=port)
        print(f"the page is at {server.url}\nEnd it with Ctrl-C.", flush=True)
        if browser:
            open_browser(server.url)
        server.run()
    finally:
        session.close()


def _within(root: Path, path: Path) -> str:
    """A file's name in the folder that the page may read."""
    try:
        return path.resolve().relative_to(root).as_posix()
    except ValueError:
        raise BadInput(
            f"{shlex.quote(str(path))}: lies outside the folder {root}, which is all that the page may read; pass a folder that "
            "holds all records as --folder"
        ) from None
