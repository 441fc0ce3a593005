"""URDF text as a small tree of elements that know their line; nothing is expanded or fetched.

The parser is expat with its doors shut: a document type that defines entities is refused before any
is expanded, depth and number of elements are bounded, and the tree is built without recursion.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import NoReturn
from xml.parsers import expat

from sk120stiff.robot.urdf.findings import Notebook, shown
from sk120stiff.robot.urdf.xml_text import mended, without_prologue

MAX_ELEMENTS = 2_000_000
MAX_KEPT = 1_000_000
MAX_NESTING = 200

# Elements of a robot that carry kinematics or pictures; the inside of all others is skipped.
_KEPT_TOP = frozenset({"link", "joint", "material"})
_SKIPPED_INSIDE = frozenset({"collision", "sensor", "gazebo", "transmission"})

_OTHER_ROOTS = {
    "mujoco": "an MJCF model of MuJoCo",
    "mujocoinclude": "an MJCF model of MuJoCo",
    "sdf": "an SDF model of Gazebo",
    "gazebo": "an SDF model of Gazebo",
    "COLLADA": "a COLLADA mesh",
    "html": "a web page, not the file behind it",
    "svg": "a picture",
    "package": "a ROS package manifest",
    "launch": "a ROS launch file",
    "srdf": "an SRDF",
}


@dataclass(eq=False)
class Element:
    """One XML element: tag, attributes, children and the line it opens on."""

    tag: str
    attributes: dict[str, str]
    line: int
    children: list[Element] = field(default_factory=list)

    def all(self, tag: str) -> Iterator[Element]:
        """Direct children of one tag."""
        return (child for child in self.children if child.tag == tag)

    def first(self, tag: str) -> Element | None:
        """First direct child of one tag."""
        return next(self.all(tag), None)

    def get(self, name: str) -> str | None:
        """Attribute value, or None."""
        return self.attributes.get(name)


class _Stop(Exception):
    """A signal through expat, never seen outside."""

    def __init__(self, what: str, line: int, remedy: str) -> None:
        super().__init__(what)
        self.what, self.line, self.remedy = what, line, remedy


def parse_robot(text: str, notes: Notebook) -> Element:
    """The `<robot>` element of a URDF.

    Raises
    ------
    InputError
        Not XML, not a URDF, entity definitions, or beyond the bounds of this module; line and
        column are named.
    """
    text = without_prologue(text, notes)
    if not text.strip():
        notes.refuse(
            "the file is empty",
            where="line 1",
            remedy="Give a URDF: <robot> with links and joints.",
        )
    _refuse_pointer(text, notes)
    try:
        root = _build(text)
    except expat.ExpatError as first:
        again = mended(text, notes)
        try:
            root = _build(again)
        except expat.ExpatError:
            _refuse_markup(first, notes)
        except _Stop as stop:
            notes.refuse(stop.what, where=f"line {stop.line}", remedy=stop.remedy)
    except _Stop as stop:
        notes.refuse(stop.what, where=f"line {stop.line}", remedy=stop.remedy)
    if root.tag != "robot":
        kind = _OTHER_ROOTS.get(root.tag, f"a file whose outermost element is <{root.tag[:40]}>")
        notes.refuse(
            f"this is {kind}, not a URDF",
            where=f"line {root.line}",
            remedy="Give the file whose outermost element is <robot>.",
        )
    return root


def _refuse_pointer(text: str, notes: Notebook) -> None:
    if text.startswith("version https://git-lfs"):
        notes.refuse(
            "this is a Git LFS pointer, the file itself was not downloaded",
            remedy="Run 'git lfs pull' in its repository.",
        )
    start = text.lstrip()[:1]
    if start != "<":
        line = len(text) - len(text.lstrip())
        notes.refuse(
            f"this is not XML (it begins with {shown(text.strip()[:20])})",
            where=f"line {text.count(chr(10), 0, line) + 1}",
            remedy="Give a URDF or xacro file, or URDF text that begins with '<'.",
        )


def _refuse_markup(error: expat.ExpatError, notes: Notebook) -> NoReturn:
    place = f"line {error.lineno}, column {error.offset + 1}"
    if error.code == expat.errors.codes[expat.errors.XML_ERROR_JUNK_AFTER_DOC_ELEMENT]:
        notes.refuse(
            "there is more than one outermost element",
            where=place,
            remedy="Keep one <robot> per file and nothing behind it.",
        )
    notes.refuse(
        f"this is not well-formed XML ({expat.ErrorString(error.code)})",
        where=place,
        remedy="Mend the markup at that place; an XML editor shows it.",
    )


def _build(text: str) -> Element:
    builder = _Builder()
    parser = expat.ParserCreate("utf-8")
    parser.buffer_text = True
    parser.StartElementHandler = builder.start
    parser.EndElementHandler = builder.end
    parser.StartDoctypeDeclHandler = builder.doctype
    parser.EntityDeclHandler = builder.entity
    parser.ExternalEntityRefHandler = builder.entity
    parser.SkippedEntityHandler = builder.entity
    builder.parser = parser
    parser.Parse(text.encode("utf-8", "replace"), True)
    assert builder.root is not None  # noqa: S101 - expat raises for a document without element
    return builder.root


class _Builder:
    def __init__(self) -> None:
        self.root: Element | None = None
        self.parser: expat.XMLParserType
        self._open: list[Element] = []
        self._skipping = 0
        self._seen = self._kept = 0

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        self._seen += 1
        if self._seen > MAX_ELEMENTS:
            self._stop(f"there are more than {MAX_ELEMENTS} elements", "Give a smaller file.")
        depth = len(self._open)
        if self._skipping:
            self._skipping += 1
            if self._skipping > MAX_NESTING:
                self._stop("elements are nested too deeply", "Remove the nesting.")
            return
        if depth > MAX_NESTING:
            self._stop("elements are nested too deeply", "Remove the nesting.")
        self._kept += 1
        if self._kept > MAX_KEPT:
            self._stop(f"there are more than {MAX_KEPT} elements", "Give a smaller file.")
        element = Element(tag, attributes, self.parser.CurrentLineNumber)
        if depth:
            self._open[-1].children.append(element)
        else:
            self.root = element
        # The inside of foreign elements may hold <joint> and <link> of another meaning.
        if (depth == 1 and tag not in _KEPT_TOP) or (depth > 1 and tag in _SKIPPED_INSIDE):
            self._skipping = 1
        else:
            self._open.append(element)

    def end(self, _tag: str) -> None:
        if self._skipping:
            self._skipping -= 1
        else:
            self._open.pop()

    def doctype(self, *_parts: object) -> None:
        self._stop(
            "the file defines a document type; entity definitions are never expanded",
            "Remove the <!DOCTYPE ...> and write the values where they are used.",
        )

    def entity(self, *_parts: object) -> int:
        self._stop("the file defines or fetches entities", "Write the values where they are used.")
        return 0

    def _stop(self, what: str, remedy: str) -> None:
        raise _Stop(what, self.parser.CurrentLineNumber, remedy)
