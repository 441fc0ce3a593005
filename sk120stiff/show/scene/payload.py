"""A scene as the JSON that the page is made from."""

from __future__ import annotations

import base64
import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sk120stiff.arrays import Array
from sk120stiff.errors import Refusal
from sk120stiff.show.scene.frame import Frame, Request, compute_frame
from sk120stiff.show.scene.mechanism import HELD, follows_pose_and_load, serialised
from sk120stiff.show.scene.scene import Reading, Scene, ScenePose
from sk120stiff.show.scene.shapes import Body, Mesh, bodies_of, reach_of
from sk120stiff.stiffness import CLASSES, POSITIONS, ROTATIONS, Principal, under_load

SAMPLES = 64  # poses from which the scale of the ellipsoids is taken
DEFAULT_LOAD = 1000.0  # N, upper end of the load sliders without data
EXAGGERATION = (1.0, 10000.0)
FORMULATIONS = ("conventional", "enhanced")


def scene_payload(scene: Scene, *, live: bool = False) -> dict[str, Any]:
    """Everything the page needs, in plain containers; matrices are (16,), column by column.

    Raises:
        InputError: A page without a server is wanted for a robot whose joints are coupled
            nonlinearly.
    """
    robot, elastic, tree = scene.robot, scene.elastic, scene.tree
    meshes: list[Mesh] = []
    bodies = [_body(body, meshes) for body in (*bodies_of(robot, tree), *scene.surroundings)]
    frame = scene.frame or robot.tool_frame
    return {
        "mode": "live" if live else "static",
        "title": scene.title or robot.name,
        "subtitle": scene.subtitle,
        "robot": robot.name,
        "base": robot.base_frame,
        "frame": frame,
        "elastic": {"label": _source(scene, live=live), "assumed": elastic.assumed},
        "joints": _joints(scene),
        "limits": limits_of(scene),
        "links": list(tree.names),
        "bodies": bodies,
        "marks": [[tree.names.index(link), text] for link, text in scene.marks.items()],
        "path": None if scene.path is None else scene.path.payload(),
        "meshes": [_mesh(mesh) for mesh in meshes],
        "kinematics": None if live else serialised(scene),
        "poses": [_pose(pose, scene.point) for pose in scene.poses],
        "models": list(scene.models),
        "positions": scene.positions,
        "listed": scene.listed,
        "start": {
            "a": _list(scene.first_pose),
            "wrench": _list(scene.first_load),
            "point": _list(np.asarray(scene.point, dtype=float)),
        },
        "scale": scale_of(scene),
        "command": {
            "robot": scene.robot_argument or robot.source,
            "model": scene.model_argument,
        },
    }


def _source(scene: Scene, *, live: bool) -> str:
    if live or follows_pose_and_load(scene.elastic.arm):
        return scene.elastic.label
    return f"{scene.elastic.label}; {HELD}"


def frame_payload(frame: Frame) -> dict[str, Any]:
    """A computed frame in the form in which the page's own engine returns it."""
    found = frame.found
    deflection = {
        "conventional": found.deflection_conventional,
        "enhanced": found.deflection_enhanced if found.stable else None,
        "equilibrium": found.deflection_equilibrium,
    }
    critical = float(found.of("critical"))
    stands = critical > 0.0  # else the arm is unstable before any load, and nothing has a share
    K_C_class = CLASSES[int(found.of("complementary_class"))].value
    return {
        "links": _matrices(frame.links, 9),
        "deflected": None if frame.deflected is None else _matrices(frame.deflected, 9),
        "position": _list(found.of("position")),
        "rotation": _list(found.of("rotation").T),
        "translation": {name: _axes(found.axes(name, POSITIONS)) for name in FORMULATIONS},
        "rotationAxes": {name: _axes(found.axes(name, ROTATIONS)) for name in FORMULATIONS},
        "deflection": {
            name: _list(value) for name, value in deflection.items() if value is not None
        },
        "classes": {
            "K_C": K_C_class if found.of("K_C").any() else "zero",
            "stiffness": CLASSES[int(found.of("stiffness_class"))].value,
        },
        "softening": 1.0 / critical if stands else None,
        "stiffening": float(found.of("stiffening")) if stands else None,
    }


def _axes(axes: Principal) -> dict[str, Any]:
    return {"values": _list(axes.values), "directions": [_list(row) for row in axes.directions]}


def _joints(scene: Scene) -> list[dict[str, Any]]:
    robot = scene.robot
    joints: list[dict[str, Any]] = []
    for name, lower, upper, slides in zip(
        robot.actuated, robot.lower, robot.upper, robot.prismatic, strict=True
    ):
        span = 1.0 if slides else math.pi
        joints.append(
            {
                "name": name,
                "slides": slides,
                "lower": float(lower) if math.isfinite(lower) else -span,
                "upper": float(upper) if math.isfinite(upper) else span,
            }
        )
    for a in (scene.first_pose, *(pose.a for pose in scene.poses)):  # measured beyond a limit
        for joint, value in zip(joints, a, strict=True):
            joint["lower"] = min(joint["lower"], float(value))
            joint["upper"] = max(joint["upper"], float(value))
    return joints


def limits_of(scene: Scene) -> dict[str, Any]:
    """Largest values that the controls offer and that the live server takes."""
    loads = [r.wrench for pose in scene.poses for r in pose.readings]
    largest = np.max(np.abs([scene.first_load, *loads]), axis=0)
    force, moment = float(largest[:3].max()), float(largest[3:].max())
    reach = reach_of(scene.robot, scene.frame)
    read = [r.point for pose in scene.poses for r in pose.readings if r.point is not None]
    return {
        "force": max(_round_up(1.2 * force), 100.0) if force else DEFAULT_LOAD,
        "moment": max(_round_up(1.2 * moment), 100.0) if moment else DEFAULT_LOAD,
        "point": max(0.25 * reach, 1.2 * float(np.max(np.abs([scene.point, *read])))),
        "exaggeration": list(EXAGGERATION),
    }


def scale_of(scene: Scene) -> dict[str, Any]:
    """Sizes that stay put while the sliders move, so that a change of stiffness can be seen."""
    robot = scene.robot
    reach = reach_of(robot, scene.frame)
    generator = np.random.default_rng(0)
    lower = np.where(np.isfinite(robot.lower), robot.lower, -1.0)
    upper = np.where(np.isfinite(robot.upper), robot.upper, 1.0)
    poses = [scene.first_pose, *(np.asarray(pose.a) for pose in scene.poses)]
    poses += list(generator.uniform(lower, upper, (SAMPLES, robot.n)))
    soft: dict[str, list[float]] = {"translation": [], "rotation": []}
    stiff: dict[str, list[float]] = {"translation": [], "rotation": []}
    arm = scene.elastic.at(scene.point)
    for a in poses:
        try:
            found = under_load(arm, a, np.zeros(6), ("compliance_conventional",))
        except Refusal:  # the arm falls under its own weight there
            continue
        for name, part in (("translation", POSITIONS), ("rotation", ROTATIONS)):
            values = np.sort(np.abs(found.axes("conventional", part).values))
            soft[name].append(float(values[-1]))
            stiff[name].append(float(values[1]))  # the middle one: no singularity carries it away
    references = {}
    for name in ("translation", "rotation"):
        compliance = float(np.median(soft[name] or [0.0])) or 1.0
        middle = [value for value in stiff[name] if value > 1e-9 * compliance]
        references[name] = {
            "compliance": compliance,
            "stiffness": 1.0 / float(np.median(middle)) if middle else 1.0 / compliance,
        }
    return {
        "reach": reach,
        "references": references,
        "exaggeration": _exaggeration(scene, reach),
        "gap": _gap_factor(scene, reach),
    }


def _exaggeration(scene: Scene, reach: float) -> float:
    """A round factor that makes the largest displacement about a tenth of the arm."""
    sizes = [
        float(np.linalg.norm(r.measured)) for p in scene.poses for r in p.readings
        if r.measured is not None
    ]  # fmt: skip
    if not sizes:
        request = Request(scene.first_pose, scene.first_load, np.asarray(scene.point))
        frame = compute_frame(scene.tree, scene.elastic, request)
        sizes = [float(np.linalg.norm(frame.found.of("deflection_conventional")))]
    largest = max(sizes)
    if largest < 1e-12:
        return 100.0
    return float(np.clip(_round_up(0.1 * reach / largest) / 2.0, *EXAGGERATION))


def _gap_factor(scene: Scene, reach: float) -> float:
    """A round factor that makes the largest gap about an eighth of the arm."""
    gaps = [
        float(np.linalg.norm(reading.measured - predicted))
        for pose in scene.poses
        for reading in pose.readings
        for predicted in reading.predicted.values()
        if reading.measured is not None
    ]
    largest = max(gaps, default=0.0)
    return _round_up(0.25 * reach / largest) / 2.0 if largest > 1e-12 else 1.0


def _round_up(value: float) -> float:
    """The next of 1, 2, 5, 10, 20, ..."""
    power = 10.0 ** math.floor(math.log10(value))
    return float(next(step * power for step in (1, 2, 5, 10) if step * power >= value * 0.999999))


def _pose(pose: ScenePose, point: Array) -> dict[str, Any]:
    return {
        "label": pose.label,
        "a": _list(np.asarray(pose.a, dtype=float)),
        "readings": [_reading(reading, k, point) for k, reading in enumerate(pose.readings)],
    }


def _reading(reading: Reading, k: int, point: Array) -> dict[str, Any]:
    return {
        "label": reading.label or f"reading {k + 1}",
        "said": reading.said,
        "wrench": _list(np.asarray(reading.wrench, dtype=float)),
        "point": _list(np.asarray(point if reading.point is None else reading.point, dtype=float)),
        "measured": None
        if reading.measured is None
        else _list(np.asarray(reading.measured, dtype=float)),
        "predicted": {
            name: _list(np.asarray(value, dtype=float)) for name, value in reading.predicted.items()
        },
    }


def _body(body: Body, meshes: list[Mesh]) -> dict[str, Any]:
    shown: dict[str, Any] = {
        "link": body.link,
        "matrix": _list(body.placement.T, digits=7),
        "kind": body.kind,
        "size": [float(value) for value in body.size],
        "colour": [round(float(value), 4) for value in body.colour],
        "still": body.still,
    }
    if body.mesh is not None:
        known = next((k for k, mesh in enumerate(meshes) if mesh is body.mesh), None)
        if known is None:
            known = len(meshes)
            meshes.append(body.mesh)
        shown["mesh"] = known
    return shown


def _mesh(mesh: Mesh) -> dict[str, Any]:
    wide = len(mesh.vertices) > np.iinfo(np.uint16).max
    return {
        "vertices": _binary(mesh.vertices.astype("<f4")),
        "faces": _binary(mesh.faces.astype("<u4" if wide else "<u2")),
        "wide": wide,
    }


def _binary(array: NDArray[Any]) -> str:
    return base64.b64encode(np.ascontiguousarray(array).tobytes()).decode("ascii")


def _matrices(many: Array, digits: int | None = None) -> list[list[float]]:
    return [_list(T.T, digits) for T in many]


def _list(array: Array, digits: int | None = None) -> list[float]:
    flat = np.asarray(array, dtype=float).ravel()
    return [float(v) for v in (flat if digits is None else np.round(flat, digits))]
