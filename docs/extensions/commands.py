"""The directive `commands`: every command of the program with its options, from the program."""

from __future__ import annotations

from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from sk120stiff.cli.main import COMMANDS, loaded


def told(name: str) -> list[str]:
    """One command as lines of Markdown."""
    command = loaded(name)
    text, _, example = (command.help or "").partition("Example: ")
    paragraphs = [" ".join(part.split()) for part in text.split("\n\n")]
    arguments = [p for p in command.params if p.param_type_name == "argument"]
    options = [p for p in command.params if p.param_type_name == "option"]
    words = " ".join(p.human_readable_name.upper() for p in arguments)
    lines = [f"## {name}", "", "```text", f"sk120stiff {name} [OPTIONS] {words}".rstrip(), "```"]
    for paragraph in paragraphs:
        lines += ["", paragraph]
    if example:
        lines += ["", "Example:", "", "```bash", " ".join(example.split()), "```"]
    for parameter in [*arguments, *options]:
        lines += ["", *_parameter(parameter)]
    return [*lines, ""]


def _parameter(parameter: Any) -> list[str]:
    """A term and its meaning, as a definition list has them."""
    if parameter.param_type_name == "argument":
        term = f"`{parameter.human_readable_name.upper()}`"
    else:
        value = "" if parameter.is_flag else f" {parameter.metavar or parameter.type.name.upper()}"
        names = [*parameter.opts, *parameter.secondary_opts]
        term = f"`{', '.join(names)}{value}`"
    default = parameter.default
    more = ""
    if parameter.required:
        more = " *Needed.*"
    elif default not in (None, False, (), []) and not callable(default):
        more = f" Default: `{getattr(default, 'value', default)}`."
    return [term, f": {' '.join((parameter.help or '').split())}{more}"]


class Commands(SphinxDirective):
    """All of them."""

    def run(self) -> list[nodes.Node]:
        """Sections, one a command."""
        text = "\n".join(line for name in COMMANDS for line in told(name))
        return self.parse_text_to_nodes(text, allow_section_headings=True)


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the directive."""
    app.add_directive("commands", Commands)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
