"""What yields in a scene, and what its pages have to say about it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError
from sk120stiff.robot import Mechanism, Robot
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
    def of_springs(
        cls,
        robot: Robot,
        springs: ArrayLike | Mapping[str, float],
        *,
        frame: str | None = None,
        label: str = "joint springs",
    ) -> Elastic:
        """Independent springs at the actuated joints.

        Args:
            springs: (n,) stiffness [N·m/rad or N/m], infinite where a joint is rigid; or joint name
                → stiffness, every other joint rigid.
            frame: Frame that carries the point; the tool frame else.

        Raises:
            InputError: Another number of springs, an unknown joint, or a stiffness that is not
                above zero.
        """
        if isinstance(springs, Mapping):
            unknown = sorted(set(springs) - set(robot.actuated))
            if unknown:
                raise InputError(
                    f"there is no actuated joint {unknown[0]!r}",
                    remedy=f"Actuated joints are: {', '.join(robot.actuated)}.",
                )
            values = np.array([springs.get(name, np.inf) for name in robot.actuated])
        else:
            values = np.asarray(springs, dtype=float)
        if values.shape != (robot.n,):
            raise InputError(f"{values.size} springs given for {robot.n} actuated joints")
        if not (values > 0.0).all():
            raise InputError("a joint spring must be above zero", where=label)
        arm = ConstantCompliance(
            robot.mechanism(frame), np.diag(1.0 / values), gravity=robot.gravity_in_base
        )
        return cls(arm, label)

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
