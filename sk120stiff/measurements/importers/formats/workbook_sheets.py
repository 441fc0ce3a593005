"""Which sheet of a workbook is for what: as --sheet says, and as the sheets' own names do."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from sk120stiff.errors import InputError
from sk120stiff.measurements.importers.columns.load_states import WITH, state_of
from sk120stiff.measurements.importers.columns.words import unit_of_header
from sk120stiff.measurements.importers.contract import Sheet

ROLES = ("before", "joints", "loads")  # files beside that of the positions
_LOAD = re.compile(r"load|last|charge|carga|carico|deform|verform", re.IGNORECASE)


def named_sheets(told: Sequence[str]) -> dict[str, str]:
    """What is before the sheet's name in ``loads=Force (N)`` → that name; nothing: positions.

    Raises:
        InputError: Two sheets for one purpose.
    """
    out: dict[str, str] = {}
    for text in told:
        role, found, name = text.partition("=")
        role = role.strip() if found and role.strip() in ROLES else ""
        if role in out:
            raise InputError(
                f"two sheets for one purpose, {out[role]} and {text}",
                where="--sheet",
                remedy="Name that of the positions alone, and before others what they are for: "
                "--sheet 'Loaded' --sheet 'before=Unloaded' --sheet 'joints=Joints' --sheet "
                "'loads=Forces'.",
            )
        out[role] = name.strip() if role else text
    return out


def load_state(title: str | None) -> str | None:
    """``unloaded`` or ``loaded`` as the name of a sheet says, or None."""
    plain = re.sub(r"[\s_.\-]+", " ", unit_of_header(title or "")[0]).strip().lower()
    said = state_of(plain)
    return said[0] if said else None


def under_load(title: str | None) -> bool:
    """Does the name of a sheet say that its readings are under a load? With the word for it."""
    return load_state(title) == WITH and _LOAD.search(title or "") is not None


def without_used(sheet: Sheet, workbook: Path, used: Sequence[str]) -> Sheet:
    """The sheet with those of the workbook that were used no longer among what is left out."""
    there = {f"sheet {name}" for name in used}
    behind = f" of {workbook.name}"
    plain = [
        item.removesuffix(behind) if item.startswith("sheet ") else item for item in sheet.unused
    ]
    return replace(sheet, unused=tuple(i for i in dict.fromkeys(plain) if i not in there))
