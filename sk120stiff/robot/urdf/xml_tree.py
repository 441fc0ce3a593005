"""URDF text as lxml's elements, which know their line; nothing is expanded or fetched.

Entity definitions are refused before a parser sees them, and depth and number of elements are
bounded while the tree grows.
"""

from __future__ import annotations

import io
import re
from typing import NoReturn

from lxml import etree
from lxml.etree import _Element as Element

from sk120stiff.robot.urdf.findings import Notebook, shown
from sk120stiff.robot.urdf.xml_text import mended, without_comments, without_prologue

MAX_ELEMENTS = 1_000_000
MAX_NESTING = 200
_ENTITIES = re.compile(r"<!(?:DOCTYPE|ENTITY)\b")
_UNDECLARED = re.compile(r"Namespace prefix (\S{1,100}) ")

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


def parse_robot(text: str, notes: Notebook, *, comments: bool = False) -> Element:
    """The `<robot>` element of a URDF, its comments kept if asked for.

    Raises:
        InputError: Not XML, not a URDF, entity definitions, or beyond the bounds of this module;
            line and column are named.
    """
    text = without_prologue(text, notes)
    if not text.strip():
        notes.refuse(
            "the file is empty",
            where="line 1",
            remedy="Give a URDF: <robot> with links and joints.",
        )
    _refuse_pointer(text, notes)
    defined = _ENTITIES.search(without_comments(text))
    if defined:
        notes.refuse(
            "the file defines a document type; entity definitions are never expanded",
            where=f"line {text.count(chr(10), 0, defined.start()) + 1}",
            remedy="Remove the <!DOCTYPE ...> and write the values where they are used.",
        )
    try:
        root = _build(text, notes, comments)
    except etree.XMLSyntaxError as first:
        try:
            root = _build(_with_prefixes(mended(text, notes), first), notes, comments)
        except etree.XMLSyntaxError:
            _refuse_markup(first, notes)
    if root.tag != "robot":
        kind = _OTHER_ROOTS.get(root.tag, f"a file whose outermost element is <{root.tag[:40]}>")
        notes.refuse(
            f"this is {kind}, not a URDF",
            where=f"line {root.sourceline}",
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


def _refuse_markup(error: etree.XMLSyntaxError, notes: Notebook) -> NoReturn:
    kinds = etree.ErrorTypes
    told = [entry for entry in error.error_log if entry.type != kinds.NS_ERR_UNDEFINED_NAMESPACE]
    (line, column), code, said = error.position, error.code, str(error.msg)
    if told:
        line, column, code, said = told[0].line, told[0].column, told[0].type, told[0].message
    place = f"line {line}, column {column}"
    if code == kinds.ERR_DOCUMENT_END:
        notes.refuse(
            "there is more than one outermost element",
            where=place,
            remedy="Keep one <robot> per file and nothing behind it.",
        )
    if code == kinds.ERR_RESOURCE_LIMIT:
        _refuse_size("elements are nested too deeply", line, notes)
    notes.refuse(
        f"this is not well-formed XML ({shown(said, 120)[1:-1]})",
        where=place,
        remedy="Mend the markup at that place; an XML editor shows it.",
    )


def _refuse_size(what: str, line: int, notes: Notebook) -> NoReturn:
    notes.refuse(what, where=f"line {line}", remedy="Give a smaller file.")


def _with_prefixes(text: str, error: etree.XMLSyntaxError) -> str:
    """The text with every prefix declared that the parser missed; what has one is foreign to us."""
    missed = dict.fromkeys(_UNDECLARED.findall("\n".join(e.message for e in error.error_log)))
    declared = "".join(f' xmlns:{name}="undeclared:{name}"' for name in missed)
    return text.replace("<robot", f"<robot{declared}", 1)


def _build(text: str, notes: Notebook, comments: bool) -> Element:
    etree.clear_error_log()  # of this thread; errors would carry those of earlier files
    growing = etree.iterparse(
        io.BytesIO(text.encode("utf-8", "replace")),
        events=("start", "end"),
        encoding="utf-8",
        huge_tree=True,
        no_network=True,
        resolve_entities=False,
        remove_comments=not comments,
        remove_pis=True,
    )
    count = depth = 0
    for event, element in growing:
        count += event == "start"
        depth += 1 if event == "start" else -1
        if count > MAX_ELEMENTS:
            _refuse_size(f"there are more than {MAX_ELEMENTS} elements", element.sourceline, notes)
        if depth > MAX_NESTING:
            _refuse_size("elements are nested too deeply", element.sourceline, notes)
    return growing.root
