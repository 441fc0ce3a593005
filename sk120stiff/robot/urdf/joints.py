"""`<joint>` elements: type, placement, axis, limits, and what had to be locked or repaired."""

from __future__ import annotations

import numpy as np
from lxml.etree import _Element as Element

from sk120stiff.arrays import Array
from sk120stiff.robot.urdf.document import MOVING, JointSpec, Mimic
from sk120stiff.robot.urdf.fields import Fields
from sk120stiff.robot.urdf.findings import Notebook, at, shown
from sk120stiff.robot.urdf.links import LONGEST_NAME, read_name

# Joints with several degrees of freedom: present, but held still.
_LOCKED_TYPES = {"floating": 6, "planar": 3, "spherical": 3, "ball": 3, "universal": 2}
_KNOWN = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")
_TURN = 2.0 * np.pi


def read_joint(element: Element, notes: Notebook) -> tuple[JointSpec, str | None]:
    """One joint after repairs, and why it was locked (None: it was not).

    Raises:
        InputError: No name, no or unknown type, no parent or child, or something that is no number.
    """
    name = read_name(element, notes)
    fields = Fields(notes, "joint", name)
    source_type = _type(element, fields)
    parent, child = (_end(element, tag, fields) for tag in ("parent", "child"))
    kind, locked = source_type, None
    if source_type in _LOCKED_TYPES:
        freedoms = _LOCKED_TYPES[source_type]
        kind, locked = "fixed", f"it is {source_type}, with {freedoms} degrees of freedom"
    origin = fields.placement(element)
    axis = np.array([1.0, 0.0, 0.0])
    if kind in MOVING:
        stated = _axis(element, fields, kind)
        if stated is None:
            kind, locked = "fixed", "its axis is zero"
        else:
            axis = stated
    if locked is not None:
        fields.warn("joint_locked", element, f"held still at zero because {locked}")
    lower = upper = effort = velocity = None
    if kind in MOVING:
        lower, upper, effort, velocity = _limits(element, fields, kind)
    mimic = _mimic(element, fields)
    if mimic is not None and kind not in MOVING:
        fields.warn("mimic_ignored", element, "the joint does not move; its <mimic> was ignored")
        mimic = None
    joint = JointSpec(
        name, kind, source_type, parent, child, origin, axis,
        lower, upper, effort, velocity, mimic, element.sourceline,
    )  # fmt: skip
    return joint, locked


def _type(element: Element, fields: Fields) -> str:
    raw = element.get("type") or ""
    kind = raw.strip().lower()
    if kind not in _KNOWN and kind not in _LOCKED_TYPES:
        fields.notes.refuse(
            f"the joint type {shown(raw)} is unknown" if kind else "the joint has no type",
            where=fields.place(element),
            remedy=f"Types are: {', '.join(_KNOWN)}.",
        )
    if kind != raw:
        fields.warn("joint_type_spelling", element, f"type {shown(raw)} read as {kind!r}")
    return kind


def _end(element: Element, tag: str, fields: Fields) -> str:
    """Name of the parent or child link."""
    ends = element.findall(tag)
    name = (ends[0].get("link") or "").strip() if ends else ""
    if not name:
        fields.notes.refuse(
            f"the joint names no {tag} link",
            where=fields.place(element),
            remedy=f'Add <{tag} link="..."/>.',
        )
    if len(name) > LONGEST_NAME:
        fields.notes.refuse(
            f"the name of its {tag} link has {len(name)} characters",
            where=fields.place(element),
            remedy=f"Use at most {LONGEST_NAME} characters.",
        )
    if len(ends) > 1:
        fields.notes.refuse(
            f"the joint has {len(ends)} <{tag}> elements",
            where=fields.place(ends[1]),
            remedy="A joint has one parent and one child.",
        )
    return name


def _axis(element: Element, fields: Fields, kind: str) -> Array | None:
    """(3,) unit axis; None when the stated one is zero."""
    stated = element.find("axis")
    xyz = fields.vector(stated, "xyz") if stated is not None else None
    if xyz is None:
        note = f"{kind} joint without <axis>; the standard says 1 0 0"
        fields.warn("axis_missing", element, note)
        return np.array([1.0, 0.0, 0.0])
    length = float(np.max(np.abs(xyz)))
    if length < 1e-9:
        return None
    length *= float(np.linalg.norm(xyz / length))
    if abs(length - 1.0) > 1e-3:
        assert stated is not None  # noqa: S101 - xyz came from it
        fields.warn("axis_not_unit", stated, f"the axis has length {length:.6g}; it was normalised")
    return xyz / length


def _limits(
    element: Element, fields: Fields, kind: str
) -> tuple[float | None, float | None, float | None, float | None]:
    limit = element.find("limit")
    if limit is None:
        if kind != "continuous":
            note = f"{kind} joint without <limit>; taken as unlimited"
            fields.warn("limit_missing", element, note)
        return None, None, None, None
    lower, upper = fields.bound(limit, "lower"), fields.bound(limit, "upper")
    effort, velocity = (_positive(limit, key, fields) for key in ("effort", "velocity"))
    if kind == "continuous":
        if lower is not None and upper is not None and 0.0 < upper - lower < _TURN - 0.1:
            note = "a continuous joint has no limits; they were ignored"
            fields.warn("limit_ignored", limit, note)
        return None, None, effort, velocity
    if lower is None or upper is None:
        absent = " and ".join(k for k, v in (("lower", lower), ("upper", upper)) if v is None)
        fields.warn("limit_missing", limit, f"<limit> without {absent}; taken as unlimited there")
    elif lower >= upper:
        fields.warn("limit_empty", limit, f"lower {lower:g} ≥ upper {upper:g}; taken as unlimited")
        return None, None, effort, velocity
    return lower, upper, effort, velocity


def _positive(limit: Element, key: str, fields: Fields) -> float | None:
    value = fields.bound(limit, key)
    if value is None:
        if key not in limit.attrib:
            fields.warn("limit_missing", limit, f"<limit> without {key}; taken as not stated")
        return None
    if value < 0.0:
        fields.warn(f"{key}_negative", limit, f"{key} {value:g} is negative; taken as not stated")
        return None
    return value


def _mimic(element: Element, fields: Fields) -> Mimic | None:
    mimics = element.findall("mimic")
    if not mimics:
        return None
    mimic = mimics[0]
    if len(mimics) > 1:
        fields.notes.refuse(
            "the joint has several <mimic> elements",
            where=fields.place(mimics[1]),
            remedy="A joint can follow one other joint; keep one <mimic>.",
        )
    target = (mimic.get("joint") or "").strip()
    if not target:
        fields.notes.refuse(
            "<mimic> names no joint",
            where=fields.place(mimic),
            remedy='Write <mimic joint="..."/> with the joint to follow.',
        )
    multiplier = fields.number(mimic, "multiplier")
    offset = fields.number(mimic, "offset") or 0.0
    return Mimic(target, 1.0 if multiplier is None else multiplier, offset)


def same_names(elements: list[tuple[str, int]], kind: str, notes: Notebook) -> None:
    """Refuse two elements of one kind with the same name.

    Raises:
        InputError: Names both lines.
    """
    lines: dict[str, int] = {}
    for name, line in elements:
        if name in lines:
            notes.refuse(
                f"there are two {kind}s of this name, the first in line {lines[name]}",
                where=at(line, kind, name),
                remedy=f"Rename one {kind}, or delete it if it was copied by mistake.",
            )
        lines[name] = line
