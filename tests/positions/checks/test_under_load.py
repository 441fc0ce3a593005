"""Rows under load that no load can have brought there, beside rows without that are right."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.errors import InputError
from sk120stiff.measurements.importers import import_readings
from sk120stiff.measurements.placing.placing import Placing, place
from tests.positions.arm import NAMES, Array, errors, poses, tracked, write

A = np.repeat(poses(24, 6), 2, axis=0)
HUNG = np.tile([0.0, 30.0], 24)  # kg
SETTINGS = "position: {frame: unknown}\npoint: {xyz: [0, 0, 0], unit: mm, fit: true}\n"


def stands() -> Array:
    """Every pose without load and with it."""
    arms = (replace(errors(2), payload=mass) for mass in HUNG)
    x = np.array([arm.stands(q[None])[0][0] for arm, q in zip(arms, A, strict=True)])
    return tracked(x) + 2e-5 * np.random.default_rng(1).normal(size=x.shape)


def placed(folder: Path, x: Array) -> Placing | None:
    cells = [f"{mass:g}" for mass in HUNG]
    path = write(folder, A, x, SETTINGS, more=",payload[kg]", cells=cells)
    robot = sk.load_robot(path.with_name("six.urdf"), base="base", tool="tool")
    return place(robot, sk.read(path).with_joints(NAMES))


def test_rows_one_apart_from_one_on_are_told(tmp_path: Path) -> None:
    """The row without load of every pose has a position of that pose still."""
    x = stands()
    x[21:-1] = x[22:]
    with pytest.raises(InputError, match=r"From line 2\d on .* look 1 row apart"):
        placed(tmp_path, x)


def test_import_says_so_too(tmp_path: Path) -> None:
    """Not by the rows without load alone, which are right."""
    x = stands()
    path = write(tmp_path, A, x, SETTINGS, more=",payload[kg]", cells=[f"{m:g}" for m in HUNG])
    robot = sk.load_robot(path.with_name("six.urdf"), base="base", tool="tool")
    assert import_readings(path, robot).fitted is not None
    x[21:-1] = x[22:]
    write(tmp_path, A, x, SETTINGS, more=",payload[kg]", cells=[f"{m:g}" for m in HUNG])
    with pytest.raises(InputError, match=r"From line 2\d on .* look 1 row apart"):
        import_readings(path, robot)


def test_rows_are_counted_as_they_lie_in_the_file(tmp_path: Path) -> None:
    """Two rows apart, both of them of the next pose."""
    x = stands()
    x[20:-2] = x[22:]
    with pytest.raises(InputError, match=r"look 2 rows apart: with the position of line 2\d"):
        placed(tmp_path, x)


def test_loads_of_other_rows_are_told(tmp_path: Path) -> None:
    x = stands()
    x[1::2] = x[1::2][::-1]
    with pytest.raises(InputError, match="no load bends an arm by so much"):
        placed(tmp_path, x)


def test_right_rows_are_kept_and_one_wild_one_stops_nothing(tmp_path: Path) -> None:
    x = stands()
    assert placed(tmp_path, x) is not None
    x[7] += 1.5
    assert placed(tmp_path, x) is not None
