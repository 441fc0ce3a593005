"""Clean kinematic URDF text out of checked joints and links: what Pinocchio gets to read."""

from __future__ import annotations

from collections.abc import Iterable
from xml.sax.saxutils import quoteattr

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.robot.rotations import rpy_from_rotation
from sk120stiff.robot.urdf.document import JointSpec, LinkSpec

# urdfdom refuses "inf"; nothing here moves this far [rad or m].
UNLIMITED = 1e30


def clean_xml(name: str, links: Iterable[LinkSpec], joints: Iterable[JointSpec]) -> str:
    """URDF without pictures, repairs applied, mimic rules kept, every number round-tripping."""
    lines = ['<?xml version="1.0"?>', f"<robot name={quoteattr(name)}>"]
    lines.extend(_link(link) for link in links)
    lines.extend(_joint(joint) for joint in joints)
    lines.append("</robot>\n")
    return "\n".join(lines)


def _link(link: LinkSpec) -> str:
    name = quoteattr(link.name)
    inertial = link.inertial
    if inertial is None or (inertial.mass == 0.0 and not inertial.inertia.any()):
        return f"  <link name={name}/>"
    moments = inertial.inertia
    inertia = " ".join(
        f'{key}="{_number(moments[i, j])}"'
        for key, i, j in (
            ("ixx", 0, 0), ("ixy", 0, 1), ("ixz", 0, 2),
            ("iyy", 1, 1), ("iyz", 1, 2), ("izz", 2, 2),
        )
    )  # fmt: skip
    return (
        f"  <link name={name}><inertial>{_origin(inertial.origin)}"
        f'<mass value="{_number(inertial.mass)}"/><inertia {inertia}/></inertial></link>'
    )


def _joint(joint: JointSpec) -> str:
    parts = [
        f'  <joint name={quoteattr(joint.name)} type="{joint.type}">',
        _origin(joint.origin),
        f"<parent link={quoteattr(joint.parent)}/><child link={quoteattr(joint.child)}/>",
    ]
    if joint.moves:
        parts.append(f'<axis xyz="{numbers(joint.axis)}"/>')
        lower = -UNLIMITED if joint.lower is None else joint.lower
        upper = UNLIMITED if joint.upper is None else joint.upper
        parts.append(
            f'<limit lower="{_number(lower)}" upper="{_number(upper)}" '
            f'effort="{_number(joint.effort or 0.0)}" velocity="{_number(joint.velocity or 0.0)}"/>'
        )
    if joint.mimic is not None:
        parts.append(
            f"<mimic joint={quoteattr(joint.mimic.joint)} "
            f'multiplier="{_number(joint.mimic.multiplier)}" '
            f'offset="{_number(joint.mimic.offset)}"/>'
        )
    parts.append("</joint>")
    return "".join(parts)


def _origin(T: Array) -> str:
    if np.array_equal(T, np.eye(4)):
        return ""
    rpy = rpy_from_rotation(T[:3, :3])
    return f'<origin xyz="{numbers(T[:3, 3])}" rpy="{numbers(rpy)}"/>'


def _number(value: float) -> str:
    return repr(float(value) + 0.0)  # no -0.0


def numbers(values: Array) -> str:
    """Numbers between blanks, each to its last digit."""
    return " ".join(_number(value) for value in values)
