"""A table of Denavit and Hartenberg's numbers with the standard errors of the calibration."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Array, Mask
from sk120stiff.errors import two_digits
from sk120stiff.exports.contract import Exported, Format, Request
from sk120stiff.exports.dh import (
    COLUMNS,
    Layout,
    forms_of,
    layout_of,
    lines_of,
    locked,
    near_parallel,
    rows_of,
    standard_to_modified,
)
from sk120stiff.exports.geometry import MEASURED, Geometry, folded, geometry_of, measured, weighing
from sk120stiff.exports.kinematics_params import yielding
from sk120stiff.files import csv_text
from sk120stiff.model import Model
from sk120stiff.model.uncertainty import spread
from sk120stiff.robot import LinearCoupling, Robot
from sk120stiff.robot.anatomy import arm_length

ANGLES = (0, 4, 5)  # of `COLUMNS`; the others are lengths
UNITS = tuple("deg" if k in ANGLES else "mm" for k in range(len(COLUMNS)))
PUBLIC = np.array([np.degrees(1.0) if k in ANGLES else 1e3 for k in range(len(COLUMNS))])
FIXED = {  # by the form of a row: columns that are zero in every arm (see `dh.rows_of`)
    "base": [0], "DH": [3, 5], "Hayati": [1, 3], "coincident": [0, 1],
    "last": [0, 2, 3, 4, 5], "tool": [1], "measured": [0, 4, 5],
}  # fmt: skip
_STEP = 1e-6  # rad or m, of the derivatives
_NOTHING = 1e-14  # rad or m, what products of rotations leave of zero
_ROUNDING = 1e-8  # of a derivative that is none


@dataclass(frozen=True, eq=False)
class Table:
    """Rows base to tool (and measured point): values (r, 6) and standard errors, SI.

    Attributes:
        names, drivers, factors: (r,) joint, and what moves it: its value is factor · driver.
        moves: (r,) the column that the value adds to, theta or d; empty where nothing moves.
        std: (r, 6) NaN: not known, as where nobody estimated it; infinite: the readings do not show
            it. None: the model stores no uncertainty.
    """

    names: tuple[str, ...]
    drivers: tuple[str, ...]
    factors: tuple[float, ...]
    moves: tuple[str, ...]
    values: Array
    std: Array | None
    layout: Layout

    def written(self, *, modified: bool) -> tuple[tuple[str, ...], Array, Array | None]:
        """Forms, values and standard errors in one of the two conventions."""
        measured = len(self.values) - 2 - (len(self.layout.forms) + 1)
        forms = (*forms_of(self.layout, modified=modified), *(["free"] * measured))
        if not modified:
            return forms, self.values, self.std
        body = slice(0, len(self.values) - measured)

        def moved(rows: Array) -> Array:
            return np.concatenate([standard_to_modified(rows[body]), rows[body.stop :]])

        std = None if self.std is None else moved(self.std)
        if std is not None and np.isnan(std[1, :2]).all():
            std[1, 2:] = np.nan  # zero by the form of a row of which nothing was estimated
        return forms, moved(self.values), std


def table_of(model: Model, geometry: Geometry) -> Table:
    """The table of a model's calibrated geometry."""
    robot = model.robot
    layout = layout_of(lines_of(geometry.placements, geometry.axes))
    offsets, drivers, factors = _coupling(robot)

    def rows(shift: Array) -> Array:
        arm = np.where(geometry.of_marker, 0.0, shift)
        lines = lines_of(folded(model, arm)[0], geometry.axes)
        found = rows_of(lines, layout)
        turns = np.where(geometry.revolute, 0, 1)
        found[np.arange(1, len(offsets) + 1), turns] += offsets
        half = found[:, ANGLES] < 1e-9 - np.pi  # one name for half a turn
        found[:, ANGLES] += np.where(half, 2.0 * np.pi, 0.0)
        x, y, z = measured(shift, geometry.of_marker)
        return np.concatenate([found, [[0.0, z, x, y, 0.0, 0.0]]])

    values = rows(geometry.shift)
    values = np.where(np.abs(values) < _NOTHING, 0.0, values)
    std = None
    if model.uncertainty is not None:
        L, B = model.uncertainty.factors(model.names)
        by_shift = np.zeros((*values.shape, len(geometry.shift)))
        for k in np.flatnonzero(geometry.by_parameter.any(axis=1)):
            step = _STEP * np.eye(len(geometry.shift))[k]
            difference = rows(geometry.shift + step) - rows(geometry.shift - step)
            difference[:, ANGLES] = (difference[:, ANGLES] + np.pi) % (2.0 * np.pi) - np.pi
            slope = difference / (2.0 * _STEP)
            by_shift[..., k] = np.where(np.abs(slope) > _ROUNDING, slope, 0.0)
        by_parameter = by_shift @ geometry.by_parameter
        floor = np.full(len(COLUMNS), model.uncertainty.floor)
        floor[list(ANGLES)] /= arm_length(robot)
        std = spread(by_parameter @ L, by_parameter @ B, floor)
        std = np.where(_estimated(by_parameter, model, layout), std, np.nan)
        for free in (0, len(geometry.joints) + 1):
            if locked(values[free]):
                std[free, [0, 5]] = np.nan
    shown = len(values) if geometry.measured.any() else len(values) - 1
    names = ("base", *geometry.joints, "tool", f"{robot.tool_frame}{MEASURED}")
    return Table(
        names[:shown],
        ("", *drivers, "", "")[:shown],
        (0.0, *factors, 0.0, 0.0)[:shown],
        ("", *("theta" if turns else "d" for turns in geometry.revolute), "", "")[:shown],
        values[:shown],
        None if std is None else std[:shown],
        layout,
    )


def _estimated(by_parameter: Array, model: Model, layout: Layout) -> Mask:
    """(r, 6) does a number go with a parameter that was estimated, or is it zero by the form of a
    row that has such numbers? Of all others nothing is known."""
    asked = set() if model.uncertainty is None else set(model.uncertainty.names)
    columns = [k for k, name in enumerate(model.names) if name in asked]
    found: Mask = (by_parameter[..., columns] != 0.0).any(axis=-1)
    forms = [FIXED.get(form, []) for form in layout.forms]
    fixed = [FIXED["base"], *forms, FIXED["last"], FIXED["tool"], FIXED["measured"]]
    for row, zeros in enumerate(fixed):
        found[row, zeros] |= found[row].any()
    return found


def _coupling(robot: Robot) -> tuple[Array, tuple[str, ...], tuple[float, ...]]:
    """Constant part of every chain joint's value, and driver and factor of the rest."""
    names = robot.mechanism().chain.names
    if not isinstance(robot.coupling, LinearCoupling):
        return np.zeros(len(names)), names, (1.0,) * len(names)
    index = robot.mechanism().chain.coordinates
    A, b = robot.coupling.A[index], robot.coupling.b[index]
    most = np.abs(A).argmax(axis=1)
    factors = tuple(float(row[k]) for row, k in zip(A, most, strict=True))
    drivers = tuple(
        robot.actuated[k] if factor else "" for k, factor in zip(most, factors, strict=True)
    )
    return np.asarray(b), drivers, factors


def make(model: Model, request: Request) -> Exported:  # noqa: ARG001
    """See `Format.make`."""
    geometry = geometry_of(model)
    table = table_of(model, geometry)
    reach = None if model.uncertainty is None else model.uncertainty.reach()
    rows: list[list[object]] = []
    details: dict[str, object] = {"coverage_factor_95": reach}
    for convention in ("standard", "modified"):
        forms, values, std = table.written(modified=convention == "modified")
        rows += _rows(convention, table, forms, values, std)
        details[convention] = _document(table, forms, values, std)
    pairs = near_parallel(table.layout, geometry.joints)
    _, values, std = table.written(modified=False)
    return Exported(
        csv_text(zip(_header(table.std is not None), zip(*rows, strict=True), strict=True)),
        geometry.carried,
        (
            *geometry.left_out,
            *weighing(model, "a table holds no masses"),
            *yielding(model, "a table holds no springs"),
        ),
        notes=_notes(model, pairs),
        details={
            **details,
            "near_parallel": [{"joints": [a, b], "angle_rad": angle} for a, b, angle in pairs],
        },
        title="Standard rows: Rz(theta + q) Tz(d) Tx(a) Ty(b) Rx(alpha) Ry(beta)"
        + ("" if reach is None else ", ± of 95 %"),
        header=("joint", *(f"{c} [{u}]" for c, u in zip(COLUMNS, UNITS, strict=True))),
        rows=[
            (name, *(_shown(k, values[r], std, r, reach) for k in range(len(COLUMNS))))
            for r, name in enumerate(table.names)
        ],
    )


FORMAT = Format("dh", "DH table, standard and modified", (".csv",), make)


def _header(known: bool) -> list[str]:
    units = list(zip(COLUMNS, UNITS, strict=True))
    return [
        "convention", "joint", "moves", "driver", "factor", "form",
        *(f"{column}[{unit}]" for column, unit in units),
        *(f"std_{column}[{unit}]" for column, unit in units if known),
    ]  # fmt: skip


def _rows(
    convention: str, table: Table, forms: tuple[str, ...], values: Array, std: Array | None
) -> list[list[object]]:
    told = [] if std is None else [np.where(np.isfinite(std), std, np.nan)]
    numbers = np.concatenate([part * PUBLIC for part in (values, *told)], axis=1)
    before = zip(table.names, table.moves, table.drivers, table.factors, forms, strict=True)
    return [[convention, *cells, *row] for cells, row in zip(before, numbers.tolist(), strict=True)]


def _document(
    table: Table, forms: tuple[str, ...], values: Array, std: Array | None
) -> list[dict[str, object]]:
    return [
        {
            "joint": name,
            "moves": table.moves[r] or None,
            "driver": table.drivers[r] or None,
            "factor": table.factors[r],
            "form": forms[r],
            **dict(zip(COLUMNS, values[r].tolist(), strict=True)),
            "std": None if std is None else dict(zip(COLUMNS, std[r].tolist(), strict=True)),
        }
        for r, name in enumerate(table.names)
    ]


def _shown(k: int, row: Array, std: Array | None, r: int, reach: float | None) -> str:
    text = f"{row[k] * PUBLIC[k] + 0.0:.4f}"
    text = "0.0000" if text == "-0.0000" else text
    if std is None or reach is None or std[r, k] == 0.0:
        return text
    error = std[r, k] * PUBLIC[k] * reach
    return f"{text} ± {two_digits(error)}" if np.isfinite(error) else f"{text} ± ?"


def _notes(model: Model, pairs: list[tuple[str, str, float]]) -> tuple[str, ...]:
    notes = [
        f"The axes of {one} and {two} are parallel but for {1e3 * angle:.2g} mrad: their common "
        "normal, and d with it, is not determined. The row has d = 0 and a second tilt beta "
        "(Hayati)."
        for one, two, angle in pairs
    ]
    if model.uncertainty is None:
        notes.append("The model stores no uncertainty, so the numbers have no standard errors.")
    else:
        notes.append(
            "A missing standard error: the number was not estimated, or the readings do not show "
            "it, or show it only together with others."
        )
    if not isinstance(model.robot.coupling, LinearCoupling):
        notes.append("Closed loops move joints of this table: their values are not in it.")
    return tuple(notes)
