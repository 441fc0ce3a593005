"""A report becomes one HTML file that needs nothing else."""

from __future__ import annotations

import logging
import math
import os
import platform
import re
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from html import escape
from importlib.metadata import PackageNotFoundError, version
from numbers import Real
from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from sk120stiff.errors import InputError, MissingPart, warn
from sk120stiff.files import sha256_of, write_atomically
from sk120stiff.show import palette
from sk120stiff.show.figures.saving import inline_svg
from sk120stiff.show.report.blocks import Block, Note, Picture, SceneFrame, Section, Table
from sk120stiff.show.wording import raised

WHOLE = 1e4  # up to here a number without digits after the point is easier read than a power
STRONG = re.compile(r"(?<!\w)\*\*(?=\S)(.+?)(?<=\S)\*\*(?!\w)")  # a unit may hold * and ** too
_LOG = logging.getLogger(__name__)
_LIBRARIES = ("sk120stiff", "numpy", "scipy", "pin", "matplotlib", "meshcat")


@dataclass(frozen=True, eq=False)
class Report:
    """A titled sequence of sections.

    Attributes:
        title: Heading of the page.
        sections: Its parts, in order.
        subtitle: A line under the heading.
        lead: The answer, in a sentence or two, before everything else.
        reproducibility: Name → text, shown last; see `reproducibility`.
    """

    title: str
    sections: Sequence[Section] = ()
    subtitle: str = ""
    lead: str = ""
    reproducibility: Mapping[str, str] = field(default_factory=dict)

    def html(self) -> str:
        """The whole page as text."""
        template = _environment().get_template("report.html.j2")
        colours = Markup(palette.style_variables())
        return template.render(report=self, colours=colours, scenes=_has_scene(self.sections))

    def write(self, path: str | os.PathLike[str]) -> Path:
        """Write the page; an interrupted write leaves the old file as it was."""
        return write_atomically(path, self.html())

    def _repr_html_(self) -> str:
        page = escape(self.html(), quote=True)
        return f'<iframe title="{escape(self.title, quote=True)}" srcdoc="{page}" ' + (
            'style="width:100%;height:640px;border:0"></iframe>'
        )


def fragment(section: Section) -> str:
    """A section alone as HTML, to be put into a page that is not ours."""
    blocks = _environment().get_template("blocks.html.j2").module
    return str(blocks.render_section(section, 4, _slug(section.title)))  # type: ignore[attr-defined]


def _has_scene(blocks: Sequence[Block]) -> bool:
    return any(
        isinstance(block, SceneFrame) or (isinstance(block, Section) and _has_scene(block.blocks))
        for block in blocks
    )


@cache
def _environment() -> Environment:
    environment = Environment(
        loader=PackageLoader("sk120stiff.show.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["cell"] = _cell
    environment.filters["numeric"] = _numeric
    environment.filters["prose"] = _prose
    environment.filters["kind"] = _kind
    environment.filters["slug"] = _slug
    environment.filters["svg"] = _svg
    environment.filters["page"] = _page
    return environment


def _kind(block: Block) -> str:
    return type(block).__name__


def _numeric(table: Table) -> list[bool]:
    """For each column after the first: does it hold a number?"""
    columns = list(zip(*table.rows, strict=True)) or [()] * len(table.header)
    return [
        k > 0 and any(isinstance(cell, Real) and not isinstance(cell, bool) for cell in column)
        for k, column in enumerate(columns)
    ]


def _cell(value: object, digits: int) -> str:
    """A number with `digits` significant digits and a true minus sign; text as it is."""
    if value is None:
        return "–"
    if not isinstance(value, Real) or isinstance(value, bool):
        return _kept_together(str(value))
    number = float(value)
    if not math.isfinite(number):
        return "–" if math.isnan(number) else ("∞" if number > 0 else "−∞")
    if isinstance(value, int):
        return str(value).replace("-", "−")
    if number == 0.0:
        return "0"
    text = f"{number:#.{digits}g}".removesuffix(".")  # 18.0 beside 18.2: all digits are meant
    if 10**digits <= abs(number) < WHOLE:
        text = f"{number:.0f}"
    if "e" in text:
        mantissa, exponent = text.split("e")
        text = f"{mantissa.removesuffix('.')}·10{raised(int(exponent))}"
    return text.replace("-", "−")


def _kept_together(text: str) -> str:
    """A number and its unit are never parted at the end of a line."""
    return re.sub(r"(?<=\d) (?=(?:µm|mm|m|N|deg)\b|%|±)|(?<=±) (?=\d)", "\u00a0", text)


def _prose(text: str) -> Markup:
    """Plain text in which `code`, **strong** words and K_C-like symbols are marked."""
    parts = re.split(r"`([^`]+)`", escape(text))
    for k, part in enumerate(parts):
        if k % 2:
            parts[k] = f"<code>{part}</code>"
        else:
            strong = STRONG.sub(r"<strong>\1</strong>", part)
            parts[k] = re.sub(r"\b([KC])_(C|X|θ)(?!\w)", r"\1<sub>\2</sub>", strong)
    return Markup("".join(parts))


def _slug(title: str) -> str:
    return re.sub(r"[^a-z0-9]+", "-", title.lower()).strip("-") or "section"


def _svg(picture: Picture) -> Markup:
    try:
        return Markup(inline_svg(picture.drawn, picture.alt))
    except Exception as error:  # noqa: BLE001  (an answer is never lost to its picture)
        said = failure(f"the picture {(picture.caption or picture.alt)!r}", error)
        return Markup('<p class="note problem">{}</p>').format(said)


def _page(frame: SceneFrame) -> str:
    """The text of the scene's page; autoescape turns it into an attribute."""
    if isinstance(frame.scene, str):
        return frame.scene
    from sk120stiff.show.scene.static import scene_html

    return scene_html(frame.scene)


def section_or_note(title: str, build: Callable[[], Section | None]) -> Section | None:
    """The section, or a section of that title that says what went wrong.

    Warns:
        ToolkitWarning: It could not be made.
    """
    try:
        return build()
    except Exception as error:  # noqa: BLE001  (an answer is never lost to its page)
        return Section(title, [Note(failure(f"the section {title!r}", error), "problem")])


def failure(what: str, error: Exception) -> str:
    """Warn that `what` could not be made, and return the sentence; the traceback goes to the log.

    Warns:
        ToolkitWarning: Always.
    """
    if isinstance(error, MissingPart):
        warn(str(error), stacklevel=3)  # one sentence for all pictures
        return f"Left out: {what}. {error}"
    reason = " ".join(str(error).split()) or "no message"
    said = f"{what[0].upper()}{what[1:]} could not be made ({type(error).__name__}: {reason})."
    _LOG.debug("%s", said, exc_info=error)
    warn(f"{said} Everything else is as it should be.", stacklevel=3)
    return said


def reproducibility(
    command: str, files: Iterable[str | os.PathLike[str]] = (), *, seed: int | None = None
) -> dict[str, str]:
    """Command, versions and SHA-256 of the input files, in the order to show them.

    Args:
        command: The command line, or the Python call, that made the result.
        files: Input files; a missing one is named as missing.
        seed: Seed of random numbers, if any were drawn.
    """
    facts = {"Command": command}
    if seed is not None:
        facts["Seed"] = str(seed)
    for file in files:
        facts[f"SHA-256 of {Path(file).name}"] = _digest(Path(file))
    found = [f"{name} {_version(name)}" for name in _LIBRARIES]
    facts["Versions"] = ", ".join([*found, f"Python {platform.python_version()}"])
    facts["System"] = f"{platform.system()} {platform.machine()} ({sys.implementation.name})"
    return facts


def _digest(path: Path) -> str:
    try:
        return sha256_of(path)
    except InputError:
        return "missing"


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "(not installed)"
