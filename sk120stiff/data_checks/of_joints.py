"""Slips in the joint columns: signs, exchanges, degrees for radians, angles to the floor."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.data_checks.correction import Correction
from sk120stiff.data_checks.sheet import Sheet

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
    yield from _units(sheet)
    yield from _to_the_floor(sheet)


def sign_of(sheet: Sheet, k: int) -> Correction:
    """Joint k counts the other way round."""
    name = sheet.robot.actuated[k]
    return _mapped(
        _entry(sheet.robot.n, {(k, k): -1.0}),
        f"{name} seems to have the wrong sign",
        f"Negate the column {name}.",
    )


def _units(sheet: Sheet) -> Iterator[Correction]:
    """Degrees under a header that says rad, and the other way round; all joints, or one."""
    names = np.array(sheet.robot.actuated)
    turning = np.flatnonzero(~np.array(sheet.robot.prismatic))
    sizes = np.abs(sheet.joints[sheet.kept]).max(axis=0)
    groups = [turning] if len(turning) > 1 else []
    groups += [np.array([k]) for k in turning]
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
