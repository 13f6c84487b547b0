"""Do the links of the built site lead somewhere? Pages, anchors, pictures and styles; nothing is asked of the network."""

from __future__ import annotations

from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit


class Page(HTMLParser):
    """The names in a page that can be linked to, and what it links to."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.names: set[str] = {"", "__top"}
        self.links: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for name, value in attrs:
            if name == "id" or (tag == "a" and name == "name"):
                self.names.add(value or "")
            elif (name == "href" and tag in ("a", "link")) or name == "src":
                self.links.append(value or "")


def broken(site: Path) -> list[str]:
    """Links within the site that lead nowhere, each with its page."""
    pages = {path.resolve(): Page(path.read_text(encoding="utf-8")) for path in sorted(site.rglob("*.html"))}
    found = []
    for path, page in pages.items():
        if path.name == "404.html":  # its links start from the address of the site
            continue
        for link in page.links:
            parts = urlsplit(link)
            if parts.scheme or parts.netloc or link.startswith("data:"):
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            target = target / "index.html" if target.is_dir() else target
            if not target.is_file() or (target in pages and unquote(parts.fragment) not in pages[target].names):
                found.append(f"{path.relative_to(site.resolve())}: {link}")
    return found


def asked_elsewhere(site: Path) -> list[str]:
    """Addresses outside the site from which a page would fetch a script, a style or a picture."""
    found = []
    for path in sorted(site.rglob("*.html")):
        page = _Fetched(path.read_text(encoding="utf-8"))
        found += [f"{path.relative_to(site)}: {link}" for link in page.fetched if urlsplit(link).netloc]
    return found


class _Fetched(HTMLParser):
    def __init__(self, text: str) -> None:
        super().__init__()
        self.fetched: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        if given.get("src"):
            self.fetched.append(given["src"] or "")
        if tag == "link" and given.get("rel") in ("stylesheet", "preload", "preconnect", "icon"):
            self.fetched.append(given.get("href") or "")
