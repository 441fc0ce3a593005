"""An arm with elastic hinges and slides in it: where everything stands, and what loads it.

The chain is a row of elements. Every element turns or slides by its commanded value plus an
elastic one. A loop adds two coordinates beside the chain (crank and rod) and makes one element
follow the others; its angle is solved from the distance of the two rod pins, exactly.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from .arm import Arm, Loop
from .rotations import Array, placement, turn

GRAVITY = np.array([0.0, 0.0, -9.81])


@dataclass(frozen=True)
class Insert:
    """One elastic coordinate that no motor drives, in the moving frame of joint `joint`.

    `joint` is -1 for the foundation. Inserts of one joint are ordered by `along`.
    """

    label: str
    joint: int
    at: Array  # (3,) [m]
    axis: Array  # (3,)
    slides: bool
    compliance: float  # rad/(N m) or m/N
    along: float = 0.0


@dataclass(frozen=True)
class Element:
    label: str
    shift: Array  # (3,) from the previous element's frame
    rotation: Array | None  # (3, 3), None for identity
    axis: Array
    slides: bool


@dataclass(frozen=True)
class Standing:
    """Where all elements, the tool and the masses stand; K elements, N rows."""

    axes: Array  # (K, N, 3)
    origins: Array  # (K, N, 3)
    tool_rotation: Array  # (N, 3, 3)
    tool_position: Array  # (N, 3)
    centres: Array  # (B, N, 3)
    follow: Array | None  # (K + 2, N) derivative of the follower's angle
    pins: tuple[Array, Array] | None  # rear pin and crank pin (N, 3)

    def point(self, local: Array) -> Array:
        """Base coordinates (N, 3) of a point of the tool frame."""
        return self.tool_position + self.tool_rotation @ local


class Mechanism:
    """The row of elements of `arm` with `inserts`, ready for many rows at once."""

    def __init__(self, arm: Arm, inserts: Sequence[Insert] = ()) -> None:
        self.arm = arm
        self.elements: list[Element] = []
        self.joint_element: list[int] = []
        self.body_element: list[int] = []
        offset = np.zeros(3)  # last element's origin in the current moving frame
        offset = self._add_inserts(-1, inserts, offset)
        body_order = []
        for index, joint in enumerate(arm.joints):
            rotation = joint.before[:3, :3]
            plain = None if np.array_equal(rotation, np.eye(3)) else rotation
            shift = joint.before[:3, 3] - offset
            self.joint_element.append(len(self.elements))
            self.elements.append(Element(joint.name, shift, plain, joint.axis, joint.slides))
            offset = self._add_inserts(index, inserts, np.zeros(3), early=True)
            for number, body in enumerate(arm.bodies):
                if body.joint == index:
                    body_order.append((number, len(self.elements) - 1, body.centre - offset))
            offset = self._add_inserts(index, inserts, offset, early=False)
        self.tool = placement(arm.tool[:3, 3] - offset, arm.tool[:3, :3])
        self.bodies = sorted(body_order, key=lambda entry: entry[0])
        self.labels = [element.label for element in self.elements]
        if arm.loop is not None:
            self.labels += [arm.loop.driver, "rod"]
        self.column = {label: k for k, label in enumerate(self.labels)}

    def _add_inserts(
        self, joint: int, inserts: Sequence[Insert], offset: Array, early: bool | None = None
    ) -> Array:
        # masses hang on the near half of a bending link
        chosen = [entry for entry in inserts if entry.joint == joint]
        if early is not None:
            chosen = [entry for entry in chosen if (entry.along <= 0.5) == early]
        for entry in sorted(chosen, key=lambda item: item.along):
            self.elements.append(
                Element(entry.label, entry.at - offset, None, entry.axis, entry.slides)
            )
            offset = entry.at
        return offset

    def commanded(self, coordinates: Mapping[str, Array]) -> Array:
        """Joint values (K, N) of all elements; elastic ones are zero, the follower nominal."""
        rows = len(next(iter(coordinates.values())))
        values = np.zeros((len(self.elements), rows))
        loop = self.arm.loop
        for index, joint in enumerate(self.arm.joints):
            if loop is not None and index == loop.follower:
                # a parallelogram's forearm keeps the crank's direction whatever its upper arm does
                values[self.joint_element[index]] = (
                    coordinates[loop.driver] + coordinates[self.arm.joints[loop.pivot].name]
                )
            else:
                values[self.joint_element[index]] = coordinates[joint.name]
        return values

    def stand(self, commanded: Array, x: Array, crank: Array | None = None) -> Standing:
        """All placements for elastic coordinates x (K or K + 2, N) [rad or m]."""
        rows = commanded.shape[1]
        rotation = np.broadcast_to(np.eye(3), (rows, 3, 3))
        position = np.zeros((rows, 3))
        axes = np.empty((len(self.elements), rows, 3))
        origins = np.empty_like(axes)
        bodies = {index: [] for _, index, _ in self.bodies}
        centres = np.empty((len(self.bodies), rows, 3))
        for slot, (_, index, centre) in enumerate(self.bodies):
            bodies[index].append((slot, centre))
        loop = self.arm.loop
        pivot_at = follower_at = -1
        if loop is not None:
            pivot_at = self.joint_element[loop.pivot]
            follower_at = self.joint_element[loop.follower]
        pin = rear = pivot_axis = pivot = None
        for k, element in enumerate(self.elements):
            position = position + rotation @ element.shift
            if element.rotation is not None:
                rotation = rotation @ element.rotation
            axis = rotation @ element.axis
            axes[k] = axis
            origins[k] = position
            value = commanded[k] + x[k]
            if k == pivot_at:
                angle = crank + x[-2]
                pivot, pivot_axis = position, rotation @ loop.crank_axis
                swung = turn(loop.crank_axis, angle) @ loop.crank
                pin = position + np.einsum("nij,nj->ni", rotation, swung)
            if k == follower_at:
                value = _close(loop, position, rotation, axis, pin, loop.rod + x[-1], commanded[k])
            if element.slides:
                position = position + axis * value[:, None]
            else:
                rotation = rotation @ turn(element.axis, value)
            if k == follower_at:
                rear = position + rotation @ loop.lever
            for slot, centre in bodies.get(k, ()):
                centres[slot] = position + rotation @ centre
        tool_position = position + rotation @ self.tool[:3, 3]
        tool_rotation = rotation @ self.tool[:3, :3]
        follow = None
        if loop is not None:
            follow = _follow(
                axes, origins, pivot_at, follower_at, rear, pin, pivot, pivot_axis, loop.rod + x[-1]
            )
        pins = None if loop is None else (rear, pin)
        return Standing(axes, origins, tool_rotation, tool_position, centres, follow, pins)

    def generalised(self, at: Standing, point: Array, force: Array, moment: Array) -> Array:
        """Generalised forces (K or K + 2, N) of a tool wrench at `point` and of gravity."""
        total_force = np.broadcast_to(force, at.origins.shape).copy()
        about_zero = moment + np.cross(point, force)
        total_moment = np.broadcast_to(about_zero, at.origins.shape).copy()
        for slot, (number, index, _) in enumerate(self.bodies):
            weight = self.arm.bodies[number].mass * GRAVITY
            total_force[: index + 1] += weight
            total_moment[: index + 1] += np.cross(at.centres[slot], weight)
        turning = np.einsum(
            "kni,kni->kn", at.axes, total_moment - np.cross(at.origins, total_force)
        )
        pushing = np.einsum("kni,kni->kn", at.axes, total_force)
        slides = np.array([element.slides for element in self.elements])
        out = np.where(slides[:, None], pushing, turning)
        if self.arm.loop is None:
            return out
        follower = self.joint_element[self.arm.loop.follower]
        passive = out[follower].copy()
        out = np.concatenate([out, np.zeros((2, out.shape[1]))]) + at.follow * passive
        out[follower] = 0.0  # the follower is no coordinate of its own
        return out


def _close(
    loop: Loop, elbow: Array, rotation: Array, axis: Array, pin: Array, rod: Array, nominal: Array
) -> Array:
    """Follower's angle (N,) from |elbow + turned lever - crank pin| = rod, nearest to nominal."""
    lever = rotation @ loop.lever
    sideways = np.cross(axis, lever)
    gap = elbow - pin
    a = np.einsum("ni,ni->n", gap, lever)
    b = np.einsum("ni,ni->n", gap, sideways)
    c = 0.5 * (rod**2 - np.sum(gap * gap, -1) - np.dot(loop.lever, loop.lever))
    middle = np.arctan2(b, a)
    swing = np.arccos(c / np.hypot(a, b))
    both = np.stack([middle + swing, middle - swing])
    away = np.angle(np.exp(1j * (both - nominal)))
    best = np.argmin(np.abs(away), 0)
    return nominal + np.take_along_axis(away, best[None], 0)[0]


def _follow(
    axes: Array,
    origins: Array,
    first: int,
    follower: int,
    rear: Array,
    pin: Array,
    pivot: Array,
    pivot_axis: Array,
    rod: Array,
) -> Array:
    """d follower / d coordinate (K + 2, N), from the constraint's gradient."""
    count, rows, _ = axes.shape
    gradient = np.zeros((count + 2, rows))
    rod_vector = rear - pin
    inner = slice(first, follower)
    gradient[inner] = np.einsum(
        "kni,ni->kn", np.cross(axes[inner], rear - origins[inner]), rod_vector
    )
    gradient[-2] = -np.einsum("ni,ni->n", np.cross(pivot_axis, pin - pivot), rod_vector)
    gradient[-1] = -rod
    own = np.einsum("ni,ni->n", np.cross(axes[follower], rear - origins[follower]), rod_vector)
    return -gradient / own
