"""What yields in a scene, and what its pages have to say about it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.robot import Mechanism
from sk120stiff.stiffness import ConstantCompliance

if TYPE_CHECKING:
    from sk120stiff.model import Model, ModelCompliance

ASSUMED = "springs assumed: typical of an arm of this size, not measured"


@dataclass(frozen=True, eq=False)
class Elastic:
    """An elastic arm, as far as a picture needs it.

    Attributes:
        arm: What yields; its point is that of each request.
        label: Where the values come from, in a few words.
        assumed: True if the values are only assumed: every page then says so.
    """

    arm: ConstantCompliance | ModelCompliance
    label: str
    assumed: bool = False

    @property
    def mechanism(self) -> Mechanism:
        """Chain and coupling from the base frame to the frame of the point."""
        return self.arm.mechanism

    def at(self, point: Array) -> ConstantCompliance | ModelCompliance:
        """What yields, seen from a point (3,) of its end frame [m]."""
        return replace(self.arm, point=np.asarray(point, dtype=float))

    def joint_values(self, z: Array) -> Array:
        """(m + v,) values of all joints of the robot, then of the virtual ones, for z (n,)."""
        coupling = self.mechanism.elastic or self.mechanism.coupling
        return coupling.motion(z).q

    @classmethod
    def of_model(cls, model: Model, *, label: str = "") -> Elastic:
        """A model's arm, without its instruments.

        Args:
            label: Where the values come from; the effects' names by default.

        Raises:
            InputError: Nothing in the model yields.
        """
        from sk120stiff.model import model_compliance, typical_parameters

        arm = model_compliance(model)
        assumed = bool(typical_parameters(arm.model))
        names = ", ".join(dict.fromkeys(effect.name for effect in arm.model.effects))
        simple = None if arm.curved else arm.constant
        return cls(simple or arm, label or (ASSUMED if assumed else f"model of {names}"), assumed)
