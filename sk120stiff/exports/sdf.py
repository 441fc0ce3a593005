"""SDF 1.11: links and joints with springs and mimic rules, the user's shapes, position controllers.

SDF knows no servo: each motor gets Gazebo's plugin for one, and its inertia stands in a link of its
own. It has no word for springs between joints, nor for gravity of a model's own.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from itertools import combinations_with_replacement

import numpy as np
from lxml import etree
from lxml.etree import _Element as Element

from sk120stiff.arrays import Array
from sk120stiff.effects import LinearElastic, load_case
from sk120stiff.exports.building import moving_arm, told_of
from sk120stiff.exports.contract import Exported, Format, Request, Told, put, xml_text
from sk120stiff.exports.meshes import mesh_files
from sk120stiff.exports.mjcf import TINY, TINY_INERTIA, details_of, header_of, notes_of, rows_of
from sk120stiff.exports.moving import Body, Joint, MovingArm
from sk120stiff.model import Model
from sk120stiff.robot.rotations import rpy_from_rotation
from sk120stiff.robot.urdf.clean import numbers
from sk120stiff.robot.visuals import Visual, visuals

UNLIMITED = 1e16  # SDF's word for no limit
_PLUGIN = {
    "filename": "gz-sim-joint-position-controller-system",
    "name": "gz::sim::systems::JointPositionController",
}

NOTHING_ELSE = "ties joints together: SDF has no such spring"
ITS_TIES = "ties its joints together: SDF has no such spring, those of each joint alone are there"


def make(model: Model, request: Request) -> Exported:
    """See `Format.make`."""
    arm = _distinct(moving_arm(model, request, ties=False))
    carried, left_out = told_of(model)
    ties = _ties(model)
    carried = tuple(told for told in carried if ties.get(told.effect) is not NOTHING_ELSE)
    lost = [Told(effect, what) for effect, what in ties.items()]
    folder = f"{request.out.stem}.meshes"
    files, paths = mesh_files([shape for _, _, shape in arm.shapes], folder)
    notes = [finding.message for finding in visuals(model.robot).findings]
    down = arm.gravity / max(float(np.linalg.norm(arm.gravity)), 1e-300)
    if arm.heavy and down @ np.array([0.0, 0.0, -1.0]) < 1.0 - 1e-9:
        notes.append(
            f"Gravity is the world's in SDF. Of this arm it points along {numbers(down.round(6))} "
            "in axes of the base: set it in the world."
        )
    text = xml_text(_document(arm, [*left_out, *lost], paths), declared=True)
    return Exported(
        text, carried, (*left_out, *lost), (*notes, *notes_of(arm)), details_of(arm), files=files,
        title="Joints that yield", header=("joint", "stiffness", "", "servo"), rows=rows_of(arm),
    )  # fmt: skip


FORMAT = Format("sdf", "SDF", (".sdf",), make, moves=True)


def _distinct(arm: MovingArm) -> MovingArm:
    """The same with no joint named like a link or a frame: SDF has one name for one thing."""
    taken = {name for name, *_ in (*arm.frames, *arm.sites)} | {body.name for body in arm.bodies}
    new = {j.name: f"{j.name}.joint" if j.name in taken else j.name for j in arm.joints}

    def named(body: Body) -> Body:
        joint = body.joint
        if joint is None:
            return body
        leader = joint.leader and (new[joint.leader[0]], *joint.leader[1:])
        return replace(body, joint=replace(joint, name=new[joint.name], leader=leader))

    actuated = tuple(new[name] for name in arm.actuated)
    return replace(arm, actuated=actuated, bodies=tuple(named(body) for body in arm.bodies))


def _ties(model: Model) -> dict[str, str]:
    """Effects by which the torque of one coordinate moves another, and what is lost of each."""
    load_cases = load_case(model.robot, model.robot.rest, np.zeros(6))
    found = {}
    for effect, part in zip(model.effects, model.assembly.slices, strict=True):
        if isinstance(effect, LinearElastic) and model.values[part].any():
            C = np.tensordot(model.values[part], effect.patterns(load_cases), axes=1)
            own = np.eye(C.shape[-1])
            if (C * (1.0 - own)).any():
                found[effect.id] = ITS_TIES if (C * own).any() else NOTHING_ELSE
    return found


def _document(arm: MovingArm, left_out: Iterable[Told], paths: list[tuple[str, ...]]) -> Element:
    root = etree.Element("sdf", version="1.11")
    root.append(etree.Comment(f" {header_of(arm, left_out)} "))
    model = put(root, "model", name=arm.name)
    names = [_name(body.name) for body in arm.bodies]
    for k, body in enumerate(arm.bodies):
        link = _link(model, body, names, heavy=arm.heavy)
        for n, ((at, T, shape), own) in enumerate(zip(arm.shapes, paths, strict=True)):
            if at == k:
                _visual(link, f"visual_{n}", shape, T, own)
    ground = put(model, "joint", name=f"{names[0]}.ground", type="fixed")
    put(ground, "parent", "world")
    put(ground, "child", names[0])
    for k, body in enumerate(arm.bodies):
        if body.joint is not None:
            _joint(model, body.joint, names[body.parent], names[k])
    taken = set(names)
    for name, at, T in (*arm.frames, *arm.sites):
        if name not in taken and name != "world":
            taken.add(name)
            frame = put(model, "frame", name=name, attached_to=names[at])
            put(frame, "pose", _pose(T))
    for joint in arm.motors:
        plugin = put(model, "plugin", **_PLUGIN)
        put(plugin, "joint_name", joint.name)
        for key, value in {
            "p_gain": joint.servo, "i_gain": 0, "d_gain": joint.damping,
            "initial_position": joint.value,
        }.items():  # fmt: skip
            put(plugin, key, repr(value))
    return root


def _name(name: str) -> str:
    return "world_link" if name == "world" else name  # SDF's own word for the ground


def _link(model: Element, body: Body, names: list[str], *, heavy: bool) -> Element:
    own = body.mass > 0.0
    mass, inertia = (body.mass, body.inertia) if own else (TINY, np.zeros((3, 3)))
    turning = body.joint.armature if body.joint is not None and body.joint.servo else 0.0
    inertia = inertia + max(turning, TINY_INERTIA) * np.eye(3)
    link = put(model, "link", name=_name(body.name))
    if body.joint is not None:
        put(link, "pose", _pose(body.placement), relative_to=names[body.parent])
    if not (own and heavy):
        put(link, "gravity", "false")
    inertial = put(link, "inertial")
    put(inertial, "pose", f"{numbers(body.centre)} 0 0 0")
    put(inertial, "mass", repr(mass))
    moments = put(inertial, "inertia")
    for i, j in combinations_with_replacement(range(3), 2):
        put(moments, f"i{'xyz'[i]}{'xyz'[j]}", repr(float(inertia[i, j])))
    return link


def _joint(model: Element, joint: Joint, parent: str, child: str) -> None:
    low, high = np.clip(joint.limits, -UNLIMITED, UNLIMITED).tolist()
    node = put(model, "joint", name=joint.name, type="prismatic" if joint.slides else "revolute")
    put(node, "parent", parent)
    put(node, "child", child)
    axis = put(node, "axis")
    put(axis, "xyz", numbers(joint.axis))
    limit = put(axis, "limit")
    put(limit, "lower", repr(low))
    put(limit, "upper", repr(high))
    if joint.leader is not None:
        leader, factor, offset = joint.leader
        mimic = put(axis, "mimic", joint=leader)
        put(mimic, "multiplier", repr(factor))
        put(mimic, "offset", repr(offset))
        put(mimic, "reference", "0")
    elif joint.stiffness:
        dynamics = put(axis, "dynamics")
        put(dynamics, "spring_stiffness", repr(joint.stiffness))
        put(dynamics, "spring_reference", "0")
        put(dynamics, "damping", repr(joint.damping))


def _visual(link: Element, name: str, shape: Visual, T: Array, paths: tuple[str, ...]) -> None:
    sizes = [repr(float(x)) for x in shape.size]
    inner = [dict(zip(("radius", "length"), sizes, strict=False))]
    if shape.kind == "mesh":
        inner = [{"uri": path} for path in paths]
    elif shape.kind == "box":
        inner = [{"size": " ".join(sizes)}]
    for k, keys in enumerate(inner):
        visual = put(link, "visual", name=f"{name}_{k}")
        put(visual, "pose", _pose(T))
        geometry = put(put(visual, "geometry"), shape.kind)
        for key, text in keys.items():
            put(geometry, key, text)
        if shape.rgba is not None:
            material = put(visual, "material")
            for key in ("ambient", "diffuse"):
                put(material, key, numbers(np.array(shape.rgba)))


def _pose(T: Array) -> str:
    """x y z roll pitch yaw."""
    return numbers(np.array([*T[:3, 3], *rpy_from_rotation(T[:3, :3])]))
