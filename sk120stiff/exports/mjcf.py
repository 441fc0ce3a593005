"""MJCF: the arm for MuJoCo, with position actuators, springs behind them, and the user's shapes.

The world's axes are those of the base frame. A command is one number for each actuated joint, in
their order, in ``data.ctrl``; the keyframe ``commanded`` stands at the pose. A load acts at the
site that bears the name of the frame (``mj_applyFT``, each step).
"""

from __future__ import annotations

from collections.abc import Iterable
from xml.sax.saxutils import quoteattr

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.exports.building import moving_arm, told_of
from sk120stiff.exports.contract import Exported, Format, Request, Told, numbers
from sk120stiff.exports.meshes import mesh_files
from sk120stiff.exports.moving import Body, Joint, MovingArm
from sk120stiff.model import Model
from sk120stiff.robot.visuals import Visual, visuals

STEP = 1e-3  # s
TINY, TINY_INERTIA = 1e-3, 1e-6  # kg, kg·m²: MuJoCo wants something in every body that moves
TIED = 100.0  # kg·m² or kg: the heavier a follower and its leader, the less a soft constraint gives
_FORM = 'solref="0.002 1" solimp="0.9999 0.9999 1"'


def make(model: Model, request: Request) -> Exported:
    """See `Format.make`."""
    arm = moving_arm(model, request)
    carried, left_out = told_of(model)
    folder = f"{request.out.stem}.meshes"
    files, paths = mesh_files([shape for _, _, shape in arm.shapes], folder)
    text = "\n".join(_document(arm, left_out, sorted(files), paths)) + "\n"
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
        "Masses are the robot's; a branch beside the arm weighs where it is at zero."
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
) -> Iterable[str]:
    mesh = {name: f"mesh_{k}" for k, name in enumerate(files)}
    children: dict[int, list[int]] = {}
    for k, body in enumerate(arm.bodies):
        children.setdefault(body.parent, []).append(k)
    yield f"<mujoco model={quoteattr(arm.name)}>"
    yield f"  <!-- {header_of(arm, left_out)} -->"
    yield (
        '  <compiler angle="radian" autolimits="false" inertiafromgeom="false" '
        'balanceinertia="true"/>'
    )
    yield (
        f'  <option gravity="{numbers(arm.gravity)}" timestep="{STEP!r}" integrator="implicitfast" '
        'jacobian="dense" iterations="200" tolerance="1e-14">'
    )
    yield '    <flag contact="disable"/>'
    yield "  </option>"
    if mesh:
        yield "  <asset>"
        for name, short in mesh.items():
            yield f'    <mesh name="{short}" file={quoteattr(name)} inertia="shell"/>'
        yield "  </asset>"
    yield "  <worldbody>"
    order: list[Joint] = []
    leaders = {joint.leader[0] for joint in arm.joints if joint.leader}

    def emit(k: int, indent: str) -> Iterable[str]:
        body = arm.bodies[k]
        if body.name != "world":  # MuJoCo has a body of that name
            own = f"name={quoteattr(body.name)} {_place(body.placement)}"
            yield f"{indent}<body {own}{_float(body)}>"
        if body.joint is not None:
            order.append(body.joint)
            yield f"{indent}  {_inertial(body)}"
            yield f"{indent}  {_joint(body.joint, leads=body.joint.name in leaders)}"
        for (at, T, shape), named in zip(arm.shapes, paths, strict=True):
            if at == k:
                yield from (
                    f"{indent}  {line}" for line in _geoms(shape, T, [mesh[p] for p in named])
                )
        for name, at, T in arm.frames:
            if at == k and name != "world":
                yield f"{indent}  <body name={quoteattr(name)} {_place(T)}/>"
        for name, at, T in arm.sites:
            if at == k:
                yield f"{indent}  <site name={quoteattr(name)} {_place(T)}/>"
        for child in children.get(k, ()):
            yield from emit(child, indent + "  ")
        if body.name != "world":
            yield f"{indent}</body>"

    yield from emit(0, "    ")
    yield "  </worldbody>"
    yield from _ties(arm)
    yield from _actuators(arm)
    qpos = numbers(np.array([joint.value for joint in order]))
    ctrl = numbers(np.array([joint.value for joint in arm.motors]))
    yield f'  <keyframe><key name="commanded" qpos="{qpos}" ctrl="{ctrl}"/></keyframe>'
    yield "</mujoco>"


def _float(body: Body) -> str:
    """What only MuJoCo asks to weigh something weighs nothing."""
    return "" if body.mass > 0.0 or body.joint is None else ' gravcomp="1"'


def _inertial(body: Body) -> str:
    if body.mass <= 0.0:
        tiny = " ".join([repr(TINY_INERTIA)] * 3)
        return f'<inertial pos="0 0 0" mass="{TINY!r}" diaginertia="{tiny}"/>'
    values, axes = np.linalg.eigh(body.inertia)
    values = np.maximum(values, TINY_INERTIA)  # real files state tensors that no body has
    axes = axes * np.sign(np.linalg.det(axes))
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = axes, body.centre
    return f'<inertial {_place(T)} mass="{body.mass!r}" diaginertia="{numbers(values)}"/>'


def _joint(joint: Joint, *, leads: bool) -> str:
    armature = max(joint.armature, TIED if leads or joint.leader else TINY)
    spring = f' stiffness="{joint.stiffness!r}" springref="0"' if joint.stiffness else ""
    damping = f' damping="{joint.damping!r}"' if joint.stiffest else ""
    return (
        f'<joint name={quoteattr(joint.name)} type="{"slide" if joint.slides else "hinge"}" '
        f'axis="{numbers(joint.axis)}" armature="{armature!r}"{spring}{damping}/>'
    )


def _geoms(shape: Visual, T: Array, meshes: list[str]) -> Iterable[str]:
    colour = f' rgba="{numbers(np.array(shape.rgba))}"' if shape.rgba is not None else ""
    look = f'{_place(T)} contype="0" conaffinity="0" group="2"{colour}/>'
    if shape.kind == "mesh":
        yield from (f'<geom type="mesh" mesh="{mesh}" {look}' for mesh in meshes)
        return
    half = {"box": (0.5, 0.5, 0.5), "sphere": (1.0,)}.get(shape.kind, (1.0, 0.5))
    size = numbers(np.array(shape.size) * half)
    yield f'<geom type="{shape.kind}" size="{size}" {look}'


def _ties(arm: MovingArm) -> Iterable[str]:
    if arm.springs:
        yield "  <tendon>"
        for k, tied in enumerate(arm.springs):
            yield f'    <fixed name="spring_{k}" stiffness="{tied.stiffness!r}" springlength="0">'
            for joint, weight in tied.weights.items():
                yield f'      <joint joint={quoteattr(joint)} coef="{weight!r}"/>'
            yield "    </fixed>"
        yield "  </tendon>"
    followers = [(joint.name, joint.leader) for joint in arm.joints if joint.leader]
    if followers:
        yield "  <equality>"
        for name, (leader, factor, offset) in followers:
            yield (
                f"    <joint joint1={quoteattr(name)} joint2={quoteattr(leader)} "
                f'polycoef="{offset!r} {factor!r} 0 0 0" {_FORM}/>'
            )
        yield "  </equality>"


def _actuators(arm: MovingArm) -> Iterable[str]:
    yield "  <actuator>"
    for joint in arm.motors:
        limit = ""
        if np.isfinite(joint.limits).all():
            low, high = min(joint.limits[0], joint.value), max(joint.limits[1], joint.value)
            limit = f' ctrllimited="true" ctrlrange="{low!r} {high!r}"'
        name = quoteattr(joint.name)
        yield (
            f'    <position name={name} joint={name} kp="{joint.servo!r}" '
            f'kv="{joint.damping!r}"{limit}/>'
        )
    yield "  </actuator>"


def _place(T: Array) -> str:
    return f'pos="{numbers(T[:3, 3])}" quat="{numbers(quaternion(T[:3, :3]))}"'


def quaternion(R: Array) -> Array:
    """(4,) w x y z of a rotation (3, 3)."""
    from scipy.spatial.transform import Rotation  # slow to import

    x, y, z, w = Rotation.from_matrix(R).as_quat()
    return np.array([w, x, y, z])
