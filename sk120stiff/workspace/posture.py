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

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError, Refusal
from sk120stiff.plan.feasible import Verdict
from sk120stiff.workspace.arm import ElasticArm
from sk120stiff.workspace.inverse import middle_of, near, starting_poses
from sk120stiff.workspace.judge import Admits, Judge, PathTask, Placement, Pool
from sk120stiff.workspace.jump import refuse_jump, refuse_unreached

FIRST_STEP, LAST_STEP = 0.5, 1e-6  # rad: radius of the random steps
GROW, SHRINK = 1.6, 0.6
ASKED = 20  # of the stiffest postures, what stands against them when none can be


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
