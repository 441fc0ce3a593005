"""A model becomes a `MovingArm`: its chain with all compliances first, then what hangs on it."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import numpy as np
from scipy.sparse.csgraph import connected_components

from sk120stiff.arrays import Array, Index
from sk120stiff.effects import Elastic, LinearElastic, load_case
from sk120stiff.effects.switching import Switching
from sk120stiff.errors import InputError
from sk120stiff.exports.contract import Request, Told
from sk120stiff.exports.geometry import IN_MASSES, MEASURED, Geometry, geometry_of, weighing
from sk120stiff.exports.moving import RIGID, SERVO, Body, Joint, MovingArm, Tied
from sk120stiff.model import Model, ModelCompliance, model_compliance, probing_poses
from sk120stiff.robot import Chain, LinearCoupling
from sk120stiff.robot.rotations import homogeneous, joint_motion
from sk120stiff.robot.visuals import visuals
from sk120stiff.stiffness.elastic import are_springs, stiffness_of

LEAST = 0.01  # of a stated inertia, that a piece has of its own at least
_SMALL = 1e-12  # share of a row below which a number is a zero that was computed

Place = tuple[int, Array]  # a body, and a (4, 4) placement on it


def moving_arm(model: Model, request: Request, *, ties: bool = True) -> MovingArm:
    """The arm that a model describes, standing at a pose, a load to act at a frame.

    Without `ties` no torque of one coordinate moves another.

    Raises:
        InputError: A closed loop that is not linear, compliances no springs can make, or nothing
            that yields.
    """
    frame = request.frame or model.robot.tool_frame
    arm = model_compliance(model, frame)
    coupling = arm.mechanism.elastic or arm.mechanism.coupling
    if not isinstance(coupling, LinearCoupling):
        raise InputError(
            "a closed loop couples joints in a way that no spring or mimic joint can",
            where=model.robot.name,
            remedy="Declare parallelograms as couplings in robot.yaml, or export a URDF.",
        )
    pose = model.robot.rest if request.pose is None else model.robot.coordinates(request.pose)
    return _Builder(arm, coupling, geometry_of(arm.model), pose, frame, ties).built()


def told_of(model: Model) -> tuple[tuple[Told, ...], tuple[Told, ...]]:
    """What a `MovingArm` carries of a model's effects, and what it leaves out."""
    geometry = geometry_of(model)
    carried, left_out = list(geometry.carried), list(geometry.left_out)
    carried += weighing(model, IN_MASSES)
    load_cases = load_case(model.robot, probing_poses(model.robot), np.zeros(6))
    for effect, part in zip(model.effects, model.assembly.slices, strict=True):
        if not isinstance(effect, Elastic) or not model.values[part].any():
            continue
        if isinstance(effect, Switching):
            left_out.append(Told(effect.id, "jumps with the sign of a torque: no spring does"))
        elif not isinstance(effect, LinearElastic):
            torques = np.zeros((load_cases.count, len(effect.coordinates(model.robot))))
            if effect.elongation(torques, load_cases, model.values[part]).by_torque.any():
                how = "as a spring, as stiff as it is under the weight alone"
                carried.append(Told(effect.id, how))
            left_out.append(Told(effect.id, "how its stiffness goes with the load"))
        elif (patterns := effect.patterns(load_cases)).ndim == 3 or not np.ptp(patterns, 1).any():
            carried.append(Told(effect.id, "as springs"))
        else:
            carried.append(Told(effect.id, "as springs, as stiff as they are at the pose"))
            left_out.append(Told(effect.id, "how its stiffness goes with the pose"))
    return tuple(carried), tuple(left_out)


class _Builder:
    """The state of one construction; `built` runs it from the base to the last shape."""

    def __init__(
        self,
        arm: ModelCompliance,
        coupling: LinearCoupling,
        geometry: Geometry,
        pose: Array,
        frame: str,
        ties: bool,
    ) -> None:
        self.robot, self.mechanism, self.point = arm.model.robot, arm.mechanism, arm.point
        self.coupling, self.geometry, self.pose, self.frame = coupling, geometry, pose, frame
        self.heavier = arm.model.assembly.heavier(arm.model.values)
        virtual = [joint.name for joint in self.mechanism.virtual]
        self.names = [*self.robot.actuated, *virtual]
        n = self.mechanism.n
        C = arm.compliance_at(pose[None]).reshape(-1, n, n)[0]
        C = C if ties else np.diag(np.diagonal(C)).copy()
        self.soft: Index = np.flatnonzero(C.any(axis=0))
        self.servos = np.full(self.robot.n, RIGID)
        for k in self.soft[self.soft < self.robot.n]:
            self.servos[k] = SERVO / C[k, k]
            C[k, k] -= C[k, k] / SERVO
        self.K = stiffness_of(C)[np.ix_(self.soft, self.soft)]
        if not are_springs(self.K):
            raise InputError(
                "the compliances of this model cannot be made of springs",
                where=self.robot.name,
                remedy="A coupling of joints is larger than their own compliances allow.",
            )
        self.bodies = [Body(self.robot.base_frame, -1, np.eye(4), None)]
        self.places: dict[str, Place] = {}
        self.held: dict[str, float] = {}
        tree = self.robot.tree
        zeros = coupling.A[: len(tree.joint_names), : self.robot.n] @ geometry.shift[: self.robot.n]
        self.zeros = dict(zip(tree.joint_names, zeros, strict=True))

    def built(self) -> MovingArm:
        """The whole arm."""
        tip = self._chain()
        self._tree()
        self._rename()
        springs = self._tied()
        look = visuals(self.robot)
        robot = self.robot
        sites = [(self.frame, *self._shifted(tip, self.point))]
        if self.geometry.measured.any():
            flange = self._shifted(tip, self.point - self.geometry.measured)
            sites = [(f"{self.frame}{MEASURED}", *sites[0][1:]), (self.frame, *flange)]
        return MovingArm(
            robot.name,
            robot.actuated,
            tuple(self.bodies),
            tuple(
                (name, *place)
                for name, place in self.places.items()
                if name != self.bodies[place[0]].name
            ),
            tuple(sites),
            tuple(
                (self.places[v.link][0], self.places[v.link][1] @ v.T_link_visual, v)
                for v in look.shapes
            ),
            springs,
            robot.gravity_in_base if self.mechanism.chain.weighs else np.zeros(3),
            self.held,
        )

    @staticmethod
    def _shifted(place: Place, point: Array) -> Place:
        return place[0], place[1] @ homogeneous(point)

    def _chain(self) -> Place:
        """Bodies of the chain with their masses; where its end frame is."""
        chain, robot = self.mechanism.chain, self.robot
        q, shift = self.mechanism.coupling.m, self.geometry.shift
        inertias = iter(robot.tree.inertias(robot.base_frame, robot.tool_frame))
        virtual = {joint.name: joint for joint in self.mechanism.virtual}
        at, pending, since, link = 0, np.eye(4), np.eye(4), ""
        whole = inertia = np.zeros((3, 3))
        turn: Array = np.eye(3)
        share, spread = _pieces(chain, virtual)
        for e, name in enumerate(chain.names):
            pending = pending @ chain.placements[e]
            since = since @ chain.placements[e]
            axis, turns = chain.axes[e], bool(chain.revolute[e])
            if name in virtual:
                z = robot.n + int(chain.coordinates[e]) - q
                if z in self.soft:
                    at = self._add(name, at, pending, Joint(name, axis, not turns))
                    pending = np.eye(4)
                else:
                    pending = pending @ joint_motion(axis, turns, shift[z])
                joint = virtual[name]
                turn = joint.placement[:3, :3]
                inertia = turn.T @ whole @ turn
                if link and not joint.placement[:3, 3].any():  # as `Chain` has it
                    self.places[link] = (at, pending @ np.linalg.inv(since))
            else:
                link, since, whole = robot.document.by_name[name].child, np.eye(4), next(inertias)
                inertia, turn = whole, np.eye(3)
                pending = pending @ joint_motion(axis, turns, self.zeros[name])
                at, pending = self._real(name, at, pending, axis, turns)
                self.places[link] = (at, pending)
            if chain.masses[e] > 0.0:
                mass = self.heavier * float(chain.masses[e])
                own = self.heavier * share[e] * _of_pieces(inertia, turn.T @ spread[e] @ turn)
                self._weigh(at, pending, mass, chain.centres[e], own)
        tip = pending @ chain.placements[-1]
        last = robot.tree.body(robot.tool_frame)
        if robot.tool_frame not in self.places and last[0] >= 0:
            flange = self._shifted((at, tip), -self.geometry.measured)
            self.places[robot.tool_frame] = flange
        return at, tip

    def _real(self, name: str, at: int, place: Array, axis: Array, turns: bool) -> Place:
        """Add a joint of the robot: motor and gear, a row of followers, or nothing that moves."""
        row = self.coupling.A[self.robot.tree.joint_index(name)]
        offset = float(self.coupling.b[self.robot.tree.joint_index(name)])
        if name in self.robot.actuated:
            k = self.robot.actuated.index(name)
            limits = (float(self.robot.lower[k]), float(self.robot.upper[k]))
            value = float(self.pose[k])
            motor = Joint(
                name, axis, not turns, servo=float(self.servos[k]), value=value, limits=limits
            )
            at = self._add(f"{name}.motor", at, place, motor)
            if k in self.soft:
                at = self._add(
                    f"{name}.gear", at, np.eye(4), Joint(f"{name}.spring", axis, not turns)
                )
            return at, np.eye(4)
        leaders = self._leaders(row)
        if not leaders:
            self.held[name] = offset
            return at, place @ joint_motion(axis, turns, offset)
        for number, (leader, factor, value) in enumerate(leaders):
            own = name if not number else f"{name}.{number}"
            shift = 0.0 if number else offset
            joint = Joint(own, axis, not turns, leader=(leader, factor, shift))
            joint = replace(joint, value=factor * value + shift)
            at = self._add(f"{own}.follower", at, place, joint)
            place = np.eye(4)
        return at, place

    def _leaders(self, row: Array) -> list[tuple[str, float, float]]:
        """Joints that a joint follows: name, factor, and their value at the pose."""
        found = []
        for z in np.flatnonzero(row):
            name, factor = self.names[z], float(row[z])
            if z < self.robot.n:
                found.append((name, factor, float(self.pose[z])))
                name = f"{name}.spring"
            if z in self.soft:
                found.append((name, factor, 0.0))
        return found

    def _add(self, name: str, parent: int, place: Array, joint: Joint) -> int:
        self.bodies.append(Body(name, parent, place, joint))
        return len(self.bodies) - 1

    def _weigh(self, at: int, place: Array, mass: float, centre: Array, inertia: Array) -> None:
        """Add a mass to a body; the ground carries what hangs on it without a word."""
        body, R = self.bodies[at], place[:3, :3]
        there = R @ centre + place[:3, 3]
        total = body.mass + mass
        middle = (body.mass * body.centre + mass * there) / total
        both = R @ inertia @ R.T + body.inertia
        for m, c in ((body.mass, body.centre), (mass, there)):
            off = c - middle
            both = both + m * (off @ off * np.eye(3) - np.outer(off, off))
        self.bodies[at] = replace(body, mass=total, centre=middle, inertia=both)

    def _tree(self) -> None:
        """Places of all links: the ground's, those beside the chain, and what is bolted on."""
        document, robot = self.robot.document, self.robot
        upstream = {joint.name for joint in document.way("", robot.base_frame)}
        root: Array = np.eye(4)
        for joint in document.way("", robot.base_frame):
            root = root @ joint.standing(0.0)
        self.places[document.root] = (0, np.asarray(np.linalg.inv(root)))
        todo = [document.root]
        while todo:
            link = todo.pop()
            at, T = self.places[link]
            for joint in document.below.get(link, ()):
                todo.append(joint.child)
                if joint.child in self.places:
                    continue
                place = T @ joint.origin
                if joint.moves and joint.name not in upstream:
                    turns = joint.type != "prismatic"
                    place = place @ joint_motion(joint.axis, turns, self.zeros[joint.name])
                    self.places[joint.child] = self._real(joint.name, at, place, joint.axis, turns)
                else:
                    self.places[joint.child] = (at, place)

    def _rename(self) -> None:
        """The body at which a link lies bears its name."""
        taken = set()
        for link, (at, T) in self.places.items():
            if at and at not in taken and np.allclose(T, np.eye(4), rtol=0.0, atol=1e-12):
                taken.add(at)
                self.bodies[at] = replace(self.bodies[at], name=link)

    def _tied(self) -> tuple[Tied, ...]:
        """Give single springs to their joints; those between several are returned."""
        names = [self.names[z] + (".spring" if z < self.robot.n else "") for z in self.soft]
        index = {body.joint.name: k for k, body in enumerate(self.bodies) if body.joint}
        tied = []
        for block in _blocks(self.K):
            K = self.K[np.ix_(block, block)]
            for i, bound in zip(block, np.abs(K).sum(axis=1), strict=True):
                body = self.bodies[index[names[i]]]
                if body.joint is not None:
                    single = float(K[0, 0]) if len(block) == 1 else 0.0
                    joint = replace(body.joint, stiffness=single, stiffest=float(bound))
                    self.bodies[index[names[i]]] = replace(body, joint=joint)
            if len(block) > 1:
                for value, weights in zip(*_modes(K), strict=True):
                    tied.append(
                        Tied({names[i]: w for i, w in zip(block, weights, strict=True)}, value)
                    )
        return tuple(tied)


def _pieces(chain: Chain, virtual: Collection[str]) -> tuple[Array, Array]:
    """What each joint carries of its link, of which beams are cut.

    Returns:
        share, spread: (m,) share of the link's mass, and (m, 3, 3) second moment [kg·m²] of all its
            pieces as points about the link's centre, axes of the link.
    """
    body = np.cumsum([name not in virtual for name in chain.names])
    masses = np.bincount(body, chain.masses)[body]
    share = np.divide(chain.masses, masses, out=np.zeros(chain.m), where=masses > 0.0)
    at, own = np.empty((chain.m, 3)), np.eye(4)
    for e, name in enumerate(chain.names):
        own = own @ chain.placements[e] if name in virtual else np.eye(4)
        at[e] = own[:3, :3] @ chain.centres[e] + own[:3, 3]
    spread = np.zeros((chain.m, 3, 3))
    for link in np.unique(body):
        here = body == link
        off = at[here] - share[here] @ at[here]
        moments = np.einsum("pi,pi->p", off, off)[:, None, None] * np.eye(3)
        moments = moments - np.einsum("pi,pj->pij", off, off)
        spread[here] = np.einsum("p,pij->ij", chain.masses[here], moments)
    return share, spread


def _of_pieces(whole: Array, spread: Array) -> Array:
    """(3, 3) inertia that the pieces of a link have of their own, together [kg·m²].

    What is left of the link's beside where they are; of a link whose inertia is stated smaller than
    that, a part of what is stated, as of any body.
    """
    left = whole - spread
    values = np.linalg.eigvalsh(left)
    body = values[0] > LEAST * np.trace(whole) and values[0] + values[1] >= values[2]
    return np.asarray(left if body else LEAST * whole)


def _modes(K: Array) -> tuple[list[float], list[list[float]]]:
    values, vectors = np.linalg.eigh(K)
    return values.tolist(), vectors.T.tolist()


def _blocks(K: Array) -> list[list[int]]:
    """Groups of coordinates that K ties together."""
    root = np.sqrt(np.diagonal(K))
    count, group = connected_components(np.abs(K) > _SMALL * np.outer(root, root))
    return [np.flatnonzero(group == k).tolist() for k in range(count)]
