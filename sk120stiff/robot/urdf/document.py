"""What a URDF says, as frozen data: the only thing the rest of the toolkit sees of the file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

from sk120stiff.arrays import Array
from sk120stiff.robot.rotations import joint_motion

MOVING = frozenset({"revolute", "continuous", "prismatic"})

BALLS = frozenset({"spherical", "ball", "universal"})

# Codes of findings that touch neither kinematics nor masses.
HARMLESS = frozenset(
    {
        "doctype", "duplicate_material", "encoding", "mesh_missing", "unknown_element",
        "unknown_geometry", "unknown_material", "visual_unreadable", "xacro_expanded",
    }
)  # fmt: skip


@dataclass(frozen=True)
class Finding:
    """Something suspicious or repaired that does not stop the work.

    Attributes:
        code: Stable identifier, e.g. ``limit_missing``.
        where: Line, joint, link or frame it was found at.
        message: What is odd, and what was done about it.
    """

    code: str
    where: str
    message: str

    def __str__(self) -> str:
        return f"{self.where}: {self.message} [{self.code}]" if self.where else self.message


class Mimic(NamedTuple):
    """A coupled joint: value = multiplier · value of `joint` + offset [rad or m]."""

    joint: str
    multiplier: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True, eq=False)
class JointSpec:
    """One joint, after repairs.

    Attributes:
        type: ``revolute``, ``continuous``, ``prismatic`` or ``fixed``. A joint that had to be
            locked is ``fixed`` here; `source_type` keeps what the file says.
        origin: (4, 4) T_parent_joint at joint value zero [m].
        axis: (3,) unit axis in the joint frame.
        lower, upper: Limits [rad or m], None where the file states none that can be used.
        effort, velocity: Largest effort [N·m or N] and speed [rad/s or m/s], None where not stated.
        line: Line of the element in the text that was parsed.
    """

    name: str
    type: str
    source_type: str
    parent: str
    child: str
    origin: Array
    axis: Array
    lower: float | None
    upper: float | None
    effort: float | None
    velocity: float | None
    mimic: Mimic | None
    line: int

    @property
    def moves(self) -> bool:
        """Has the joint a degree of freedom left?"""
        return self.type in MOVING

    def standing(self, value: float) -> Array:
        """(4, 4) its child's placement in its parent when it stands at `value` [rad or m]."""
        return self.origin @ joint_motion(self.axis, self.type != "prismatic", value)


@dataclass(frozen=True, eq=False)
class Inertial:
    """Mass [kg], (4, 4) placement of the inertia frame [m], (3, 3) inertia about it [kg·m²]."""

    mass: float
    origin: Array
    inertia: Array


@dataclass(frozen=True, eq=False)
class LinkSpec:
    """One link; `line` is 0 for a link that no element declares."""

    name: str
    inertial: Inertial | None
    line: int

    @property
    def mass(self) -> float:
        """Mass [kg]; zero where the file states none."""
        return self.inertial.mass if self.inertial is not None else 0.0


@dataclass(frozen=True, eq=False)
class GeometrySpec:
    """A shape as the file describes it.

    Attributes:
        kind: ``box``, ``cylinder``, ``sphere``, ``capsule`` or ``mesh``.
        size: box: x, y, z; cylinder and capsule: radius, length; sphere: radius; mesh: scale x, y,
            z. Metres, but for the scale.
        filename: As written in the file; meshes only.
    """

    kind: str
    size: tuple[float, ...]
    filename: str | None = None


@dataclass(frozen=True, eq=False)
class VisualSpec:
    """One `<visual>` or `<collision>` of a link.

    (4, 4) T_link_visual [m], shape, colour (r, g, b, a) or None.
    """

    link: str
    name: str
    origin: Array
    geometry: GeometrySpec
    rgba: tuple[float, float, float, float] | None
    line: int

    @property
    def place(self) -> str:
        """Where it stands in the file, as findings say it."""
        return f"line {self.line}, link {self.link!r}"


@dataclass(frozen=True, eq=False)
class UrdfDocument:
    """A robot description that is known to be one tree of links, joined by joints.

    Attributes:
        name: Name of the robot.
        xml: Clean kinematic URDF: one element per line, no visuals, no collisions, numbers that
            round-trip. Pinocchio reads this and never the user's file.
        text: The user's own words, a xacro expanded; see `document_tree`.
        path: The file that was read, None for text.
        package_folders: Folders in which ``package://`` addresses are looked up, first match wins.
        joints, links, visuals: In the order of the file; undeclared links last.
        collisions: Shapes for collision checks, in the order of the file.
        root: The only link without a parent.
        locked: Why each joint was locked that the file describes as moving.
        orphans: Mimic rules that name a joint which does not exist, by the joint that has the rule.
            It moves and follows nothing; beside the arm it is held still, on the arm it is refused.
        warnings: Repairs and oddities, in the order of the file.
    """

    name: str
    xml: str
    text: str
    path: Path | None
    package_folders: tuple[Path, ...]
    joints: tuple[JointSpec, ...]
    links: tuple[LinkSpec, ...]
    visuals: tuple[VisualSpec, ...]
    root: str
    collisions: tuple[VisualSpec, ...] = ()
    locked: Mapping[str, str] = field(default_factory=dict)
    orphans: Mapping[str, Mimic] = field(default_factory=dict)
    warnings: tuple[Finding, ...] = ()

    @property
    def moving_joints(self) -> tuple[JointSpec, ...]:
        """Joints with a degree of freedom, mimics included."""
        return tuple(joint for joint in self.joints if joint.moves)

    @cached_property
    def by_name(self) -> Mapping[str, JointSpec]:
        """The joints by their names."""
        return {joint.name: joint for joint in self.joints}

    @cached_property
    def above(self) -> Mapping[str, JointSpec]:
        """The joint that carries each link but the root."""
        return {joint.child: joint for joint in self.joints}

    @cached_property
    def below(self) -> Mapping[str, list[JointSpec]]:
        """The joints on each link that carries any, in the order of the file."""
        found: dict[str, list[JointSpec]] = {}
        for joint in self.joints:
            found.setdefault(joint.parent, []).append(joint)
        return found

    def way(self, base: str, tool: str) -> tuple[JointSpec, ...]:
        """Joints of any type from `base` outwards to `tool`; from the root if `base` is not met."""
        found: list[JointSpec] = []
        name = tool
        while name != base and name in self.above:
            found.append(self.above[name])
            name = found[-1].parent
        return tuple(reversed(found))

    @property
    def total_mass(self) -> float:
        """Sum of all link masses, the root's included [kg]."""
        return float(sum(link.mass for link in self.links))

    @property
    def place(self) -> str:
        """What to call this document in a message: its path, or its name."""
        return str(self.path) if self.path is not None else f"robot {self.name!r}"
