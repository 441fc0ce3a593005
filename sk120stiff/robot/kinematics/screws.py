"""A mechanism at a pose: the unit twists of its joints at a point, and what follows from them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.robot.kinematics.chain import Chain, Sweep, VirtualJoint
from sk120stiff.robot.kinematics.coupling import Coupling, Curvature
from sk120stiff.robot.rotations import cross_product


@dataclass(frozen=True, eq=False)
class Screws:
    """Joint axes of a chain at one pose or many, seen from a point of the end frame.

    Attributes:
        axes, origins: (..., m, 3) unit joint axes and points on them, in base axes [m].
        revolute: (m,) rotation or translation.
        rotation, frame_position: (..., 3, 3) and (..., 3) of the end frame [m].
        point: (3,) or (..., 3) the point, in the end frame [m].
        first, second: (..., m, n) derivative of the joint values by the coordinates, and the second
            one, or None where it vanishes.
        carried: (..., m, 3) change of Σ mass · position with each joint [kg·m per rad], or None
            where nothing weighs.
    """

    axes: Array
    origins: Array
    revolute: Mask
    rotation: Array
    frame_position: Array
    point: Array
    first: Array
    second: Curvature | None = None
    carried: Array | None = None

    @cached_property
    def position(self) -> Array:
        """(..., 3) position of the point in the base frame [m]."""
        turned = np.einsum("...ij,...j->...i", self.rotation, self.point)
        return np.asarray(self.frame_position + turned)

    @cached_property
    def angular(self) -> Array:
        """(..., m, 3) angular parts w_k of the unit twists [rad per rad, 0 for a slide]."""
        if self.revolute.all():
            return self.axes
        return np.where(self.revolute[:, None], self.axes, 0.0)

    @cached_property
    def linear(self) -> Array:
        """(..., m, 3) linear parts v_k of the unit twists at the point [m per rad, or 1]."""
        turned = cross_product(self.axes, self.position[..., None, :] - self.origins)
        if self.revolute.all():
            return turned
        return np.where(self.revolute[:, None], turned, self.axes)

    @cached_property
    def jacobian(self) -> Array:
        """(..., 6, n) Jacobian of the point by the coordinates, [linear; angular], base axes."""
        columns = np.concatenate([self.linear, self.angular], axis=-1)  # (..., m, 6)
        return np.swapaxes(columns, -1, -2) @ self.first

    @cached_property
    def linear_jacobian(self) -> Array:
        """(..., 3, n) the upper half of `jacobian`, without computing the lower one."""
        return np.asarray(np.swapaxes(self.linear, -1, -2) @ self.first)

    def joint_torques(self, wrench: Array) -> Array:
        """(..., m) torque of a wrench (..., 6) about every chain joint, Jᵀ W [N·m or N]."""
        force, moment = wrench[..., None, :3], wrench[..., None, 3:]
        return np.asarray((self.linear * force).sum(-1) + (self.angular * moment).sum(-1))

    def torques(self, wrench: Array) -> Array:
        """(..., n) generalised forces of a wrench (..., 6) on the coordinates [N·m or N]."""
        per_joint = self.joint_torques(wrench)
        return (per_joint[..., None, :] @ self.first)[..., 0, :]

    def gravity_torques(self, gravity: Array) -> Array:
        """(..., n) torques of the arm's own weight on the coordinates [N·m or N].

        Args:
            gravity: (3,) acceleration in base axes [m/s²].
        """
        if self.carried is None:
            return np.zeros((*self.position.shape[:-1], self.first.shape[-1]))
        return np.asarray(((self.carried @ gravity)[..., None, :] @ self.first)[..., 0, :])

    def alone(self, coordinates: Index) -> Screws:
        """The same pose where these coordinates alone may change, with the joints they move."""
        first = self.first[..., coordinates]
        moved = np.asarray(first.any(axis=(*range(first.ndim - 2), -1)))
        second = None if self.second is None else self.second.along(coordinates)
        if second is not None:
            moved[second.joints] = True
        joints = np.flatnonzero(moved)
        return replace(
            self,
            axes=self.axes[..., joints, :],
            origins=self.origins[..., joints, :],
            revolute=self.revolute[joints],
            first=first[..., joints, :],
            second=None if second is None else second.picked(joints),
            carried=None if self.carried is None else self.carried[..., joints, :],
        )

    def at(self, point: Array) -> Screws:
        """The same pose seen from another point of the end frame, (3,) or (..., 3) [m]."""
        return replace(self, point=np.asarray(point, dtype=float))


@dataclass(frozen=True, eq=False)
class Mechanism:
    """A chain whose joints follow generalised coordinates z = [a; v].

    ``a`` are the actuated coordinates, ``v`` the displacements of the virtual joints (rigid robots
    have none). `coupling` is that of the rigid robot, `elastic` the one that knows the virtual
    joints too.
    """

    chain: Chain
    coupling: Coupling
    virtual: tuple[VirtualJoint, ...] = field(default=())
    elastic: Coupling | None = None

    @property
    def n(self) -> int:
        """Number of coordinates, actuated and virtual."""
        return self.coupling.n + len(self.virtual)

    def with_virtual_joints(self, virtual: Sequence[VirtualJoint]) -> Mechanism:
        """This mechanism with compliance at the given places."""
        if self.virtual:
            raise ValueError("virtual joints are inserted once, all together")
        chain = self.chain.with_virtual_joints(virtual, self.coupling.m)
        elastic = self.coupling.with_virtual_joints(virtual, self.chain.names)
        return Mechanism(chain, self.coupling, tuple(virtual), elastic)

    def screws(self, z: Array, point: Array | None = None) -> Screws:
        """Kinematics at coordinates `z` (..., n), seen from `point` of the end frame [m]."""
        z = np.asarray(z, dtype=float)
        motion = (self.elastic or self.coupling).motion(z)
        pick = self.chain.coordinates
        swept = self.chain.sweep(motion.q[..., pick])
        return Screws(
            axes=swept.axes,
            origins=swept.origins,
            revolute=self.chain.revolute,
            rotation=swept.rotation,
            frame_position=swept.position,
            point=np.zeros(3) if point is None else np.asarray(point, dtype=float),
            first=motion.first[..., pick, :],
            second=None if motion.second is None else motion.second.picked(pick),
            carried=None if swept.centres is None else _carried(self.chain, swept),
        )


def _carried(chain: Chain, swept: Sweep) -> Array:
    """(..., m, 3) w × Σ m (c − o) over all that a joint carries, or axis · Σ m for a slide."""
    if swept.centres is None:
        raise ValueError("nothing weighs")
    moments = chain.masses[:, None] * swept.centres
    beyond = np.flip(np.cumsum(np.flip(moments, -2), axis=-2), -2)
    mass = np.flip(np.cumsum(np.flip(chain.masses)))[:, None]
    turned = cross_product(swept.axes, beyond - mass * swept.origins)
    return np.where(chain.revolute[:, None], turned, mass * swept.axes)
