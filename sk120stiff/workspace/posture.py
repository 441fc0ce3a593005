"""The best posture for a task: stiffest in a direction, or least deflected under a load.

A task leaves freedom: rotation about the tool's axis, another branch of the arm, more joints than
needed, the place of the part. Many postures at once are let wander through that freedom: each is
put back on the task by inverse kinematics after a random step, followed along the path, judged, and
kept where it is better. Steps grow while they succeed and shrink while they do not.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError, Refusal
from sk120stiff.plan.feasible import Verdict
from sk120stiff.workspace.arm import ElasticArm
from sk120stiff.workspace.inverse import middle_of, near, solve_inverse, starting_poses
from sk120stiff.workspace.judge import Admits, Judge, PathTask, Placement, Pool
from sk120stiff.workspace.reach import why_unreached

FIRST_STEP, LAST_STEP = 0.5, 1e-6  # rad: radius of the random steps
GROW, SHRINK = 1.6, 0.6
ASKED = 20  # of the stiffest postures, what stands against them when none can be
PIECES, FINE = 32, 1000  # of a move that is looked at again in small steps, and of the whole path


@dataclass(frozen=True, eq=False)
class BestPosture:
    """The best posture that was found, and how much there was to gain.

    Attributes:
        a: (N, n) joint coordinates along the path [rad or m].
        placement: (6,) how the part was moved.
        objective: The worst compliance [m/N] or deflection [m] along the path: the smaller the
            better.
        per_point: (N,) the same at every point.
        condition: (N,) smallest over largest singular value of the position Jacobian.
        limit_margin: Smallest distance of any joint from its limits [rad or m].
        admissible: (k,) objectives of the postures that were met at random in the beginning: what
            choosing blindly would give.
        usual: (N, n) the one of these in the middle: as many are better as are worse.
        judge: By what all of them were judged: the arm within its margins, and the path.
    """

    a: Array
    placement: Array
    objective: float
    per_point: Array
    condition: Array
    limit_margin: float
    admissible: Array
    usual: Array
    judge: Judge


def best_posture(
    arm: ElasticArm,
    path: PathTask,
    *,
    minimise: str = "compliance",
    placement: Placement | None = None,
    limit_margin: float = 0.0,
    singularity_margin: float = 0.02,
    largest_step: float = 0.5,
    starts: int = 256,
    kept: int = 16,
    children: int = 8,
    rounds: int = 60,
    seed: int = 0,
    admits: Callable[[Array, Array], Verdict] | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> BestPosture:
    """Search the posture that serves a path best; the worst point of the path counts.

    Args:
        arm: The arm and its stiffness.
        path: Points, orientations, loads.
        minimise: ``compliance``: displacement along `path.direction` per force along it (in the
            softest direction if there is none), so the stiffness is maximised. ``deflection``:
            displacement under `path.wrench`, along `path.direction` or its length.
        placement: Where the part may be put; it stays where it is by default.
        limit_margin: Distance that joints must keep from their limits [rad or m].
        singularity_margin: Smallest allowed `condition`.
        largest_step: Largest change of a joint from one point to the next [rad or m]; more is
            another branch.
        starts, kept, children, rounds: Effort: random postures in the beginning, those that go on,
            steps of each in a round.
        seed: Of the random numbers.
        admits: Which of the poses (N, n) can be under the loads (N, 6) as the part lies, by
            `plan.feasible`; all by default.

    Raises:
        InputError: Nothing to minimise, or shapes that do not fit.
        Refusal: No posture passes the path within limits and margins.
    """
    if minimise not in ("compliance", "deflection"):
        raise InputError(f"{minimise!r} cannot be minimised", remedy="compliance or deflection.")
    if minimise == "deflection" and not np.any(path.wrench):
        raise InputError("nothing deflects without a load", remedy="Give a wrench.")
    judge = Judge(
        replace(arm, lower=arm.lower + limit_margin, upper=arm.upper - limit_margin),
        path.each(),
        minimise,
        placement,
        singularity_margin,
        largest_step,
    )
    rng = np.random.default_rng(seed)
    rest = np.clip(np.zeros(arm.n), judge.arm.lower, judge.arm.upper)
    a = starting_poses(judge.arm, starts, rest)
    moved = rng.uniform(judge.lower, judge.upper, (len(a), 6))
    moved[0] = np.clip(0.0, judge.lower, judge.upper)
    first = judge(a, moved)
    if not np.isfinite(first.objective).any():
        refuse_unreached(judge, a, moved)
        refuse_jump(judge, a, moved)
        raise Refusal(
            f"none of {starts} postures passes all {path.count} points far enough from singular "
            "poses",
            remedy="Lower --singularity-margin, or leave more freedom.",
        )
    asked: Admits | None = None
    if admits is not None:
        asked = partial(_asked, admits, judge)
    passing = first.best(len(first.objective), asked)
    if not len(passing.objective) and asked is not None:
        count = int(np.isfinite(first.objective).sum())
        best = np.argsort(first.objective)[: min(count, ASKED)]
        told = (asked(first.path[k], first.placement[k]) for k in best)
        faults = [why for verdict in told for row in verdict.faults for why in set(row)]
        kinds = Counter(re.sub(r"[-\d.]+", "", why) for why in faults)
        (worst, _), *_ = kinds.most_common(1)
        why = next(each for each in faults if re.sub(r"[-\d.]+", "", each) == worst)
        raise Refusal(
            f"none of {count} postures that pass the path can be; most often: {why}",
            remedy="Look at the cell (cell.yaml) and the path, or leave more freedom.",
        )
    pool = Pool(passing.path[:kept], passing.placement[:kept], passing.objective[:kept])
    radius = np.full(len(pool.objective), FIRST_STEP)
    for done in range(rounds):
        noise = rng.normal(size=(children, len(radius), arm.n + 6)) * radius[:, None]
        trial = judge(
            (pool.path[:, 0] + noise[..., : arm.n]).reshape(-1, arm.n),
            judge.inside(pool.placement + noise[..., arm.n :] * judge.span).reshape(-1, 6),
        )
        better = pool.improve(trial, children, asked)
        pool = better.pool
        radius = np.clip(radius * np.where(better.improved, GROW, SHRINK), LAST_STEP, FIRST_STEP)
        if progress:
            progress(done + 1, rounds)
    return _report(judge, pool, passing.objective, passing.path[len(passing.path) // 2])


def _asked(
    admits: Callable[[Array, Array], Verdict], judge: Judge, a: Array, placement: Array
) -> Verdict:
    return admits(a, judge.loads(placement))


def _report(judge: Judge, pool: Pool, admissible: Array, usual: Array) -> BestPosture:
    """The best of a pool, with what it gives at every point."""
    best = int(np.argmin(pool.objective))
    a, placement = pool.path[best], pool.placement[best]
    # the very same postures by whole turns farther from the limits
    off = 0.5 * (a.min(axis=0) + a.max(axis=0))
    a = a + near(judge.arm, off, middle_of(judge.arm)) - off
    turn, _ = judge.moves(placement[None])
    costs, conditions = zip(
        *(judge.cost(a[k : k + 1], k, turn) for k in range(judge.path.count)), strict=True
    )
    distance = np.minimum(a - judge.arm.lower, judge.arm.upper - a)
    return BestPosture(
        a=a,
        placement=placement,
        objective=float(pool.objective[best]),
        per_point=np.concatenate(costs),
        condition=np.concatenate(conditions),
        limit_margin=float(distance.min()),
        admissible=admissible,
        usual=usual,
        judge=judge,
    )


def refuse_jump(judge: Judge, starts: Array, placement: Array) -> None:
    """Name the points between which a joint jumps, if some posture passes but for that.

    Args:
        judge: By which no posture passes.
        starts, placement: (k, n) and (k, 6) of these postures.

    Raises:
        Refusal: Between which points, which joint, and whether more points would do.
    """
    free = replace(judge, largest_step=np.inf)(starts, placement)
    through = np.flatnonzero(np.isfinite(free.objective))
    path, arm = judge.path, judge.arm
    if not len(through) or path.count < 2:
        return
    moves = np.abs(np.diff(free.path[through], axis=1))  # (k, N - 1, n)
    best = moves[np.argmin(moves.max(axis=(1, 2)))]
    point, joint = (int(k) for k in np.unravel_index(np.argmax(best), best.shape))
    apart = 1e3 * np.linalg.norm(path.position[point + 1] - path.position[point])
    value, unit = (1e3, "mm") if arm.slides[joint] else (180.0 / np.pi, "deg")
    what = (
        f"between point {point + 1} and point {point + 2}, {apart:.0f} mm apart, "
        f"{arm.joints[joint]} jumps by {value * best[point, joint]:.0f} {unit} in the best of "
        f"{len(through)} postures that reach all {path.count} points"
    )
    pieces = min(PIECES, FINE // (path.count - 1))
    if pieces > 1:
        fine = replace(judge, path=finer(path, pieces))
        if np.isfinite(fine(free.path[through, 0], placement[through]).objective).any():
            raise Refusal(
                f"points lie too far from each other: {what}",
                remedy=f"Put points between them: with {pieces - 1} in every move it can be "
                "passed in one branch.",
            )
    raise Refusal(
        f"{what}: no branch goes on there",
        remedy="Turn the tool another way or leave its rotation free (--tool-axis), move or turn "
        "the part (--place), or divide the path there.",
    )


def refuse_unreached(judge: Judge, starts: Array, placement: Array) -> None:
    """Name the first point that no posture reaches, if there is one.

    Raises:
        Refusal: Which point, and whether reach or a joint's limit is what stands in the way.
    """
    turn, shift = judge.moves(placement)
    for point in range(judge.path.count):
        target = judge.task(point, turn, shift)
        if solve_inverse(judge.arm, target, starts).found.any():
            continue
        raise Refusal(
            f"point {point + 1} cannot be reached: "
            + why_unreached(judge.arm, target.rows(np.array([0]))),
            remedy="Move the point or the part (--place), leave the tool's rotation free "
            "(--tool-axis), or lower the margins.",
        )


def finer(path: PathTask, pieces: int) -> PathTask:
    """The same straight way with every move of `PathTask.each` in so many pieces."""
    N = path.count
    at = np.linspace(0.0, N - 1, pieces * (N - 1) + 1)
    here, there = np.floor(at).astype(int), np.ceil(at).astype(int)
    share = (at - here)[:, None]
    axis, rotation = path.axis, path.rotation
    if axis is not None:
        axis = axis[here] * (1.0 - share) + axis[there] * share
        axis = axis / np.maximum(np.linalg.norm(axis, axis=1, keepdims=True), 1e-9)
    if rotation is not None:
        rotation = Slerp(np.arange(N), Rotation.from_matrix(rotation))(at).as_matrix()
    return replace(
        path,
        position=path.position[here] * (1.0 - share) + path.position[there] * share,
        axis=axis,
        rotation=rotation,
        wrench=path.wrench[there],
        direction=None if path.direction is None else path.direction[there],
    )
