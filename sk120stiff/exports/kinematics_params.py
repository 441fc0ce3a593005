"""`kinematics_params.yaml` as the ROS driver and description of Universal Robots take it.

Six transforms lead from `base_link_inertia`, the controller's own base (ROS's base_link turned by π
about z), through the frames of the six joints, each with its joint's axis along z:

    shoulder (0, 0, d1)   upper_arm turned by π/2 about x   forearm (a2, 0, 0)
    wrist_1 (a3, 0, d4)   wrist_2 (0, -d5, 0) turned by π/2 about x
    wrist_3 (0, d6, 0) turned by -π/2 about x

A robot described by other frames is seen from these: the nominal arm must have this structure, and
the frames are laid on its own axes, so that nothing is rounded off.
"""

from __future__ import annotations

import hashlib
from itertools import accumulate

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError
from sk120stiff.exports.contract import Exported, Format, Request, Told
from sk120stiff.exports.geometry import Geometry, geometry_of, weighing
from sk120stiff.model import Model
from sk120stiff.robot import Chain, Robot
from sk120stiff.robot.rotations import rotation_from_rpy, rpy_from_rotation

NAMES = ("shoulder", "upper_arm", "forearm", "wrist_1", "wrist_2", "wrist_3")
_NEAR = 1e-3  # rad or m by which a nominal URDF may miss the structure: they round π/2 at times
_IN_TOOL = 1e-9  # rad or m that an error of the tool frame must have to be told


def make(model: Model, request: Request) -> Exported:  # noqa: ARG001
    """See `Format.make`."""
    robot, geometry = model.robot, geometry_of(model)
    frames = _frames(robot)  # (7, 4, 4) nominal, base axes; the first is base_link_inertia
    chain = robot.mechanism().chain
    nominal = list(accumulate(chain.placements[:-1], np.matmul))
    into = [np.linalg.inv(own) @ frame for own, frame in zip(nominal, frames[1:], strict=True)]
    before = [frames[0], *into]
    steps = [np.linalg.inv(before[k]) @ geometry.placements[k] @ into[k] for k in range(len(NAMES))]
    left_out = (*geometry.left_out, *_left_out(model, geometry))
    lines = [f"# {robot.name}, calibrated, written by sk120stiff; lengths in m, angles in rad"]
    lines += [f"# left out: {one.effect}: {one.how}" for one in left_out]
    lines.append("kinematics:")
    values = []
    for name, T in zip(NAMES, steps, strict=True):
        row = [*T[:3, 3], *rpy_from_rotation(T[:3, :3])]
        values.append(row)
        lines.append(f"  {name}:")
        lines += [
            f"    {key}: {float(value) + 0.0!r}"
            for key, value in zip(("x", "y", "z", "roll", "pitch", "yaw"), row, strict=True)
        ]
    digest = hashlib.sha256("\n".join(lines).encode()).hexdigest()[:16]
    lines.append(f"  hash: sk120stiff_{digest}")
    return Exported(
        "\n".join(lines) + "\n",
        geometry.carried if not geometry.measured.any() else _without_marker(geometry),
        left_out,
        notes=(
            "The hash is this file's own: the driver will say that it is not the controller's. "
            "Put the controller's hash there to silence it.",
        ),
        details={"kinematics": dict(zip(NAMES, values, strict=True))},
        title="Transforms between the joints",
        header=("", "x [mm]", "y [mm]", "z [mm]", "roll [deg]", "pitch [deg]", "yaw [deg]"),
        rows=[
            (name, *(1e3 * x for x in row[:3]), *np.degrees(row[3:]))
            for name, row in zip(NAMES, values, strict=True)
        ],
    )


FORMAT = Format("kinematics_params", "kinematics of UR's driver", (".yaml", ".yml"), make)


def _without_marker(geometry: Geometry) -> tuple[Told, ...]:
    return tuple(told for told in geometry.carried if not told.how.startswith("frame "))


def _left_out(model: Model, geometry: Geometry) -> list[Told]:
    """What stands behind the last joint, and what yields."""
    told = [
        Told(one.effect, "a place on the tool: the file ends at wrist_3")
        for one in geometry.carried
        if one.how.startswith("frame ")
    ]
    if np.abs(geometry.tool - np.eye(4)).max() > _IN_TOOL:
        told.append(Told("tool frame", "its error lies behind wrist_3, where the file ends"))
    told += weighing(model, "the file holds no masses")
    return told + yielding(model, "the file holds no springs")


def yielding(model: Model, how: str) -> list[Told]:
    """Every effect that yields under load, for a format that holds none of them."""
    soft = dict.fromkeys(
        p.effect.id for p in model.physical().parameters
        if p.internal != 0.0 and hasattr(p.effect, "elongation")
    )  # fmt: skip
    return [Told(name, how) for name in soft]


def _frames(robot: Robot) -> list[Array]:
    """(7, 4, 4) the driver's frames on the axes of the nominal arm at zero, base axes.

    Raises:
        InputError: It is no arm of this structure; what is missing is said.
    """
    chain = robot.mechanism().chain
    plain = chain.names == robot.actuated and len(chain.names) == 6 and chain.revolute.all()
    if not plain:
        _refuse(robot, "it has no six turning joints in one row, each with a motor of its own")
    own = list(accumulate(chain.placements[:-1], np.matmul))
    z = [T[:3, :3] @ axis for T, axis in zip(own, chain.axes, strict=True)]
    origin = [T[:3, 3] for T in own]
    y = -z[1]
    x = np.cross(y, z[0])
    base = np.column_stack([x, y, z[0]])
    if np.abs(base.T @ base - np.eye(3)).max() > _NEAR:
        _refuse(robot, "its second axis is not square to its first")
    u, _, v = np.linalg.svd(base)  # the rotation nearest to it
    base = u @ v
    lean = base @ rotation_from_rpy(np.array([0.5 * np.pi, 0.0, 0.0]))
    last = lean @ rotation_from_rpy(np.array([0.5 * np.pi, 0.0, 0.0]))
    turns = [base, lean, lean, lean, last, lean]
    for k, (name, turn) in enumerate(zip(chain.names, turns, strict=True)):
        if np.abs(turn[:, 2] - z[k]).max() > _NEAR:
            _refuse(robot, f"the axis of {name} points elsewhere, or its zero or sign differs")
    return _laid(robot, chain, turns, z, origin)


def _laid(
    robot: Robot, chain: Chain, turns: list[Array], z: list[Array], origin: list[Array]
) -> list[Array]:
    """Frames at the places of the structure, each with its origin and z on the true axis."""
    x, y, up = turns[1][:, 0], turns[0][:, 1], turns[0][:, 2]
    shoulder = origin[0] + up * (up @ (origin[1] - origin[0]))
    elbow = shoulder + x * (x @ (origin[2] - shoulder)) + up * (up @ (origin[2] - shoulder))
    wrist = shoulder + _across(origin[3] - shoulder, y) + y * (y @ (origin[4] - shoulder))
    second = wrist + up * (up @ (origin[5] - wrist))
    third = second + y * (y @ (_flange(robot) - second))
    places = [shoulder, shoulder, elbow, wrist, second, third]
    if abs(up @ (elbow - shoulder)) > _NEAR or abs(up @ (wrist - shoulder)) > _NEAR:
        _refuse(robot, "its arm is not stretched level at zero")
    frames = [np.eye(4)]
    yaw = np.arctan2(turns[0][1, 0], turns[0][0, 0])  # π from ROS's base_link, 0 from UR's base
    frames[0][:3, :3] = rotation_from_rpy(np.array([0.0, 0.0, yaw]))
    for k, place in enumerate(places):
        off = place - origin[k]
        beside = off - z[k] * (z[k] @ off)
        if np.linalg.norm(beside) > _NEAR:
            _refuse(robot, f"{chain.names[k]} does not turn about the line that it should")
        T = np.eye(4)
        T[:3, 3] = place - beside
        side = turns[k][:, 0] - z[k] * (z[k] @ turns[k][:, 0])
        side = side / np.linalg.norm(side)
        T[:3, :3] = np.column_stack([side, np.cross(z[k], side), z[k]])
        frames.append(T)
    return frames


def _flange(robot: Robot) -> Array:
    """(3,) where the driver's wrist_3 ends: the frame tool0 or flange, else the tool frame."""
    last = robot.tree.body(robot.tool_frame)[0]
    names = [f for end in ("tool0", "flange") for f in robot.frames if f.endswith(end)]
    on_it = [name for name in names if robot.tree.body(name)[0] == last]
    return robot.placement(np.zeros(6), on_it[0] if on_it else None)[:3, 3]


def _across(vector: Array, axis: Array) -> Array:
    return vector - axis * (axis @ vector)


def _refuse(robot: Robot, why: str) -> None:
    raise InputError(
        f"this is no arm of Universal Robots' structure: {why}",
        where=robot.name,
        remedy="Export a URDF or a DH table instead.",
    )
