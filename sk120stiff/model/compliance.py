"""A model as something that yields: what stiffness under load asks of it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from sk120stiff.arrays import Array, Index
from sk120stiff.effects import Elastic, Geometric, LinearElastic, LoadCases, load_case
from sk120stiff.errors import InputError, warn
from sk120stiff.model.model import Model
from sk120stiff.robot import Mechanism, Robot
from sk120stiff.stiffness import ConstantCompliance, ElasticLaw, Weight, symmetric_part
from sk120stiff.stiffness.kernel.folding import Fold, fold

PROBES = 16  # random poses at which the compliance is compared
MARKER = "tool_offset"  # the effect that is where a marker sits


@dataclass(frozen=True, eq=False)
class ModelCompliance:
    """`Compliant` made of a model's effects, with every law that they have.

    Attributes:
        model: Robot and elastic or geometric effects, its tool frame that of the point.
        point: (3,) in the tool frame [m].
    """

    model: Model
    point: Array

    @property
    def mechanism(self) -> Mechanism:
        """See `Compliant`."""
        return self.model.assembly.mechanism

    @cached_property
    def soft(self) -> Index:
        """See `Compliant`."""
        return self.model.assembly.soft(self.model.values)

    @cached_property
    def fold(self) -> Fold | None:
        """See `Compliant`."""
        if self.constant is not None:
            return self.constant.fold
        weight = self.weight_at(self.model.robot.rest[None])
        gravity = None if weight is None else weight.gravity
        return fold(self.mechanism, self.soft, None, self.point, np.zeros(0), gravity)

    @cached_property
    def constant(self) -> ConstantCompliance | None:
        """The same with constant springs; None where they change with the pose.

        Under small loads, that is: what a gear does beyond is not asked.
        """
        robot = self.model.robot
        poses = probing_poses(robot)
        C = self.compliance_at(poses)
        weight = self.weight_at(poses)
        alike = [C] if weight is None else [C, weight.compliance]
        first = C.reshape(-1, *C.shape[-2:])[0]
        if not all(np.allclose(each, first, rtol=1e-12, atol=0.0) for each in alike):
            return None
        shift = self.start(poses[:1])[0]
        shift[: robot.n] -= poses[0]
        gravity = None if weight is None else weight.gravity
        return ConstantCompliance(self.mechanism, first, self.point, shift, gravity)

    @property
    def curved(self) -> tuple[str, ...]:
        """Effects that do not yield in proportion to the load; where none, `constant` is all."""
        parts = zip(self.model.effects, self.model.assembly.slices, strict=True)
        return tuple(
            effect.id
            for effect, part in parts
            if isinstance(effect, Elastic)
            and not isinstance(effect, LinearElastic)
            and self.model.values[part].any()
        )

    def warn_of_small_loads(self) -> None:
        """Tell that a stiffness is the one under small loads, where that is not all there is.

        Warns:
            ToolkitWarning: Something does not yield in proportion to the load.
        """
        if self.curved:
            warn(
                f"not in proportion to the load: {', '.join(self.curved)}. A stiffness, and what "
                "it foretells, holds for small loads beside the arm's weight; 'predict', "
                "'compensate' and the equilibrium of 'stiffness' follow the whole law",
                stacklevel=3,
            )

    def start(self, a: Array) -> Array:
        """See `Compliant`."""
        return self.model.assembly.start(self._load_cases(a, np.zeros(6)), self.model.values)

    def compliance_at(self, a: Array) -> Array:
        """See `Compliant`."""
        law, _ = self._laws(a, np.zeros(6))
        return symmetric_part(law(np.zeros((len(a), self.mechanism.n)))[1])

    def linear_at(self, a: Array) -> Array:
        """(n, n) or (N, n, n) compliance of what is linear, which is what yields to the weight."""
        return symmetric_part(self._laws(a, np.zeros(6))[1])

    def weight_at(self, a: Array) -> Weight | None:
        """See `Compliant`."""
        return self.model.assembly.weight(self._laws(a, np.zeros(6))[1], self.model.values)

    def law(self, a: Array, wrench: Array) -> ElasticLaw:
        """See `Compliant`."""
        return self._laws(a, wrench)[0]

    def _laws(self, a: Array, wrench: Array) -> tuple[ElasticLaw, Array]:
        """The law, and the compliance of what is linear and yields to the weight."""
        load_cases, values = self._load_cases(a, wrench), self.model.values
        z_0 = self.model.assembly.start(load_cases, values)
        onset = self.mechanism.screws(z_0, self.point).torques(load_cases.wrench)
        return self.model.assembly.law(load_cases, values, onset)

    def _load_cases(self, a: Array, wrench: Array) -> LoadCases:
        return load_case(self.model.robot, a, wrench, point=self.point)


def model_compliance(
    model: Model, frame: str | None = None, point: ArrayLike | None = None
) -> ModelCompliance:
    """The arm that a model describes, seen from a point of a frame; instruments have no say.

    Args:
        frame: Frame that carries the point; the tool frame by default.
        point: (3,) in that frame [m]; its origin by default.

    Raises:
        InputError: Nothing in the model yields under small loads, or there is no such frame.
    """
    physical, at = seen_from(model.physical(), frame, point)
    arm = ModelCompliance(physical, at)
    if not arm.compliance_at(physical.robot.rest[None]).any():
        raise InputError(
            "nothing in this model yields under small loads",
            where=model.robot.name,
            remedy="Give a model with joint_springs or another elastic effect.",
        )
    return arm


def seen_from(
    model: Model, frame: str | None = None, point: ArrayLike | None = None
) -> tuple[Model, Array]:
    """The model of the arm up to a frame, and a point of the frame in that arm's tool frame.

    By default the tool frame and the frame's origin.
    """
    robot = model.robot
    frame = frame or robot.tool_frame
    point = np.zeros(3) if point is None else np.asarray(point, dtype=float)
    if robot.mechanism(frame).chain.names == robot.mechanism().chain.names:
        at = robot.placement(robot.rest, frame, point)
        return model, (np.linalg.inv(robot.placement(robot.rest)) @ at)[:3, 3]
    return replace(model, robot=replace(robot, tool_frame=frame)), point


def without_marker(model: Model) -> Model:
    """The arm alone, `Model.physical`, without where on its tool the measured marker sat."""
    arm = model.physical()
    marks = {e for e in arm.effects if isinstance(e, Geometric) and e.of_marker}
    return replace(arm, parameters=tuple(p for p in arm.parameters if p.effect not in marks))


def marker_off(model: Model) -> float:
    """How far the measured marker was found off its stated place [m]; 0 where nobody looked."""
    return float(np.linalg.norm([p.internal for p in model.parameters if p.effect.name == MARKER]))


def probing_poses(robot: Robot) -> Array:
    """(PROBES, n) random poses within the limits, all loops closed [rad or m]."""
    lower = np.where(np.isfinite(robot.lower), robot.lower, -np.pi)
    upper = np.where(np.isfinite(robot.upper), robot.upper, np.pi)
    poses = np.random.default_rng(0).uniform(lower, upper, (PROBES, robot.n))
    poses[~robot.closes(poses)] = robot.rest
    return poses
