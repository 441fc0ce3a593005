"""Does an arm run into itself, its pedestal, its tool, or what stands around it?

Pinocchio places the solids, coal holds convex ones against each other. Neighbours along the chain
touch at their joint and are not asked; nor are pairs that touch where all joints stand at zero, or
as near to it as their limits allow, or wherever the arm stands: so they were drawn (as MoveIt's
assistant has it), and that is said.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np
import pinocchio as pin

from sk120stiff.arrays import Array, Mask
from sk120stiff.robot.anatomy import arm_joint, arm_joints, sample_poses
from sk120stiff.robot.robot import Robot
from sk120stiff.robot.solids import Solid, body_of, capsule_between

try:
    import coal
except ImportError:  # Pinocchio 2 and 3.0
    import hppfcl as coal

    coal.Transform3s = coal.Transform3f

SAMPLES = 100  # poses that tell which pairs touch wherever the arm stands
WHEREVER = 0.95  # share of them
SIGHT_RADIUS = 2e-3  # m; of a laser beam
UPRIGHT = 0.999  # cosine of an axis that is vertical
FAR = 1e3  # m; below everything

Pair = tuple[str, str]


class Scene:
    """A robot among solids.

    Args:
        robot: The robot.
        fixed: Solids that stand around it, in frames that do not move against the base.
        carried: Solids on frames that it moves: tool, fixture.
        clearance: Distance below which two solids count as touching [m].
    """

    def __init__(
        self,
        robot: Robot,
        *,
        fixed: Sequence[Solid] = (),
        carried: Sequence[Solid] = (),
        clearance: float = 0.0,
    ) -> None:
        self.robot = robot
        self.clearance = clearance
        body = body_of(robot)
        self.solids: tuple[Solid, ...] = (*body.solids, *carried, *fixed)
        self._own = len(body.solids) + len(carried)
        self._bodies = np.array([robot.tree.body(s.frame)[0] for s in self.solids], dtype=np.intp)
        self._shapes = [_shape(solid) for solid in self.solids]
        self._geometry = pin.GeometryModel()
        for k, solid in enumerate(self.solids):
            _, T_body_frame = robot.tree.body(solid.frame)
            place = pin.SE3(T_body_frame @ solid.T_frame_solid)
            parent = int(self._bodies[k]) + 1
            self._geometry.addGeometryObject(
                pin.GeometryObject(  # by name: Pinocchio 2 has another order
                    name=f"{k}", parent_frame=0, parent_joint=parent, placement=place,
                    collision_geometry=self._shapes[k],
                )
            )  # fmt: skip
        self.pairs, touching = self._asked()
        self.remarks: tuple[str, ...] = body.remarks
        if touching:
            names = ", ".join(f"{a} and {b}" for a, b in touching)
            self.remarks += (f"These touch as they were drawn and are not asked: {names}.",)
        for i, j in self.pairs:
            self._geometry.addCollisionPair(pin.CollisionPair(int(i), int(j)))
        self._model, self._data = robot.tree.model, robot.tree.model.createData()
        self._found = self._geometry.createData()
        for request in self._found.collisionRequests:
            request.security_margin = clearance

    def free(self, a: Array) -> Mask:
        """(N,) poses (N, n) at which nothing touches."""
        return np.array([not self._ask(q, stop=True) for q in self._values(a)], dtype=bool)

    def contacts(self, a: Array) -> list[tuple[Pair, ...]]:
        """For each of the poses (N, n) the names of what touches."""
        found = []
        for q in self._values(a):
            self._ask(q, stop=False)
            hits = [
                (self.solids[i].name, self.solids[j].name)
                for (i, j), result in zip(self.pairs, self._found.collisionResults, strict=True)
                if result.isCollision()
            ]
            found.append(tuple(dict.fromkeys(hits)))
        return found

    def lowest(self, a: Array, up: Array) -> Array:
        """(N,) how high the lowest solid that moves stands, along `up` (3,) from the base [m].

        A turret that turns about `up` is left out: it stands as high as it was put.
        """
        ground = coal.Halfspace(np.asarray(up, dtype=float), -FAR)
        least = turret(self.robot, up)
        moving = [k for k in range(self._own) if self._rank(int(self._bodies[k])) > least]
        out = np.full(len(a), np.inf)
        request = coal.DistanceRequest()
        for row, q in enumerate(self._values(a)):
            self._place(q)
            T_base = self._T_base(self._data)
            for k in moving:
                T = T_base.inverse() * self._found.oMg[int(k)]
                here = coal.distance(
                    self._shapes[k], _transform(T), ground, coal.Transform3s(), request,
                    coal.DistanceResult(),
                )  # fmt: skip
                out[row] = min(out[row], here - FAR)
        return out

    def sees(self, a: Array, start: Array, end: Array) -> list[str]:
        """What stands between a point (3,) and points (N, 3) of the poses (N, n), base axes [m].

        What the tool frame's own body carries is not asked: it holds the reflector.

        Returns:
            The name of the first obstruction, or nothing, for each pose.
        """
        found = []
        request = coal.CollisionRequest()
        for q, to in zip(self._values(a), end, strict=True):
            self._place(q)
            beam = capsule_between("", "", np.asarray(start), to, SIGHT_RADIUS)
            shape, T = _shape(beam), self._T_base(self._data) * pin.SE3(beam.T_frame_solid)
            name = ""
            for k, solid in enumerate(self._shapes):
                if k < self._own and self._bodies[k] == self._tool:
                    continue
                result = coal.CollisionResult()
                coal.collide(
                    shape, _transform(T), solid, _transform(self._found.oMg[k]), request, result
                )
                if result.isCollision():
                    name = self.solids[k].name
                    break
            found.append(name)
        return found

    @cached_property
    def _tool(self) -> int:
        return self.robot.tree.body(self.robot.tool_frame)[0]

    @cached_property
    def _base(self) -> int:
        return self.robot.tree.body(self.robot.base_frame)[0]

    def _T_base(self, data: pin.Data) -> pin.SE3:
        _, T_body_base = self.robot.tree.body(self.robot.base_frame)
        return data.oMi[self._base + 1] * pin.SE3(T_body_base)

    def _values(self, a: Array) -> list[Array]:
        """Pinocchio's configuration of each of the poses."""
        values = self.robot.coupling.motion(self.robot.coordinates(a)).q
        return [self.robot.tree.configuration(q) for q in values]

    def _place(self, q: Array) -> None:
        pin.updateGeometryPlacements(self._model, self._data, self._geometry, self._found, q)

    def _ask(self, q: Array, *, stop: bool) -> bool:
        return bool(
            pin.computeCollisions(self._model, self._data, self._geometry, self._found, q, stop)
        )

    def _asked(self) -> tuple[list[tuple[int, int]], list[Pair]]:
        """Pairs of solids that may not touch, and pairs that do wherever the arm is."""
        held = [
            (i, j)
            for i in range(self._own)
            for j in range(i + 1, len(self.solids))
            if self._may_meet(i, j)
        ]
        geometry = self._geometry.copy()
        for i, j in held:
            geometry.addCollisionPair(pin.CollisionPair(i, j))
        model, found = self.robot.tree.model, geometry.createData()
        data = model.createData()
        for request in found.collisionRequests:  # how near they were drawn counts too
            request.security_margin = self.clearance
        poses = sample_poses(self.robot, SAMPLES)
        times = np.zeros(len(held))

        def touching(q: Array) -> Mask:
            pin.computeCollisions(model, data, geometry, found, q, False)
            return np.array([r.isCollision() for r in found.collisionResults], dtype=bool)

        for q in self._values(poses):
            times += touching(q)
        # Zero, or what of it the limits allow: no evidence where the joints cannot stand.
        rest = np.clip(self.robot.rest, self.robot.lower, self.robot.upper)
        (drawn,) = self._values(rest[None])
        own = np.array([j < self._own for _, j in held], dtype=bool)  # a wall is never drawn so
        always = own & ((times >= WHEREVER * len(poses)) | touching(drawn))
        names = [
            (self.solids[i].name, self.solids[j].name)
            for (i, j), touch in zip(held, always, strict=True)
            if touch
        ]
        asked = [pair for pair, touch in zip(held, always, strict=True) if not touch]
        return asked, list(dict.fromkeys(names))

    def _may_meet(self, i: int, j: int) -> bool:
        first, second = int(self._bodies[i]), int(self._bodies[j])
        if first == second:
            return False
        if j >= self._own:
            return first != self._base and self._rank(first) > self.solids[j].spares
        return (
            self._next(first) != second
            and self._next(second) != first
            and frozenset((first, second)) not in self._pinned
        )

    @cached_property
    def _pinned(self) -> set[frozenset[int]]:
        """Bodies that a closed loop joins, which the tree of the URDF holds apart."""
        robot = self.robot
        joined = [closure.frames for closure in robot.closures]
        for linkage in robot.linkages:
            ends = [arm_joint(robot, driver).link for driver in linkage.drivers]
            joined += [(linkage.rod, end) for end in (*ends, *linkage.corners)]
        return {frozenset(robot.tree.body(frame)[0] for frame in pair) for pair in joined}

    def _next(self, body: int) -> int:
        """The nearest body towards the root that has a shape."""
        own = set(self._bodies[: self._own].tolist())
        while body >= 0:
            body = self.robot.tree.carrier(body)
            if body in own:
                return body
        return -1

    def _rank(self, body: int) -> int:
        """So many joints of the arm lie between the base and a body, its own included."""
        chain = {int(k): rank for rank, k in enumerate(self.robot.mechanism().chain.coordinates, 1)}
        while body >= 0 and body not in chain:
            body = self.robot.tree.carrier(body)
        return chain.get(body, 0)


def turret(robot: Robot, up: Array) -> int:
    """1 where the arm's first joint turns about a direction (3,) of the base, else 0."""
    if not arm_joints(robot) or not arm_joints(robot)[0].revolute:
        return 0
    return int(abs(robot.screws(robot.rest).axes[0] @ np.asarray(up)) > UPRIGHT)


def _transform(T: pin.SE3) -> coal.Transform3s:
    return coal.Transform3s(T.rotation, T.translation)


def _shape(solid: Solid) -> coal.CollisionGeometry:
    size = solid.size
    if solid.kind == "box":
        return coal.Box(*size)
    if solid.kind == "sphere":
        return coal.Sphere(size[0])
    if solid.kind == "cylinder":
        return coal.Cylinder(*size)
    if solid.kind == "capsule":
        return coal.Capsule(*size)
    if solid.kind == "plane":
        return coal.Halfspace(np.array([0.0, 0.0, 1.0]), 0.0)
    mesh = coal.BVHModelOBBRSS()
    corners = solid.points
    if corners is None:
        raise ValueError("a hull without corners")
    mesh.beginModel(0, len(corners))
    mesh.addVertices(np.asarray(corners))
    mesh.endModel()
    mesh.buildConvexHull(True, "Qt")
    return mesh.convex
