"""The directive `commands`: what every command says of itself, from the program."""

from __future__ import annotations

import os
from contextlib import redirect_stdout
from io import StringIO

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from sk120stiff.cli.main import COMMANDS, main

WIDTH = "84"  # columns that fit the page


def told(name: str) -> str:
    """The help of one command under its heading, as Markdown."""
    said = StringIO()
    os.environ["COLUMNS"] = WIDTH
    with redirect_stdout(said):
        code = main([name, "--help"])
    if code:
        raise RuntimeError(f"'{name} --help' leaves {code}")
    return f"## {name}\n\n```text\n{said.getvalue().strip()}\n```\n"


class Commands(SphinxDirective):
    """All of them."""

    def run(self) -> list[nodes.Node]:
        """Sections, one a command."""
        text = "\n".join(map(told, COMMANDS))
        return self.parse_text_to_nodes(text, allow_section_headings=True)


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the directive."""
    app.add_directive("commands", Commands)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
