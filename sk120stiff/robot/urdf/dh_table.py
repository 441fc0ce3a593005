"""A table of Denavit and Hartenberg's numbers, as makers and papers print arms, becomes a URDF.

One row per joint: the joint's value adds to theta, or to d where it slides. With

    C = Tx(a) Ty(b) Rx(alpha) Ry(beta),

a row of the standard convention is Rz(theta + q) Tz(d) C (Denavit & Hartenberg 1955), one of the
modified convention C Rz(theta + q) Tz(d) (Craig 1986); b and beta are zero but in rows after Hayati
(1983). A row that moves nothing is a fixed transform, of the base or the tool.
"""

from __future__ import annotations

import csv
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from lxml import etree

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError
from sk120stiff.robot.rotations import homogeneous, rotation_from_rpy, rpy_from_rotation
from sk120stiff.robot.urdf.clean import numbers
from sk120stiff.units import split_header, to_si

_ANGLES, _LENGTHS = ("theta", "alpha", "beta"), ("d", "a", "b")
_NEEDED = ("theta", "d", "a", "alpha")
_LIMITS = ("lower", "upper")
_WORDS = ("convention", "joint", "moves", "driver", "factor", "form")
_CONVENTIONS = ("standard", "modified")
_EXAMPLE = "convention,joint,theta[deg],d[mm],a[mm],alpha[deg]"
MARKER = " (measured)"  # ends the row that `export` writes for the point that a tracker saw


@dataclass(frozen=True)
class Row:
    """One row, SI.

    Attributes:
        name: Of its joint, or of the frame it fixes.
        moves: The column that the joint's value adds to, theta or d; empty: nothing.
        driver, factor: The value is factor times that of the driver.
        convention: standard or modified.
        free: A general transform, written as a standard row in either convention.
        numbers: theta, d, a, b, alpha, beta [rad, m].
        limits: Lower and upper, where the table states them [rad or m].
        place: File and line.
    """

    name: str
    moves: str
    driver: str
    factor: float
    convention: str
    free: bool
    numbers: Mapping[str, float]
    limits: tuple[float, float] | None
    place: str

    @property
    def modified(self) -> bool:
        """Does C stand before what moves?"""
        return self.convention == "modified" and not self.free

    @property
    def before(self) -> Array:
        """(4, 4) from the frame before to the joint."""
        return self._ahead @ self._screw if self.modified else np.eye(4)

    @property
    def behind(self) -> Array:
        """(4, 4) from the joint to the frame behind."""
        return np.eye(4) if self.modified else self._screw @ self._ahead

    @property
    def _screw(self) -> Array:
        return _placed(yaw=self.numbers["theta"], z=self.numbers["d"])

    @property
    def _ahead(self) -> Array:
        here = self.numbers
        shift = _placed(x=here["a"], y=here["b"])
        return shift @ _placed(roll=here["alpha"]) @ _placed(pitch=here["beta"])


def is_dh_table(path: Path) -> bool:
    """Is this a CSV file whose header names Denavit and Hartenberg's columns?"""
    if path.suffix.lower() != ".csv" or not path.is_file():
        return False
    with path.open(encoding="utf-8-sig", errors="replace") as stream:
        header = next((cells for _, cells in _told(stream)), [])
    names = {cell.partition("[")[0].strip().lower() for cell in header}
    return {"theta", "alpha", "a", "d"} <= names


def _told(lines: Iterable[str]) -> Iterator[tuple[int, list[str]]]:
    """Number and cells of every line that is neither blank nor a comment."""
    for number, line in enumerate(lines, 1):
        if line.strip(" ,;\t\r\n") and not line.lstrip().startswith("#"):
            yield number, next(csv.reader([line]))


def urdf_of_table(text: str, name: str, place: str) -> str:
    """URDF text of the arm in a table.

    Args:
        text: CSV with the header ``convention, joint, theta[deg], d[mm], a[mm], alpha[deg]`` and,
            where wanted, ``b[mm], beta[deg], moves, driver, factor, lower[deg], upper[deg]``;
            joints that slide have their limits in a length. Of a file with both conventions, as
            `export --format dh` writes it, the standard rows are read.
        name: Of the robot.
        place: For messages.

    Raises:
        InputError: A column that is missing or unknown, a number that is none, a convention that
            nobody stated, or a table in which nothing moves.
    """
    rows = _rows(text, place)
    moving = {row.name for row in rows if row.moves}
    if not moving:
        raise InputError("no row of this table moves", where=place, remedy="Fill the column moves.")
    root = etree.Element("robot", name=name)
    etree.SubElement(root, "link", name="base_link")
    link, at = "base_link", np.eye(4)
    for row in rows:
        if not row.moves:
            at = at @ (row.before @ row.behind)
            continue
        if row.driver not in moving:
            raise InputError(
                f"the driver {row.driver!r} is no joint of this table", where=row.place
            )
        behind = f"link_{len(root.findall('joint')) + 1}"
        etree.SubElement(root, "link", name=behind)
        root.append(_joint(row, link, behind, at @ row.before))
        link, at = behind, row.behind
    etree.SubElement(root, "link", name="tool0")
    root.append(_element("tool0_fixed", "fixed", link, "tool0", at))
    return str(etree.tostring(root, encoding="unicode", pretty_print=True))


def _joint(row: Row, parent: str, child: str, placement: Array) -> etree._Element:
    turns = row.moves == "theta"
    follows = row.driver != row.name
    kind = "prismatic" if not turns else "revolute" if row.limits else "continuous"
    element = _element(row.name, kind, parent, child, placement)
    etree.SubElement(element, "axis", xyz=f"0 0 {1.0 if follows else row.factor:g}")
    if row.limits is not None:
        lower, upper = map(repr, row.limits)
        etree.SubElement(element, "limit", lower=lower, upper=upper, effort="0", velocity="0")
    elif not turns:
        raise InputError(
            "this joint slides, and nobody says how far",
            where=row.place,
            remedy="Add the columns lower[mm] and upper[mm].",
        )
    if follows:
        etree.SubElement(element, "mimic", joint=row.driver, multiplier=repr(row.factor))
    return element


def _element(name: str, kind: str, parent: str, child: str, T: Array) -> etree._Element:
    element = etree.Element("joint", name=name, type=kind)
    etree.SubElement(element, "parent", link=parent)
    etree.SubElement(element, "child", link=child)
    rpy = rpy_from_rotation(T[:3, :3])
    etree.SubElement(element, "origin", xyz=numbers(T[:3, 3]), rpy=numbers(rpy))
    return element


def _placed(
    roll: float = 0.0, pitch: float = 0.0, yaw: float = 0.0, x: float = 0.0, y: float = 0.0,
    z: float = 0.0,
) -> Array:  # fmt: skip
    return homogeneous((x, y, z), rotation_from_rpy(np.array([roll, pitch, yaw])))


def _rows(text: str, place: str) -> list[Row]:
    lines = _told(text.splitlines())
    first, cells = next(lines)
    headers = [split_header(cell, where=f"{place}, line {first}") for cell in cells]
    names = [name.lower() for name, _ in headers]
    units = dict(zip(names, (unit for _, unit in headers), strict=True))
    known = {*_ANGLES, *_LENGTHS, *_LIMITS, *_WORDS}
    known |= {f"std_{name}" for name in (*_ANGLES, *_LENGTHS)}
    odd = [name for name in names if name not in known]
    missing = [name for name in ("convention", *_NEEDED) if name not in names]
    if odd or missing or len(set(names)) < len(names):
        what = f"lacks {', '.join(missing)}" if missing else f"has unknown or double columns: {odd}"
        raise InputError(
            f"this table of Denavit and Hartenberg's numbers {what}",
            where=f"{place}, line {first}",
            remedy=f"Write it like {_EXAMPLE}; convention is standard or modified.",
        )
    rows: list[Row] = []
    for number, cells in lines:
        filled = dict(zip(names, (cell.strip() for cell in cells), strict=False))
        rows.append(_row(filled, units, len(rows) + 1, f"{place}, line {number}"))
    read = "standard" if any(row.convention == "standard" for row in rows) else "modified"
    kept = [row for row in rows if row.convention == read and not row.name.endswith(MARKER)]
    twice = {row.name for row in kept if [each.name for each in kept].count(row.name) > 1}
    if twice:
        raise InputError(f"two rows are named {sorted(twice)[0]!r}", where=place)
    return kept


def _row(cells: Mapping[str, str], units: Mapping[str, str | None], number: int, place: str) -> Row:
    convention = cells.get("convention", "").lower()
    if convention not in _CONVENTIONS:
        raise InputError(
            f"the convention {convention!r} is not one of {', '.join(_CONVENTIONS)}",
            where=place,
            remedy="Say which one it is: standard (Rz Tz Tx Rx) or modified after Craig "
            "(Rx Tx Rz Tz). The numbers alone do not tell.",
        )
    moves = cells.get("moves", "theta").lower()
    if moves not in ("theta", "d", ""):
        raise InputError(f"moves is {moves!r}, not theta, d or blank", where=place)
    numbers = {
        name: _number(cells, units, name, "angle" if name in _ANGLES else "length", place)
        for name in (*_ANGLES, *_LENGTHS)
    }
    name = cells.get("joint") or f"joint_{number}"
    limits = None
    stated = [each for each in _LIMITS if cells.get(each)]
    if moves and len(stated) == 1:
        raise InputError(f"{stated[0]} is stated without the other limit", where=place)
    if moves and stated:
        kind = "angle" if moves == "theta" else "length"
        lower, upper = (_number(cells, units, each, kind, place) for each in _LIMITS)
        limits = (lower, upper)
    driver = cells.get("driver") or name
    factor = _plain(cells["factor"], "factor", place) if cells.get("factor") else 1.0
    if moves and driver == name and abs(factor) != 1.0:
        raise InputError(
            f"a joint turns by its own value, and its factor is {factor:g}",
            where=place,
            remedy="Write 1 or -1, or name the joint that it follows in column driver.",
        )
    return Row(
        name=name,
        moves=moves,
        driver=driver,
        factor=factor,
        convention=convention,
        free=cells.get("form", "").lower() == "free",
        numbers=numbers,
        limits=limits,
        place=place,
    )


def _number(
    cells: Mapping[str, str], units: Mapping[str, str | None], name: str, kind: str, place: str
) -> float:
    if name not in units and name not in _NEEDED:
        return 0.0
    value = _plain(cells.get(name, ""), name, place)
    return float(to_si(value, units[name], kind, where=f"{place}, column {name}"))


def _plain(cell: str, name: str, place: str) -> float:
    try:
        return float(cell)
    except ValueError:
        raise InputError(
            f"{cell!r} in column {name} is no number",
            where=place,
            remedy="Write what is there when the joint stands at zero, 0 if nothing is; the "
            "joint's own value is added to theta (to d, where column moves says d).",
        ) from None
