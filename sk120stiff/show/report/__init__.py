"""The report: content in plain blocks, one look for every command that writes one."""

from sk120stiff.show.report.blocks import (
    Block,
    Code,
    Items,
    KeyFigure,
    KeyFigures,
    Note,
    Picture,
    SceneFrame,
    Section,
    Table,
)
from sk120stiff.show.report.rendering import (
    Report,
    failure,
    fragment,
    reproducibility,
    section_or_note,
)

__all__ = [
    "Block",
    "Code",
    "Items",
    "KeyFigure",
    "KeyFigures",
    "Note",
    "Picture",
    "Report",
    "SceneFrame",
    "Section",
    "Table",
    "failure",
    "fragment",
    "reproducibility",
    "section_or_note",
]
