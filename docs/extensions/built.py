"""Check the built site: every link leads somewhere, and no page fetches anything.

    python docs/extensions/built.py docs/_build/html

Links to other sites are listed, not followed.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from urllib.parse import unquote, urlsplit

from lxml import html

LOADED = {  # what a browser fetches by itself
    "script": "src", "img": "src", "link": "href", "iframe": "src", "source": "src", "video": "src",
}  # fmt: skip
WORDS_ONLY = ("canonical", "author", "search", "index", "next", "prev", "prefetch")


@cache
def anchors(page: Path) -> frozenset[str]:
    """The ids of a page."""
    return frozenset(html.parse(str(page)).xpath("//@id | //a/@name"))


def faults(page: Path, outside: set[str]) -> Iterator[str]:
    """What is wrong with the links of a page; links to other sites join `outside`."""
    for element in html.parse(str(page)).iter():
        if not isinstance(element.tag, str):
            continue
        loaded = LOADED.get(element.tag)
        if element.tag == "link" and element.get("rel") in WORDS_ONLY:
            loaded = None
        address = element.get(loaded or "href")
        if not address:
            continue
        parts = urlsplit(address)
        if parts.scheme in ("http", "https") or parts.netloc:
            if loaded:
                yield f"<{element.tag}> fetches {address}"
            outside.add(address)
        elif not parts.scheme:
            target = (page.parent / unquote(parts.path)).resolve() if parts.path else page
            if not target.is_file():
                yield f"{address} leads nowhere"
            elif target.suffix == ".html" and parts.fragment:
                place = unquote(parts.fragment)
                yield from () if place in anchors(target) else [f"{address}: no such place there"]


def fetched(sheet: Path) -> Iterator[str]:
    """What a style sheet fetches from elsewhere."""
    for part in sheet.read_text(encoding="utf-8").split("url(")[1:]:
        if part.lstrip("\"' ").startswith(("http:", "https:", "//")):
            yield f"fetches {part[:60]}"


def main(site: Path) -> int:
    """Check all pages; the number of faults."""
    outside: set[str] = set()
    found = [
        f"{file.relative_to(site)}: {fault}"
        for pattern, check in (("*.html", lambda p: faults(p, outside)), ("*.css", fetched))
        for file in sorted(site.rglob(pattern))
        for fault in check(file)
    ]
    pages = len(list(site.rglob("*.html")))
    print("links to other sites, not followed:", *sorted(outside), sep="\n  ")
    print(f"{pages} pages, {len(found)} faults", *found, sep="\n  ")
    return len(found)


if __name__ == "__main__":
    sys.exit(min(main(Path(sys.argv[1]).resolve()), 1))
