"""The page's server answers its owner alone: not without the token, not another origin, no file outside the folder."""

import http.client
import threading
from contextlib import closing, contextmanager

import pytest

from jaxbacklash.studio.folder import Folder
from jaxbacklash.studio.guard import HEADERS, allowed, new_token
from jaxbacklash.studio.session import Session

OWN = {"Host": "127.0.0.1:5006"}
VISIT = {"Sec-Fetch-Site": "cross-site", "Sec-Fetch-Mode": "navigate", "Sec-Fetch-Dest": "document"}


@pytest.mark.parametrize(
    ("path", "headers", "answered"),
    [
        ("/tok/", OWN, True),
        ("/tok/", {"Host": "localhost:5006"}, True),
        ("/tok/ws", OWN | {"Origin": "http://127.0.0.1:5006", "Sec-Fetch-Site": "same-origin"}, True),
        ("/tok/", OWN | VISIT, True),
        ("/", OWN, False),
        ("/tokk/", OWN, False),
        ("/to/", OWN, False),
        ("/static/tok/", OWN, False),
        ("/tok\u00e9/", OWN, False),
        ("/tok/", {}, False),
        ("/tok/", {"Host": "example.org:5006"}, False),
        ("/tok/", {"Host": "127.0.0.1:80"}, False),
        ("/tok/ws", OWN | {"Origin": "http://example.org"}, False),
        ("/tok/ws", OWN | {"Origin": "null"}, False),
        ("/tok/ws", OWN | {"Origin": "https://127.0.0.1:5006"}, False),
        ("/tok/", OWN | {"Sec-Fetch-Site": "cross-site"}, False),
        ("/tok/", OWN | {"Sec-Fetch-Site": "same-site"}, False),
        ("/tok/", OWN | VISIT | {"Sec-Fetch-Dest": "iframe"}, False),
    ],
)
def test_who_is_answered(path, headers, answered):
    assert allowed(path, headers, token="tok", port=5006) is answered


def test_tokens_are_long_and_differ():
    assert len(new_token()) >= 40
    assert new_token() != new_token()


@contextmanager
def serving(folder):
    """A server of the page in a thread."""
    pytest.importorskip("panel_material_ui", reason="the page's toolkit is not here: pip install .[studio]")
    from jaxbacklash.studio.serving import Server

    session, came = Session(Folder(folder)), []
    ready = threading.Event()

    def run():
        server = Server(session)
        came.append(server)
        server.loop.add_callback(ready.set)
        server.run()

    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    assert ready.wait(120.0)
    try:
        yield came[0]
    finally:
        came[0].stop()
        thread.join(20.0)
        session.close()


def asked(server, path, **headers):
    """Status, headers and body of an answer."""
    with closing(http.client.HTTPConnection("127.0.0.1", server.port, timeout=60.0)) as line:
        line.request("GET", path, headers={name.replace("_", "-"): value for name, value in headers.items()})
        answer = line.getresponse()
        return answer.status, dict(answer.getheaders()), answer.read()


UPGRADE = {
    "Connection": "Upgrade", "Upgrade": "websocket", "Sec_WebSocket_Version": "13",
    "Sec_WebSocket_Key": "dGhlIHNhbXBsZSBub25jZQ==",
}  # fmt: skip


def test_a_server_that_runs_gives_nothing_away(tmp_path):
    (tmp_path / "bench").mkdir()
    (tmp_path / "secret.csv").write_text("secret")
    with serving(tmp_path / "bench") as server:
        status, headers, body = asked(server, f"/{server.token}/")
        assert status == 200
        assert b"jaxbacklash studio" in body
        for name, value in HEADERS.items():
            assert headers[name] == value
        assert server.url.startswith("http://127.0.0.1:")

        refused = [
            ("/", {}),
            ("/static/js/bokeh.min.js", {}),
            ("/ws", UPGRADE),
            (f"/{server.token[:-1]}/", {}),
            (f"/{server.token}/", {"Host": "example.org"}),
            (f"/{server.token}/", {"Origin": "http://example.org"}),
            (f"/{server.token}/", {"Sec_Fetch_Site": "cross-site", "Sec_Fetch_Mode": "no-cors"}),
            (f"/{server.token}/ws", UPGRADE | {"Origin": "http://example.org"}),
        ]
        for path, words in refused:
            status, headers, body = asked(server, path, **words)
            assert status == 403, path
            assert server.token.encode() not in body
            assert "Access-Control-Allow-Origin" not in headers
        outside = ["../secret.csv", "..%2fsecret.csv", "static/../../secret.csv", "static/..%2f..%2fsecret.csv", "secret.csv"]
        components = [f"components/{name}" for name in outside]
        for name in [*outside, *components]:
            status, _, body = asked(server, f"/{server.token}/{name}")
            assert status in (400, 403, 404), name
            assert b"secret\n" not in body
            assert body != b"secret"


def test_only_this_machine_is_listened_to(tmp_path):
    with serving(tmp_path) as server:
        addresses = {own.getsockname()[0] for own in server.sockets}
        assert addresses == {"127.0.0.1"}
