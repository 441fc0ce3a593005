"""What the tools of the workspace need of a model: plain arrays that can be sent anywhere."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from sk120stiff.arrays import Array, Mask
from sk120stiff.effects import LinearElastic, situation_of_load
from sk120stiff.errors import InputError
from sk120stiff.model import Model
from sk120stiff.robot import LinearCoupling, Mechanism
from sk120stiff.stiffness import CLASSES, Definiteness, Weight, symmetric_part
from sk120stiff.stiffness.batch import StiffnessBatch, run_folded
from sk120stiff.stiffness.lanes.folding import Fold, fold
from sk120stiff.workspace.bending import Bending, Doubt, at_poses, bending, doubt_of
from sk120stiff.workspace.slow import slow_batch

PROBES = 16  # random poses at which the compliance is compared


@dataclass(frozen=True, eq=False)
class Kinematics:
    """Placement of the point and Jacobian at N poses.

    Attributes
    ----------
    position, rotation
        (N, 3) of the point and (N, 3, 3) of its frame [m].
    jacobian
        (N, 6, n) by the actuated joints, [linear; angular], base axes.
    """

    position: Array
    rotation: Array
    jacobian: Array


@dataclass(frozen=True, eq=False)
class ElasticArm:
    """An arm with the stiffness that it has under small loads, seen from one point.

    Attributes
    ----------
    name, frame
        Name of the robot, and of the frame that carries the point.
    joints
        (n,) names of the actuated joints.
    slides
        (n,) does the joint slide?
    lower, upper
        (n,) joint limits [rad or m]; infinite where none are known.
    mechanism
        Chain to the frame of the point, with the model's virtual joints.
    springs
        (n_z, n_z) stiffness of all coordinates [N·m/rad or N/m], infinite on the diagonal where
        rigid.
    shift
        (n_z,) by which the unloaded coordinates differ from the commanded ones [rad or m].
    point
        (3,) in the frame [m].
    weight
        Gravity and the compliance by which the arm sags; None where nothing weighs.
    slow
        The model, where the compiled kernel does not follow it: its compliance changes with the
        pose, is not positive in all directions, or a closed loop couples joints.
    doubt
        How well the springs are known; None where nothing says so.
    """

    name: str
    frame: str
    joints: tuple[str, ...]
    slides: tuple[bool, ...]
    lower: Array
    upper: Array
    mechanism: Mechanism
    springs: Array
    shift: Array
    point: Array
    weight: Weight | None = None
    slow: Model | None = None
    doubt: Doubt | None = None

    @property
    def n(self) -> int:
        """Number of actuated joints."""
        return len(self.joints)

    @cached_property
    def _folded(self) -> Fold:
        virtual = self.shift[self.n :]
        return fold(self.mechanism, self.springs, self.point, virtual, self.weight)

    @cached_property
    def _rigid(self) -> Fold | None:
        if not isinstance(self.mechanism.elastic or self.mechanism.coupling, LinearCoupling):
            return None
        unit = np.ones(self.mechanism.n)
        return fold(self.mechanism, unit, self.point, self.shift[self.n :])

    def batch(
        self,
        a: ArrayLike,
        wrench: ArrayLike,
        want: Collection[str],
        *,
        threads: int | None = None,
    ) -> StiffnessBatch:
        """`stiffness_batch` of this arm at commanded coordinates (N, n)."""
        poses = np.asarray(a, dtype=float)
        if self.slow is not None:
            return slow_batch(self.slow, poses, wrench, want, self.point)
        return run_folded(self._folded, poses + self.shift[: self.n], wrench, want, threads=threads)

    def bending(self, a: Array, found: StiffnessBatch, loads: Array) -> tuple[Bending, ...]:
        """Deflections at (N, n) under loads (Q, 6).

        Parameters
        ----------
        found
            `batch` of the same with ``jacobian``, ``K_C`` and ``stiffness_class``.
        """
        soft, doubt = found.soft, self.doubt
        if self.slow is None:
            C = np.asarray(np.linalg.inv(self.springs[np.ix_(soft, soft)]))
        else:
            rest = self.slow.solve(situation_of_load(self.slow.robot, a, np.zeros(6))).rest
            C = np.asarray(rest.compliance)[..., soft[:, None], soft]
            doubt = None if doubt is None else at_poses(doubt, self.slow, a)
        stable = found.of("stiffness_class") == CLASSES.index(Definiteness.POSITIVE_DEFINITE)
        return tuple(
            bending(found.of("jacobian"), C, K_C, soft, held, load, doubt)
            for K_C, held, load in zip(found.of("K_C"), stable, loads, strict=True)
        )

    def kinematics(self, a: Array) -> Kinematics:
        """Where the point is before it sags, and how the actuated joints move it, at (N, n)."""
        if self._rigid is None:
            z = np.concatenate([a, np.zeros((len(a), self.mechanism.n - self.n))], axis=1)
            screws = self.mechanism.screws(z + self.shift, self.point)
            return Kinematics(screws.position, screws.rotation, screws.jacobian[..., : self.n])
        want = ("position", "rotation", "jacobian")
        found = run_folded(self._rigid, a + self.shift[: self.n], np.zeros(6), want)
        return Kinematics(
            found.of("position"), found.of("rotation"), found.of("jacobian")[..., : self.n]
        )

    @property
    def has_loops(self) -> bool:
        """Do closed loops couple joints otherwise than linearly?"""
        return self._rigid is None

    def closes(self, a: Array) -> Mask:
        """(N,) can the closed loops be closed at coordinates (N, n)?"""
        if self.slow is None:
            return np.ones(len(a), dtype=bool)
        return np.asarray(self.slow.robot.closes(a), dtype=bool)

    def within_limits(self, a: Array) -> Mask:
        """(N,) are all joints (N, n) within their limits?"""
        return np.asarray(((a >= self.lower) & (a <= self.upper)).all(axis=-1), dtype=bool)


def elastic_arm(
    model: Model, *, frame: str | None = None, point: ArrayLike | None = None
) -> ElasticArm:
    """The arm that a model describes, with its stiffness under small loads.

    Parameters
    ----------
    model
        Robot and effects; instruments have no say here.
    frame
        Frame that carries the point; the tool frame by default.
    point
        (3,) in that frame [m]; its origin by default.

    Raises
    ------
    InputError
        Nothing in the model yields or moves the frame, or there is no such frame.
    """
    at = np.zeros(3) if point is None else np.asarray(point, dtype=float)
    if at.shape != (3,) or not np.isfinite(at).all():
        raise InputError("the point is not three finite numbers", remedy="Give x, y, z in metres.")
    physical, at = seen_from(model.physical(), frame or model.robot.tool_frame, at)
    robot = physical.robot
    lower = np.where(np.isfinite(robot.lower), robot.lower, -np.pi)
    upper = np.where(np.isfinite(robot.upper), robot.upper, np.pi)
    probes = np.random.default_rng(0).uniform(lower, upper, (PROBES, robot.n))
    probes[~robot.closes(probes)] = 0.0
    compliance, sag, shift = _compliances(physical, probes)
    mechanism = physical.assembly.mechanism
    if not mechanism.chain.names:
        raise InputError(
            "no joint moves this frame, so nothing yields there",
            where=robot.tool_frame,
            remedy="Name a frame farther out.",
        )
    springs = springs_of(compliance[0], robot.name)
    followed = (
        isinstance(mechanism.elastic or mechanism.coupling, LinearCoupling)
        and springs is not None
        and all(np.allclose(part, part[0], rtol=1e-12, atol=0.0) for part in (compliance, sag))
    )
    weighs = mechanism.chain.weighs and sag.any()
    return ElasticArm(
        name=robot.name,
        frame=robot.tool_frame,
        joints=robot.actuated,
        slides=robot.prismatic,
        lower=robot.lower,
        upper=robot.upper,
        mechanism=mechanism,
        springs=np.zeros((0, 0)) if springs is None else springs,
        shift=shift,
        point=at,
        weight=Weight(robot.gravity_in_base, sag[0]) if weighs else None,
        slow=None if followed else physical,
        doubt=doubt_of(physical, probes),
    )


def _compliances(physical: Model, poses: Array) -> tuple[Array, Array, Array]:
    """Compliance under small loads and under the weight, (N, n, n) each, and (n,) the shift."""

    def of(model: Model) -> Array:
        situation = situation_of_load(model.robot, poses, np.zeros(6))
        found = model.solve(situation).rest.compliance
        return np.broadcast_to(found, (len(poses), *found.shape[-2:]))

    # Only what is linear carries the weight; the rest is a law about the load.
    linear = replace(
        physical,
        parameters=tuple(
            parameter
            if isinstance(parameter.effect, LinearElastic)
            else replace(parameter, internal=0.0)
            for parameter in physical.parameters
        ),
    )
    start = physical.assembly.start(
        situation_of_load(physical.robot, poses[:1], np.zeros(6)), physical.values
    )[0]
    start[: physical.robot.n] -= poses[0]
    return of(physical), of(linear), start


def seen_from(model: Model, frame: str, point: Array) -> tuple[Model, Array]:
    """The model of the arm up to a frame, and a point of the frame in that arm's tool frame."""
    robot = model.robot
    rest = np.zeros(robot.n)
    if robot.mechanism(frame).chain.names == robot.mechanism().chain.names:
        inward = np.linalg.inv(robot.placement(rest)) @ robot.placement(rest, frame, point)
        return model, inward[:3, 3]
    return replace(model, robot=replace(robot, tool_frame=frame)), point


def springs_of(compliance: Array, name: str) -> Array | None:
    """(n, n) stiffness of a compliance, infinite on the diagonal where nothing yields.

    None where the compliance of what yields is singular or negative in some direction.
    """
    soft = np.flatnonzero(compliance.any(axis=0))
    if not len(soft):
        raise InputError(
            "nothing in this model yields under load",
            where=name,
            remedy="Give a model with joint_springs or another elastic effect.",
        )
    part = symmetric_part(compliance[np.ix_(soft, soft)])
    values = np.linalg.eigvalsh(part)
    if values[0] <= 1e-12 * values[-1]:
        return None
    springs = np.diag(np.where(compliance.any(axis=0), 0.0, np.inf))
    springs[np.ix_(soft, soft)] = symmetric_part(np.asarray(np.linalg.inv(part), dtype=float))
    return springs
