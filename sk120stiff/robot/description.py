"""`robot.yaml`: what a URDF cannot say about a robot arm."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

from pydantic import Field

from sk120stiff.files import Strict, read_yaml, validated


class CouplingRule(Strict):
    """value = multiplier · driver + offset, in rad or m."""

    driver: str
    multiplier: float = 1.0
    offset: float = 0.0


class Foundation(Strict):
    """The point about which the base rocks, in a frame that does not move against the base."""

    frame: str | None = None
    xyz: tuple[float, float, float]
    unit: Literal["m", "mm"] = "m"


class LinkageRule(Strict):
    """A driven rod of a closed linkage.

    `corners` are three frames whose origins are the crank's pivot, the joint of crank and rod, and
    the far end of the rod; `drivers` are the two actuated joints that the linkage ties together,
    the one that turns the crank last.
    """

    rod: str
    drivers: tuple[str, str]
    corners: tuple[str, str, str]


class ClosureRule(Strict):
    """A closed loop, which the tree of a URDF holds open: two frames that must coincide.

    `type` is ``point`` where their origins meet (a ball joint, or any pin of a planar linkage), or
    ``axis`` for a revolute pin, whose direction `axis`, stated in the axes of either frame, they
    share too. `dependent` names the joints that the loop determines; left out, these are all joints
    of the loop that are neither actuated nor locked. `start` gives values [rad or m] of joints near
    which the loop is closed the right way round; zero where it does not say.
    """

    frames: tuple[str, str]
    name: str | None = None
    type: Literal["point", "axis"] = "point"
    axis: tuple[float, float, float] = (0.0, 0.0, 1.0)
    dependent: tuple[str, ...] = ()
    start: dict[str, float] = Field(default_factory=dict)


class ControllerRule(Strict):
    """How the controller counts: its axes as linear expressions of the joints, and motor pulses.

    ``axes: {A1: -joint_1, A2: joint_2 - 90 deg}``; pulses per degree, per mm of a slide, in their
    order. Without the key the axes are the actuated joints. `frame` is the link in whose axes it
    states places; by default ``base``, where the URDF has it beside ``base_link``.
    """

    axes: dict[str, str] = Field(default_factory=dict)
    pulses_per_degree: tuple[float, ...] = ()
    frame: str | None = None


class RobotDescription(Strict):
    """The keys of `robot.yaml`; every one has a default."""

    name: str | None = None
    urdf: str = "robot.urdf"
    xacro: dict[str, str | bool | int | float] = Field(default_factory=dict)
    base_frame: str | None = None
    tool_frame: str | None = None
    actuated: tuple[str, ...] | None = None
    couplings: dict[str, CouplingRule] = Field(default_factory=dict)
    lock: dict[str, float] = Field(default_factory=dict)
    closures: tuple[ClosureRule, ...] = ()
    linkages: tuple[LinkageRule, ...] = ()
    foundation: Foundation | None = None
    controller: ControllerRule = Field(default_factory=ControllerRule)
    notes: str = ""


def xacro_value(value: str | bool | int | float) -> str:
    """A value of `robot.yaml` as xacro reads it: true and false in small letters."""
    return str(value).lower() if isinstance(value, bool) else str(value)


def read_description(path: Path) -> RobotDescription:
    """Read and check a `robot.yaml`.

    Raises:
        InputError: Not YAML, an unknown key, or a value of the wrong kind; file, line or key are
            named.
    """
    return validated(RobotDescription, read_yaml(path).content, str(path))
