"""Kinematics and gravity of any URDF by 4x4 matrices alone, read with xml.etree.

Written to be obvious, not fast. Handles revolute, continuous, prismatic and fixed joints and any
chain of mimics. Everything else raises.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
GRAVITY = np.array([0.0, 0.0, -9.81])


@dataclass(frozen=True)
class Joint:
    name: str
    kind: str
    parent: str
    child: str
    origin: Array  # (4, 4) parent link -> joint frame at zero
    axis: Array  # (3,) unit, in the joint frame
    mimic: tuple[str, float, float] | None  # driver, multiplier, offset


@dataclass(frozen=True)
class Body:
    mass: float
    centre: Array  # (3,) in the link frame


def rotation(axis: ArrayLike, angle: float) -> Array:
    """Rodrigues' formula: rotation by `angle` [rad] about the unit `axis`."""
    x, y, z = np.asarray(axis, float)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def rotation_vector(matrix: ArrayLike) -> Array:
    """Axis times angle [rad] of a rotation matrix, for angles below pi."""
    matrix = np.asarray(matrix, float)
    skew = np.array(
        [matrix[2, 1] - matrix[1, 2], matrix[0, 2] - matrix[2, 0], matrix[1, 0] - matrix[0, 1]]
    )
    sine, cosine = np.linalg.norm(skew) / 2, (np.trace(matrix) - 1) / 2
    angle = np.arctan2(sine, cosine)
    return skew / 2 if sine < 1e-12 else skew * (angle / (2 * sine))


def transform(xyz: ArrayLike = (0, 0, 0), turn: ArrayLike | None = None) -> Array:
    """(4, 4) from a translation [m] and a rotation matrix."""
    result = np.eye(4)
    result[:3, 3] = xyz
    if turn is not None:
        result[:3, :3] = turn
    return result


def _origin(element: ET.Element | None) -> Array:
    if element is None:
        return np.eye(4)
    xyz = [float(x) for x in element.get("xyz", "0 0 0").split()]
    roll, pitch, yaw = (float(x) for x in element.get("rpy", "0 0 0").split())
    turn = rotation([0, 0, 1], yaw) @ rotation([0, 1, 0], pitch) @ rotation([1, 0, 0], roll)
    return transform(xyz, turn)


class UrdfTree:
    """A URDF as nested 4x4 transforms. `values` maps independent joint names to rad or m."""

    def __init__(self, source: str | Path) -> None:
        text = str(source)
        is_text = text.lstrip().startswith("<")
        root = ET.fromstring(text) if is_text else ET.parse(text).getroot()
        self.joints: dict[str, Joint] = {}
        self.by_child: dict[str, Joint] = {}
        for element in root.findall("joint"):
            joint = self._read_joint(element)
            self.joints[joint.name] = joint
            self.by_child[joint.child] = joint
        self.links = [str(link.get("name")) for link in root.findall("link")]
        self.bodies = {
            str(link.get("name")): body
            for link in root.findall("link")
            if (body := self._read_body(link)) is not None
        }
        (self.root,) = [name for name in self.links if name not in self.by_child]

    @staticmethod
    def _read_joint(element: ET.Element) -> Joint:
        name, kind = str(element.get("name")), str(element.get("type"))
        if kind not in {"revolute", "continuous", "prismatic", "fixed"}:
            raise NotImplementedError(f"joint {name}: type {kind}")
        axis_element, mimic_element = element.find("axis"), element.find("mimic")
        axis = np.array([1.0, 0.0, 0.0])
        if axis_element is not None:
            axis = np.array([float(x) for x in str(axis_element.get("xyz")).split()])
        mimic = None
        if mimic_element is not None:
            mimic = (
                str(mimic_element.get("joint")),
                float(mimic_element.get("multiplier", "1")),
                float(mimic_element.get("offset", "0")),
            )
        parent, child = element.find("parent"), element.find("child")
        assert parent is not None and child is not None
        return Joint(
            name=name,
            kind=kind,
            parent=str(parent.get("link")),
            child=str(child.get("link")),
            origin=_origin(element.find("origin")),
            axis=axis / np.linalg.norm(axis),
            mimic=mimic,
        )

    @staticmethod
    def _read_body(link: ET.Element) -> Body | None:
        inertial = link.find("inertial")
        if inertial is None:
            return None
        mass = inertial.find("mass")
        assert mass is not None
        return Body(float(str(mass.get("value"))), _origin(inertial.find("origin"))[:3, 3])

    @property
    def independent(self) -> list[str]:
        """Moving joints that mimic nothing, in the order of the file."""
        return [j.name for j in self.joints.values() if j.kind != "fixed" and j.mimic is None]

    def value(self, name: str, values: Mapping[str, float]) -> float:
        """Coordinate of one joint, through as many mimics as there are."""
        joint = self.joints[name]
        if joint.mimic is None or joint.mimic[0] not in self.joints:  # a rule that leads nowhere
            return values.get(name, 0.0)
        driver, multiplier, offset = joint.mimic
        return multiplier * self.value(driver, values) + offset

    def placement(self, values: Mapping[str, float], link: str, base: str | None = None) -> Array:
        """(4, 4) pose of `link` seen from `base` (default: the root link)."""
        if base is not None:
            seen_from_base = np.linalg.inv(self.placement(values, base))
            return np.asarray(seen_from_base @ self.placement(values, link))
        if link == self.root:
            return np.eye(4)
        joint = self.by_child[link]
        motion = np.eye(4)
        if joint.kind in {"revolute", "continuous"}:
            motion = transform(turn=rotation(joint.axis, self.value(joint.name, values)))
        elif joint.kind == "prismatic":
            motion = transform(joint.axis * self.value(joint.name, values))
        return self.placement(values, joint.parent) @ joint.origin @ motion

    def point(self, values: Mapping[str, float], link: str, at: ArrayLike = (0, 0, 0)) -> Array:
        """(3,) position in root axes of a point given in link axes [m]."""
        return (self.placement(values, link) @ np.append(np.asarray(at, float), 1.0))[:3]

    def jacobian(
        self,
        values: Mapping[str, float],
        link: str,
        names: list[str],
        at: ArrayLike = (0, 0, 0),
        step: float = 1e-3,
    ) -> Array:
        """(6, n) [linear; angular] in root axes, by fourth-order central differences."""
        columns = []
        here = self.placement(values, link)[:3, :3]
        for name in names:

            def moved(by: float, name: str = name) -> Array:
                there = {**values, name: values.get(name, 0.0) + by}
                turn = self.placement(there, link)[:3, :3] @ here.T
                return np.concatenate([self.point(there, link, at), rotation_vector(turn)])

            near, far = moved(step) - moved(-step), moved(2 * step) - moved(-2 * step)
            columns.append((8 * near - far) / (12 * step))
        return np.array(columns).T

    def potential(self, values: Mapping[str, float]) -> float:
        """Gravity potential of all links [J], the root link included."""
        return -sum(
            body.mass * float(GRAVITY @ self.point(values, link, body.centre))
            for link, body in self.bodies.items()
        )

    def gravity_torque(
        self, values: Mapping[str, float], names: list[str], step: float = 1e-3
    ) -> Array:
        """(n,) gradient of the potential: the torque a motor gives to hold the arm still."""

        def moved(name: str, by: float) -> float:
            return self.potential({**values, name: values.get(name, 0.0) + by})

        return np.array(
            [
                (8 * (moved(n, step) - moved(n, -step)) - moved(n, 2 * step) + moved(n, -2 * step))
                / (12 * step)
                for n in names
            ]
        )
