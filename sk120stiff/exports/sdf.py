"""SDF 1.11: links and joints with springs and mimic rules, the user's shapes, position controllers.

SDF knows no servo: each motor gets Gazebo's plugin for one, and its inertia stands in a link of its
own. It has no word for springs between joints, nor for gravity of a model's own.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from xml.sax.saxutils import escape, quoteattr

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects import LinearElastic, load_case
from sk120stiff.exports.building import moving_arm, told_of
from sk120stiff.exports.contract import Exported, Format, Request, Told, numbers
from sk120stiff.exports.meshes import mesh_files
from sk120stiff.exports.mjcf import TINY, TINY_INERTIA, details_of, header_of, notes_of, rows_of
from sk120stiff.exports.moving import Body, Joint, MovingArm
from sk120stiff.model import Model
from sk120stiff.robot.urdf.clean import rpy_from_rotation
from sk120stiff.robot.visuals import Visual, visuals

UNLIMITED = 1e16  # SDF's word for no limit
_PLUGIN = (
    '    <plugin filename="gz-sim-joint-position-controller-system" '
    'name="gz::sim::systems::JointPositionController">'
)


def make(model: Model, request: Request) -> Exported:
    """See `Format.make`."""
    arm = _distinct(moving_arm(model, request, ties=False))
    carried, left_out = told_of(model)
    ties = _ties(model)
    carried = tuple(told for told in carried if told.effect not in ties)
    lost = [Told(effect, "ties joints together: SDF has no such spring") for effect in ties]
    folder = f"{request.out.stem}.meshes"
    files, paths = mesh_files([shape for _, _, shape in arm.shapes], folder)
    notes = [finding.message for finding in visuals(model.robot).findings]
    down = arm.gravity / max(float(np.linalg.norm(arm.gravity)), 1e-300)
    if arm.heavy and down @ np.array([0.0, 0.0, -1.0]) < 1.0 - 1e-9:
        notes.append(
            f"Gravity is the world's in SDF. Of this arm it points along {numbers(down.round(6))} "
            "in axes of the base: set it in the world."
        )
    text = "\n".join(_document(arm, [*left_out, *lost], paths)) + "\n"
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


def _ties(model: Model) -> list[str]:
    """Effects by which the torque of one coordinate moves another."""
    load_cases = load_case(model.robot, model.robot.rest, np.zeros(6))
    found = []
    for effect, part in zip(model.effects, model.assembly.slices, strict=True):
        if isinstance(effect, LinearElastic) and model.values[part].any():
            C = np.tensordot(model.values[part], effect.patterns(load_cases), axes=1)
            if (C * (1.0 - np.eye(C.shape[-1]))).any():
                found.append(effect.id)
    return found


def _document(
    arm: MovingArm, left_out: Iterable[Told], paths: list[tuple[str, ...]]
) -> Iterable[str]:
    yield '<?xml version="1.0"?>'
    yield '<sdf version="1.11">'
    yield f"  <!-- {header_of(arm, left_out)} -->"
    yield f"  <model name={quoteattr(arm.name)}>"
    names = [_name(body.name) for body in arm.bodies]
    for k, body in enumerate(arm.bodies):
        looks = [
            line
            for n, ((at, T, shape), own) in enumerate(zip(arm.shapes, paths, strict=True))
            if at == k
            for line in _visual(f"visual_{n}", shape, T, own)
        ]
        yield from _link(body, names, looks, heavy=arm.heavy)
    base = escape(names[0])
    yield f'    <joint name={quoteattr(f"{names[0]}.ground")} type="fixed">'
    yield f"      <parent>world</parent><child>{base}</child>"
    yield "    </joint>"
    for k, body in enumerate(arm.bodies):
        if body.joint is not None:
            yield from _joint(body.joint, names[body.parent], names[k])
    taken = set(names)
    for name, at, T in (*arm.frames, *arm.sites):
        if name in taken or name == "world":
            continue
        taken.add(name)
        yield f"    <frame name={quoteattr(name)} attached_to={quoteattr(names[at])}>"
        yield f"      <pose>{_pose(T)}</pose>"
        yield "    </frame>"
    for joint in arm.motors:
        yield from _controller(joint)
    yield "  </model>"
    yield "</sdf>"


def _name(name: str) -> str:
    return "world_link" if name == "world" else name  # SDF's own word for the ground


def _link(body: Body, names: list[str], looks: list[str], *, heavy: bool) -> Iterable[str]:
    own = body.mass > 0.0
    mass, inertia = (body.mass, body.inertia) if own else (TINY, np.zeros((3, 3)))
    turning = body.joint.armature if body.joint is not None and body.joint.servo else 0.0
    inertia = inertia + max(turning, TINY_INERTIA) * np.eye(3)
    keys = (
        ("ixx", 0, 0),
        ("ixy", 0, 1),
        ("ixz", 0, 2),
        ("iyy", 1, 1),
        ("iyz", 1, 2),
        ("izz", 2, 2),
    )
    moments = "".join(f"<{key}>{float(inertia[i, j])!r}</{key}>" for key, i, j in keys)
    yield f"    <link name={quoteattr(_name(body.name))}>"
    if body.joint is not None:
        parent = quoteattr(names[body.parent])
        yield f"      <pose relative_to={parent}>{_pose(body.placement)}</pose>"
    if not (own and heavy):
        yield "      <gravity>false</gravity>"
    yield (
        f"      <inertial><pose>{numbers(body.centre)} 0 0 0</pose><mass>{mass!r}</mass>"
        f"<inertia>{moments}</inertia></inertial>"
    )
    yield from looks
    yield "    </link>"


def _joint(joint: Joint, parent: str, child: str) -> Iterable[str]:
    low, high = np.clip(joint.limits, -UNLIMITED, UNLIMITED).tolist()
    kind = "prismatic" if joint.slides else "revolute"
    yield f'    <joint name={quoteattr(joint.name)} type="{kind}">'
    yield f"      <parent>{escape(parent)}</parent><child>{escape(child)}</child>"
    yield "      <axis>"
    yield f"        <xyz>{numbers(joint.axis)}</xyz>"
    yield f"        <limit><lower>{low!r}</lower><upper>{high!r}</upper></limit>"
    if joint.leader is not None:
        leader, factor, offset = joint.leader
        yield (
            f"        <mimic joint={quoteattr(leader)}><multiplier>{factor!r}</multiplier>"
            f"<offset>{offset!r}</offset><reference>0</reference></mimic>"
        )
    elif joint.stiffness:
        yield (
            f"        <dynamics><spring_stiffness>{joint.stiffness!r}</spring_stiffness>"
            f"<spring_reference>0</spring_reference><damping>{joint.damping!r}</damping></dynamics>"
        )
    yield "      </axis>"
    yield "    </joint>"


def _controller(joint: Joint) -> Iterable[str]:
    yield _PLUGIN
    yield f"      <joint_name>{escape(joint.name)}</joint_name>"
    yield f"      <p_gain>{joint.servo!r}</p_gain><i_gain>0</i_gain>"
    yield f"      <d_gain>{joint.damping!r}</d_gain>"
    yield f"      <initial_position>{joint.value!r}</initial_position>"
    yield "    </plugin>"


def _visual(name: str, shape: Visual, T: Array, paths: tuple[str, ...]) -> Iterable[str]:
    size = [repr(float(x)) for x in shape.size]
    if shape.kind == "mesh":
        inner = [f"<mesh><uri>{escape(path)}</uri></mesh>" for path in paths]
    elif shape.kind == "box":
        inner = [f"<box><size>{' '.join(size)}</size></box>"]
    elif shape.kind == "sphere":
        inner = [f"<sphere><radius>{size[0]}</radius></sphere>"]
    else:
        inner = [
            f"<{shape.kind}><radius>{size[0]}</radius><length>{size[1]}</length></{shape.kind}>"
        ]
    for k, geometry in enumerate(inner):
        yield f'      <visual name="{name}_{k}">'
        yield f"        <pose>{_pose(T)}</pose><geometry>{geometry}</geometry>"
        if shape.rgba is not None:
            rgba = numbers(np.array(shape.rgba))
            colour = f"<ambient>{rgba}</ambient><diffuse>{rgba}</diffuse>"
            yield f"        <material>{colour}</material>"
        yield "      </visual>"


def _pose(T: Array) -> str:
    """x y z roll pitch yaw."""
    return numbers(np.array([*T[:3, 3], *rpy_from_rotation(T[:3, :3])]))
