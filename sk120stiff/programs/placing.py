"""A machining program's path put in front of a robot: in base axes, with the tool's orientation."""

from __future__ import annotations

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError
from sk120stiff.measurements.table.table import table_of
from sk120stiff.programs.orientation import fixed_xyz
from sk120stiff.programs.toolpath import ToolPath
from sk120stiff.robot.rotations import homogeneous, rotation_from_rpy, rotation_of
from sk120stiff.units import from_si, parse_values
from sk120stiff.workspace import LoadedPath, parse_axes

TOOL_DOWN = "180,0,0 deg"  # the tool's z axis against the part's, their x axes alike
PLACES = ("x", "y", "z", "roll", "pitch", "yaw")
ANYWHERE = {name: (-np.inf, np.inf, "length" if name in "xyz" else "angle") for name in PLACES}


def part_frame(text: str) -> Array:
    """(4, 4) of text like ``x=1200 mm; z=-300 mm; yaw=90 deg``; roll, pitch, yaw as in a URDF.

    Raises:
        InputError: An unknown name, a range, or a missing unit.
    """
    values = dict.fromkeys(PLACES, 0.0)
    axes = parse_axes([text], ANYWHERE, where="--frame")
    for axis in axes:
        if len(axis.values) != 1 or [other.name for other in axes].count(axis.name) > 1:
            raise InputError(
                f"{axis.name} has several values",
                where="--frame",
                remedy="Say where the part lies: 'x=1200 mm; yaw=90 deg'.",
            )
        values[axis.name] = float(axis.values[0])
    *xyz, roll, pitch, yaw = (values[name] for name in PLACES)
    return homogeneous(xyz, rotation_from_rpy(np.array([roll, pitch, yaw])))


def place_text(T: Array) -> str:
    """The placement (4, 4) [m] as `part_frame` reads it, in mm and deg."""
    angles = fixed_xyz(T[None, :3, :3])[0]
    angles = np.where(angles < -179.99999, angles + 360.0, angles)
    said = [
        f"{name}={round(value, 6) + 0.0:.9g} {unit}"
        for values, unit in ((1e3 * T[:3, 3], "mm"), (angles, "deg"))
        for name, value in zip(PLACES[:3] if unit == "mm" else PLACES[3:], values, strict=True)
        if abs(value) >= 1e-6
    ]
    return "; ".join(said) or "x=0 mm"


def tool_rotation(text: str) -> Array | None:
    """(3, 3) of the tool in the part's axes from roll, pitch, yaw; None for the word ``free``."""
    if text.strip().lower() == "free":
        return None
    rpy = parse_values(text, "angle", where="--tool-rpy", like=TOOL_DOWN)
    return rotation_from_rpy(rpy)


def placed(path: ToolPath, part: Array, tool: Array | None, wrench: Array) -> LoadedPath:
    """The path in base axes.

    Where the file states the tool's axis, the tool is turned from `tool` to it by the shortest way.

    Args:
        part: (4, 4) part in the base.
        tool: (3, 3) tool in the part's axes; None: any orientation will do.
        wrench: (6,) load at every point [N, N·m].

    Raises:
        InputError: The axis is opposite to that of `tool`, so no way to it is the shortest.
    """
    position = path.position @ part[:3, :3].T + part[:3, 3]
    rotation = None
    if tool is not None:
        turned = np.broadcast_to(tool, (path.count, 3, 3))
        if path.axis is not None:
            turned = _turned(path, tool)
        rotation = part[:3, :3] @ turned
    header = ["point", "line", *(f"{name}[mm]" for name in "xyz")]
    columns: list[list[str]] = [
        [str(k + 1) for k in range(path.count)],
        [str(line) for line in path.lines],
        *([f"{x:.9g}" for x in 1e3 * axis] for axis in position.T),
    ]
    if rotation is not None:
        header += ["roll[deg]", "pitch[deg]", "yaw[deg]"]
        columns += [[f"{x:.9g}" for x in axis] for axis in fixed_xyz(rotation).T]
    header += ["feed[mm/min]", "rapid"]
    columns += [
        ["" if np.isnan(x) else f"{float(from_si(x, 'mm/min', 'm/s')):.9g}" for x in path.feed],
        [str(int(x)) for x in path.rapid],
    ]
    rows = [list(row) for row in zip(*columns, strict=True)]
    return LoadedPath(
        wrench=np.tile(wrench, (path.count, 1)),
        joints=None,
        position=position,
        rotation=rotation,
        table=table_of(path.source, header, 1, rows, [int(line) for line in path.lines]),
        feed=path.feed,
        rapid=path.rapid,
    )


def _turned(path: ToolPath, tool: Array) -> Array:
    """(N, 3, 3) `tool` turned so that its z axis points along −axis, from the shank to the tip."""
    assert path.axis is not None  # noqa: S101  (the caller has looked)
    z, goal = tool[:, 2], -path.axis
    across = np.cross(z, goal)
    sine = np.linalg.norm(across, axis=1)
    cosine = goal @ z
    opposite = (sine < 1e-6) & (cosine < 0.0)
    if opposite.any():
        raise InputError(
            "the tool's axis is opposite to that of --tool-rpy, so its turn about itself is open",
            where=f"{path.source}, line {path.lines[int(np.argmax(opposite))]}",
            remedy="Choose another --tool-rpy: the tool's roll, pitch, yaw where the path begins.",
        )
    vector = across * (np.arctan2(sine, cosine) / np.maximum(sine, 1e-300))[:, None]
    return np.asarray(rotation_of(vector) @ tool)
