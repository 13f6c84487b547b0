"""Who may ask the page's server for anything: only who has the token, under the server's own name, and no page of another origin.

The token is the first part of every address, so that nothing is found without it. Further, the name that a request was sent to
must be this machine's (another name may have been made to point here), and a request that another site's page has made is
refused, but for a plain visit of the page. All answers forbid the page to load anything from elsewhere.
"""

from __future__ import annotations

import hmac
import secrets
from collections.abc import Mapping
from typing import Any

TOKEN_BYTES = 32
ADDRESS = "127.0.0.1"
HEADERS = {
    # Panel's components are modules and styles that it makes at run time; none of them may come from, or speak to, elsewhere.
    "Content-Security-Policy": "default-src 'none'; script-src 'self' 'unsafe-inline' 'unsafe-eval' blob:; "
    "style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; font-src 'self' data:; connect-src 'self' blob:; "
    "worker-src blob:; frame-ancestors 'none'; base-uri 'none'; form-action 'none'",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cache-Control": "no-store",
}
"""What goes with every answer."""


def new_token() -> str:
    """A random token that can stand in an address."""
    return secrets.token_urlsafe(TOKEN_BYTES)


def allowed(path: str, headers: Mapping[str, str], *, token: str, port: int) -> bool:
    """Whether a request is answered at all.

    Parameters
    ----------
    path : of the address, with a leading slash
    headers : of the request
    token, port : of the server

    Examples
    --------
    >>> allowed("/abc/", {"Host": "127.0.0.1:5006"}, token="abc", port=5006)
    True
    >>> allowed("/", {"Host": "127.0.0.1:5006"}, token="abc", port=5006)
    False
    >>> allowed("/abc/ws", {"Host": "127.0.0.1:5006", "Origin": "http://example.org"}, token="abc", port=5006)
    False
    """
    given = path.lstrip("/").partition("/")[0]
    if not hmac.compare_digest(given.encode("utf-8", "replace"), token.encode()):
        return False
    names = {f"{ADDRESS}:{port}", f"localhost:{port}"}
    if headers.get("Host", "").lower() not in names:
        return False
    origin = headers.get("Origin")
    if origin is not None and origin.lower() not in {f"http://{name}" for name in names}:
        return False
    if headers.get("Sec-Fetch-Site", "none") in ("none", "same-origin"):
        return True
    # A link to the page may be followed from anywhere: from the file that opens the browser, or from a mail.
    return headers.get("Sec-Fetch-Mode") == "navigate" and headers.get("Sec-Fetch-Dest") == "document"


def guarded(base: Any) -> Any:
    """A class of web server that answers only what is allowed, made from one of Tornado's application classes.

    Its attributes ``token`` and ``port`` are set before it is asked for anything.
    """
    from tornado.web import ErrorHandler, OutputTransform

    class Headed(OutputTransform):
        """Puts the headers on every answer."""

        def __init__(self, request: Any) -> None:
            self._fixed = "/static/" in request.path

        def transform_first_chunk(self, status_code: int, headers: Any, chunk: bytes, finishing: bool) -> Any:
            for name, value in HEADERS.items():
                headers[name] = value
            if self._fixed and status_code == 200:  # the toolkit's own files: a page that is loaded anew has them already
                headers["Cache-Control"] = "private, max-age=86400"
            return status_code, headers, chunk

    class Guarded(base):
        """Refuses before anything is looked up."""

        token, port = "", 0

        def __init__(self, *arguments: Any, **keywords: Any) -> None:
            super().__init__(*arguments, **keywords)
            self.add_transform(Headed)

        def find_handler(self, request: Any, **keywords: Any) -> Any:
            """Tornado's way to what answers a request."""
            if self.token and allowed(request.path, request.headers, token=self.token, port=self.port):
                return super().find_handler(request, **keywords)
            return self.get_handler_delegate(request, ErrorHandler, {"status_code": 403})

    return Guarded
