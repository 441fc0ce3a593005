"""A bearing tilts about the axes normal to its joint axis."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects.askew import COUPLINGS, CROSS, cross_term, patterns_of_two, softest_way
from sk120stiff.effects.base import Effect
from sk120stiff.effects.load_cases import LoadCases
from sk120stiff.effects.nonlinear import ALSO, Nonlinear, StraightPart
from sk120stiff.effects.options import Options
from sk120stiff.effects.parameter import ParameterSpec, compliance
from sk120stiff.errors import InputError
from sk120stiff.robot import Robot, VirtualJoint
from sk120stiff.robot.anatomy import arm_joint, arm_length, carrier_of, free_joints
from sk120stiff.robot.rotations import homogeneous

HOUSING = "_of_housing"
ROLL = "stiffness_about"
CLEAR = 0.1  # of the arm's length: heights over the foundation from which on the two differ


@dataclass(frozen=True)
class JointTilt(StraightPart):
    """Two virtual joints at the bearing: along a link and across it, normal to the joint axis.

    What is softer one way than the other may be the part that the joint moves, or the housing on
    the link before it: the soft direction then does not turn with the joint. The bearing of a joint
    that slides is its carriage, which may roll about its rail, too.

    Attributes:
        askew: The stiff direction lies askew of the axes.
        housing: So it does, and the axes are those of the link that carries the joint, not of the
            one that it moves.
        rolls: A carriage turns about its rail, too.
    """

    askew: bool = False
    housing: bool = False
    rolls: bool = False
    name: ClassVar[str] = "joint_tilt"
    place: ClassVar[str] = "a joint"
    equation: ClassVar[str] = "tilt = moment / K, about each of two axes"
    says: ClassVar[str] = "The bearing of {where} tilts about the axes normal to its joint axis."
    axes: ClassVar[str] = (
        "axes through the joint, normal to its own: along the link that it carries, and across it"
    )
    also: ClassVar[str] = (
        f"with {CROSS}, where the stiff direction lies askew of the axes; all three with "
        f"{HOUSING} behind their names, about the axes along and across the link on which the "
        f"joint sits, which do not turn with it; with {ROLL}, where a carriage rolls about its "
        f"rail; {ALSO}"
    )
    yields_under: ClassVar[str] = "{where} carries across its axis"

    @classmethod
    def at(cls, robot: Robot, where: str, options: Options) -> Effect:
        """The bearing, by the law that names of parameters tell.

        Raises:
            InputError: A joint that turns is said to roll: that is its spring.
        """
        housing = any(name.endswith(HOUSING) for name in options.shape)
        askew, rolls = housing or CROSS in options.shape, ROLL in options.shape
        if rolls and arm_joint(robot, where).revolute:
            raise InputError(
                f"{where} does not slide: what turns about its axis is its spring",
                remedy=f"Leave {ROLL} out; joint_springs holds it.",
            )
        found = super().at(robot, where, options)
        if not isinstance(found, cls):
            return found
        return replace(found, askew=askew, housing=housing, rolls=rolls)

    def other_laws(self, load_cases: LoadCases) -> tuple[Effect, ...]:
        """Askew of the axes, by those of the housing, and out of proportion.

        A housing on the base, near the point about which the base rocks, is the base that rocks.
        """
        robot, plain = load_cases.robot, JointTilt(self.where, self.scale)
        joint, carrier = arm_joint(robot, self.where), carrier_of(robot, self.where)
        height = float(np.linalg.norm(joint.placement[:3, 3] - robot.foundation))
        laws = [plain, replace(plain, askew=True)]
        if not joint.revolute:
            laws.append(replace(plain, rolls=True))
        elif carrier is not None or height > CLEAR * arm_length(robot):
            laws.append(replace(plain, askew=True, housing=True))
        straight = tuple(law for law in laws if law != self)
        return (*straight, *super(JointTilt, plain).other_laws(load_cases))

    def told(self, values: Mapping[str, float]) -> str:
        """See `Effect.told`: about which axis it is softest, and whether that turns with it."""
        if self.rolls:
            return f"The carriage of {self.where} tilts and rolls on its rail."
        if not self.askew:
            return self.sentence()
        link = "the link that carries it (of x on the base)" if self.housing else "its link"
        way = softest_way([*values.values()], f"the direction of {link}", "the one across")
        turns = ", whatever the joint's angle" if self.housing else ""
        return f"The bearing of {self.where} tilts{f': {way}{turns}' if way else ''}."

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Tilt stiffness about the link's direction and across it, and what couples the two."""
        end, link = (HOUSING, "link that carries the joint") if self.housing else ("", "link")
        along, across = f"the direction of the {link}", f"the axis across {link} and joint axis"
        own = [
            _tilt(f"stiffness_{label}{end}", self.scale, f"against tilting about {axis}")
            for label, axis in (("along", along), ("across", across))
        ]
        if self.rolls:
            about = "against rolling about the axis along which the joint slides"
            own.append(_tilt(ROLL, self.scale, about))
        return (*own, *([cross_term(self.scale, along, across, end)] if self.askew else []))

    @property
    def ties(self) -> tuple[tuple[int, ...], ...]:
        """Often as stiff about one axis as about the other."""
        return ((0, 1),)

    @property
    def couplings(self) -> tuple[tuple[int, int, int], ...]:
        """What tilts about one axis under a moment about the other."""
        return COUPLINGS if self.askew else ()

    @classmethod
    def places(cls, robot: Robot) -> tuple[str, ...]:
        """Every joint on the way to the tool that a motor drives or a closed loop determines."""
        return free_joints(robot)

    def virtual_joints(self, robot: Robot) -> tuple[VirtualJoint, ...]:
        """One joint for each tilt axis, at the joint's origin."""
        joint, carrier = arm_joint(robot, self.where), carrier_of(robot, self.where)
        end, index, at = "", joint.index, np.eye(4)
        axes: tuple[Array, ...] = joint.tilt_axes()
        if self.housing:
            end, index = HOUSING, -1 if carrier is None else carrier.index
            at, axes = homogeneous(joint.placement[:3, 3]), joint.tilt_axes_on(carrier)
        if self.rolls:
            axes = (*axes, joint.axis)
        return tuple(
            VirtualJoint(f"{self.id}.{label}{end}", index, at, axis)
            for label, axis in zip(("along", "across", "about"), axes, strict=False)
        )

    def patterns(self, load_cases: LoadCases) -> Array:
        """Each axis has a compliance of its own; the cross term couples them."""
        return super().patterns(load_cases) if self.rolls else patterns_of_two(self.askew)


def _tilt(name: str, scale: float, meaning: str) -> ParameterSpec:
    return compliance(name, softest=3e5, typical=1e7, scale=scale, meaning=meaning)


class NonlinearTilt(Nonlinear):
    """The bearing stiffens as more of it carries, or gives way one way only."""

    says: ClassVar[str] = (
        "The bearing of {where} tilts about the axes normal to its joint axis, not in proportion."
    )
    straight: ClassVar[type[StraightPart]] = JointTilt
