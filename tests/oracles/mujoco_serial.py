"""Statics of a serial elastic arm in MuJoCo: hinges, slides, springs, a wrench at the tip."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tests.oracles.mujoco_statics import Deflection, Statics
from tests.oracles.numpy_kinematics import UrdfTree, rotation, transform

Array = NDArray[np.float64]

OPTIONS = """
  <compiler angle="radian" autolimits="true"/>
  <option gravity="0 0 0" timestep="{timestep}" integrator="implicitfast" jacobian="dense"
          iterations="200" tolerance="1e-14"><flag contact="disable"/></option>
"""
# Masses move nothing at rest without gravity, but MuJoCo refuses moving bodies without any.
INERTIAL = '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'


@dataclass(frozen=True)
class Spring:
    """One joint of the arm, its frame seen from the joint before it when that one is at zero."""

    origin: Array  # (4, 4)
    axis: Array  # (3,) in the joint frame
    angle: float  # commanded coordinate [rad or m], where the spring is relaxed
    stiffness: float | None  # [N·m/rad or N/m]; None holds the joint rigid
    slide: bool = False


def pose_attributes(matrix: Array) -> str:
    """pos and quat of a (4, 4) placement, to full precision."""
    turn = matrix[:3, :3]
    # Largest of the four squared components first: no division by a small number.
    squares = np.array(
        [
            1 + np.trace(turn),
            *(1 + 2 * turn[i, i] - np.trace(turn) for i in range(3)),
        ]
    )
    largest = int(np.argmax(squares))
    skew = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
    quat = np.empty(4)
    if largest == 0:
        quat[0], quat[1:] = squares[0], skew
    else:
        axis = largest - 1
        quat[0], quat[1:] = skew[axis], turn[axis] + turn[:, axis]
        quat[largest] = squares[largest]
    quat /= np.linalg.norm(quat)
    pos = " ".join(repr(float(x)) for x in matrix[:3, 3])
    return f'pos="{pos}" quat="{" ".join(repr(float(x)) for x in quat)}"'


def spring_joint(name: str, spring: Spring) -> str:
    """A hinge or slide with a linear spring, and enough armature and damping to step time."""
    axis = " ".join(repr(float(x)) for x in spring.axis)
    stiffness = float(spring.stiffness or 0.0)
    armature = max(1.0, stiffness / 1e4)
    damping = 2.0 * float(np.sqrt(max(stiffness, 1e4) * armature))
    return (
        f'<joint name="{name}" type="{"slide" if spring.slide else "hinge"}" axis="{axis}" '
        f'stiffness="{stiffness!r}" springref="{float(spring.angle)!r}" damping="{damping!r}" '
        f'armature="{armature!r}"/>'
    )


def motion(spring: Spring) -> Array:
    """(4, 4) of a joint at its commanded coordinate."""
    if spring.slide:
        return transform(spring.axis * spring.angle)
    return transform(turn=rotation(spring.axis, spring.angle))


def serial_statics(springs: Sequence[Spring], tip: ArrayLike, timestep: float = 1e-4) -> Statics:
    """The arm as a chain of bodies; `tip` (4, 4) is the loaded point seen from the last joint."""
    opening, closing, pending = "", "", np.eye(4)
    relaxed: dict[str, float] = {}
    for index, spring in enumerate(springs):
        place = pending @ spring.origin
        if spring.stiffness is None:
            pending = place @ motion(spring)
            continue
        name = f"j{index}"
        relaxed[name] = spring.angle
        opening += f"<body {pose_attributes(place)}>{INERTIAL}{spring_joint(name, spring)}"
        closing, pending = "</body>" + closing, np.eye(4)
    site = f'<site name="tip" {pose_attributes(pending @ np.asarray(tip, float))}/>'
    options = OPTIONS.format(timestep=timestep)
    xml = f"<mujoco>{options}<worldbody>{opening}{site}{closing}</worldbody></mujoco>"
    return Statics(xml, relaxed)


def springs_of(
    tree: UrdfTree,
    link: str,
    values: Mapping[str, float],
    stiffness: Mapping[str, float],
) -> tuple[list[Spring], Array]:
    """Springs and tip of the chain from the root of a URDF to `link`.

    Joints without a stiffness are rigid. A mimic joint with a stiffness, or one whose driver is
    elastic, is no serial spring: refused.
    """
    chain = []
    while link != tree.root:
        chain.append(tree.by_child[link])
        link = chain[-1].parent
    springs, tip = [], np.eye(4)
    for joint in reversed(chain):
        if joint.kind == "fixed":
            tip = tip @ joint.origin
            continue
        if joint.mimic is not None and (joint.name in stiffness or joint.mimic[0] in stiffness):
            raise NotImplementedError(f"{joint.name} is coupled: not a serial arm")
        springs.append(
            Spring(
                origin=tip @ joint.origin,
                axis=joint.axis,
                angle=tree.value(joint.name, values),
                stiffness=stiffness.get(joint.name),
                slide=joint.kind == "prismatic",
            )
        )
        tip = np.eye(4)
    return springs, tip


def deflect_urdf(
    tree: UrdfTree,
    link: str,
    values: Mapping[str, float],
    stiffness: Mapping[str, float],
    wrench: ArrayLike,
    at: ArrayLike = (0, 0, 0),
) -> Deflection:
    """Exact deflection of a point of `link` (given in link axes) under a world wrench there."""
    springs, tip = springs_of(tree, link, values, stiffness)
    return serial_statics(springs, tip @ transform(at)).deflection(wrench)
