"""`cell.yaml`: what stands around an arm, what it carries, how it is loaded, and who looks on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import ConfigDict, Field

from sk120stiff import units
from sk120stiff.arrays import Array
from sk120stiff.errors import InputError
from sk120stiff.files import Strict, Vector, read_yaml, validated
from sk120stiff.plan.rig import Rig, unit
from sk120stiff.robot import Robot
from sk120stiff.robot.rotations import frame_about, homogeneous, rotation_from_rpy
from sk120stiff.robot.solids import Solid, mesh_solid

CLEARANCE = 0.01  # m
ANGLE_MARGIN, SLIDE_MARGIN = np.deg2rad(1.0), 0.002
EFFORT_SHARE = 0.9  # of a motor's effort that a push to be held may ask for

LIKE = {  # what can be written, by key
    "floor": "floor: -0.8 m",
    "region": "region: {low: [800, -1000, 0], high: [2200, 1000, 1500], unit: mm}",
    "low": "region: {low: [800, -1000, 0], high: [2200, 1000, 1500], unit: mm}",
    "high": "region: {low: [800, -1000, 0], high: [2200, 1000, 1500], unit: mm}",
    "clearance": "clearance: 20 mm",
    "joint_margin": "joint_margin: 2 deg",
    "slide_margin": "slide_margin: 5 mm",
    "effort_share": "effort_share: 0.9",
    "pedestal": "pedestal: 250 mm   (its radius; or none)",
    "obstacles": "obstacles: [{name: wall, box: [100, 3000, 2000], xyz: [1800, 0, 0], unit: mm}]",
    "tool": "tool: [{name: gripper, cylinder: [40, 150], xyz: [0, 0, 75], unit: mm}]",
    "box": "box: [100, 3000, 2000], unit: mm   (three edges; numbers alone)",
    "sphere": "sphere: 200, unit: mm   (radius)",
    "cylinder": "cylinder: [50, 1500], unit: mm   (radius, length)",
    "capsule": "capsule: [50, 1500], unit: mm   (radius, length)",
    "plane": "plane: [-1, 0, 0]   (the direction that points away from it)",
    "xyz": "xyz: [1800, 0, 1000], unit: mm",
    "rpy": "rpy: [0, 0, 90]   (roll, pitch, yaw in degrees)",
    "unit": "unit: mm   (or m)",
    "kind": "kind: cable   (any, weight, cable, jack)",
    "directions": "directions: [[0, 0, -1], [1, 0, 0]]",
    "axis": "axis: [0, 0, 1]",
    "anchors": "anchors: [[1.5, 0, 2.0]]",
    "tracker": "tracker: {xyz: [3, 0, 1], axis: [1, 0, 0], cone: 40 deg, range: '0.5, 20 m'}",
}


@dataclass(frozen=True, eq=False)
class Tracker:
    """Where the instrument stands and what it asks of the reflector.

    Attributes:
        place: (3,) base frame [m].
        axis: (3,) where the reflector looks, tool frame; None: everywhere.
        cone: Half opening of what it takes in [rad].
        nearest, farthest: Distances that can be measured [m].
    """

    place: Array
    axis: Array | None = None
    cone: float = np.pi
    nearest: float = 0.0
    farthest: float = np.inf


@dataclass(frozen=True, eq=False)
class Cell:
    """All that a pose and a load must keep to, beside what the URDF says; SI, base frame.

    Attributes:
        floor: Height below which nothing that moves may go [m]; -inf: none.
        low, high: (3,) corners of a box that the measured point must not leave, or None.
        clearance: Distance that solids keep [m].
        angle_margin, slide_margin: Distances that joints keep from their limits [rad], [m].
        effort_share: Share of a motor's effort that may be asked for.
        pedestal: Radius of what the base stands on [m]; 0: nothing; None: guessed.
        obstacles, tool: Solids around the arm, and on its tool frame; `tool` None: a rod to the
            measured point is guessed.
        rig: How forces are brought.
        tracker: The instrument, or None.
        source: The file, or what else told it.
        told: What of it followed from data, in sentences.
    """

    floor: float = -np.inf
    low: Array | None = None
    high: Array | None = None
    clearance: float = CLEARANCE
    angle_margin: float = ANGLE_MARGIN
    slide_margin: float = SLIDE_MARGIN
    effort_share: float = EFFORT_SHARE
    pedestal: float | None = None
    obstacles: tuple[Solid, ...] = ()
    tool: tuple[Solid, ...] | None = None
    rig: Rig = field(default_factory=Rig)
    tracker: Tracker | None = None
    source: str = ""
    told: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for name in ("low", "high"):
            corner = getattr(self, name)
            if corner is not None and np.shape(corner) != (3,):
                raise InputError(f"a corner of the box has the shape {np.shape(corner)}, not (3,)")
        if self.low is not None and self.high is not None and np.any(self.low >= self.high):
            raise InputError(
                "the box has no inside", remedy="Give the smaller corner first: x, y, z each."
            )


class _Entry(Strict):
    model_config = ConfigDict(coerce_numbers_to_str=True)


class _Placed(_Entry):
    name: str = ""
    xyz: Vector = (0.0, 0.0, 0.0)
    rpy: Vector = (0.0, 0.0, 0.0)
    box: Vector | None = None
    sphere: float | None = None
    cylinder: tuple[float, float] | None = None
    capsule: tuple[float, float] | None = None
    plane: Vector | None = None
    mesh: str | None = None
    scale: float = 1.0
    unit: Literal["m", "mm"] = "m"


class _Region(_Entry):
    low: Vector | None = None
    high: Vector | None = None
    unit: Literal["m", "mm"] = "m"


class _Rig(_Entry):
    kind: Literal["any", "weight", "cable", "jack"] = "any"
    directions: tuple[Vector, ...] = ()
    axis: Vector | None = None
    angle: str = "0 deg"
    anchors: tuple[Vector, ...] = ()
    unit: Literal["m", "mm"] = "m"
    steps: str | None = None


class _Tracker(_Entry):
    xyz: Vector
    unit: Literal["m", "mm"] = "m"
    axis: Vector | None = None
    cone: str = "180 deg"
    range: str | None = None


class CellFile(_Entry):
    """The keys of `cell.yaml`; every one has a default."""

    floor: str | None = None
    region: _Region = _Region()
    clearance: str = f"{1e3 * CLEARANCE:g} mm"
    joint_margin: str = f"{np.rad2deg(ANGLE_MARGIN):g} deg"
    slide_margin: str = f"{1e3 * SLIDE_MARGIN:g} mm"
    effort_share: Annotated[float, Field(gt=0.0, le=1.0)] = EFFORT_SHARE
    pedestal: str | None = None
    obstacles: tuple[_Placed, ...] = ()
    tool: tuple[_Placed, ...] | None = None
    rig: _Rig = _Rig()
    tracker: _Tracker | None = None


def read_cell(path: Path, robot: Robot) -> Cell:
    """Read and check a `cell.yaml`.

    Raises:
        InputError: Not YAML, an unknown key, a value without unit or of the wrong kind, a solid
            without a shape, a mesh that cannot be read; file and key are named.
    """
    said = validated(CellFile, read_yaml(path).content, str(path), LIKE)

    def number(key: str, text: str, kind: str) -> float:
        (value,) = _numbers(path, key, text, kind, LIKE[key].partition(": ")[2].partition("   ")[0])
        return value

    scale = 1e-3 if said.region.unit == "mm" else 1.0
    corners = [
        None if c is None else scale * np.array(c) for c in (said.region.low, said.region.high)
    ]
    bare = said.pedestal is not None and said.pedestal.strip() == "none"
    radius = None if said.pedestal is None or bare else number("pedestal", said.pedestal, "length")
    solids = _solids(path)
    return Cell(
        floor=-np.inf if said.floor in (None, "none") else number("floor", said.floor, "length"),
        low=corners[0],
        high=corners[1],
        clearance=number("clearance", said.clearance, "length"),
        angle_margin=number("joint_margin", said.joint_margin, "angle"),
        slide_margin=number("slide_margin", said.slide_margin, "length"),
        effort_share=said.effort_share,
        pedestal=0.0 if bare else radius,
        obstacles=tuple(solids("obstacles", robot.base_frame, each) for each in said.obstacles),
        tool=None
        if said.tool is None
        else tuple(solids("tool", robot.tool_frame, each) for each in said.tool),
        rig=_rig(path, said.rig, robot),
        tracker=None if said.tracker is None else _tracker(path, said.tracker),
        source=str(path),
    )


def _numbers(
    path: Path, key: str, text: str, kind: str, like: str | None = None
) -> tuple[float, ...]:
    where = f"{path}, key {key!r}"
    return tuple(float(x) for x in units.parse_values(text, kind, where=where, like=like))


def _solids(path: Path) -> Callable[[str, str, _Placed], Solid]:
    def solid(key: str, frame: str, entry: _Placed) -> Solid:
        where = f"{path}, key {key!r}"
        kinds = ("box", "sphere", "cylinder", "capsule", "plane", "mesh")
        stated = [kind for kind in kinds if getattr(entry, kind) is not None]
        if len(stated) != 1:
            raise InputError(
                f"the solid {entry.name!r} has {len(stated)} shapes", where=where,
                remedy=f"Give it one of: {', '.join(kinds)}.",
            )  # fmt: skip
        (kind,) = stated
        metre = 1e-3 if entry.unit == "mm" else 1.0
        turn = rotation_from_rpy(np.deg2rad(np.array(entry.rpy)))
        T = homogeneous(metre * np.array(entry.xyz), turn)
        name = entry.name or kind
        if entry.mesh is not None:
            found = mesh_solid(name, frame, T, path.parent / entry.mesh, metre * entry.scale)
            if isinstance(found, str):
                raise InputError(f"the mesh {entry.mesh!r}: {found}", where=where)
            return found
        if entry.plane is not None:
            z = unit([entry.plane])[0]
            if key == "tool" or not z.any():
                raise InputError(
                    f"the plane {name!r} has no direction, or hangs on the tool", where=where,
                    remedy="Give the direction that points away from it: plane: [0, 1, 0].",
                )  # fmt: skip
            T[:3, :3] = frame_about(z)
            return Solid(name, frame, T, "plane")
        size = metre * np.atleast_1d(np.array(getattr(entry, kind), dtype=float))
        if not (size > 0.0).all():
            raise InputError(f"the solid {name!r} has a size that is not positive", where=where)
        return Solid(name, frame, T, kind, tuple(size.tolist()))

    return solid


def _rig(path: Path, said: _Rig, robot: Robot) -> Rig:
    steps: tuple[float, ...] = ()
    if said.steps is not None:
        steps = tuple(sorted(_numbers(path, "rig.steps", said.steps, "force")))
        if steps[0] <= 0.0:
            raise InputError("steps of a load are positive", where=f"{path}, key 'rig.steps'")
    down = unit([robot.gravity_in_base])[0]
    if said.kind in ("weight", "jack"):
        if said.directions or said.axis or said.anchors:
            raise InputError(
                f"a {said.kind} knows one direction alone", where=f"{path}, key 'rig'",
                remedy="Leave directions, axis and anchors out, or say kind: any.",
            )  # fmt: skip
        words = "a weight that hangs" if said.kind == "weight" else "a jack that pushes up"
        return Rig(words, np.array([down if said.kind == "weight" else -down]), steps=steps)
    stated = [bool(said.directions), said.axis is not None, bool(said.anchors)]
    if sum(stated) > 1 or (said.kind == "cable" and not any(stated)):
        raise InputError(
            "a rig has one of directions, axis with angle, anchors", where=f"{path}, key 'rig'",
            remedy="Write e.g. anchors: [[1.5, 0, 2.0]] for a cable over a pulley.",
        )  # fmt: skip
    words = "a cable" if said.kind == "cable" else "a rig"
    if said.directions:
        return Rig(f"{words} in stated directions", np.array(said.directions), steps=steps)
    if said.axis is not None:
        (angle,) = _numbers(path, "rig.angle", said.angle, "angle", "30 deg")
        axis = unit([said.axis])[0]
        return Rig(f"{words} within a cone", axis=axis, angle=angle, steps=steps)
    if said.anchors:
        metre = 1e-3 if said.unit == "mm" else 1.0
        return Rig(
            "a cable towards its anchor", anchors=metre * np.array(said.anchors), steps=steps
        )
    return Rig(steps=steps)


def _tracker(path: Path, said: _Tracker) -> Tracker:
    metre = 1e-3 if said.unit == "mm" else 1.0
    nearest, farthest = 0.0, np.inf
    if said.range is not None:
        ends = _numbers(path, "tracker.range", said.range, "length", "0.5, 20 m")
        if not 0.0 <= ends[0] < ends[1]:
            raise InputError(
                "a range has two ends, the nearer one first",
                where=f"{path}, key 'tracker.range'",
                remedy="Write e.g. '0.5, 20 m'.",
            )
        nearest, farthest = ends
    (cone,) = _numbers(path, "tracker.cone", said.cone, "angle", "30 deg")
    axis = None if said.axis is None else unit([said.axis])[0]
    return Tracker(metre * np.array(said.xyz), axis, cone, nearest, farthest)
