"""Levels that tell another gravity, another sign or other axes than their file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.errors import InputError
from sk120stiff.identify.positions.calibrate import calibrate
from sk120stiff.model import predict
from sk120stiff.model.predicted import prediction_table
from tests.positions.arm import Array, errors, poses, write

A = np.repeat(poses(30, 5), 2, axis=0)
WAYS = np.tile(np.eye(3), (20, 1))  # of the tool, along which the level lies
SETTINGS = "noise: {rotation: 20, rotation_unit: urad}\n"


def levelled(
    folder: Path,
    *,
    up: Array | None = None,
    sign: float = 1.0,
    ways: Array | None = None,
    a: Array | None = None,
    more: str = "",
    wild: int = 0,
) -> sk.Measurements:
    """Angles of an arm whose base has `up`, written with a sign and along the stated ways."""
    arm = errors(2)
    arm.up = np.array([0.0, 0.0, 1.0]) if up is None else up
    axes = arm.stands(A)[1]
    sine = np.einsum("i,nij,nj->n", arm.up, axes, WAYS)
    angle = np.degrees(np.arcsin(sine) + 2e-5 * np.random.default_rng(4).normal(size=len(A)))
    flat = np.abs(angle) < 80.0
    angle[np.flatnonzero(flat)[:wild]] += 40.0
    told = np.column_stack([sign * angle, WAYS if ways is None else ways])[flat]
    cells = [",".join(f"{v:.8g}" for v in row) for row in told]
    nothing = np.full((len(told), 3), np.nan)
    own = (A if a is None else a)[flat]
    path = write(folder, own, nothing, SETTINGS + more, more=",inc[deg],vx,vy,vz", cells=cells)
    return sk.read(path)


def robot_of(data: sk.Measurements) -> sk.Robot:
    return sk.load_robot(data.robot, base="base", tool="tool")


CEILING = np.array([0.0, 0.0, -1.0])
FLIPPED = A * np.array([1.0, 1.0, -1.0, 1.0, 1.0, 1.0])


@pytest.mark.parametrize(
    ("slip", "says"),
    [
        ({"up": CEILING}, r"as if it were \[0, 0, 9.81\].*'gravity: \[0, 0, 9.81\]'.*negate inc"),
        ({"sign": -1.0}, r"as if it were \[0, 0, 9.81\].*negate inc.*are one"),
        ({"up": np.array([-1.0, 0.0, 0.0])}, r"Gravity looks as if it were \[9.81, 0, 0\]"),
        ({"ways": WAYS[:, [1, 0, 2]]}, "vx, vy, vz look like vy, vx, vz.*Rename the headers"),
        ({"ways": WAYS[:, [1, 2, 0]]}, "vx, vy, vz look like vy, vz, vx.*Rename the headers"),
        ({"ways": WAYS * [1.0, -1.0, 1.0]}, "Vy looks negated.*Negate vy"),
        ({"a": FLIPPED}, "j3 looks as if it counted the other way.*Negate the column j3"),
        ({"a": np.degrees(A)}, "look like degrees, not radians"),
        ({"a": np.roll(A, 3, axis=0)}, "rms.*Check where gravity points to"),
    ],
)
@pytest.mark.parametrize("verb", [sk.fit, sk.explain])
def test_what_mends_them_is_told(tmp_path: Path, verb: object, slip: dict, says: str) -> None:
    data = levelled(tmp_path, **slip)
    model = sk.base_model(robot_of(data)) if verb is sk.fit else sk.Model(robot_of(data))
    with pytest.raises(sk.InputError, match=f"not those of this arm as it is stated.*{says}"):
        verb(model, data)  # type: ignore[operator]


@pytest.mark.parametrize(
    "right",
    [{}, {"up": CEILING, "more": "gravity: [0, 0, 9.80665]\n"}, {"wild": 3}],
)
def test_what_is_right_is_kept(tmp_path: Path, right: dict) -> None:
    """Stated ceilings, and single rows that are wild, are no slip."""
    data = levelled(tmp_path, **right)
    robot = robot_of(data)
    model = sk.base_model(robot)
    assert model is not None
    found = calibrate(model, data.with_joints(robot.actuated), geometry=False, waves=False)
    assert found.wild.sum() == right.get("wild", 0)


def test_a_prediction_tells_the_gap_of_levels(tmp_path: Path) -> None:
    data = levelled(tmp_path)
    model = sk.base_model(robot_of(data))
    assert model is not None
    found = sk.fit(model, data)
    columns = prediction_table(data, predict(found.model, data))
    gap = np.array(columns["gap_inc[urad]"], dtype=float)
    assert np.sqrt(np.mean(gap**2)) < 30.0  # 20 µrad of noise
    assert np.allclose(gap * 1e-6, found.problem.of_channels.undo(found.residual), atol=1e-9)


def test_a_level_near_the_plumb_line_is_left_out_and_told(tmp_path: Path) -> None:
    data = levelled(tmp_path)
    lines = data.path.read_text().splitlines()
    cells = lines[5].split(",")
    steep = [*cells[:-4], "-85.09", *cells[-3:]]
    data.path.write_text("\n".join([*lines[:5], ",".join(steep), *lines[6:]]))
    with pytest.warns(UserWarning, match=r"line 6.* an inclination of -85.09 deg left out"):
        read = sk.read(data.path)
    assert read.absolute is not None
    level = read.absolute.channels.inclination
    assert level is not None and np.flatnonzero(np.isnan(level)).tolist() == [4]
    every = [",".join([*line.split(",")[:-4], "86", *line.split(",")[-3:]]) for line in lines[1:]]
    data.path.write_text("\n".join([lines[0], *every]))
    with pytest.raises(InputError, match="an inclination of 86 deg"):
        sk.read(data.path)
