"""What a report is made of. Blocks hold content; how they look is the template's business."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

from sk120stiff.errors import InputError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from sk120stiff.show.scene.scene import Scene


@dataclass(frozen=True)
class Table:
    """A table; the first column heads its rows.

    Attributes:
        header: One name per column.
        rows: Cells: text as it stands, numbers with `digits` significant digits, None as a dash.
        caption: What the table says, in a sentence.
        units: One per column, shown under the names; empty where a column has none.
        digits: Significant digits of numbers.
    """

    header: Sequence[str]
    rows: Sequence[Sequence[object]]
    caption: str
    units: Sequence[str] = ()
    digits: int = 4

    def __post_init__(self) -> None:
        width = len(self.header)
        if self.units and len(self.units) != width:
            raise InputError(f"{len(self.units)} units for {width} columns", where=self.caption)
        for k, row in enumerate(self.rows):
            if len(row) != width:
                raise InputError(f"row {k + 1} has {len(row)} of {width} cells", where=self.caption)


@dataclass(frozen=True, eq=False)
class Picture:
    """A figure with its caption; `alt` tells what it shows to a reader who cannot see it.

    `figure` may be a function that draws it: then a drawing that fails is said in its place, and
    the rest of the report stands.
    """

    figure: Figure | Callable[[], Figure]
    alt: str
    caption: str = ""

    @property
    def drawn(self) -> Figure:
        """The figure itself."""
        return self.figure() if callable(self.figure) else self.figure


@dataclass(frozen=True)
class KeyFigure:
    """One number that matters, e.g. ``KeyFigure("rms gap", "9.8", "µm", "was 41 µm")``."""

    label: str
    value: str
    unit: str = ""
    note: str = ""


@dataclass(frozen=True)
class KeyFigures:
    """A row of numbers that matter."""

    figures: Sequence[KeyFigure]


@dataclass(frozen=True)
class Note:
    """A boxed remark; `kind` decides its colour and the word that heads it."""

    text: str
    kind: Literal["note", "result", "caution", "problem"] = "note"
    title: str = ""


@dataclass(frozen=True)
class Items:
    """A list of sentences."""

    items: Sequence[str]
    ordered: bool = False


@dataclass(frozen=True)
class Code:
    """Lines to copy: a command, or Python."""

    text: str
    caption: str = ""


@dataclass(frozen=True, eq=False)
class SceneFrame:
    """The 3-D scene inside the report.

    Attributes:
        scene: A `Scene`, or the text of a self-contained page.
        title: What it shows, for screen readers and for print.
        caption: Sentence under it.
        link: Relative address of the scene as a page of its own, if there is one.
        height: In CSS pixels.
    """

    scene: Scene | str
    title: str
    caption: str = ""
    link: str = ""
    height: int = 620


@dataclass(frozen=True, eq=False)
class Section:
    """A heading and what stands under it; a section among the blocks is a subsection."""

    title: str
    blocks: Sequence[Block] = field(default_factory=tuple)


Block = str | Table | Picture | KeyFigures | Note | Items | Code | SceneFrame | Section
