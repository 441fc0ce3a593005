"""A serial chain of one-degree-of-freedom joints as plain arrays, and its kinematics.

The constants are read once out of the Pinocchio model; everything after that is array work for one
pose or for many. A *virtual joint* (a bearing that tilts, a slice of a beam, a base on its
foundation) is one more joint of the chain, so compliance anywhere needs no other formula.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.robot.rotations import crossed


@dataclass(frozen=True, eq=False)
class VirtualJoint:
    """A joint that no motor drives, placed somewhere along a chain.

    Attributes:
        name: Unique name, e.g. ``link_bending:link_2_l[3].y``.
        body: Index of the chain joint that carries it (it sits on that joint's moving side); -1 for
            the base.
        placement: (4, 4) its frame in the frame of that joint [m].
        axis: (3,) unit direction in its own frame.
        revolute: Rotation about the axis if true, translation along it else.
        followers: Joints of the robot that follow this displacement through a closed linkage, as
            (index in q, multiplier): a parallelogram keeps the forearm's direction also when the
            upper arm bends.
    """

    name: str
    body: int
    placement: Array
    axis: Array
    revolute: bool = True
    followers: tuple[tuple[int, float], ...] = ()


@dataclass(frozen=True, eq=False)
class Chain:
    """Constants of a serial chain from a base frame to an end frame.

    Attributes:
        names: Joint names, base to end.
        placements: (m + 1, 4, 4) constant transform before each joint, and from the last joint to
            the end frame [m].
        axes: (m, 3) unit joint axes in the joint frames.
        revolute: (m,) true for rotation, false for translation.
        coordinates: (m,) index of each joint's value in the joint vector [q of all robot joints;
            virtual].
        masses, centres: (m,) mass that each joint carries up to the next one [kg], and (m, 3) its
            centre in the joint's moving frame [m]. Branches off the chain count at their rest
            position.
    """

    names: tuple[str, ...]
    placements: Array
    axes: Array
    revolute: Mask
    coordinates: Index
    masses: Array = field(default_factory=lambda: np.zeros(0))
    centres: Array = field(default_factory=lambda: np.zeros((0, 3)))

    def __post_init__(self) -> None:
        m = len(self.names)
        shapes = (self.placements.shape, self.axes.shape, self.revolute.shape)
        if shapes != ((m + 1, 4, 4), (m, 3), (m,)) or self.coordinates.shape != (m,):
            raise ValueError(f"chain of {m} joints with arrays of shapes {shapes}")
        if not len(self.masses):
            object.__setattr__(self, "masses", np.zeros(m))
            object.__setattr__(self, "centres", np.zeros((m, 3)))

    @property
    def m(self) -> int:
        """Number of joints of the chain."""
        return len(self.names)

    @property
    def weighs(self) -> bool:
        """Does the chain carry any mass?"""
        return bool(self.masses.any())

    def with_virtual_joints(self, virtual: Sequence[VirtualJoint], first_index: int) -> Chain:
        """The same chain with `virtual` joints inserted, in the given order on each body.

        Args:
            virtual: Joints to insert; several on one body act one after the other as listed.
            first_index: Index of the first virtual joint's value in the joint vector.
        """
        names: list[str] = []
        placements: list[Array] = []
        axes: list[Array] = []
        revolute: list[bool] = []
        coordinates: list[int] = []
        masses: list[float] = []
        centres: list[Array] = []
        for body in range(-1, self.m):
            if body >= 0:
                names.append(self.names[body])
                axes.append(self.axes[body])
                revolute.append(bool(self.revolute[body]))
                coordinates.append(int(self.coordinates[body]))
                masses.append(float(self.masses[body]))
                centres.append(self.centres[body])
            back: Array = np.eye(4)
            for k, joint in enumerate(virtual):
                if joint.body != body:
                    continue
                placements.append(back @ joint.placement)
                back = np.asarray(np.linalg.inv(joint.placement), dtype=float)
                names.append(joint.name)
                axes.append(joint.axis)
                revolute.append(joint.revolute)
                coordinates.append(first_index + k)
                # A joint at the body's own origin carries the body; one further out does not.
                takes = bool(masses) and not joint.placement[:3, 3].any() and body >= 0
                masses.append(masses[-1] if takes else 0.0)
                turn = joint.placement[:3, :3]
                centres.append(turn.T @ self.centres[body] if takes else np.zeros(3))
                if takes:
                    masses[-2] = 0.0
            placements.append(back @ self.placements[body + 1])
        return Chain(
            tuple(names),
            np.array(placements),
            np.array(axes).reshape(-1, 3),
            np.array(revolute, dtype=bool),
            np.array(coordinates, dtype=np.intp),
            np.array(masses),
            np.array(centres).reshape(-1, 3),
        )

    @cached_property
    def _crosses(self) -> Array:
        """(m, 3, 3) cross products with the joint axes."""
        return crossed(self.axes)

    def sweep(self, q: Array) -> Sweep:
        """Forward kinematics that keeps every joint on the way.

        Args:
            q: (..., m) joint values [rad or m].

        Returns:
            Sweep: Joint axes, joint origins, centres of mass and the end frame, in base axes.
        """
        batch = q.shape[:-1]
        count = int(np.prod(batch, dtype=int))
        flat = q.reshape(count, self.m)
        sines, cosines = np.sin(flat), np.cos(flat)
        axes = np.empty((count, self.m, 3))
        origins = np.empty((count, self.m, 3))
        centres = np.empty((count, self.m, 3)) if self.weighs else None
        rotation = np.broadcast_to(np.eye(3), (count, 3, 3))
        position = np.zeros((count, 3))
        for k in range(self.m):
            position = position + rotation @ self.placements[k, :3, 3]
            rotation = _times(rotation, self.placements[k, :3, :3])
            axes[:, k] = rotation @ self.axes[k]
            if self.revolute[k]:
                cross = self._crosses[k]
                swept = _times(rotation, cross)
                rotation = (
                    rotation
                    + sines[:, k, None, None] * swept
                    + (1.0 - cosines[:, k, None, None]) * _times(swept, cross)
                )
            else:
                position = position + flat[:, k, None] * axes[:, k]
            origins[:, k] = position
            if centres is not None:
                centres[:, k] = position + rotation @ self.centres[k]
        position = position + rotation @ self.placements[-1, :3, 3]
        rotation = _times(rotation, self.placements[-1, :3, :3])
        return Sweep(
            axes.reshape(*batch, self.m, 3),
            origins.reshape(*batch, self.m, 3),
            rotation.reshape(*batch, 3, 3),
            position.reshape(*batch, 3),
            None if centres is None else centres.reshape(*batch, self.m, 3),
        )


class Sweep(NamedTuple):
    """What forward kinematics meets on the way, in base axes [m].

    Attributes:
        axes, origins: (..., m, 3) joint axes and joint origins.
        rotation, position: (..., 3, 3) and (..., 3) of the end frame.
        centres: (..., m, 3) centres of the carried masses, or None where nothing weighs.
    """

    axes: Array
    origins: Array
    rotation: Array
    position: Array
    centres: Array | None


def _times(many: Array, one: Array) -> Array:
    """(N, 3, 3) @ (3, 3) as a single matrix product, which is several times faster."""
    return (many.reshape(-1, 3) @ one).reshape(many.shape)
