"""The fixture or sensor at the flange yields."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from sk120stiff.effects.base import Effect
from sk120stiff.effects.lengths_in_names import MM, from_name, in_name
from sk120stiff.effects.load_cases import LoadCases
from sk120stiff.effects.nonlinear import ALSO, Nonlinear, StraightPart
from sk120stiff.effects.options import Options
from sk120stiff.effects.parameter import ParameterSpec, compliances
from sk120stiff.errors import InputError
from sk120stiff.robot import Robot, VirtualJoint
from sk120stiff.robot.rotations import homogeneous

ABOUT = "_about_"
POINT = re.compile(f"{MM}_{MM}_{MM}")  # what stands behind _about_
ON_THE_WAY = (0.25, 0.5, 0.75)  # of the way to the point: half for a beam that is bent at its end
NEAR = 0.05  # m: a point nearer to the tool frame has no bracket between


@dataclass(frozen=True)
class ToolCompliance(StraightPart):
    """What is bolted to the flange turns about and shifts along the axes of the tool frame.

    Fixtures are rarely round, so every axis has a stiffness of its own. A bracket has its elastic
    centre on the way to its end: a force through that shifts it, and does not turn it.

    Attributes:
        about: The elastic centre in the tool frame [m]; None: its origin.
    """

    about: tuple[float, float, float] | None = None
    name: ClassVar[str] = "tool_compliance"
    place: ClassVar[str] = "the tool frame"
    equation: ClassVar[str] = "turn = moment / K and shift = force / K, axis by axis"
    says: ClassVar[str] = "The fixture at {where} yields between flange and measured point."
    axes: ClassVar[str] = "axes of the tool frame, at its origin"
    yields_under: ClassVar[str] = "the tool carries"
    also: ClassVar[str] = (
        f"all six with {ABOUT} and three numbers behind their names, as "
        "stiffness_turn_x_about_0_minus_20_225: about and along axes through a point at so many "
        f"millimetres along x, y and z of the tool frame; {ALSO}"
    )

    @classmethod
    def at(cls, robot: Robot, where: str, options: Options) -> Effect:
        """The fixture by the law that names of parameters tell.

        Raises:
            InputError: Names that tell of several points.
        """
        found = super().at(robot, where, options)
        points = {name.partition(ABOUT)[2] for name in options.shape} or {""}
        told = POINT.fullmatch(next(iter(points)))
        if points == {""} or not isinstance(found, cls):
            return found
        if len(points) > 1 or told is None:
            raise InputError(
                f"{where} yields about one point, and parameters say {sorted(points)}",
                remedy="Write the same whole numbers of millimetres behind _about_ in all names, "
                "as 0_minus_20_225.",
            )
        x, y, z = map(from_name, told.groups())
        return replace(found, about=(x, y, z))

    def laws_at_positions(self, load_cases: LoadCases) -> tuple[Effect, ...]:
        """About points on the way to where the loads act: turns that were read tell them apart."""
        point = np.reshape(load_cases.force_point, (-1, 3)).mean(axis=0)
        if np.linalg.norm(point) < NEAR:
            return ()
        plain = ToolCompliance(self.where, self.scale)
        centres = ((share * point).round(3) + 0.0 for share in ON_THE_WAY)
        laws = (plain, *(replace(plain, about=tuple(centre.tolist())) for centre in centres))
        return tuple(law for law in laws if law != self)

    @property
    def _end(self) -> str:
        if self.about is None:
            return ""
        return f"{ABOUT}{'_'.join(map(in_name, self.about))}"

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Stiffness against turning about x, y, z and against shifting along them.

        Softest is rubber, or a compliance device, that gives some millimetres under what the arm
        may carry.
        """
        turning = compliances(
            "xyz", "stiffness_turn_{}" + self._end, softest=1e2, customary=3e3, typical=2e5,
            scale=self.scale, meaning="against turning about {} of the tool frame",
        )  # fmt: skip
        shifting = compliances(
            "xyz", "stiffness_shift_{}" + self._end, softest=3e4, customary=2e6, typical=5e7,
            scale=self.scale, unit="N/m", meaning="against shifting along {} of the tool frame",
        )  # fmt: skip
        return (*turning, *shifting)

    @property
    def ties(self) -> tuple[tuple[int, ...], ...]:
        """Often as stiff against bending both ways, and against shifting all ways."""
        return ((0, 1), (3, 4, 5))

    def virtual_joints(self, robot: Robot) -> tuple[VirtualJoint, ...]:
        """Three turns and three slides at the tool frame, or at the elastic centre."""
        chain = robot.mechanism().chain
        placement = chain.placements[-1] @ homogeneous(np.array(self.about or np.zeros(3)))
        return tuple(
            VirtualJoint(
                f"{self.id}.{kind}_{label}{self._end}",
                chain.m - 1,
                placement,
                np.eye(3)[k],
                revolute=turns,
            )
            for kind, turns in (("turn", True), ("shift", False))
            for k, label in enumerate("xyz")
        )


class NonlinearTool(Nonlinear):
    """The fixture stiffens as it is pressed, or gives way one way only."""

    says: ClassVar[str] = (
        "The fixture at {where} yields between flange and measured point, not in proportion."
    )
    straight: ClassVar[type[StraightPart]] = ToolCompliance
