"""URDF bytes become text, and text lxml's elements, which know their line; nothing is fetched.

A few lexical slips that other URDF parsers let pass are mended, each with a note. Entity
definitions are refused before a parser sees them, and depth and number of elements are bounded
while the tree grows.
"""

from __future__ import annotations

import io
import re
from collections.abc import Iterator
from typing import NoReturn

from lxml import etree
from lxml.etree import _Element as Element

from sk120stiff.robot.urdf.findings import Notebook, at, shown

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


_DECLARATION = re.compile(r"<\?xml\b[^>]{0,200}\?>")
_ENCODING = re.compile(rb"<\?xml\b[^>]{0,200}?encoding\s*=\s*[\"']([A-Za-z0-9._-]{1,40})[\"']")
_PLAIN_DOCTYPE = re.compile(r"<!DOCTYPE\b[^>\[]*>")
_STRAY_AMPERSAND = re.compile(r"&(?!(?:#\d{1,7}|#x[0-9A-Fa-f]{1,6}|amp|lt|gt|quot|apos);)")
_CONTROL = re.compile("[\x01-\x08\x0b\x0c\x0e-\x1f]")
_ENTITY_NAME = re.compile(r"&\w{1,40};")

_MOST_AMPERSANDS = 100_000

# Only codecs that map bytes to text and cannot be made to inflate.
_ENCODINGS = frozenset(
    {
        "utf-8", "utf8", "utf-8-sig", "us-ascii", "ascii", "iso-8859-1", "latin-1", "latin1",
        "iso-8859-2", "iso-8859-15", "windows-1250", "windows-1251", "windows-1252", "cp1250",
        "cp1251", "cp1252", "gbk", "gb2312", "gb18030", "big5", "shift_jis", "shift-jis", "euc-jp",
        "euc-kr", "koi8-r",
    }
)  # fmt: skip


def decode(data: bytes, notes: Notebook) -> str:
    """Text of an XML file, by its byte-order mark or its declaration.

    Bytes that do not fit the encoding are taken as Windows-1252 and noted: they are nearly always a
    manufacturer's comment, and names are checked later.
    """
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        return data.decode("utf-16", "replace").lstrip("\ufeff")
    match = _ENCODING.search(data[:400])
    declared = match.group(1).decode("ascii").lower() if match else "utf-8"
    encoding = declared if declared in _ENCODINGS else "utf-8"
    if declared not in _ENCODINGS and not declared.startswith("utf-16"):
        notes.warn("encoding", "line 1", f"encoding {declared!r} is unknown; read as UTF-8")
    if encoding.startswith("utf"):
        encoding = "utf-8-sig"
    try:
        return data.decode(encoding)
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        notes.warn(
            "encoding",
            f"line {line}",
            f"byte 0x{data[error.start]:02x} is not {declared}; read as Windows-1252",
        )
        return data.decode("cp1252", "replace")


def without_prologue(text: str, notes: Notebook) -> str:
    """Blank out the XML declaration and a DOCTYPE that defines nothing; lines stay in place."""
    text = _DECLARATION.sub(lambda match: _blank(match.group()), text, count=1)
    head = text[:2000]
    doctype = _PLAIN_DOCTYPE.search(head)
    if doctype:
        line = text.count("\n", 0, doctype.start()) + 1
        notes.warn("doctype", f"line {line}", "the DOCTYPE was ignored; nothing is fetched for it")
        text = head.replace(doctype.group(), _blank(doctype.group()), 1) + text[2000:]
    return text


def mended(text: str, notes: Notebook) -> str:
    """Repair slips that strict XML forbids and common URDF parsers accept; each one is noted.

    Double hyphens inside comments, bare ampersands, control characters, text behind the end. Text
    with other entity references is left as it is: what an entity stands for is not ours to guess.
    """
    comments = list(_comments(text))
    if any("-" in text[end - 4] or "--" in text[start + 4 : end - 3] for start, end in comments):
        notes.warn("xml_syntax", "", "a comment contains '--', which XML forbids; it was skipped")
        text = without_comments(text)
    few = text.count("&") < _MOST_AMPERSANDS
    if (
        few
        and _STRAY_AMPERSAND.search(text)
        and not _ENTITY_NAME.search(re.sub(r"&(?:amp|lt|gt|quot|apos);", "", text))
    ):
        notes.warn("xml_syntax", "", "a bare '&' was read as '&amp;'")
        text = _STRAY_AMPERSAND.sub("&amp;", text)
    end = text.rfind("</robot>") + len("</robot>")
    if end >= len("</robot>") and text[end:].strip() and "<" not in text[end:]:
        notes.warn(
            "xml_syntax", at(text.count("\n", 0, end) + 1), "text behind </robot> was ignored"
        )
        text = text[:end]
    if _CONTROL.search(text):
        notes.warn("xml_syntax", "", "control characters were skipped")
        text = _CONTROL.sub(" ", text)
    return text


def without_comments(text: str) -> str:
    """The text with every comment blanked out, lines in place."""
    parts, done = [], 0
    for start, end in _comments(text):
        parts += [text[done:start], _blank(text[start:end])]
        done = end
    return "".join([*parts, text[done:]])


def _comments(text: str) -> Iterator[tuple[int, int]]:
    """Start and end of each closed comment; linear in the text, whatever stands in it."""
    start = text.find("<!--")
    while start >= 0:
        end = text.find("-->", start + 4)
        if end < 0:
            return
        yield start, end + 3
        start = text.find("<!--", end + 3)


def _blank(text: str) -> str:
    return re.sub(r"[^\n]", " ", text)
