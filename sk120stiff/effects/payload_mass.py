"""One of several payloads weighs otherwise than its cells say."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, Self

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects.base import LoadError, scale_of
from sk120stiff.effects.load_cases import LoadCases
from sk120stiff.effects.options import Options
from sk120stiff.effects.parameter import ParameterSpec
from sk120stiff.robot import Robot

SAME = 1e-3  # share by which masses may differ that are one payload
OFF = 0.03  # usual share by which a payload is off that nobody weighed
FARTHEST = 0.5  # of what is stated
NAME = re.compile(r"mass_(\d+(?:\.\d+)?)")


def distinct(masses: Iterable[float]) -> tuple[float, ...]:
    """Payloads [kg] in ascending order; what differs by a rounding is one."""
    found: list[float] = []
    for mass in sorted(m for m in masses if m > 0.0):
        if not found or mass - found[-1] > SAME * mass:
            found.append(float(mass))
    return tuple(found)


@dataclass(frozen=True)
class PayloadMass(LoadError):
    """The payload of some rows is heavier or lighter than stated, and that of others is not.

    A plate was counted twice, or the hook was not. Other laws are that it is another of the masses.
    Where all payloads are off by one share, `link_masses` says so.

    Attributes:
        stated: What the cells say of it [kg].
        masses: Every payload of the readings [kg].
    """

    stated: float = 0.0
    masses: tuple[float, ...] = ()
    name: ClassVar[str] = "payload_mass"
    place: ClassVar[str] = "the tool frame"
    equation: ClassVar[str] = "W_true = W + (dm g, (dm c) x g) in rows of that payload"
    says: ClassVar[str] = (
        "One of the payloads weighs more or less than is stated, and the others do not."
    )
    advice: ClassVar[str] = "Weigh the payload, and write what it weighs into its rows."
    axes: ClassVar[str] = "where the payload hangs"
    also: ClassVar[str] = "mass_160: of the payload that is stated as 160 kg"
    needs: ClassVar[str] = "positions under two payloads or more that differ"
    only_absolute: ClassVar[bool] = True
    hangs: ClassVar[bool] = True
    rare: ClassVar[bool] = True

    @classmethod
    def at(cls, robot: Robot, where: str, options: Options) -> PayloadMass:
        """Of the payload that a parameter's name tells, or of the heaviest."""
        found = [match for name in options.shape if (match := NAME.fullmatch(name))]
        told = tuple(float(match[1]) for match in found) or options.masses
        return cls(where, scale_of(robot), max(told, default=0.0), options.masses)

    @classmethod
    def sample(cls) -> Self:
        """As of a payload of 160 kg."""
        return cls(cls.place, stated=160.0)

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """How much heavier it is."""
        if not self.stated:
            return ()
        return (
            ParameterSpec(
                f"mass_{self.stated:g}", "kg", "kg",
                plausible=FARTHEST * self.stated, typical=OFF * self.stated,
                meaning=f"true minus stated mass of the payload that is stated as {self.stated:g} "
                "kg",
            ),
        )  # fmt: skip

    def told(self, values: Mapping[str, float]) -> str:
        """Which payload it is, and what it weighs."""
        off = values.get(f"mass_{self.stated:g}")
        if off is None:
            return self.sentence()
        return (
            f"The payload that is stated as {self.stated:g} kg weighs {self.stated + off:.4g} kg; "
            "the others weigh what is stated."
        )

    def other_laws(self, load_cases: LoadCases) -> tuple[PayloadMass, ...]:
        """It is another of the payloads."""
        others = (mass for mass in self.masses if mass != self.stated)
        return tuple(PayloadMass(self.where, self.scale, mass, self.masses) for mass in others)

    def applies_to(self, load_cases: LoadCases) -> bool:
        """Of one payload alone nothing but the weight of the arm tells how heavy it is."""
        several = len(self.masses) > 1 or not self.masses  # of a file, which names one of them
        return super().applies_to(load_cases) and several

    @cached_property
    def generators(self) -> Array:
        """It does not depend on the reported load."""
        return np.zeros((1, 6, 6))

    def offsets(self, load_cases: LoadCases) -> Array:
        """Weight of one kilogram more where it hangs, tool axes, at the point of the force."""
        out = np.zeros((load_cases.count, 6, 1))
        if load_cases.payload is None or load_cases.payload_point is None:
            return out
        hangs = np.abs(load_cases.payload - self.stated) <= 2.0 * SAME * self.stated
        gravity = np.einsum("nji,j->ni", load_cases.rotation, load_cases.robot.gravity_in_base)
        weight = gravity * hangs[:, None]
        out[:, :3, 0] = weight
        out[:, 3:, 0] = np.cross(load_cases.payload_point - load_cases.force_point, weight)
        return out
