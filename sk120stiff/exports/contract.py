"""What an export is: a model goes in; text, and what it carries and what it cannot, come out."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from lxml import etree
from lxml.etree import _Element as Element

from sk120stiff.arrays import Array
from sk120stiff.model import Model


@dataclass(frozen=True)
class Told:
    """One effect of the model (``name:where``), and what became of it, in words."""

    effect: str
    how: str


@dataclass(frozen=True, eq=False)
class Request:
    """What was asked for beside the format.

    Attributes:
        out: The file that will hold the text: other files are named after it, and as seen from it.
        pose: (n,) commanded coordinates at which a moving model begins [rad or m].
        frame: Where the load acts; the tool frame by default.
    """

    out: Path
    pose: Array | None = None
    frame: str | None = None


@dataclass(frozen=True, eq=False)
class Exported:
    """A model in another program's words.

    Attributes:
        text: The file.
        carried, left_out: Every effect that does something stands in one of the two, or in both
            where a part of it is carried.
        notes: What else its reader should know.
        details: What the JSON holds beside it.
        title, header, rows: A table for people; none without rows.
        files: Files beside it: path as seen from its folder → bytes.
    """

    text: str
    carried: tuple[Told, ...]
    left_out: tuple[Told, ...]
    notes: tuple[str, ...] = ()
    details: Mapping[str, object] = field(default_factory=dict)
    title: str = ""
    header: tuple[str, ...] = ()
    rows: Sequence[Sequence[object]] = ()
    files: Mapping[str, bytes] = field(default_factory=dict)

    def __repr__(self) -> str:
        """The file itself is its `text`."""
        return (
            f"<Exported: {len(self.text.splitlines())} lines of text; {len(self.carried)} effects "
            f"carried, {len(self.left_out)} left out>"
        )


@dataclass(frozen=True)
class Format:
    """One format; `make` writes nothing and refuses by `InputError` what it has no word for.

    Attributes:
        name, title: For the command line, and for people.
        endings: Of the files that are taken for it.
        moves: A model that moves: it begins at a pose, and a load acts at a frame.
    """

    name: str
    title: str
    endings: tuple[str, ...]
    make: Callable[[Model, Request], Exported]
    moves: bool = False


def put(parent: Element, tag: str, text: str | None = None, /, **attributes: object) -> Element:
    """A new element at the end of another; a number to its last digit."""
    said = {key: each if isinstance(each, str) else repr(each) for key, each in attributes.items()}
    element = etree.SubElement(parent, tag, said)
    element.text = text
    return element


def xml_text(root: Element, *, declared: bool = False) -> str:
    """The text of an XML file, indented."""
    etree.indent(root, space="  ")
    head = '<?xml version="1.0"?>\n' if declared else ""
    return f"{head}{etree.tostring(root, encoding='unicode')}\n"
