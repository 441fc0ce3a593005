"""A URDF read with the standard library: the chain from base to tool, and the masses on it."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np

from .arm import Arm, ArmJoint, Body, Typical
from .rotations import Array, from_rpy, placement


def _numbers(text: str | None, default: str = "0 0 0") -> Array:
    return np.array([float(part) for part in (text or default).split()])


def _origin(node: ET.Element | None) -> Array:
    origin = None if node is None else node.find("origin")
    if origin is None:
        return np.eye(4)
    return placement(_numbers(origin.get("xyz")), from_rpy(*_numbers(origin.get("rpy"))))


def urdf_arm(
    text: str, *, name: str, reference: str, base: str, tool: str, typical: Typical
) -> Arm:
    """The chain of a URDF whose moving joints are all on the way from `base` to `tool`."""
    root = ET.fromstring(text)
    by_child = {node.find("child").get("link"): node for node in root.findall("joint")}
    path: list[ET.Element] = []
    link = tool
    while link != base:
        node = by_child[link]
        path.insert(0, node)
        link = node.find("parent").get("link")

    joints: list[ArmJoint] = []
    where = {base: (-1, np.eye(4))}  # link -> joint that moves it, placement in its moving frame
    pending = np.eye(4)
    for node in path:
        pending = pending @ _origin(node)
        child = node.find("child").get("link")
        if node.get("type") == "fixed":
            where[child] = (len(joints) - 1, pending.copy())
            continue
        axis = _numbers(node.find("axis").get("xyz"))
        limit = node.find("limit")
        joints.append(
            ArmJoint(
                name=node.get("name"),
                before=pending,
                axis=axis / np.linalg.norm(axis),
                slides=node.get("type") == "prismatic",
                lower=float(limit.get("lower")),
                upper=float(limit.get("upper")),
                link=child,
            )
        )
        pending = np.eye(4)
        where[child] = (len(joints) - 1, np.eye(4))

    bodies = []
    for node in root.findall("link"):
        inertial = node.find("inertial")
        if inertial is None or node.get("name") not in where:
            continue
        joint, at = where[node.get("name")]
        centre = (at @ _origin(inertial))[:3, 3]
        if joint >= 0:
            bodies.append(Body(joint, centre, float(inertial.find("mass").get("value"))))
    return Arm(
        name=name,
        reference=reference,
        base_frame=base,
        tool_frame=tool,
        joints=tuple(joints),
        tool=pending,
        actuated=tuple(joint.name for joint in joints),
        limits={joint.name: (joint.lower, joint.upper) for joint in joints},
        typical=typical,
        bodies=tuple(bodies),
        base_link=base,
    )


def read_urdf_arm(path: Path, **keywords: object) -> Arm:
    """`urdf_arm` of a file."""
    return urdf_arm(path.read_text(encoding="utf-8"), **keywords)  # type: ignore[arg-type]
