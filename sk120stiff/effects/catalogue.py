"""The list of all effects. A new effect is one file beside this one and one line here."""

from __future__ import annotations

from collections.abc import Sequence
from difflib import get_close_matches

from sk120stiff.effects.base import Effect, Options
from sk120stiff.effects.closure import ClosureCoupling, ClosureRod
from sk120stiff.effects.force_sensor import ForceBias, ForceCrosstalk, ForceRotation, ForceScale
from sk120stiff.effects.foundation import BaseRocking, BaseSliding
from sk120stiff.effects.gear import FrictionHysteresis, GearHardening, LostMotion
from sk120stiff.effects.geometry import JointOffset, LinkLength, ToolOffset
from sk120stiff.effects.gravity_compensator import GravityCompensator
from sk120stiff.effects.joint_springs import JointSprings
from sk120stiff.effects.joint_tilt import JointTilt
from sk120stiff.effects.link_beam import LinkBending, LinkTorsion
from sk120stiff.effects.tool_compliance import ToolCompliance
from sk120stiff.effects.tracker import ReadingDrift, ReadingRotation, ReadingScale, ZeroOffset
from sk120stiff.errors import InputError
from sk120stiff.robot import Robot

CATALOGUE: tuple[type[Effect], ...] = (
    JointSprings,
    JointTilt,
    LinkBending,
    LinkTorsion,
    BaseRocking,
    BaseSliding,
    ToolCompliance,
    ClosureCoupling,
    ClosureRod,
    GearHardening,
    LostMotion,
    FrictionHysteresis,
    GravityCompensator,
    ForceScale,
    ForceBias,
    ForceRotation,
    ForceCrosstalk,
    ReadingRotation,
    ReadingScale,
    ReadingDrift,
    ZeroOffset,
    JointOffset,
    ToolOffset,
    LinkLength,
)

BY_NAME: dict[str, type[Effect]] = {effect.name: effect for effect in CATALOGUE}


def effect(
    robot: Robot,
    name: str,
    where: str | None = None,
    *,
    poses: Sequence[str] = (),
    timed: bool = False,
    breaks: Sequence[float] = (),
) -> Effect:
    """One effect at one place of a robot.

    Parameters
    ----------
    robot
        The robot that it acts on.
    name
        Public identifier, e.g. ``"base_rocking"``.
    where
        Joint, link or instrument; may be left out where there is only one.
    poses
        Poses of the experiment, for `zero_offset`.
    timed
        The experiment has times, for `reading_drift`.
    breaks
        Torques [N·m] at which a gear changes its stiffness, for `gear_hardening`.

    Raises
    ------
    InputError
        No such effect, or it cannot act there; what exists is listed.
    """
    if name not in BY_NAME:
        raise unknown_effect(name)
    kind = BY_NAME[name]
    places = kind.places(robot)
    if where is None and len(places) == 1:
        where = places[0]
    if where not in places:
        raise InputError(
            f"the effect {name!r} cannot act at {where!r} on {robot.name}",
            remedy=f"It acts at: {', '.join(places) or 'no place of this robot'}.",
        )
    return kind.at(robot, where, Options(tuple(poses), timed, tuple(breaks)))


def unknown_effect(name: str) -> InputError:
    """What to say of a name that is no effect's."""
    close = get_close_matches(name, BY_NAME, n=1)
    hint = f" (did you mean {close[0]!r}?)" if close else ""
    return InputError(
        f"there is no effect {name!r}{hint}", remedy=f"Effects are: {', '.join(BY_NAME)}."
    )


def all_effects(
    robot: Robot, *, poses: Sequence[str] = (), timed: bool = False
) -> tuple[Effect, ...]:
    """Every effect of the catalogue at every place of a robot where it can act."""
    return tuple(
        effect(robot, kind.name, where, poses=poses, timed=timed)
        for kind in CATALOGUE
        for where in kind.places(robot)
    )
