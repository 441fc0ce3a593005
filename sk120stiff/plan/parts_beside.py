"""What links, bearings and floors that may yield will make of springs, where positions are planned.

A fit of the readings will count them (`identify.positions.uncertainty.compliant_parts`): so a plan
does.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects import CATALOGUE
from sk120stiff.identify.checks.left_over import beside, orthonormal
from sk120stiff.identify.positions.omitted.other_causes import causes_at, slopes
from sk120stiff.identify.positions.solve.pose_problem import PoseProblem
from sk120stiff.identify.uncertainty.parts import ROUNDING, expected_weights, taken, yields
from sk120stiff.plan.positions_pool import PositionsPool


@dataclass(frozen=True, eq=False)
class PartsBeside:
    """What parts that may yield add to the variances of the estimates.

    Attributes:
        variance: (P,) of the free parameters, internal.
        most: (P,) the part that adds most to each, ``name:where``; empty where none does.
    """

    variance: Array
    most: tuple[str, ...]


def parts_beside(pool: PositionsPool, chosen: Sequence[int], seed: int) -> PartsBeside:
    """Of the candidates that are chosen, beside the readings that were taken already.

    Parts are expected to be rigid; how far the readings leave that open is their part in the ±.
    `seed`: of the noise that these may have.
    """
    model, span = pool.problem.model, pool.span
    free = [model.parameters[k] for k in model.free]
    x = np.array([p.internal for p in free])
    springs = np.array([p.effect.joint_spring for p in free], dtype=bool) & (x > 0.0)
    readings = pool.problem.measurements.select(pool.rows_of(np.asarray(chosen, dtype=np.intp)))
    problems = [replace(pool.problem, measurements=readings)]
    if pool.known is not None:
        problems.append(replace(pool.problem, measurements=pool.known))
    every = causes_at(
        model.robot, problems[0].load_cases, readings, [e.id for e in model.effects], CATALOGUE
    )
    parts = tuple(cause for cause in every if yields(cause))
    if not springs.any() or not parts:
        return PartsBeside(np.zeros(len(free)), ("",) * len(free))

    def columns(problem: PoseProblem) -> tuple[Array, Array]:
        own = problem.channel_gap(model.values, derivative=True)[1][:, model.free]
        white, slope = problem.of_channels.apply, slopes(problem, model, parts)
        usual = [slope[each] * [spec.usual for spec in each.parameters] for each in parts]
        return white(own * span), white(np.hstack(usual))

    kept, ways = (np.vstack(part) for part in zip(*map(columns, problems), strict=True))
    takes = taken(kept, np.ones(len(free)), ways) * span
    shown = beside(orthonormal(kept, ROUNDING), ways)
    share = np.abs(takes[:, springs] / x[springs]).max(axis=1)
    added = expected_weights(shown, share, np.random.default_rng(seed))[:, None] * takes**2
    names = [each.id for each in parts for _ in each.parameters]
    most = tuple(names[int(np.argmax(own))] if own.any() else "" for own in added.T)
    return PartsBeside(added.sum(axis=0), most)
