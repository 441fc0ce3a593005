"""Pages that live at the top of the repository are shown as they stand there, never copied.

A page that holds ``<!-- from: NAME.md -->`` is that file. Links between such files become links
between the pages of the site.
"""

from __future__ import annotations

import re
from pathlib import Path

from pygments.lexers.special import TextLexer
from sphinx.application import Sphinx

ROOT = Path(__file__).resolve().parents[2]
PAGES = {
    "CHANGELOG.md": "/about/changelog.md",
    "CODE_OF_CONDUCT.md": "/about/conduct.md",
    "CONTRIBUTING.md": "/about/contributing.md",
    "SECURITY.md": "/about/security.md",
    "docs/FILES.md": "/FILES.md",
    "docs/STABILITY.md": "/STABILITY.md",
}
SOURCE = re.compile(r"<!-- from: (\S+) -->")


def shown(app: Sphinx, page: str, source: list[str]) -> None:
    """The text of the file that a page stands for, its links turned."""
    told = SOURCE.match(source[0])
    if told:
        file = ROOT / told[1]
        app.env.note_dependency(str(file), docname=page)
        source[0] = file.read_text(encoding="utf-8")
    for name, target in PAGES.items():
        source[0] = source[0].replace(f"]({name})", f"]({target})")
        source[0] = source[0].replace(f"](../{name})", f"]({target})")


def setup(app: Sphinx) -> dict[str, bool]:
    """Listen; and show tables and G-code as plain text."""
    app.connect("source-read", shown, priority=400)
    for name in ("csv", "gcode"):
        app.add_lexer(name, TextLexer)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
