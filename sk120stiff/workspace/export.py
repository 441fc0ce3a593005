"""A modelled arm as a file for simulators: MuJoCo's MJCF, and SDF."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError
from sk120stiff.workspace.springs import Body, Follower, SpringArm

# Where the robot states no masses, or a virtual joint stands between two bodies: simulators want
# some mass in every body, and without gravity it moves nothing at rest.
_MASS, _INERTIA = 1.0, 0.01
_SPEED = 100.0  # rad/s: joint springs oscillate with the armature at this pace, critically damped
_STEP = 5e-4  # s
_FOLLOWER = 100.0  # kg m² or kg


def mjcf_text(arm: SpringArm) -> str:
    """MJCF: bodies, joints with springs, the commanded pose as a keyframe, and a site at the tool.

    The arm stands at its command when loaded; the springs' references are the commanded values. To
    command another pose at run time, set ``model.qpos_spring``; joints in the header's list of held
    ones are built in at this pose. Masses are the robot's, where it has any; inertia tensors,
    armature and damping are not, so the way to rest is not that of the arm, only the rest is.
    """
    heavy = bool(arm.gravity.any())
    held = {follower.joint for follower in arm.followers}
    lines = [
        f'<mujoco model="{_escaped(arm.name)}">',
        f"  <!-- {_header(arm)} -->",
        '  <compiler angle="radian" autolimits="false"/>',
        f'  <option gravity="{_numbers(arm.gravity)}" timestep="{_STEP!r}" '
        'integrator="implicitfast" iterations="200" tolerance="1e-14">',
        '    <flag contact="disable"/>',
        "  </option>",
        "  <worldbody>",
    ]
    for depth, body in enumerate(arm.bodies):
        lines += _mjcf_body(body, "  " * (depth + 2), heavy=heavy, follows=body.name in held)
    indent = "  " * (len(arm.bodies) + 2)
    lines.append(f'{indent}<site name="{_escaped(arm.frame)}" {_mjcf_place(arm.tip)}/>')
    lines += ["  " * (depth + 2) + "</body>" for depth in reversed(range(len(arm.bodies)))]
    lines.append("  </worldbody>")
    lines += _mjcf_sums(arm)
    keys = _numbers(np.array([body.reference for body in arm.bodies]))
    lines += [f'  <keyframe><key name="commanded" qpos="{keys}"/></keyframe>', "</mujoco>"]
    return "\n".join(lines) + "\n"


def _mjcf_body(body: Body, indent: str, *, heavy: bool, follows: bool) -> list[str]:
    own = heavy and body.mass > 0.0
    mass = body.mass if own else (1e-6 if heavy else _MASS)
    inertia = max(_INERTIA * mass, 1e-9)
    centre = body.centre if own else np.zeros(3)
    # The heavier a follower, the less the solver's soft constraints give way.
    armature = _FOLLOWER if follows else max(1.0, body.stiffness / _SPEED**2)
    damping = 2.0 * float(np.sqrt(max(body.stiffness, _SPEED**2) * armature))
    kind = "slide" if body.slides else "hinge"
    spring = f' stiffness="{body.stiffness!r}" springref="{body.reference!r}"'
    return [
        f'{indent}<body name="{_escaped(body.name)}.body" {_mjcf_place(body.placement)}>',
        f'{indent}  <inertial pos="{_numbers(centre)}" mass="{mass!r}" '
        f'diaginertia="{inertia!r} {inertia!r} {inertia!r}"/>',
        f'{indent}  <joint name="{_escaped(body.name)}" type="{kind}" '
        f'axis="{_numbers(body.axis)}" armature="{armature!r}" damping="{damping!r}"'
        f"{spring if body.stiffness and not follows else ''}/>",
    ]


def _mjcf_sums(arm: SpringArm) -> list[str]:
    """Springs of several joints, and joints that follow others, by fixed tendons."""
    lines: list[str] = []
    equalities: list[str] = []
    for k, one in enumerate(arm.springs):
        lines.append(
            f'    <fixed name="spring_{k}" stiffness="{one.stiffness!r}" '
            f'springlength="{one.value!r}">'
        )
        lines += [
            f'      <joint joint="{_escaped(joint)}" coef="{weight!r}"/>'
            for joint, weight in one.weights.items()
        ]
        lines.append("    </fixed>")
    for follower in arm.followers:
        name = f"{_escaped(follower.joint)}.follows"
        terms = {follower.joint: 1.0, **{joint: -f for joint, f in follower.drivers.items()}}
        lines.append(f'    <fixed name="{name}">')
        lines += [
            f'      <joint joint="{_escaped(joint)}" coef="{weight!r}"/>'
            for joint, weight in terms.items()
        ]
        lines.append("    </fixed>")
        equalities.append(
            f'    <tendon tendon1="{name}" polycoef="{follower.offset!r} 0 0 0 0" '
            f'solref="{2.0 * _STEP!r} 1" solimp="0.9999 0.9999 1"/>'
        )
    if lines:
        lines = ["  <tendon>", *lines, "  </tendon>"]
    if equalities:
        lines += ["  <equality>", *equalities, "  </equality>"]
    return lines


def _mjcf_place(placement: Array) -> str:
    return f'pos="{_numbers(placement[:3, 3])}" quat="{_numbers(_quaternion(placement))}"'


def sdf_text(arm: SpringArm) -> str:
    """SDF 1.11: links, joints with ``spring_stiffness`` and ``spring_reference``, mimic joints.

    Raises:
        InputError: A spring ties several joints together, or a joint follows several: SDF has no
            word for it.
    """
    if arm.springs:
        raise InputError(
            "SDF has no springs that tie joints together",
            where=" and ".join(arm.springs[0].weights),
            remedy="Export to MJCF, or leave the coupling out of the model.",
        )
    follows = {follower.joint: follower for follower in arm.followers}
    several = [follower.joint for follower in arm.followers if len(follower.drivers) > 1]
    if several:
        raise InputError(
            "SDF has no joint that follows several others",
            where=several[0],
            remedy="Export to MJCF, or leave the effect out that bends the linkage.",
        )
    heavy = bool(arm.gravity.any())
    lines = [
        '<?xml version="1.0"?>',
        '<sdf version="1.11">',
        f"  <!-- {_header(arm)} -->",
        f'  <model name="{_escaped(arm.name)}">',
        '    <link name="base"/>',
        '    <joint name="base.fixed" type="fixed">',
        "      <parent>world</parent><child>base</child>",
        "    </joint>",
    ]
    parent = "base"
    for body in arm.bodies:
        link = f"{body.name}.body"
        lines += _sdf_link(body, link, parent, heavy=heavy)
        lines += _sdf_joint(body, link, parent, follows)
        parent = link
    lines += [
        f'    <frame name="{_escaped(arm.frame)}" attached_to="{_escaped(parent)}">',
        f"      <pose>{_sdf_pose(arm.tip)}</pose>",
        "    </frame>",
        "  </model>",
        "</sdf>",
    ]
    return "\n".join(lines) + "\n"


def _sdf_link(body: Body, link: str, parent: str, *, heavy: bool) -> list[str]:
    own = heavy and body.mass > 0.0
    mass = body.mass if own else (1e-6 if heavy else _MASS)
    inertia = max(_INERTIA * mass, 1e-9)
    centre = body.centre if own else np.zeros(3)
    moments = "".join(f"<{name}>{inertia!r}</{name}>" for name in ("ixx", "iyy", "izz"))
    return [
        f'    <link name="{_escaped(link)}">',
        f'      <pose relative_to="{_escaped(parent)}">{_sdf_pose(body.placement)}</pose>',
        *([] if heavy else ["      <gravity>false</gravity>"]),
        f"      <inertial><pose>{_numbers(centre)} 0 0 0</pose><mass>{mass!r}</mass>"
        f"<inertia>{moments}</inertia></inertial>",
        "    </link>",
    ]


def _sdf_joint(body: Body, link: str, parent: str, follows: dict[str, Follower]) -> list[str]:
    kind = "prismatic" if body.slides else "revolute"
    low, high = np.clip(body.limits, -1e16, 1e16).tolist()  # SDF's word for no limit
    lines = [
        f'    <joint name="{_escaped(body.name)}" type="{kind}">',
        f"      <parent>{_escaped(parent)}</parent><child>{_escaped(link)}</child>",
        "      <axis>",
        f"        <xyz>{_numbers(body.axis)}</xyz>",
        f"        <limit><lower>{low!r}</lower><upper>{high!r}</upper></limit>",
    ]
    rule = follows.get(body.name)
    if rule is not None:
        ((driver, factor),) = rule.drivers.items()
        lines.append(
            f'        <mimic joint="{_escaped(driver)}"><multiplier>{factor!r}</multiplier>'
            f"<offset>{rule.offset!r}</offset><reference>0</reference></mimic>"
        )
    else:
        damping = 2.0 * body.stiffness / _SPEED
        lines.append(
            f"        <dynamics><spring_stiffness>{body.stiffness!r}</spring_stiffness>"
            f"<spring_reference>{body.reference!r}</spring_reference>"
            f"<damping>{damping!r}</damping></dynamics>"
        )
    return [*lines, "      </axis>", "    </joint>"]


def _sdf_pose(placement: Array) -> str:
    """x y z roll pitch yaw."""
    R = placement[:3, :3]
    pitch = np.arctan2(-R[2, 0], np.hypot(R[0, 0], R[1, 0]))
    if np.hypot(R[0, 0], R[1, 0]) > 1e-9:
        roll, yaw = np.arctan2(R[2, 1], R[2, 2]), np.arctan2(R[1, 0], R[0, 0])
    else:  # straight up or down: only the sum of roll and yaw is determined
        roll, yaw = np.arctan2(-R[1, 2], R[1, 1]), 0.0
    return _numbers(np.array([*placement[:3, 3], roll, pitch, yaw]))


#: format → (function, what it is)
FORMATS: dict[str, tuple[Callable[[SpringArm], str], str]] = {
    "mjcf": (mjcf_text, "MuJoCo MJCF"),
    "sdf": (sdf_text, "SDF"),
}


def _header(arm: SpringArm) -> str:
    """What a reader of the file should know, without the two hyphens that end a comment."""
    held = ", ".join(f"{joint} = {value:.6g}" for joint, value in arm.held.items()) or "none"
    masses = (
        "Masses are the robot's, inertia tensors are placeholders."
        if arm.gravity.any()
        else "The robot states no masses: those here are placeholders, and gravity is off."
    )
    text = (
        f"Elastic statics of {arm.name}, written by sk120stiff. SI units. Joints held where they "
        f"are: {held}. {masses} Armature and damping only bring it to rest."
    )
    return text.replace("--", "- -")


def _quaternion(placement: Array) -> Array:
    """(4,) w x y z."""
    R = placement[:3, :3]
    trace = float(np.trace(R))
    squares = np.array([trace, *np.diagonal(R)])
    k = int(np.argmax(squares))
    spin = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    if k == 0:
        q = np.array([1.0 + trace, *spin])
    else:
        q = np.array([spin[k - 1], *(R[k - 1] + R[:, k - 1])])
        q[k] += 1.0 - trace
    return np.asarray(q / np.linalg.norm(q))


def _numbers(values: Array) -> str:
    return " ".join(repr(float(value)) for value in values)


def _escaped(text: str) -> str:
    table = {"&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;"}
    return "".join(table.get(letter, letter) for letter in text)
