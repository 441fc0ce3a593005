"""`<mimic>` rules: targets that exist, no circles, and followers of joints that stand still."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from sk120stiff.robot.urdf.document import Array, JointSpec
from sk120stiff.robot.urdf.findings import Notebook, at, close_name, listed, shown


def checked_mimics(
    joints: tuple[JointSpec, ...], locked: dict[str, str], notes: Notebook
) -> tuple[JointSpec, ...]:
    """The joints, each mimic rule leading to a moving joint.

    A joint that follows one which does not move cannot move either: it becomes fixed at its offset.
    `locked` is extended by it. Chains of rules may come in any order.

    Raises
    ------
    InputError
        A rule names an unknown joint, or rules run in a circle; the circle is listed.
    """
    by_name = {joint.name: joint for joint in joints}
    for joint in joints:
        if joint.mimic is not None and joint.mimic.joint not in by_name:
            close = close_name(joint.mimic.joint, by_name)
            hint = f"Did you mean {close!r}? " if close else ""
            notes.refuse(
                f"the joint mimics {shown(joint.mimic.joint)}, which does not exist",
                where=at(joint.line, "joint", joint.name),
                remedy=f"{hint}Joints are: {listed(list(by_name))}.",
            )
    followers: dict[str, list[str]] = {}
    for joint in joints:
        if joint.mimic is not None:
            followers.setdefault(joint.mimic.joint, []).append(joint.name)
    for name in drivers_first(joints, by_name, notes):
        joint = by_name[name]
        if joint.mimic is None or by_name[joint.mimic.joint].moves:
            continue
        driver = joint.mimic.joint
        why = f"it mimics {shown(driver)}, which does not move"
        value = joint.mimic.offset  # a joint that does not move stands at zero
        origin = joint.origin @ motion(joint, value)
        by_name[name] = replace(joint, type="fixed", origin=origin, mimic=None)
        for follower in followers.get(name, ()):  # they see its value through their own rule
            rule = by_name[follower].mimic
            if rule is not None:
                moved = rule._replace(offset=rule.offset + rule.multiplier * value)
                by_name[follower] = replace(by_name[follower], mimic=moved)
        locked[name] = why
        notes.warn(
            "joint_locked",
            at(joint.line, "joint", name),
            f"held still at {value:g} because {why}",
        )
    return tuple(by_name[joint.name] for joint in joints)


def drivers_first(
    joints: tuple[JointSpec, ...], by_name: Mapping[str, JointSpec], notes: Notebook
) -> list[str]:
    """Names of all joints, every driver before its followers."""
    done: dict[str, None] = {}
    for joint in joints:
        way: list[str] = []
        on_way: set[str] = set()
        name: str | None = joint.name
        while name is not None and name not in done:
            if name in on_way:
                circle = [*way[way.index(name) :], name]
                notes.refuse(
                    "mimic rules run in a circle: " + " → ".join(map(shown, circle)),
                    where=at(by_name[name].line, "joint", name),
                    remedy="Remove the <mimic> of one joint of the circle.",
                )
            way.append(name)
            on_way.add(name)
            rule = by_name[name].mimic
            name = rule.joint if rule is not None else None
        done.update(dict.fromkeys(reversed(way)))
    return list(done)


def motion(joint: JointSpec, value: float) -> Array:
    """(4, 4) displacement of a joint from its zero, by `value` [rad or m]."""
    T = np.eye(4)
    if joint.type == "prismatic":
        T[:3, 3] = value * joint.axis
        return T
    x, y, z = joint.axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    T[:3, :3] += np.sin(value) * cross + (1.0 - np.cos(value)) * cross @ cross
    return T
