"""The check of the site finds what it is there for."""

import importlib.util
import re
from pathlib import Path

ROOT = Path(__file__).parents[2]


def test_lost_links_and_foreign_requests_are_found(tmp_path: Path) -> None:
    spec = importlib.util.spec_from_file_location("check", ROOT / "docs" / "site" / "check.py")
    assert spec is not None
    assert spec.loader is not None
    check = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(check)
    (tmp_path / "a.html").write_text(
        '<h1 id="top"></h1><a href="b.html#there">1</a><a href="b.html#nowhere">2</a><a href="c.html">3</a>'
        '<a href="https://example.org">4</a><a href="#top">5</a><script src="https://example.org/x.js"></script>'
    )
    (tmp_path / "b.html").write_text('<p id="there"></p><img src="gone.png">')
    (tmp_path / "s.css").write_text("@import url('//example.org/font.css'); body { background: url(data:x) }")
    assert sorted(check.problems(tmp_path)) == [
        "a.html: asks others for https://example.org/x.js",
        "a.html: b.html#nowhere: there is no such place on that page",
        "a.html: c.html leads nowhere",
        "b.html: gone.png leads nowhere",
        "s.css: asks others for //example.org/font.css",
    ]


def test_every_page_is_in_the_index_of_the_site() -> None:
    docs = ROOT / "docs"
    entries = [line for line in (docs / "index.md").read_text().splitlines() if re.fullmatch(r"[\w./*-]+", line)]
    listed = {page for entry in entries for page in docs.glob(f"{entry}.md") if ".." not in entry}
    assert {page for page in docs.rglob("*.md") if page.name != "index.md"} - listed == set()
