"""A serial chain of one-degree-of-freedom joints as plain arrays, and its kinematics.

The constants are read once out of the Pinocchio model; everything after that is array work for one
pose or for many. A *virtual joint* (a bearing that tilts, a slice of a beam, a base on its
foundation) is one more joint of the chain, so compliance anywhere needs no other formula.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.robot.rotations import crossed

ROUNDING = 1e-9  # of a link's mass or length, which is none of it


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
        """The same chain with `virtual` joints inserted, from the near end of each body to the far.

        Each carries what of its body's mass lies beyond it (`_beyond`).

        Args:
            virtual: Joints to insert; several at one place act one after the other as listed.
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
            own = [k for k, joint in enumerate(virtual) if joint.body == body]
            share = np.array([self._along(body, virtual[k].placement[:3, 3]) for k in own])
            order = [int(k) for k in np.argsort(share, kind="stable")]
            if body >= 0:
                names.append(self.names[body])
                axes.append(self.axes[body])
                revolute.append(bool(self.revolute[body]))
                coordinates.append(int(self.coordinates[body]))
                parts = self._cut(body, share[order])
                masses += [mass for mass, _ in parts]
                centres.append(parts[0][1])
            back: Array = np.eye(4)
            for place, at in enumerate(order):
                k, joint = own[at], virtual[own[at]]
                placements.append(back @ joint.placement)
                back = np.asarray(np.linalg.inv(joint.placement), dtype=float)
                names.append(joint.name)
                axes.append(joint.axis)
                revolute.append(joint.revolute)
                coordinates.append(first_index + k)
                if body < 0:
                    masses.append(0.0)
                    centres.append(np.zeros(3))
                else:
                    mass, centre = parts[place + 1]
                    turn, origin = joint.placement[:3, :3], joint.placement[:3, 3]
                    centres.append(turn.T @ (centre - origin) if mass else np.zeros(3))
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

    def _along(self, body: int, at: Array) -> float:
        """Where on the way to the next joint a point of a body lies: 0 at its joint, 1 there."""
        span = self.placements[body + 1, :3, 3]
        length = float(span @ span)
        return float(at @ span) / length if length and at.any() else 0.0

    def _cut(self, body: int, share: Array) -> list[tuple[float, Array]]:
        """Mass [kg] and centre (3,) [m, body axes] up to the first cut, then beyond each of them.

        Args:
            body: The body.
            share: (k,) where it is cut, as of `_along`, ascending.
        """
        left = [(float(self.masses[body]), self.masses[body] * self.centres[body])]
        left += [self._beyond(body, float(at)) for at in share]
        left.append((0.0, np.zeros(3)))
        parts = []
        for (mass, moment), (rest, further) in pairwise(left):
            own = mass - rest
            some = own > ROUNDING * self.masses[body]
            parts.append((own, (moment - further) / own) if some else (0.0, np.zeros(3)))
        return parts

    def _beyond(self, body: int, share: float) -> tuple[float, Array]:
        """Mass [kg] and its moment (3,) [kg·m] beyond a cut through a body.

        Nobody states how a link's mass is spread, only where its centre is. It is taken to lie
        along the way to the next joint, evenly over as much of it as has its middle at the centre:
        a beam whose centre is halfway weighs the same everywhere.
        """
        mass, centre = float(self.masses[body]), self.centres[body]
        middle = self._along(body, centre)
        first, last = max(0.0, 2.0 * middle - 1.0), min(1.0, 2.0 * middle)
        if middle >= 1.0:  # all that is not mounted at the next joint
            first = last = 1.0 - ROUNDING
        if share <= 0.0 or share < first:
            return mass, mass * centre
        begin = max(share, first)
        if middle <= 0.0 or begin >= last:  # it weighs behind the joint, or behind the cut
            return 0.0, np.zeros(3)
        part = mass * (last - begin) / (last - first)
        span = self.placements[body + 1, :3, 3]
        return part, part * (centre + (0.5 * (begin + last) - middle) * span)

    @cached_property
    def _folded(self) -> dict[bytes, tuple[_Stretch, ...]]:
        return {}

    def _stretches(self, moving: Mask) -> tuple[_Stretch, ...]:
        """The chain cut behind each of the joints that move; what stands still in between is rigid.

        Most virtual joints of a catalogue stand still: they cost no step of their own.
        """
        key = moving.tobytes()
        if key not in self._folded:
            ends = np.flatnonzero(moving)
            starts = np.append(0, ends + 1)
            self._folded[key] = tuple(
                self._stretch(int(first), int(end), mover=k < len(ends))
                for k, (first, end) in enumerate(zip(starts, [*ends, self.m], strict=True))
            )
        return self._folded[key]

    def _stretch(self, first: int, last: int, *, mover: bool) -> _Stretch:
        """From joint `first` to joint `last`, whose own motion comes last, or to the end frame."""
        placement: Array = np.eye(4)
        length = last - first + int(mover)
        axes, origins, centres = (np.zeros((3, length)) for _ in range(3))
        for place, k in enumerate(range(first, first + length)):
            placement = placement @ self.placements[k]
            rotation, origins[:, place] = placement[:3, :3], placement[:3, 3]
            axes[:, place] = rotation @ self.axes[k]
            centres[:, place] = rotation @ self.centres[k] + placement[:3, 3]
        if not mover:
            placement = placement @ self.placements[-1]
        parts = [axes, origins, placement[:3, 3:], placement[:3, :3]]
        if self.weighs:
            parts.insert(2, centres)
        if mover and self.revolute[last]:
            cross = crossed(self.axes[last])
            parts += [placement[:3, :3] @ cross, placement[:3, :3] @ cross @ cross]
        constants = np.ascontiguousarray(np.hstack(parts).T)
        joints = slice(first, first + length)
        return _Stretch(joints, length, constants, last if mover else None)

    def sweep(self, q: Array) -> Sweep:
        """Forward kinematics that keeps every joint on the way.

        Args:
            q: (..., m) joint values [rad or m].

        Returns:
            Sweep: Joint axes, joint origins, centres of mass and the end frame, in base axes.
        """
        batch = q.shape[:-1]
        flat = q.reshape(int(np.prod(batch, dtype=int)), self.m)
        if len(flat) == 1:  # a product with one column is rounded otherwise than with many
            return self.sweep(np.repeat(flat, 2, axis=0)).of_first(batch)
        moving: Mask = np.asarray(flat.any(axis=0))
        value = np.ascontiguousarray(flat[:, moving].T)
        sines, versines = np.sin(value), 1.0 - np.cos(value)
        # Poses come last on the way: long rows are what arithmetic is fast on.
        count = len(flat)
        axes, origins = np.empty((self.m, 3, count)), np.empty((self.m, 3, count))
        centres = np.empty((self.m, 3, count)) if self.weighs else None
        rotation: Array = np.repeat(np.eye(3)[:, :, None], count, axis=2)  # (row, column, pose)
        position = np.zeros((3, count))
        for k, stretch in enumerate(self._stretches(moving)):
            joints, n = stretch.joints, stretch.length
            turned = stretch.constants @ rotation
            axes[joints] = np.swapaxes(turned[:, :n], 0, 1)
            origins[joints] = position + np.swapaxes(turned[:, n : 2 * n], 0, 1)
            at = 2 * n
            if centres is not None:
                centres[joints] = position + np.swapaxes(turned[:, at : at + n], 0, 1)
                at += n
            position = position + turned[:, at]
            rotation = turned[:, at + 1 : at + 4]
            mover = stretch.mover
            if mover is None:
                break
            if self.revolute[mover]:
                rotation = rotation + sines[k] * turned[:, at + 4 : at + 7]
                rotation += versines[k] * turned[:, at + 7 :]
            else:
                position = position + value[k] * axes[mover]
                origins[mover] = position
            if centres is not None:
                own = self.centres[mover]
                centres[mover] = position + own @ rotation if own.any() else position
        return Sweep(
            _by_pose(axes, batch),
            _by_pose(origins, batch),
            _by_pose(rotation, batch),
            position.T.reshape(*batch, 3),
            None if centres is None else _by_pose(centres, batch),
        )


def _by_pose(many: Array, batch: tuple[int, ...]) -> Array:
    """(k, 3, N) → (..., k, 3)."""
    return np.ascontiguousarray(many.transpose(2, 0, 1)).reshape(*batch, *many.shape[:2])


class _Stretch(NamedTuple):
    """A rigid piece of a chain, up to the next joint that moves.

    Attributes:
        joints, length: Those on it, and how many; the one that moves is the last.
        constants: (c, 3) in the frame where it begins: the joints' axes, their origins, the centres
            of their masses where there are any, the end's position and rotation, and this rotation
            times the cross product with the axis of a joint that turns there, once and twice.
        mover: The joint at its end, None for the end frame.
    """

    joints: slice
    length: int
    constants: Array
    mover: int | None


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

    def of_first(self, batch: tuple[int, ...]) -> Sweep:
        """The first pose alone, in the shape of a batch of one."""
        axes, origins, rotation, position = (x[:1].reshape(*batch, *x.shape[1:]) for x in self[:4])
        centres = None if self.centres is None else self.centres[:1].reshape(axes.shape)
        return Sweep(axes, origins, rotation, position, centres)
