"""A sheet becomes columns of a measurement file: what each row says, in units and words of ours."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from decimal import Decimal

import numpy as np

from sk120stiff.arrays import Array, Mask
from sk120stiff.errors import InputError
from sk120stiff.measurements.importers.clock import EITHER_WAY, since_1970, since_first
from sk120stiff.measurements.importers.columns.compound_groups import COMMANDED_JOINT
from sk120stiff.measurements.importers.columns.joints import JointColumns, joint_columns
from sk120stiff.measurements.importers.columns.matrices import MATRIX_END
from sk120stiff.measurements.importers.columns.orientations import orientation_columns
from sk120stiff.measurements.importers.columns.pose_labels import pose_labels
from sk120stiff.measurements.importers.columns.unread_axes import displacements
from sk120stiff.measurements.importers.contract import Column, Sheet
from sk120stiff.measurements.importers.loads.loads import Loads, lightest, loads_of
from sk120stiff.measurements.importers.told import (
    Told,
    numbers,
    plain,
    quantity,
    refuse_other_joints,
    texts,
    two_units,
    unit_of,
)
from sk120stiff.measurements.table.columns import POSITIONS, QUATERNION, UNCERTAINTIES

Written = tuple[tuple[str, tuple[str, ...]], ...]
LABELS = ("order", "marker", "series", "station", "branch", "repeat")  # taken over as they stand


@dataclass(frozen=True, eq=False)
class Draft:
    """The rows of a sheet, understood.

    Attributes:
        sheet: Where they come from.
        pose: N labels.
        joints, loads: Joint values and loads.
        measured: (N, 3) positions or displacements [m]; `displaced` says which.
        readings: Headers with units and cells of these, digit by digit.
        other: The same of uncertainties, temperature, time and labels.
        markers: N names of markers and their places in the tool frame (3,) [m], where the file
            has them; empty otherwise.
        use: (N,) False where masked.
        reversed: (N, 3) positions if deviations had the other sign, where they are a sum.
        unused: What is not taken over, with the reason.
        said: What was decided or taken for granted, in sentences.
    """

    sheet: Sheet
    pose: tuple[str, ...]
    joints: JointColumns
    loads: Loads
    measured: Array
    displaced: bool
    readings: Written
    other: Written
    markers: tuple[tuple[str, ...], dict[str, Array]]
    use: Mask
    reversed: Array | None
    unused: tuple[str, ...]
    said: tuple[str, ...]

    @property
    def marker_of(self) -> tuple[str, ...]:
        """The marker of every row, N names; empty ones where the file names none."""
        named = next((cells for header, cells in self.other if header == "marker"), ())
        return named or self.markers[0] or ("",) * len(self.pose)

    @property
    def mounts(self) -> tuple[str, ...]:
        """N labels of markers as they were mounted: of another series one may sit elsewhere."""
        series = self.series or ("",) * len(self.pose)
        return tuple(f"{m}/{s}" for m, s in zip(self.marker_of, series, strict=True))

    @property
    def stations(self) -> tuple[str, ...] | None:
        """Where the instrument stood for every row, N labels, where the file tells."""
        return self._labels("station")

    @property
    def series(self) -> tuple[str, ...] | None:
        """What may have changed from row to row, N labels, where the file tells."""
        return self._labels("series")

    def _labels(self, header: str) -> tuple[str, ...] | None:
        return next((cells for name, cells in self.other if name == header), None)


def drafted(
    sheet: Sheet, told: Told, actuated: tuple[str, ...], prismatic: tuple[str, ...]
) -> Draft:
    """Understand a sheet.

    Raises:
        InputError: Positions or joints are missing, a unit that nobody said, a cell that is no
            number.
    """
    joints = joint_columns(sheet, told, actuated, prismatic)
    measured, readings, columns, back, said = _measured(sheet, told)
    loads = loads_of(sheet, told)
    taken = [*joints.taken, *loads.taken, *columns]
    other: list[tuple[str, tuple[str, ...]]] = []
    reasons: dict[int, str] = {}
    unit = readings[0][0].partition("[")[2].rstrip("]")
    for group, notes in (
        _sigmas(sheet, told, unit, reasons),
        _turns(sheet, told, displaced=readings[0][0].startswith("d")),
        _conditions(sheet, told, loads.wrench, reasons),
    ):
        for column, header, cells in group:
            if header:
                other.append((header, cells))
            taken.append(column)
        said += notes
    markers, places = _markers(sheet, told)
    taken += [c for c in sheet.columns if c.meaning.startswith("tcp ")]
    use = _use(sheet)
    displaced = readings[0][0].startswith("d")
    pose, label, notes = pose_labels(sheet, joints.values, loads.wrench, displaced=displaced)
    said += notes
    names, stated = sheet.get("name"), sheet.get("pose")
    if names is None and label is None and stated is not None and all(stated.cells):
        names = stated  # of rows that are one pose
    if names is not None:
        taken.append(names)
        if label is not names:
            other.append(("name", names.cells))
    taken += [c for c in sheet.columns if c.meaning in ("use", "pose")]
    taken += orientation_columns(sheet)  # what is made of them is for the placed robot to tell
    left = [c for c in (*sheet.columns, *sheet.spare) if not any(c is t for t in taken)]
    asked = [c for c in left if not c.meaning.startswith(COMMANDED_JOINT)]
    refuse_other_joints(sheet, asked, actuated)
    unused = [f"column {c.header}{reasons.get(id(c), _why_unused(c))}" for c in left]
    return Draft(
        sheet=sheet,
        pose=pose,
        joints=joints,
        loads=loads,
        measured=measured,
        displaced=displaced,
        readings=readings,
        other=tuple(other),
        markers=(markers, places),
        use=use,
        reversed=back,
        unused=(*unused, *sheet.unused),
        said=(*sheet.notes, *joints.said, loads.said, *said),
    )


_WHOLE = re.compile(r"\bu ?95\b|sigma|uncertainty", re.IGNORECASE)


def _why_unused(column: Column) -> str:
    if column.meaning.startswith("orientation") or column.meaning in QUATERNION:
        return ": one of several numbers of an orientation, and the others are missing"
    if _WHOLE.search(column.header):
        return ": of the whole point, and how much of it is along x, y and z is not stated"
    if column.meaning.startswith(("nominal", "deviation")):
        return ": the measured position stands beside it"
    if column.meaning.startswith(COMMANDED_JOINT):
        return ": commanded, and the measured value stands beside it"
    if column.meaning.startswith(MATRIX_END):
        return ": 0 0 0 1 of the matrix"
    return ""


def _measured(
    sheet: Sheet, told: Told
) -> tuple[Array, Written, list[Column], Array | None, list[str]]:
    """(N, 3) positions or displacements [m], as they are written, and the columns they are from."""
    nominal = sheet.those(*(f"nominal {axis}" for axis in POSITIONS))
    columns = sheet.those(*POSITIONS)
    if len(columns) == len(POSITIONS):
        units = [unit_of(sheet, c, "length", told) for c in columns]
        values = [quantity(sheet, c, "length", u) for c, u in zip(columns, units, strict=True)]
        written = tuple(
            (f"{name}[{u}]", texts(c)) for name, u, c in zip(POSITIONS, units, columns, strict=True)
        )
        return np.column_stack(values), written, columns, None, []
    moved = None if nominal else displacements(sheet, told)
    if moved is not None:
        return moved[0], moved[1], moved[2], None, moved[3]
    deviation = [c for a in POSITIONS if (c := sheet.get(f"deviation {a}") or sheet.get(f"d{a}"))]
    if len(nominal) == len(deviation) == 3:
        return _summed(sheet, told, nominal, deviation)
    there = ", ".join(c.header for c in (*sheet.columns, *sheet.spare))
    raise InputError(
        "no columns hold a position: x, y and z"
        if not nominal
        else "nominal positions alone are no measurement",
        where=str(sheet.path),
        remedy=f"There are {there}. Name the columns with --columns.",
    )


def _summed(
    sheet: Sheet, told: Told, nominal: list[Column], deviation: list[Column]
) -> tuple[Array, Written, list[Column], Array | None, list[str]]:
    values, back, written = [], [], []
    for axis, a, b in zip(POSITIONS, nominal, deviation, strict=True):
        numbers(sheet, a), numbers(sheet, b)
        units = {unit_of(sheet, c, "length", told) for c in (a, b)}
        if len(units) > 1:
            raise two_units(sheet, a, b)
        (unit,) = units
        pairs = [(Decimal(p), Decimal(q)) for p, q in zip(a.cells, b.cells, strict=True)]
        total = replace(a, cells=tuple(str(p + q) for p, q in pairs))
        other = replace(a, cells=tuple(str(p - q) for p, q in pairs))
        values.append(quantity(sheet, total, "length", unit))
        back.append(quantity(sheet, other, "length", unit))
        written.append((f"{axis}[{unit}]", total.cells))
    said = (
        f"Positions are {nominal[0].header} + {deviation[0].header} and so on: deviations are "
        "taken to be measured minus nominal."
    )
    columns = [*nominal, *deviation]
    return np.column_stack(values), tuple(written), columns, np.column_stack(back), [said]


_Group = tuple[list[tuple[Column, str, tuple[str, ...]]], list[str]]


def _sigmas(sheet: Sheet, told: Told, unit: str, reasons: dict[int, str]) -> _Group:
    columns = sheet.those(*UNCERTAINTIES)
    if len(columns) != 3:
        return [], []
    if told.coverage is not None:
        columns_used = [replace(c, factor=1.0 / told.coverage) for c in columns]
    else:
        columns_used = columns
    sizes = np.column_stack([numbers(sheet, c) if all(c.cells) else [0.0] for c in columns_used])
    if not (sizes > 0.0).all():
        reasons.update({id(c): ": not all of them are positive" for c in columns})
        return [], []
    factor = columns_used[0].factor
    notes = [
        f"Stated uncertainties are divided by {1 / factor:g} to standard ones"
        + (", as told." if told.coverage else " (95 %, k = 2).")
        if factor != 1.0
        else "Stated uncertainties are taken for standard ones (k = 1; --coverage 2: twice those)."
    ]
    found = []
    for name, column, used in zip(UNCERTAINTIES, columns, columns_used, strict=True):
        own = column.unit
        if own is None:
            notes = [*notes[:1], f"Uncertainties are in {unit}, as the positions are."]
        found.append((column, f"{name}[{plain(own or unit)}]", texts(used)))
    return found, notes


def _turns(sheet: Sheet, told: Told, *, displaced: bool) -> _Group:
    """How the load turned the tool, beside displacements."""
    columns = sheet.those(*(f"turn {axis}" for axis in POSITIONS))
    found = []
    for column in columns if displaced else []:
        axis = column.meaning[-1]
        unit = unit_of(sheet, column, "angle", told)
        if all(column.cells):
            quantity(sheet, column, "angle", unit)
        found.append((column, f"dr{axis}[{plain(unit)}]", texts(column)))
    return found, []


def _conditions(sheet: Sheet, told: Told, W: Array, reasons: dict[int, str]) -> _Group:
    """Temperature, time, order and labels; rows without load need no branch."""
    loaded = [bool(row.any()) for row in W]
    found: list[tuple[Column, str, tuple[str, ...]]] = []
    for column in sheet.columns:
        word, unit = column.meaning, column.unit
        if word == "temperature":
            if unit not in ("degC", "°C", "ºC", "C", "K"):
                reasons[id(column)] = ": its unit is not stated" if unit is None else f" in {unit}"
            elif not all(column.cells):
                reasons[id(column)] = ": some cells are empty"
            else:
                numbers(sheet, column)
                header = f"temperature[{'K' if unit == 'K' else 'degC'}]"
                found.append((column, header, texts(column)))
        elif word in LABELS and not all(
            cell or (word == "branch" and not under)
            for cell, under in zip(column.cells, loaded, strict=True)
        ):
            reasons[id(column)] = ": some cells are empty"
        elif word in LABELS:
            if word == "order":
                numbers(sheet, column)
            found.append((column, word, column.cells))
    clock = sheet.get("time")
    counted = since_1970(clock.cells) if clock is not None and clock.unit is None else None
    notes = [f"{clock.header} counts {counted[0]} since 1970."] if clock and counted else []
    return found + _clock(sheet, told, reasons), notes


def _clock(
    sheet: Sheet, told: Told, reasons: dict[int, str]
) -> list[tuple[Column, str, tuple[str, ...]]]:
    """Seconds; of a date and a time of the day in columns of their own, both together.

    Raises:
        InputError: Day and month can be read either way.
    """
    time, date = sheet.get("time"), sheet.get("date")
    if time is not None and time.unit == "s":
        return [(time, "time[s]", texts(time))]
    columns = [column for column in (date, time) if column is not None]
    if not columns:
        return []
    seconds = since_first(*(column.cells for column in columns), order=told.dates)
    if seconds == EITHER_WAY:
        raise InputError(
            f"dates like {columns[0].cells[0]} can be read with the day or the month first, and "
            "the order of the rows does not tell which",
            where=sheet.place(columns[0]),
            remedy="Give --dates dmy (the day first) or --dates mdy (the month first).",
        )
    if isinstance(seconds, str):
        reasons.update({id(column): f": {seconds}" for column in columns})
        return []
    return [(columns[-1], "time[s]", seconds), *((column, "", ()) for column in columns[:-1])]


def _markers(sheet: Sheet, told: Told) -> tuple[tuple[str, ...], dict[str, Array]]:
    """The marker of each row, and where each sits; none where every tool is zero, as never set."""
    columns = sheet.those(*(f"tcp {axis}" for axis in POSITIONS))
    if len(columns) != 3:
        return (), {}
    values = np.column_stack(
        [quantity(sheet, c, "length", unit_of(sheet, c, "length", told)) for c in columns]
    )
    if not values.any():
        return (), {}
    kinds, index = np.unique(values, axis=0, return_inverse=True)
    names = [f"M{k + 1}" for k in range(len(kinds))]
    return tuple(names[k] for k in index.ravel()), dict(zip(names, kinds, strict=True))


def _use(sheet: Sheet) -> Mask:
    column = sheet.get("use")
    if column is None:
        return np.ones(len(sheet.lines), dtype=np.bool_)
    values = numbers(sheet, column)
    bad = (values != 0.0) & (values != 1.0)
    if bad.any() or not values.any():
        raise InputError(
            "the column use masks every row" if not bad.any() else "use is neither 1 nor 0",
            where=sheet.place(column, int(np.argmax(bad))),
            remedy="Write 0 to mask the row, 1 to use it.",
        )
    used: Mask = values == 1.0
    return used


def paired_loads(draft: Draft) -> tuple[Array, Mask, int]:
    """Loads less the lightest of their pose (N, 6), rows that differ from it, poses shifted."""
    return lightest(draft.pose, draft.loads.wrench, draft.use)
