"""From bytes to text, and the few lexical slips that other URDF parsers let pass."""

from __future__ import annotations

import re
from collections.abc import Iterator

from sk120stiff.robot.urdf.findings import Notebook, at

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
