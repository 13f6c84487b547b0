"""The server of the page: on this machine's own address, behind `guard`, with Bokeh's server and Panel's documents."""

from __future__ import annotations

import asyncio
import atexit
import logging
import shutil
import sys
import tempfile
import webbrowser
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from ..errors import BadInput
from .figures import Gallery
from .guard import ADDRESS, guarded, new_token
from .session import Session

MISSING = 'the page needs Panel, which is not installed: pip install "jaxbacklash[studio]"'


class Server:
    """The page of a session at an address that nobody can guess.

    Parameters
    ----------
    session : the work that is shown
    port : 0 takes a free one

    Attributes: ``url`` of the page; ``sockets`` that are listened to.

    Raises
    ------
    BadInput
        Panel is not installed, or the port is taken.
    """

    def __init__(self, session: Session, *, port: int = 0) -> None:
        try:
            import panel_material_ui  # noqa: F401
            from bokeh.server.server import BaseServer
            from bokeh.server.tornado import BokehTornado
            from bokeh.server.util import bind_sockets
            from panel.io.application import build_applications
            from panel.io.server import get_static_routes
            from tornado.httpserver import HTTPServer
            from tornado.ioloop import IOLoop
        except ImportError as error:
            raise BadInput(f"{MISSING} ({error})") from None
        from .page import page

        asyncio.set_event_loop(asyncio.new_event_loop())
        self.loop = IOLoop.current()
        try:
            self.sockets, self.port = bind_sockets(ADDRESS, port)
        except OSError as error:
            raise BadInput(f"--port {port}: cannot be used ({error.strerror}), wanted a free one, or 0 for any") from None
        self.session, self.token = session, new_token()
        self._gallery, self._aside = Gallery(session.touch), ThreadPoolExecutor(1)
        show: Callable[[], Any] = lambda: page(session, self._gallery, self._aside)  # noqa: E731
        applications = build_applications(show, title="jaxbacklash studio", location=False)
        names = [f"{ADDRESS}:{self.port}", f"localhost:{self.port}"]
        application = guarded(BokehTornado)(
            applications, prefix=self.token, extra_websocket_origins=names, extra_patterns=get_static_routes({}),
            absolute_url=f"http://{ADDRESS}:{self.port}", websocket_max_message_size_bytes=20 * 2**20, include_cookies=[],
        )  # fmt: skip
        application.token, application.port = self.token, self.port
        http = HTTPServer(application)
        http.add_sockets(self.sockets)
        self._server = BaseServer(self.loop, application, http)
        self.url = f"http://{ADDRESS}:{self.port}/{self.token}/"

    def run(self) -> None:
        """Serve until the process ends or `stop` is called."""
        for name in ("tornado.access", "tornado.general", "bokeh.server.views.ws"):
            logging.getLogger(name).setLevel(logging.ERROR)  # what is refused, and tabs that are closed, concern nobody
        logging.getLogger("tornado.application").addFilter(_no_early_leave)
        self.loop.asyncio_loop.set_exception_handler(_unless_closed)  # type: ignore[attr-defined]
        self._gallery.warm()
        self._server.start()
        self.loop.start()
        self._server.stop()
        self._gallery.close()
        self._aside.shutdown(wait=False, cancel_futures=True)

    def stop(self) -> None:
        """End `run`, from any thread."""
        self.loop.add_callback(self.loop.stop)


def _unless_closed(loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
    """Tell of an error, but not that a tab was closed while something was on its way to it."""
    from tornado.websocket import WebSocketClosedError

    if not isinstance(context.get("exception"), WebSocketClosedError):
        loop.default_exception_handler(context)


def _no_early_leave(entry: logging.LogRecord) -> bool:
    """False of what Bokeh's server (3.9) says of a tab that was closed before it was connected."""
    kind, _, trace = entry.exc_info or (None, None, None)
    while trace is not None and trace.tb_next is not None:
        trace = trace.tb_next
    return not (kind is AssertionError and trace is not None and trace.tb_frame.f_code.co_filename.endswith("connection.py"))


def open_browser(url: str) -> None:
    """Open the page without its address on any command line, where other users of the machine would read it."""
    folder = Path(tempfile.mkdtemp(prefix="jaxbacklash-"))  # for this user alone
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    file = folder / "open.html"
    go_on = f'<meta http-equiv="refresh" content="0;url={url}">'
    file.write_text(f'<!doctype html><meta charset="utf-8"><title>jaxbacklash</title>{go_on}', encoding="utf-8")
    file.chmod(0o600)
    try:
        webbrowser.open(file.as_uri())
    except webbrowser.Error as error:
        print(f"warning: no browser could be opened ({error})", file=sys.stderr)
