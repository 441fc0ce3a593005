"""What the tools of the workspace need of a model: plain arrays that can be sent anywhere."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from sk120stiff.arrays import Array, Mask
from sk120stiff.errors import InputError
from sk120stiff.model import Model, ModelCompliance, model_compliance, probing_poses
from sk120stiff.robot import LinearCoupling, Robot
from sk120stiff.stiffness import ConstantCompliance, UnderLoad, under_load
from sk120stiff.workspace.bending import ArmUncertainty, Bending, at_poses, bending, uncertainty_of

BENDING = ("jacobian", "K_C", "K_gravity", "deflection_enhanced")  # what `bending` needs


@dataclass(frozen=True, eq=False)
class Kinematics:
    """Placement of the point and Jacobian at N poses.

    Attributes:
        position, rotation: (N, 3) of the point and (N, 3, 3) of its frame [m].
        jacobian: (N, 6, n) by the actuated joints, [linear; angular], base axes.
    """

    position: Array
    rotation: Array
    jacobian: Array


@dataclass(frozen=True, eq=False)
class ElasticArm:
    """An arm with the stiffness that it has under small loads, seen from one point.

    Attributes:
        name, frame: Name of the robot, and of the frame that carries the point.
        joints: (n,) names of the actuated joints.
        slides: (n,) does the joint slide?
        lower, upper: (n,) joint limits [rad or m]; infinite where none are known.
        elastic: What yields: constant springs, or the model where they change with the pose.
        robot: Knows where closed loops open; None where there are none.
        uncertainty: How well the springs are known; None where nothing says so.
    """

    name: str
    frame: str
    joints: tuple[str, ...]
    slides: tuple[bool, ...]
    lower: Array
    upper: Array
    elastic: ConstantCompliance | ModelCompliance
    robot: Robot | None = None
    uncertainty: ArmUncertainty | None = None

    @property
    def n(self) -> int:
        """Number of actuated joints."""
        return len(self.joints)

    @property
    def compiled(self) -> bool:
        """Does the compiled kernel do it all? Else poses are several times slower."""
        return self.elastic.fold is not None and not self.elastic.fold.given

    @cached_property
    def _rigid(self) -> ConstantCompliance:
        mechanism, n = self.elastic.mechanism, self.elastic.mechanism.n
        shift = self.elastic.start(np.zeros((1, self.n)))[0]
        return ConstantCompliance(mechanism, np.eye(n), self.elastic.point, shift)

    def batch(
        self,
        a: ArrayLike,
        wrench: ArrayLike,
        want: Collection[str],
        *,
        threads: int | None = None,
    ) -> UnderLoad:
        """`under_load` of this arm at commanded coordinates (N, n)."""
        return under_load(self.elastic, a, wrench, want, threads=threads)

    def bending(self, a: Array, found: UnderLoad, loads: Array) -> tuple[Bending, ...]:
        """Deflections at (N, n) under loads (Q, 6), ± what the model knows of its uncertainty.

        Args:
            found: `batch` of the same with the quantities of `BENDING`.
        """
        C = self.elastic.compliance_at(a)[..., found.soft[:, None], found.soft]
        uncertainty = self.uncertainty
        if uncertainty is not None and isinstance(self.elastic, ModelCompliance):
            uncertainty = at_poses(uncertainty, self.elastic.model, a)
        return tuple(
            bending(
                found.of("jacobian"),
                C,
                K_C + found.of("K_gravity"),
                found.soft,
                deflection,
                load,
                uncertainty,
            )
            for K_C, deflection, load in zip(
                found.of("K_C"), found.of("deflection_enhanced"), loads, strict=True
            )
        )

    def kinematics(self, a: Array) -> Kinematics:
        """Where the point is before it sags, and how the actuated joints move it, at (N, n)."""
        found = under_load(self._rigid, a, np.zeros(6), ("position", "rotation", "jacobian"))
        return Kinematics(
            found.of("position"), found.of("rotation"), found.of("jacobian")[..., : self.n]
        )

    @property
    def has_loops(self) -> bool:
        """Do closed loops couple joints otherwise than linearly?"""
        coupling = self.elastic.mechanism.elastic or self.elastic.mechanism.coupling
        return not isinstance(coupling, LinearCoupling)

    def closes(self, a: Array) -> Mask:
        """(N,) can the closed loops be closed at coordinates (N, n)?"""
        if self.robot is None:
            return np.ones(len(a), dtype=bool)
        return np.asarray(self.robot.closes(a), dtype=bool)

    def within_limits(self, a: Array) -> Mask:
        """(N,) are all joints (N, n) within their limits?"""
        return np.asarray(((a >= self.lower) & (a <= self.upper)).all(axis=-1), dtype=bool)


def elastic_arm(
    model: Model, *, frame: str | None = None, point: ArrayLike | None = None
) -> ElasticArm:
    """The arm that a model describes, with its stiffness under small loads.

    Args:
        model: Robot and effects; instruments have no say here.
        frame: Frame that carries the point; the tool frame by default.
        point: (3,) in that frame [m]; its origin by default.

    Raises:
        InputError: Nothing in the model yields or moves the frame, or there is no such frame.

    Warns:
        ToolkitWarning: Something does not yield in proportion to the load.
    """
    model_arm = model_compliance(model, frame, point)
    model_arm.warn_of_small_loads()
    physical = model_arm.model
    robot = physical.robot
    if not model_arm.mechanism.chain.names:
        raise InputError(
            "no joint moves this frame, so nothing yields there",
            where=robot.tool_frame,
            remedy="Name a frame farther out.",
        )
    return ElasticArm(
        name=robot.name,
        frame=robot.tool_frame,
        joints=robot.actuated,
        slides=robot.prismatic,
        lower=robot.lower,
        upper=robot.upper,
        elastic=model_arm.constant or model_arm,
        robot=robot if robot.closures else None,
        uncertainty=uncertainty_of(physical, probing_poses(robot)),
    )
