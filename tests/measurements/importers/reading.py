"""A file as the importers read it, without a robot: text or bytes in, a `Draft` out."""

from pathlib import Path
from typing import Any

from sk120stiff.measurements.importers import FORMATS, Sheet, Source, Told
from sk120stiff.measurements.importers.drafting import Draft, drafted
from sk120stiff.measurements.importers.one_file import opened

SIX = tuple(f"joint_{k}" for k in range(1, 7))


def sheet_of(
    folder: Path, content: str | bytes, joints: tuple[str, ...] = SIX, **known: Any
) -> Sheet:
    """The readings, in the format that the content tells; the name of the file tells nothing."""
    path = folder / "file"
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    source = opened(Source(path, joints, **known))
    return FORMATS.chosen(source)[0].read(source)


def draft_of(
    folder: Path,
    content: str | bytes,
    actuated: tuple[str, ...] = SIX,
    prismatic: tuple[str, ...] = (),
    known: dict[str, Any] | None = None,
    **told: Any,
) -> Draft:
    """The same understood."""
    sheet = sheet_of(folder, content, actuated, **(known or {}))
    return drafted(sheet, Told(**told), actuated, prismatic)


def written(draft: Draft) -> dict[str, tuple[str, ...]]:
    """Header → cells, as they are written."""
    return dict((*draft.joints.written, *draft.readings, *draft.other))
