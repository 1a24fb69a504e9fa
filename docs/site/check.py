"""Whether the site that was built leads nowhere that is not there, and asks nobody else for anything."""

import re
import sys
from collections.abc import Iterator
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

_FETCHED = {"script": "src", "img": "src", "link": "href", "iframe": "src", "source": "src", "video": "src"}
"""What a browser asks for by itself, and by which attribute."""
_IN_STYLES = re.compile(r"(?:@import\s+|url\()\s*['\"]?((?:https?:)?//[^'\")\s]+)")


class Page(HTMLParser):
    """What a page links to, fetches, and can be linked to by."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.links: list[str] = []
        self.fetched: list[str] = []
        self.anchors = {""}
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Take note of a tag."""
        named = {name: value for name, value in attrs if value is not None}
        self.anchors |= {named[name] for name in ("id", "name") if name in named}
        if tag == "a" and "href" in named:
            self.links.append(named["href"])
        elif tag in _FETCHED and _FETCHED[tag] in named and named.get("rel") not in {"canonical", "license"}:
            self.fetched.append(named[_FETCHED[tag]])


@cache
def page_of(path: Path) -> Page:
    """Return a page, read once."""
    return Page(path)


def problems(site: Path) -> Iterator[str]:
    """Yield what is wrong, a line each."""
    for path in sorted(site.rglob("*.html")):
        page, name = page_of(path), path.relative_to(site)
        yield from (f"{name}: asks others for {url}" for url in page.fetched if urlsplit(url).netloc)
        for link in {*page.links, *page.fetched}:
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if not target.exists():
                yield f"{name}: {link} leads nowhere"
            elif target.suffix == ".html" and unquote(parts.fragment) not in page_of(target).anchors:
                yield f"{name}: {link}: there is no such place on that page"
    for path in sorted(site.rglob("*.css")):
        yield from (f"{path.relative_to(site)}: asks others for {url}" for url in _IN_STYLES.findall(path.read_text()))


if __name__ == "__main__":
    found = list(problems(Path(sys.argv[1])))
    print(
        "\n".join(found)
        or f"{len(list(Path(sys.argv[1]).rglob('*.html')))} pages: every link leads somewhere, nothing is foreign"
    )
    sys.exit(bool(found))
