"""From the closures of `robot.yaml` to a coupling that closes them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError, warn
from sk120stiff.robot.description import RobotDescription
from sk120stiff.robot.kinematics.chain import Chain
from sk120stiff.robot.kinematics.coupling import Follower, LinearCoupling, linear_coupling
from sk120stiff.robot.kinematics.tree import Tree
from sk120stiff.robot.loops.closing import Closer
from sk120stiff.robot.loops.constraint import Closure, Constraint
from sk120stiff.robot.loops.coupling import CLOSED, LoopCoupling

_FAR = 0.05  # rad, or parts of a loop's length: a start that is this far off was not meant


def loop_coupling(
    tree: Tree,
    closures: Sequence[Closure],
    actuated: Sequence[str],
    followers: dict[str, Follower],
    rest: dict[str, float],
    start: Mapping[str, float],
) -> LoopCoupling:
    """Coupling of all joints of a tree with closed loops to its actuated ones.

    Args:
        tree: The robot, opened at the closures.
        closures: What closes it. Where one names no dependent joints, those joints of its loop are
            dependent that are neither driven, locked, nor coupled by a rule.
        actuated: Joints that motors drive.
        followers, rest: Mimic rules, and values of locked joints.
        start: Values [rad or m] of joints near which the loops are closed, in the wanted assembly
            mode; zero where not named.

    Raises:
        InputError: A closure names what does not exist, closes nothing, leaves joints undetermined
            or cannot be closed at the start.

    Warns:
        ToolkitWarning: No start is given, and the loops are far from closed with all joints at
            zero: the assembly mode was a matter of chance.
    """
    constraints = tuple(_constraint(tree, closure) for closure in closures)
    dependent = _dependent(tree, constraints, actuated, followers, rest)
    linear = linear_coupling(tree.joint_names, [*actuated, *dependent], followers, rest)
    names = (*actuated, *dependent)
    turns = np.array([bool(tree.revolute[tree.joint_index(name)]) for name in names])
    size = max(constraint.size for constraint in constraints)
    felt = linear.A[np.concatenate([c.coordinates for c in constraints])].any(axis=0)
    scale = np.where(felt, np.where(turns, 1.0, size), np.inf)
    for name in start:
        _joint(tree, name, "start of the closures")
    wanted = np.array([start.get(name, 0.0) for name in names])
    rows = _rows(linear, constraints, wanted, scale, len(actuated), dependent)
    closer = Closer(linear, len(actuated), scale, constraints, rows)
    return LoopCoupling(closer, names, turns, _started(closer, wanted, names, turns, bool(start)))


def closures_of(description: RobotDescription) -> tuple[Closure, ...]:
    """The closures that `robot.yaml` declares.

    Raises:
        InputError: Two of one name, or an axis without a direction.
    """
    found: list[Closure] = []
    for rule in description.closures:
        name = rule.name or " = ".join(rule.frames)
        length = float(np.linalg.norm(rule.axis))
        if not np.isfinite(length) or length < 1e-12:
            raise InputError(
                "the axis has no direction",
                where=f"closure {name!r}",
                remedy="Write the pin's direction in the axes of either frame: axis: [0, 1, 0].",
            )
        if name in [closure.name for closure in found]:
            raise InputError(
                "two closures have this name", where=f"closure {name!r}", remedy="Rename one."
            )
        x, y, z = (float(part) / length for part in rule.axis)
        found.append(Closure(name, rule.frames, rule.type, (x, y, z), rule.dependent))
    return tuple(found)


def loop_drivers(
    tree: Tree,
    closures: Sequence[Closure],
    on_way: Sequence[str],
    followers: Mapping[str, Follower],
    rest: Mapping[str, float],
) -> tuple[str, ...]:
    """Actuated joints of a robot with loops whose `robot.yaml` does not name them.

    They are the joints on the way to the tool and those of the loops, without the dependent ones.

    Raises:
        InputError: A closure does not say which of its joints depend on it: no guess is made which
            joints of a loop have a motor.
    """
    joints: list[str] = list(on_way)
    dependent: list[str] = []
    for closure in closures:
        own = _independent(tree, [_constraint(tree, closure)], followers)
        if not closure.dependent:
            raise InputError(
                f"which joints of the loop have a motor? Its joints are: {', '.join(own)}",
                where=f"closure {closure.name!r}",
                remedy="Name the driven joints of the robot under 'actuated:', or the others of "
                "this loop under 'dependent:' of the closure.",
            )
        dependent.extend(closure.dependent)
        joints.extend(name for name in own if name not in joints)
    return tuple(name for name in joints if name not in dependent and name not in rest)


def _constraint(tree: Tree, closure: Closure) -> Constraint:
    try:
        near, far = (tree.chain(_root(tree), frame) for frame in closure.frames)
    except InputError as error:
        where = f"closure {closure.name!r}"
        raise InputError(error.what, where=where, remedy=error.remedy) from error
    shared = 0
    while shared < min(near.m, far.m) and near.names[shared] == far.names[shared]:
        shared += 1
    if near.m == shared and far.m == shared:
        raise InputError(
            f"the frames {closure.frames[0]!r} and {closure.frames[1]!r} are on one body, so "
            "there is nothing to close",
            where=f"closure {closure.name!r}",
            remedy="Name two frames that meet at a pin of the loop.",
        )
    return Constraint(closure, (_beyond(near, shared), _beyond(far, shared)))


def _joint(tree: Tree, name: str, where: str) -> None:
    """Make sure that the joint exists."""
    try:
        tree.joint_index(name)
    except InputError as error:
        raise InputError(error.what, where=where, remedy=error.remedy) from error


def _root(tree: Tree) -> str:
    return next(name for name in tree.frame_names if tree.body(name)[0] < 0)


def _beyond(chain: Chain, shared: int) -> Chain:
    return Chain(
        chain.names[shared:],
        chain.placements[shared:],
        chain.axes[shared:],
        chain.revolute[shared:],
        chain.coordinates[shared:],
    )


def _independent(
    tree: Tree, constraints: Sequence[Constraint], followers: Mapping[str, Follower]
) -> tuple[str, ...]:
    found: list[str] = []
    for constraint in constraints:
        for side in constraint.sides:
            for name in side.names:
                seen = {name}
                while name in followers and followers[name].driver not in seen:
                    name = followers[name].driver
                    seen.add(name)
                if name not in found and name in tree.joint_names:
                    found.append(name)
    return tuple(found)


def _dependent(
    tree: Tree,
    constraints: Sequence[Constraint],
    actuated: Sequence[str],
    followers: Mapping[str, Follower],
    rest: Mapping[str, float],
) -> tuple[str, ...]:
    """Joints that the loops determine, as named or as left over."""
    everything = _independent(tree, constraints, followers)
    found: list[str] = []
    for constraint in constraints:
        named = constraint.closure.dependent
        where = f"closure {constraint.closure.name!r}"
        for name in named:
            _joint(tree, name, where)
            why = ""
            if name in followers:
                why = f"it follows {followers[name].driver!r} by a rule"
            elif name in actuated:
                why = "it is actuated"
            elif name in rest:
                why = "it is locked"
            elif name not in everything:
                why = "it is in no loop"
            if why:
                raise InputError(
                    f"the joint {name!r} cannot depend on the loop because {why}",
                    where=where,
                    remedy=f"Joints of the loops are: {', '.join(everything)}.",
                )
        left = [
            name
            for name in _independent(tree, [constraint], followers)
            if name not in actuated and name not in rest
        ]
        found.extend(name for name in named or left if name not in found)
    if not found:
        raise InputError(
            "every joint of the loop is driven or locked, so nothing can close it",
            where=f"closure {constraints[0].closure.name!r}",
            remedy=f"Take dependent joints out of 'actuated' or 'lock': {', '.join(everything)}.",
        )
    return tuple(found)


def _rows(
    linear: LinearCoupling,
    constraints: tuple[Constraint, ...],
    start: Array,
    scale: Array,
    driven: int,
    dependent: tuple[str, ...],
) -> Array | None:
    """(e, r) rows of the constraints that the dependent joints can act on at all.

    A planar loop has rows across its plane that no joint ever moves. They are found by moving the
    joints at random, the loop open: what no column of C_d ever reaches is no equation.
    """
    rng = np.random.default_rng(0)
    reach = np.where(np.isfinite(scale), scale, 1.0)
    samples = start + 0.5 * reach * rng.uniform(-1.0, 1.0, (16, len(start)))
    closer = Closer(linear, driven, scale, constraints)
    _, derivative = closer.system(closer.gaps(samples[:, :driven], samples[:, driven:]))
    C_d = derivative[:, :, driven:] * scale[driven:]  # (16, e, r)
    reached, values, _ = np.linalg.svd(np.concatenate(C_d, axis=1))
    count = int((values > 1e-9 * values[0]).sum()) if values[0] > 0.0 else 0
    rank = int(np.linalg.matrix_rank(C_d, tol=1e-9 * max(values[0], 1e-300)).max())
    if rank < len(dependent):
        names = ", ".join(repr(constraint.closure.name) for constraint in constraints)
        raise InputError(
            f"the loops determine {rank} joints, but {len(dependent)} are left free: "
            + ", ".join(dependent),
            where=f"closure {names}",
            remedy=f"Name {rank} of them under 'dependent:', and drive ('actuated:') or hold "
            "('lock:') the others.",
        )
    return reached[:, :count] if count == len(dependent) else None


def _started(
    closer: Closer, wanted: Array, names: tuple[str, ...], turns: Array, given: bool
) -> Array:
    """(n + r,) a closed pose near the wanted one."""
    n = closer.driven
    z, d = wanted[None, :n], wanted[None, n:]
    for _ in range(12):  # each of them up to eight Newton steps
        d, closed = closer.newton(z, d)
        if closed[0]:
            break
    apart = max(
        float(np.linalg.norm(gap.value)) / constraint.size
        for gap, constraint in zip(closer.gaps(z, d), closer.constraints, strict=True)
    )
    loops = ", ".join(repr(constraint.closure.name) for constraint in closer.constraints)
    if not closed[0] or apart > CLOSED:
        raise InputError(
            f"the loop cannot be closed near the start: a gap of {1e3 * apart * closer.size:.3g} mm"
            " stays",
            where=f"closure {loops}",
            remedy="Write values of all its joints at a closed pose under 'start:', or name more "
            "dependent joints.",
        )
    off = np.abs((d - wanted[n:]) / closer.scale[n:])[0]
    if not given and off.max() > _FAR:
        moved = ", ".join(
            f"{name}: {value:.6g}" for name, value in zip(names[n:], d[0], strict=True)
        )
        warn(
            f"closure {loops}: the loop is open with all joints at zero; it was closed with "
            f"{moved}. If that is the wrong assembly mode, write these joints' values at a right "
            "one as start: under the closure in robot.yaml",
            stacklevel=4,
        )
    if turns[n:].any():
        turned = d[0] - wanted[n:]
        whole = np.where(turns[n:], 2.0 * np.pi * np.round(turned / (2.0 * np.pi)), 0.0)
        d = d - whole
    return np.concatenate([z[0], d[0]])
