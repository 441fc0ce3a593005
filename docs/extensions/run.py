"""The directive `run`: a page's commands are run while it is built, and it shows what they print.

Each page has a desk, a folder with the files that the page shows (``<!-- file: NAME -->`` before a
fenced block, as in README.md) and the bundled robots. Blocks of a page run in their order::

    ```{run}
    :exit: 1            what the last line leaves; 0 if not said
    :shows: it loads    what must be among what is printed, for the text speaks of it
    :lines: 12          print no more of it
    :picture: fit.png   and show this file of the desk
    sk120stiff check motoman_sk120
    ```

The argument ``python`` runs lines of Python instead.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import ClassVar

from docutils import nodes
from docutils.parsers.rst import directives
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from tests.pages import blocks

ROOT = Path(__file__).resolve().parents[2]
WIDTH = 88  # of what is printed


def desk_of(app: Sphinx, page: str) -> Path:
    """Where the commands of a page run."""
    return Path(app.outdir).parent / "desks" / page


def lay(app: Sphinx, page: str, source: list[str]) -> None:
    """An empty desk with the files that the page shows."""
    if "{run}" not in source[0]:
        return
    desk = desk_of(app, page)
    shutil.rmtree(desk, ignore_errors=True)
    desk.mkdir(parents=True)
    shutil.copytree(ROOT / "robots", desk / "robots")  # a link would lead packaging astray
    for block in blocks(source[0]):
        if block.file:
            (desk / block.file).write_text(block.text, encoding="utf-8")


class Run(SphinxDirective):
    """A block that is run."""

    has_content = True
    optional_arguments = 1
    option_spec: ClassVar = {
        "exit": directives.nonnegative_int,
        "lines": directives.positive_int,
        "picture": directives.path,
        "alt": directives.unchanged_required,
        "quiet": directives.flag,
        "shows": directives.unchanged_required,
    }

    def run(self) -> list[nodes.Node]:
        """The commands, what they print, and the picture they leave."""
        python = bool(self.arguments) and self.arguments[0] == "python"
        text = "\n".join(self.content)
        desk = desk_of(self.env.app, self.env.docname)
        shell = ["bash", "-euo", "pipefail", "-c", text]
        here = Path(sys.executable).parent
        done = subprocess.run(
            [sys.executable, "-c", text] if python else shell,
            cwd=desk,
            env={
                **os.environ, "PATH": f"{here}:{os.environ['PATH']}", "COLUMNS": str(WIDTH),
                "NO_COLOR": "1", "MPLBACKEND": "agg", "PYTHONPATH": str(ROOT),
            },
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False,
        )  # fmt: skip
        if done.returncode != self.options.get("exit", 0):
            raise self.error(f"exit {done.returncode} of\n{text}\n{done.stdout}")
        if self.options.get("shows", "") not in done.stdout:
            raise self.error(f"{self.options['shows']!r} is not in\n{done.stdout}")
        shown: list[nodes.Node] = [
            nodes.literal_block(text, text, language="python" if python else "bash")
        ]
        lines = [] if "quiet" in self.options else done.stdout.rstrip().splitlines()
        most = self.options.get("lines", len(lines))
        lines = lines[:most] + ["…"] * (len(lines) > most)
        if lines:
            said = "\n".join(lines)
            shown.append(nodes.literal_block(said, said, language="text", classes=["printed"]))
        if "picture" in self.options:
            shown.append(self._picture(desk / self.options["picture"]))
        return shown

    def _picture(self, file: Path) -> nodes.image:
        name = f"{self.env.docname.replace('/', '-')}-{file.name}"
        target = Path(self.env.app.outdir) / "_images" / name
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(file, target)
        up = "../" * self.env.docname.count("/")
        alt = self.options["alt"]  # a picture without words is an error
        return nodes.raw("", f'<img class="made" src="{up}_images/{name}" alt="{alt}"/>',
                         format="html")  # fmt: skip


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the directive."""
    app.add_directive("run", Run)
    app.connect("source-read", lay)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
