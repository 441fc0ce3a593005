"""The base on its foundation: it rocks about the axes of its mounting surface, and it slides."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects.askew import COUPLINGS, CROSS, cross_term, patterns_of_two, softest_way
from sk120stiff.effects.base import AxisByAxis, Effect
from sk120stiff.effects.form import Form
from sk120stiff.effects.lengths_in_names import MM, from_name, in_name
from sk120stiff.effects.load_cases import LoadCases
from sk120stiff.effects.nonlinear import ALSO, Nonlinear, StraightPart
from sk120stiff.effects.options import Options
from sk120stiff.effects.parameter import ParameterSpec, compliances
from sk120stiff.errors import InputError, listed, two_digits
from sk120stiff.robot import Robot, VirtualJoint
from sk120stiff.robot.rotations import homogeneous

BELOW = "_below_"
PEDESTALS = (0.4, 0.8, 1.6)  # m: heights of what arms stand on, where it is not told
LOWEST, REACH = 0.02, 2.5  # m: within which such a height is sought
POINT = re.compile(f"{MM}(?:_x_{MM}_y_{MM})?")  # what stands behind _below_
FINER = (0.75, 0.87, 1.15, 1.3)  # times such a height


@dataclass(frozen=True)
class BaseRocking(StraightPart):
    """The base turns about the x and y axes of the base frame through the foundation point.

    The base frame's z is the normal of the mounting surface, whether floor, wall or ceiling. Yaw
    about it is left out: where the first joint turns about that line, it is that joint's spring
    under another name. A foundation whose stiff direction lies askew has a cross term too; one that
    stands on a pedestal rocks about a point below.

    Attributes:
        askew: There is a cross term.
        below: Height of the foundation point over that about which the base rocks [m].
        beside: How far that lies along x and y of the base frame [m]; None: below the foundation
            point.
    """

    askew: bool = False
    below: float = 0.0
    beside: tuple[float, float] | None = None
    name: ClassVar[str] = "base_rocking"
    place: ClassVar[str] = "the base frame"
    equation: ClassVar[str] = "turn = moment / K, about x and about y"
    says: ClassVar[str] = "The base rocks on its foundation."
    axes: ClassVar[str] = (
        "axes of the base frame through the foundation point; z is the normal of the floor"
    )
    also: ClassVar[str] = (
        f"with {CROSS}, where the stiff direction lies askew of the axes; all three with {BELOW} "
        "and a number behind their names, as stiffness_x_below_800: about a point so many "
        "millimetres below, as on a pedestal, and stiffness_x_below_800_x_150_y_minus_100: about "
        f"one that lies beside, as on a vehicle; {ALSO}"
    )
    yields_under: ClassVar[str] = "tips the base"

    @classmethod
    def at(cls, robot: Robot, where: str, options: Options) -> Effect:
        """The foundation by the law that names of parameters tell.

        Raises:
            InputError: Names that tell of points at several heights.
        """
        found = super().at(robot, where, options)
        points = {name.partition(BELOW)[2] for name in options.shape} or {""}
        told = [POINT.fullmatch(each) for each in points - {""}]
        if len(points) > 1 or None in told:
            raise InputError(
                f"{where} rocks about one point, and parameters say {sorted(points)}",
                remedy=f"Write the same whole numbers of millimetres behind {BELOW} in all names, "
                "as 800, or 800_x_150_y_minus_100.",
            )
        if not isinstance(found, cls):
            return found
        found = replace(found, askew=any(name.startswith(CROSS) for name in options.shape))
        for point in filter(None, told):
            below, x, y = (None if each is None else from_name(each) for each in point.groups())
            beside = None if x is None or y is None else (x, y)
            found = replace(found, below=below or 0.0, beside=beside)
        return found

    def other_laws(self, load_cases: LoadCases) -> tuple[Effect, ...]:
        """With a cross term, about points below too, and out of proportion."""
        plain = BaseRocking(self.where, self.scale)
        laws = [plain, *(replace(plain, askew=True, below=h) for h in (0.0, *PEDESTALS))]
        straight = tuple(law for law in laws if law != self)
        return (*straight, *super(BaseRocking, plain).other_laws(load_cases))

    def nearby_laws(self, load_cases: LoadCases) -> tuple[Effect, ...]:
        """About points a little higher and lower."""
        if not self.below:
            return ()
        heights = {round(factor * self.below, 3) for factor in FINER} - {self.below, *PEDESTALS}
        return tuple(replace(self, below=h) for h in sorted(heights))

    @property
    def form(self) -> Form[Effect] | None:
        """See `Effect.form`: how far below it rocks, and how far beside the axis [m]."""
        if self.beside is not None:
            return Form((self.below, *self.beside), self._rocking_about, self._pivot)
        wider = replace(self, askew=True, beside=(0.0, 0.0))
        return Form((self.below,) if self.below else (), self._rocking_about, self._pivot, wider)

    def _rocking_about(self, at: Sequence[float]) -> BaseRocking:
        """The same about another point, to the millimetre."""
        below, *beside = (round(float(value), 3) + 0.0 for value in at)  # no minus zero
        if self.beside is None:
            return replace(self, below=float(np.clip(below, LOWEST, REACH)))
        return replace(
            self, below=float(np.clip(below, -REACH, REACH)), beside=(beside[0], beside[1])
        )

    def _pivot(self, std: Sequence[float]) -> str:
        if not len(std):
            return ""
        numbers = zip((self.below, *(self.beside or ())), std, strict=True)
        where = [f"{value:.3f} ± {two_digits(error)} m" for value, error in numbers]
        aside = "" if self.beside is None else f", at x = {where[1]} and y = {where[2]}"
        return (
            f"{self.id}: the point about which the base rocks lies {where[0]} below{aside}; errors "
            "and intervals hold that."
        )

    def told(self, values: Mapping[str, float]) -> str:
        """See `Effect.told`: about which axis it is softest, and about which point."""
        way = softest_way([*values.values()], "x", "y") if self.askew else ""
        about = [f"{self.below:.2g} m below"] if self.below else []
        if self.beside is not None:
            about += [
                f"{value:.2g} m along {axis}" for axis, value in zip("xy", self.beside, strict=True)
            ]
        point = f" about a point {listed(about)}" if about else ""
        return f"The base rocks on its foundation{point}{f': {way}' if way else ''}."

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Rocking stiffness about x and about y, and what couples the two.

        Softest is a base on wheels, that the arm's own weight does not quite tip over.
        """
        own = compliances(
            "xy", "stiffness_{}" + self._end, softest=1e4, customary=3e5, typical=1e7,
            scale=self.scale, meaning="against rocking about {} of the base frame",
        )  # fmt: skip
        cross = cross_term(self.scale, "x", "y", self._end, softest=2e4)
        return (*own, cross) if self.askew else own

    @property
    def ties(self) -> tuple[tuple[int, ...], ...]:
        """Often as stiff about one axis as about the other."""
        return ((0, 1),)

    @property
    def _end(self) -> str:
        if self.beside is None:
            return f"{BELOW}{in_name(self.below)}" if self.below else ""
        below, x, y = map(in_name, (self.below, *self.beside))
        return f"{BELOW}{below}_x_{x}_y_{y}"

    @property
    def couplings(self) -> tuple[tuple[int, int, int], ...]:
        """What turns about x under a moment about y, and the other way round."""
        return COUPLINGS if self.askew else ()

    def virtual_joints(self, robot: Robot) -> tuple[VirtualJoint, ...]:
        """Two joints before all others."""
        at = homogeneous(robot.foundation + np.array([*(self.beside or (0.0, 0.0)), -self.below]))
        return tuple(
            VirtualJoint(f"{self.id}.{label}{self._end}", -1, at, np.eye(3)[k])
            for k, label in enumerate("xy")
        )

    def patterns(self, load_cases: LoadCases) -> Array:
        """Each axis has a compliance of its own; the cross term couples them."""
        return patterns_of_two(self.askew)


class NonlinearRocking(Nonlinear):
    """The foundation gives way more and more, one way only, or stiffens as it is loaded."""

    says: ClassVar[str] = "The base rocks on its foundation, not in proportion to the moment."
    straight: ClassVar[type[StraightPart]] = BaseRocking


@dataclass(frozen=True)
class BaseSliding(AxisByAxis):
    """The base shifts along the axes of the base frame."""

    name: ClassVar[str] = "base_sliding"
    place: ClassVar[str] = "the base frame"
    equation: ClassVar[str] = "shift = force / K, along x, y and z"
    says: ClassVar[str] = "The base shifts on its foundation under the load."
    axes: ClassVar[str] = "axes of the base frame"
    yields_under: ClassVar[str] = "pushes the base"

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Stiffness against shifting along x, y and z."""
        return compliances(
            "xyz", "stiffness_{}", softest=1e5, customary=2e6, typical=7e7, scale=self.scale,
            unit="N/m", meaning="against shifting along {} of the base frame",
        )  # fmt: skip

    @property
    def ties(self) -> tuple[tuple[int, ...], ...]:
        """Often as stiff along one axis as along the others."""
        return ((0, 1, 2),)

    def virtual_joints(self, robot: Robot) -> tuple[VirtualJoint, ...]:
        """Three slides before all other joints."""
        return tuple(
            VirtualJoint(f"{self.id}.{label}", -1, np.eye(4), np.eye(3)[k], revolute=False)
            for k, label in enumerate("xyz")
        )
