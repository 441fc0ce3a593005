"""A modelled arm at a pose as bodies, joints and springs, the way simulators see it.

Simulators know joints with springs, joints that follow others, and little else. A model's
coordinates are turned into those: every coordinate that yields gets one joint of the chain to its
name, joints that no spring reaches are held where the command puts them, and the rest follow.
Springs that tie coordinates together become springs of weighted sums.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from sk120stiff.arrays import Array, Index
from sk120stiff.errors import InputError
from sk120stiff.model import Model, model_compliance
from sk120stiff.robot import LinearCoupling
from sk120stiff.stiffness.elastic import are_springs, stiffness_of

_SMALL = 1e-12  # share of a row below which a number is a zero that was computed


@dataclass(frozen=True, eq=False)
class Body:
    """One body and the joint that carries it.

    Attributes:
        name: The joint.
        placement: (4, 4) joint frame in the frame of the body before it, all joints at zero [m].
        axis: (3,) unit axis in the joint frame.
        slides: Translation along the axis rather than rotation about it.
        reference: Value of the joint at the commanded pose without load [rad or m].
        stiffness: Spring about `reference` [N·m/rad or N/m]; zero where another body's spring holds
            it.
        limits: (2,) of the joint; infinite where unknown [rad or m].
        mass, centre: Mass [kg] and its centre (3,) in the joint's moving frame [m].
    """

    name: str
    placement: Array
    axis: Array
    slides: bool
    reference: float
    stiffness: float
    limits: tuple[float, float]
    mass: float
    centre: Array


@dataclass(frozen=True, eq=False)
class Sum:
    """A weighted sum of joint values: Σ weight · joint.

    Attributes:
        weights: Joint → weight.
        value: The sum's value at the commanded pose [rad or m].
        stiffness: Spring of the sum [N·m/rad or N/m].
    """

    weights: dict[str, float]
    value: float
    stiffness: float


@dataclass(frozen=True, eq=False)
class Follower:
    """A joint that follows others: joint = Σ factor · driver + offset.

    Attributes:
        joint: The joint.
        drivers: Driver → factor.
        offset: [rad or m].
    """

    joint: str
    drivers: dict[str, float]
    offset: float


@dataclass(frozen=True, eq=False)
class SpringArm:
    """An arm held at a pose, ready for a simulator.

    Attributes:
        name, frame: Robot, and frame at the end of the chain.
        bodies: Base to tool.
        tip: (4, 4) the frame seen from the last body [m].
        springs: Springs between joints.
        followers: Joints that follow.
        held: Joints that nothing lets yield → value at which they are built in [rad or m].
        gravity: (3,) base axes [m/s²]; zero where the robot states no mass.
    """

    name: str
    frame: str
    bodies: tuple[Body, ...]
    tip: Array
    springs: tuple[Sum, ...]
    followers: tuple[Follower, ...]
    held: dict[str, float]
    gravity: Array


def spring_arm(model: Model, pose: ArrayLike, *, frame: str | None = None) -> SpringArm:
    """The arm that a model describes, commanded to a pose.

    Args:
        model: Robot and effects. Laws that are not linear enter with their stiffness at zero load;
            compliances that change with the pose with their value at this one. Instruments have no
            say.
        pose: (n,) commanded coordinates [rad or m].
        frame: End of the chain; the tool frame by default.

    Raises:
        InputError: A closed loop that is not linear, compliances no springs can make, or nothing
            that yields.
    """
    name = frame or model.robot.tool_frame
    arm = model_compliance(model, name)
    robot, mechanism, point = arm.model.robot, arm.mechanism, arm.point
    coupling = mechanism.elastic or mechanism.coupling
    if not isinstance(coupling, LinearCoupling):
        raise InputError(
            "a closed loop couples joints in a way that is exported by no spring or mimic joint",
            where=robot.name,
            remedy="Declare parallelograms as couplings in robot.yaml.",
        )
    a = robot.coordinates(pose)[None]
    springs = stiffness_of(arm.compliance_at(a).reshape(-1, mechanism.n, mechanism.n)[0])
    soft = np.flatnonzero(~np.isposinf(np.diagonal(springs)))
    if not are_springs(springs[np.ix_(soft, soft)]):
        raise InputError(
            "the compliances of this model cannot be made of springs",
            where=robot.name,
            remedy="A coupling of joints is larger than their own compliances allow.",
        )
    z = arm.start(a)[0]
    chain = mechanism.chain
    rows = coupling.A[chain.coordinates]
    values = rows @ z + coupling.b[chain.coordinates]
    own = _owners(rows, soft, chain.names, robot.name)
    limits = dict(zip(robot.actuated, zip(robot.lower, robot.upper, strict=True), strict=True))
    bodies: list[Body] = []
    followers: list[Follower] = []
    held: dict[str, float] = {}
    pending = np.eye(4)
    for k, joint in enumerate(chain.names):
        place = pending @ chain.placements[k]
        turns = bool(chain.revolute[k])
        if not rows[k, soft].any():
            pending = place @ _motion(chain.axes[k], float(values[k]), turns=turns)
            held[joint] = float(values[k])
            centre = pending[:3, :3] @ chain.centres[k] + pending[:3, 3]
            _carry(bodies, float(chain.masses[k]), centre)
            continue
        coordinate = next((z for z, owner in own.items() if owner == k), None)
        low, high = limits.get(joint, (-np.inf, np.inf))
        bodies.append(
            Body(
                name=joint,
                placement=place,
                axis=chain.axes[k],
                slides=not turns,
                reference=float(values[k]),
                stiffness=0.0,
                limits=(float(low), float(high)),
                mass=float(chain.masses[k]),
                centre=chain.centres[k],
            )
        )
        pending = np.eye(4)
        if coordinate is None:
            followers.append(_follower(joint, k, rows, values, soft, own, chain.names))
    sums = _springs(springs, soft, own, rows, values, chain.names)
    single = {next(iter(one.weights)): one for one in sums if len(one.weights) == 1}
    tip = pending @ chain.placements[-1]
    tip = tip.copy()
    tip[:3, 3] += tip[:3, :3] @ point
    return SpringArm(
        name=robot.name,
        frame=name,
        bodies=tuple(_with_spring(body, single) for body in bodies),
        tip=tip,
        springs=tuple(one for one in sums if len(one.weights) > 1),
        followers=tuple(followers),
        held=held,
        gravity=robot.gravity_in_base if chain.weighs else np.zeros(3),
    )


def _owners(rows: Array, soft: Index, names: tuple[str, ...], robot: str) -> dict[int, int]:
    """Coordinate → index of the chain joint that stands for it, depending on nothing else."""
    own: dict[int, int] = {}
    for coordinate in soft:
        alone = [
            k
            for k in range(len(names))
            if rows[k, coordinate] != 0.0 and np.count_nonzero(rows[k, soft]) == 1
        ]
        if not alone and rows[:, coordinate].any():
            raise InputError(
                "a coordinate moves several joints, and none of them alone",
                where=robot,
                remedy="This coupling is not exported.",
            )
        if alone:
            own[int(coordinate)] = min(alone, key=lambda k: abs(abs(rows[k, coordinate]) - 1.0))
    return own


def _follower(
    joint: str,
    k: int,
    rows: Array,
    values: Array,
    soft: Index,
    own: dict[int, int],
    names: tuple[str, ...],
) -> Follower:
    drivers, rest = {}, float(values[k])
    for coordinate in soft:
        if rows[k, coordinate] != 0.0:
            owner = own[int(coordinate)]
            factor = float(rows[k, coordinate] / rows[owner, coordinate])
            drivers[names[owner]] = factor
            rest -= factor * float(values[owner])
    return Follower(joint, drivers, rest)


def _springs(
    springs: Array,
    soft: Index,
    own: dict[int, int],
    rows: Array,
    values: Array,
    names: tuple[str, ...],
) -> list[Sum]:
    """Springs whose energies add up to ½ (z − z₀)ᵀ K (z − z₀), in terms of the owners' joints."""
    known = [int(c) for c in soft if int(c) in own]
    # A coordinate that moves no joint of the chain is relaxed: it leaves a Schur complement.
    idle = [int(c) for c in soft if int(c) not in own]
    K = springs[np.ix_(known, known)]
    if idle:
        cross = springs[np.ix_(known, idle)]
        K = K - cross @ np.linalg.solve(springs[np.ix_(idle, idle)], cross.T)
    scale = np.array([rows[own[c], c] for c in known])  # joint = scale · z + constant
    K = K / np.outer(scale, scale)
    found: list[Sum] = []
    for block in _blocks(K):
        members = [own[known[i]] for i in block]
        stiffness, directions = np.linalg.eigh(K[np.ix_(block, block)])
        if len(block) == 1:
            directions = np.ones((1, 1))
        for value, direction in zip(stiffness, directions.T, strict=True):
            weights = {names[k]: float(w) for k, w in zip(members, direction, strict=True)}
            rest = sum(w * float(values[k]) for k, w in zip(members, direction, strict=True))
            found.append(Sum(weights, float(rest), float(value)))
    return found


def _blocks(K: Array) -> list[list[int]]:
    """Groups of coordinates that K ties together."""
    root = np.sqrt(np.diagonal(K))
    tied = np.abs(K) > _SMALL * np.outer(root, root)
    left, groups = set(range(len(K))), []
    while left:
        group = {min(left)}
        while True:
            grown = {int(j) for i in group for j in np.flatnonzero(tied[i])} | group
            if grown == group:
                break
            group = grown
        groups.append(sorted(group))
        left -= group
    return groups


def _with_spring(body: Body, single: dict[str, Sum]) -> Body:
    if body.name not in single:
        return body
    return replace(body, stiffness=single[body.name].stiffness)


def _carry(bodies: list[Body], mass: float, at: Array) -> None:
    """Add a mass at a point of the last body to that body; without any, the base carries it."""
    if not bodies or mass == 0.0:
        return
    body = bodies[-1]
    total = body.mass + mass
    centre = (body.mass * body.centre + mass * at) / total
    bodies[-1] = replace(body, mass=total, centre=centre)


def _motion(axis: Array, value: float, *, turns: bool) -> Array:
    """(4, 4) of a joint at a value."""
    T = np.eye(4)
    if not turns:
        T[:3, 3] = value * axis
        return T
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    T[:3, :3] += np.sin(value) * cross + (1.0 - np.cos(value)) * cross @ cross
    return T
