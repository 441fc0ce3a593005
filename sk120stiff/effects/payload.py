"""A load on the tool that is not known well: its mass, and where its centre lies."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects.base import LoadError
from sk120stiff.effects.load_cases import LoadCases
from sk120stiff.effects.parameter import ParameterSpec
from sk120stiff.robot.rotations import crossed


@dataclass(frozen=True)
class Payload(LoadError):
    """A mass hangs on the tool beside what was stated; mass and first moments enter linearly."""

    name: ClassVar[str] = "payload"
    place: ClassVar[str] = "the tool frame"
    equation: ClassVar[str] = "W_true = W + (m g, (m c) x g)"
    says: ClassVar[str] = "The tool carries another mass, or carries it elsewhere, than stated."
    axes: ClassVar[str] = "axes of the tool frame, about the point where the payload hangs"
    needs: ClassVar[str] = "positions of an arm that yields under weight"
    only_absolute: ClassVar[bool] = True
    hangs: ClassVar[bool] = True

    @property
    def parameters(self) -> tuple[ParameterSpec, ...]:
        """Mass, and mass times the place of its centre."""
        mass = ParameterSpec(
            "mass", "kg", "kg", plausible=20.0 * self.scale**2, typical=1.0 * self.scale**2,
            meaning="true minus stated mass on the tool",
        )  # fmt: skip
        return (
            mass,
            *(
                ParameterSpec(
                    f"moment_{axis}", "kg*m", "kg*m",
                    plausible=5.0 * self.scale**3, typical=0.2 * self.scale**3,
                    meaning=f"mass times the place of its centre along {axis}, true minus stated",
                )
                for axis in "xyz"
            ),
        )  # fmt: skip

    @cached_property
    def generators(self) -> Array:
        """It does not depend on the reported load."""
        return np.zeros((4, 6, 6))

    def offsets(self, load_cases: LoadCases) -> Array:
        """Weight and moment of a unit of each parameter, tool axes, at the point of the force."""
        gravity = np.einsum("nji,j->ni", load_cases.rotation, load_cases.robot.gravity_in_base)
        out = np.zeros((load_cases.count, 6, 4))
        out[:, :3, 0] = gravity
        hung = (
            load_cases.force_point if load_cases.payload_point is None else load_cases.payload_point
        )
        out[:, 3:, 0] = np.cross(hung - load_cases.force_point, gravity)
        out[:, 3:, 1:] = -crossed(gravity)
        return out
