"""Slips that a file of readings may hold, each with what mends it.

In loads and displacements: signs, exchanged axes, frames, one axis in another unit. In the joint
columns: signs, exchanges, degrees for radians, angles to the floor. Between rows: columns that were
pasted some rows too high or low, or upside down.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations, permutations

import numpy as np

from sk120stiff.arrays import Array, Index
from sk120stiff.data_checks.correction import Correction
from sk120stiff.data_checks.sheet import Sheet
from sk120stiff.measurements.data import Frame
from sk120stiff.measurements.table.angle_units import mixed

AXES = "xyz"
#: factors by which one axis may have been written in another unit of length
UNITS = (
    (1e3, "mm labelled um, or m labelled mm"),
    (1e-3, "um labelled mm, or mm labelled m"),
    (25.4, "inch labelled mm"),
    (1.0 / 25.4, "mm labelled inch"),
)
OTHER: dict[Frame, Frame] = {"base": "tool", "tool": "base"}


def of_axes(sheet: Sheet) -> Iterator[Correction]:
    """Corrections of the columns of load and displacement."""
    against = int((np.einsum("ni,ni->n", _base(sheet, "force"), _base(sheet, "d")) < 0).sum())
    yield Correction(
        f"displacement and force point against each other in {against} of {len(sheet.measured)} "
        "rows: check the sign convention",
        "A displacement is loaded minus unloaded, a force is the one on the arm.",
        lambda s: replace(s, displacement=-s.displacement),
    )
    for axis, name in enumerate(AXES):
        signs = np.ones(3)
        signs[axis] = -1.0
        said, remedy = f"d{name} seems to have the wrong sign", f"Negate the column d{name}."
        if sheet.directions is not None:
            said = f"gauges along {name} seem to read with the wrong sign"
            remedy = "Turn their direction in ux, uy, uz by 180 deg, or negate what they read (d)."
        yield _displacement(signs, said, remedy)
        yield _wrench(signs, f"f{name} seems to have the wrong sign", f"Negate the column f{name}.")
    for order in list(permutations(range(3)))[1:]:
        names = ", ".join(AXES[k] for k in order)
        both = [*order, *(3 + k for k in order)]
        yield Correction(
            f"the axes of the force seem to be swapped: fx, fy, fz look like {names}",
            "Rename the headers of the force.",
            lambda s, o=both: replace(s, wrench=s.wrench[:, o]),  # type: ignore[misc]
        )
        if sheet.directions is not None:  # in a column of their own for all axes
            continue
        yield Correction(
            f"the axes of the displacement seem to be swapped: dx, dy, dz look like {names}",
            "Rename the headers of the displacement.",
            lambda s, o=list(order): replace(s, displacement=s.displacement[:, o]),  # type: ignore[misc]
        )
    yield from _frames(sheet)
    if sheet.directions is None:
        yield from _units()


def _frames(sheet: Sheet) -> Iterator[Correction]:
    force, read = OTHER[sheet.force_frame], OTHER[sheet.displacement_frame]
    yield Correction(
        f"the force looks as if it were given in {force} axes, not in {sheet.force_frame} axes",
        f"Write force: {{frame: {force}}} into the YAML file beside the readings.",
        lambda s: replace(s, force_frame=force),
    )
    yield Correction(
        f"the displacement looks as if it were given in {read} axes, "
        f"not in {sheet.displacement_frame} axes",
        f"Write displacement: {{frame: {read}}} into the YAML file beside the readings.",
        lambda s: replace(s, displacement_frame=read),
    )
    if force == read:
        yield Correction(
            f"force and displacement look as if both were given in {read} axes",
            f"Write force: {{frame: {force}}} and displacement: {{frame: {read}}} into the YAML "
            "file beside the readings.",
            lambda s: replace(s, force_frame=force, displacement_frame=read),
        )


def _units() -> Iterator[Correction]:
    for axis, name in enumerate(AXES):
        for factor, words in UNITS:
            by = np.ones(3)
            by[axis] = factor
            yield _displacement(
                by,
                f"d{name} looks as if it were in another unit than the other axes ({words})",
                f"Edit the unit in the header of d{name}.",
            )


def _displacement(by: np.ndarray, said: str, remedy: str) -> Correction:
    factor = np.log(np.abs(by))
    return Correction(
        said,
        remedy,
        lambda s: replace(
            s, displacement=s.displacement * by, stretch=s.stretch + float(factor @ s.axes)
        ),
    )


def _wrench(signs: np.ndarray, said: str, remedy: str) -> Correction:
    def mend(s: Sheet) -> Sheet:
        moments = signs if s.wrench[:, 3:].any() else np.ones(3)
        return replace(s, wrench=s.wrench * np.concatenate([signs, moments]))

    return Correction(said, remedy, mend)


def _base(sheet: Sheet, what: str) -> np.ndarray:
    """Forces or displacements of the rows in use, in base axes (M, 3)."""
    values = sheet.wrench[sheet.kept, :3] if what == "force" else np.nan_to_num(sheet.measured)
    frame = sheet.force_frame if what == "force" else sheet.displacement_frame
    if frame == "base":
        return values
    return np.asarray(np.einsum("nij,nj->ni", sheet.at().rotation, values))


TURN = 2.0 * np.pi
PARALLEL = 0.999  # cosine between the axes of joints that turn in one plane


def of_joints(sheet: Sheet) -> Iterator[Correction]:
    """Corrections of the joint columns that these values allow."""
    names = sheet.robot.actuated
    n = len(names)
    for k in range(n):
        yield sign_of(sheet, k)
    for i, j in combinations(range(n), 2):
        if sheet.robot.prismatic[i] == sheet.robot.prismatic[j]:
            yield _mapped(
                _entry(n, {(i, i): 0.0, (j, j): 0.0, (i, j): 1.0, (j, i): 1.0}),
                f"the columns {names[i]} and {names[j]} seem to be exchanged",
                f"Exchange the headers {names[i]} and {names[j]}.",
            )
    yield from _units_of_joints(sheet)
    yield from _to_the_floor(sheet)


def sign_of(sheet: Sheet, k: int) -> Correction:
    """Joint k counts the other way round."""
    name = sheet.robot.actuated[k]
    return _mapped(
        _entry(sheet.robot.n, {(k, k): -1.0}),
        f"{name} seems to have the wrong sign",
        f"Negate the column {name}.",
    )


def _units_of_joints(sheet: Sheet) -> Iterator[Correction]:
    """Degrees under a header that says rad, and the other way round; all joints, or one."""
    names = np.array(sheet.robot.actuated)
    turning = np.flatnonzero(~np.array(sheet.robot.prismatic))
    sizes = np.abs(sheet.joints[sheet.kept]).max(axis=0)
    groups = [turning] if len(turning) > 1 else []
    groups += [np.array([k]) for k in turning]
    turns = ~np.array(sheet.robot.prismatic)
    groups += [some for some, *_ in mixed(sheet.joints[sheet.kept], turns) if len(some) > 1]
    for group in groups:
        some = group[sizes[group] > 0.0]
        for written, meant, factor in (
            ("rad", "deg", np.pi / 180.0),
            ("deg", "rad", 180.0 / np.pi),
        ):
            # Degrees taken for radians go beyond a turn; radians taken for degrees hardly move.
            beyond = sizes[some].max(initial=0.0) > 0.5 * TURN
            if not len(some) or (factor < 1.0) != beyond or factor * sizes[some].max() > TURN:
                continue
            listed = ", ".join(names[group])
            headers = ", ".join(f"{name}[{written}] → {name}[{meant}]" for name in names[group])
            yield _mapped(
                _entry(len(names), {(int(k), int(k)): factor for k in group}),
                f"the values of {listed} look like {meant} labelled {written}",
                f"Edit the header{'s' if len(group) > 1 else ''} {headers}.",
            )


def _to_the_floor(sheet: Sheet) -> Iterator[Correction]:
    """A joint that is measured against the floor where the URDF wants the link before, or v.v."""
    for k, sign, own in floors(sheet):
        yield floor(sheet, k, sign, own)


def floors(sheet: Sheet) -> Iterator[tuple[int, float, float]]:
    """Joint k that turns in one plane with the one before it, the sign of that and of its own."""
    names = list(sheet.robot.actuated)
    chain = list(sheet.robot.mechanism().chain.names)
    turned = sheet.at().axes[0]
    axes = {name: turned[chain.index(name)] for name in names if name in chain}
    for k in range(1, len(names)):
        one, two = axes.get(names[k - 1]), axes.get(names[k])
        turns = not (sheet.robot.prismatic[k - 1] or sheet.robot.prismatic[k])
        if one is None or two is None or not turns or abs(one @ two) < PARALLEL:
            continue
        for sign in (1.0, -1.0):
            for own in (1.0, -1.0):
                yield k, sign, own


def floor(sheet: Sheet, k: int, sign: float, own: float) -> Correction:
    """The URDF's joint k is `own` times its column plus `sign` times the column before it."""
    names = sheet.robot.actuated
    made = f"{'-' if own < 0 else ''}{names[k]} {'+' if sign > 0 else '-'} {names[k - 1]}"
    return _mapped(
        _entry(len(names), {(k, k): own, (k, k - 1): sign}),
        f"{names[k]} seems to be measured against the floor, or not as in the URDF: many "
        f"controllers couple joint {k} and joint {k + 1}",
        f"The URDF's {names[k]} is {made} of this file: compute it for every row and write it into "
        f"the column {names[k]} instead.",
    )


def _entry(n: int, entries: dict[tuple[int, int], float]) -> Array:
    matrix = np.eye(n)
    for place, value in entries.items():
        matrix[place] = value
    return matrix


def _mapped(matrix: Array, said: str, remedy: str) -> Correction:
    """The joints are `matrix` times what the columns say."""
    return Correction(said, remedy, lambda s: replace(s, joints=s.joints @ matrix.T))


SHIFTS = (1, -1, 2, -2)  # rows
PARTS: tuple[tuple[str, dict[str, bool]], ...] = (
    ("the readings (dx, dy, dz)", {}),
    ("the loads (fx, fy, fz)", {"wrench": True}),
    ("the joints", {"joints": True}),
)


def of_rows(sheet: Sheet) -> Iterator[Correction]:
    """Corrections of the order of rows, for displacements, loads and joints apart."""
    count = len(sheet.joints)
    for name, which in PARTS:
        if not which and sheet.directions is not None:
            name = "the readings (d, ux, uy, uz)"
        for shift in SHIFTS:
            way, back = ("low", "up") if shift > 0 else ("high", "down")
            rows = f"{abs(shift)} row{'s' if abs(shift) > 1 else ''}"
            yield _moved(
                shifted(count, shift),
                which,
                f"{name} seem to stand {rows} too {way}",
                f"Move their columns {back} by {rows}.",
            )
        yield _moved(
            np.arange(count)[::-1],
            which,
            f"{name} seem to stand in reverse order",
            "Turn their columns upside down.",
        )


def shifted(count: int, shift: int) -> Index:
    """(count,) the row whose values belong into each row; -1: none."""
    rows = np.arange(count) + shift
    return np.where((rows >= 0) & (rows < count), rows, -1)


def _moved(rows: Index, which: dict[str, bool], said: str, remedy: str) -> Correction:
    return Correction(said, remedy, lambda s: s.moved(rows, **which))
