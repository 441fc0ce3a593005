"""MJCF: the arm for MuJoCo, with position actuators, springs behind them, and the user's shapes.

The world's axes are those of the base frame. A command is one number for each actuated joint, in
their order, in ``data.ctrl``; the keyframe ``commanded`` stands at the pose. A load acts at the
site that bears the name of the frame (``mj_applyFT``, each step).
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from lxml import etree
from lxml.etree import _Element as Element

from sk120stiff.arrays import Array
from sk120stiff.exports.building import moving_arm, told_of
from sk120stiff.exports.contract import Exported, Format, Request, Told, put, xml_text
from sk120stiff.exports.meshes import mesh_files
from sk120stiff.exports.moving import Body, Joint, MovingArm
from sk120stiff.model import Model
from sk120stiff.robot.rotations import homogeneous
from sk120stiff.robot.urdf.clean import numbers
from sk120stiff.robot.visuals import Visual, visuals

STEP = 1e-3  # s
TINY, TINY_INERTIA = 1e-3, 1e-6  # kg, kg·m²: MuJoCo wants something in every body that moves
TIED = 100.0  # kg·m² or kg: the heavier a follower and its leader, the less a soft constraint gives
_FORM = {"solref": "0.002 1", "solimp": "0.9999 0.9999 1"}


def make(model: Model, request: Request) -> Exported:
    """See `Format.make`."""
    arm = moving_arm(model, request)
    carried, left_out = told_of(model)
    folder = f"{request.out.stem}.meshes"
    files, paths = mesh_files([shape for _, _, shape in arm.shapes], folder)
    text = xml_text(_document(arm, left_out, sorted(files), paths))
    missing = tuple(finding.message for finding in visuals(model.robot).findings)
    return Exported(
        text, carried, left_out, (*missing, *notes_of(arm)), details_of(arm), files=files,
        title="Joints that yield", header=("joint", "stiffness", "", "servo"), rows=rows_of(arm),
    )  # fmt: skip


FORMAT = Format("mjcf", "MuJoCo MJCF", (".xml", ".mjcf"), make, moves=True)


def notes_of(arm: MovingArm) -> tuple[str, ...]:
    """What the reader of a moving model should know."""
    notes = [
        "Servos and springs are in series; how they share a joint's compliance is a choice, their "
        "sum is the model's. Armature and damping only bring the arm to rest.",
        "Masses are the model's; a branch beside the arm weighs where it is at zero."
        if arm.heavy
        else "The robot states no masses: those here are placeholders, and gravity is off.",
    ]
    if arm.held:
        notes.append(f"Built in, because nothing moves them: {', '.join(arm.held)}.")
    return tuple(notes)


def details_of(arm: MovingArm) -> dict[str, object]:
    """The JSON of a moving model."""
    return {
        "frame": arm.sites[0][0],
        "springs": [
            {"joint": joint.name.removesuffix(".spring"), "stiffness": 1.0 / total,
             "unit": "N/m" if joint.slides else "N*m/rad"}
            for joint, total in compliances(arm)
        ],
        "servos": {joint.name: joint.servo for joint in arm.motors},
        "coupled": [{"weights": one.weights, "stiffness": one.stiffness} for one in arm.springs],
        "followers": [
            {"joint": j.name, "driver": j.leader[0], "factor": j.leader[1], "offset": j.leader[2]}
            for j in arm.joints if j.leader
        ],
        "held": arm.held,
    }  # fmt: skip


def rows_of(arm: MovingArm) -> list[tuple[object, ...]]:
    """Springs for people: of the joint as a whole, and the servo's."""
    servos = {f"{joint.name}.spring": joint.servo for joint in arm.motors}
    return [
        (joint.name.removesuffix(".spring"), 1.0 / total, "N/m" if joint.slides else "N*m/rad",
         servos.get(joint.name, ""))
        for joint, total in compliances(arm)
    ]  # fmt: skip


def compliances(arm: MovingArm) -> list[tuple[Joint, float]]:
    """Joints with a spring of their own, and the compliance of spring and servo together."""
    servos = {f"{joint.name}.spring": joint.servo for joint in arm.motors}
    return [
        (joint, 1.0 / joint.stiffness + (1.0 / servos[joint.name] if joint.name in servos else 0.0))
        for joint in arm.joints
        if joint.stiffness
    ]


def header_of(arm: MovingArm, left_out: Iterable[Told]) -> str:
    """What the file says of itself, without the two hyphens that end a comment."""
    lost = "; ".join(f"{told.effect}: {told.how}" for told in left_out) or "nothing"
    text = (
        f"{arm.name}, elastic, written by sk120stiff. SI units, axes of the base frame. "
        f"{' '.join(notes_of(arm))} Left out: {lost}."
    )
    return text.replace("--", "- -").rstrip("-")


def _document(
    arm: MovingArm, left_out: Iterable[Told], files: list[str], paths: list[tuple[str, ...]]
) -> Element:
    mesh = {name: f"mesh_{k}" for k, name in enumerate(files)}
    root = etree.Element("mujoco", model=arm.name)
    root.append(etree.Comment(f" {header_of(arm, left_out)} "))
    put(
        root, "compiler", angle="radian", autolimits="false", inertiafromgeom="false",
        balanceinertia="true",
    )  # fmt: skip
    option = put(
        root, "option", gravity=numbers(arm.gravity), timestep=STEP, integrator="implicitfast",
        jacobian="dense", iterations=200, tolerance="1e-14",
    )  # fmt: skip
    put(option, "flag", contact="disable")
    if mesh:
        asset = put(root, "asset")
        for name, short in mesh.items():
            put(asset, "mesh", name=short, file=name, inertia="shell")
    world = put(root, "worldbody")
    _bodies(arm, world, [[mesh[path] for path in own] for own in paths])
    _ties(arm, root)
    _actuators(arm, root)
    values = {joint.name: joint.value for joint in arm.joints}
    qpos = [values[joint.get("name", "")] for joint in world.iter("joint")]
    ctrl = [joint.value for joint in arm.motors]
    keys = {"qpos": numbers(np.array(qpos)), "ctrl": numbers(np.array(ctrl))}
    put(put(root, "keyframe"), "key", name="commanded", **keys)
    return root


def _bodies(arm: MovingArm, world: Element, meshes: list[list[str]]) -> None:
    """Every body in its carrier, with its joint, its shapes, and the frames that lie on it."""
    leaders = {joint.leader[0] for joint in arm.joints if joint.leader}
    nodes: list[Element] = []
    for k, body in enumerate(arm.bodies):
        node = nodes[body.parent] if k else world
        if body.name != "world":  # MuJoCo has a body of that name
            node = put(node, "body", name=body.name, **_place(body.placement))
            if body.mass <= 0.0 and body.joint is not None:
                node.set("gravcomp", "1")  # what only MuJoCo asks to weigh something weighs nothing
        nodes.append(node)
        if body.joint is not None:
            put(node, "inertial", **_inertial(body))
            put(node, "joint", **_joint(body.joint, leads=body.joint.name in leaders))
        for (at, T, shape), named in zip(arm.shapes, meshes, strict=True):
            if at == k:
                _geoms(node, shape, T, named)
        for name, at, T in arm.frames:
            if at == k and name != "world":
                put(node, "body", name=name, **_place(T))
        for name, at, T in arm.sites:
            if at == k:
                put(node, "site", name=name, **_place(T))


def _inertial(body: Body) -> dict[str, object]:
    if body.mass <= 0.0:
        return {"pos": "0 0 0", "mass": TINY, "diaginertia": numbers(np.full(3, TINY_INERTIA))}
    values, axes = np.linalg.eigh(body.inertia)
    values = np.maximum(values, TINY_INERTIA)  # real files state tensors that no body has
    T = homogeneous(body.centre, axes * np.sign(np.linalg.det(axes)))
    return {**_place(T), "mass": body.mass, "diaginertia": numbers(values)}


def _joint(joint: Joint, *, leads: bool) -> dict[str, object]:
    return {
        "name": joint.name,
        "type": "slide" if joint.slides else "hinge",
        "axis": numbers(joint.axis),
        "armature": max(joint.armature, TIED if leads or joint.leader else TINY),
        **({"stiffness": joint.stiffness, "springref": 0} if joint.stiffness else {}),
        **({"damping": joint.damping} if joint.stiffest else {}),
    }


def _geoms(node: Element, shape: Visual, T: Array, meshes: list[str]) -> None:
    look: dict[str, object] = {**_place(T), "contype": 0, "conaffinity": 0, "group": 2}
    if shape.rgba is not None:
        look["rgba"] = numbers(np.array(shape.rgba))
    if shape.kind == "mesh":
        for mesh in meshes:
            put(node, "geom", type="mesh", mesh=mesh, **look)
        return
    half = {"box": (0.5, 0.5, 0.5), "sphere": (1.0,)}.get(shape.kind, (1.0, 0.5))
    put(node, "geom", type=shape.kind, size=numbers(np.array(shape.size) * half), **look)


def _ties(arm: MovingArm, root: Element) -> None:
    if arm.springs:
        tendon = put(root, "tendon")
        for k, tied in enumerate(arm.springs):
            fixed = put(
                tendon, "fixed", name=f"spring_{k}", stiffness=tied.stiffness, springlength=0
            )
            for joint, weight in tied.weights.items():
                put(fixed, "joint", joint=joint, coef=weight)
    followers = [(joint.name, joint.leader) for joint in arm.joints if joint.leader]
    if followers:
        equality = put(root, "equality")
        for name, (leader, factor, offset) in followers:
            law = f"{offset!r} {factor!r} 0 0 0"
            put(equality, "joint", joint1=name, joint2=leader, polycoef=law, **_FORM)


def _actuators(arm: MovingArm, root: Element) -> None:
    actuators = put(root, "actuator")
    for joint in arm.motors:
        name, gains = joint.name, {"kp": joint.servo, "kv": joint.damping}
        node = put(actuators, "position", name=name, joint=name, **gains)
        if np.isfinite(joint.limits).all():
            low, high = min(joint.limits[0], joint.value), max(joint.limits[1], joint.value)
            node.set("ctrllimited", "true")
            node.set("ctrlrange", f"{low!r} {high!r}")


def _place(T: Array) -> dict[str, str]:
    return {"pos": numbers(T[:3, 3]), "quat": numbers(quaternion(T[:3, :3]))}


def quaternion(R: Array) -> Array:
    """(4,) w x y z of a rotation (3, 3)."""
    from scipy.spatial.transform import Rotation  # slow to import

    x, y, z, w = Rotation.from_matrix(R).as_quat()
    return np.array([w, x, y, z])
