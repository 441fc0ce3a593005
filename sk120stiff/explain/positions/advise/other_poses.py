"""Names that no other poses tell apart, and the poses that tell the others."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sk120stiff.effects import Effect
from sk120stiff.errors import Refusal
from sk120stiff.explain.candidates.aliases import imitators
from sk120stiff.explain.options import Options
from sk120stiff.identify.positions.calibrate import Calibration
from sk120stiff.measurements import Measurements
from sk120stiff.measurements.noise.rays import anywhere
from sk120stiff.measurements.poses import labels_to_come
from sk120stiff.plan import Cell, Rig, cell_from_data, random_pool
from sk120stiff.plan.discriminate import with_both
from sk120stiff.plan.positions_pool import rivalry_of, to_be_read

POOL, COUNT = 200, 8  # poses to choose from, and chosen
TOLD = 3.0  # standard deviations by which new readings must tell two names apart
PAIRS = 3  # open pairs that poses are looked for, one after the other


@dataclass(frozen=True, eq=False)
class NextPoses:
    """Readings that tell two names apart.

    Attributes:
        readings: K readings to take, a plan: their cells are blank.
        between: The two names.
        before, after: √λ between them without and with these, in units of the noise.
    """

    readings: Measurements
    between: tuple[str, str]
    before: float
    after: float


def elsewhere(final: Calibration, options: Options) -> Measurements | None:
    """Readings like those that were taken at other poses, all that a campaign could go on to.

    They keep to the cell, where it names no floor go no lower than the poses that were measured,
    and keep clear of the base column; payload, load and temperature are as there. None where no
    other pose can be driven as far as is known.
    """
    problem, seed = final.problem, options.seed
    robot, readings = problem.model.robot, problem.measurements
    load_cases = problem.load_cases
    at = load_cases.point[0]
    bare = replace(options.cell or Cell(), rig=Rig())  # nothing pulls
    within = cell_from_data(robot, bare, load_cases.a, np.zeros((1, 6)), at)
    try:
        pool = random_pool(
            robot, poses=POOL, directions=1, force=1.0, point=at, seed=seed, cell=within
        )  # fmt: skip
    except Refusal:
        return None
    a = pool.load_cases.a
    like = readings.select(np.random.default_rng(seed).integers(readings.n_readings, size=len(a)))
    if like.absolute is not None:
        channels = anywhere(like.absolute.channels)
        like = replace(like, absolute=replace(like.absolute, channels=channels))
    return replace(
        like, joints=a, pose=tuple(f"pool_{k + 1}" for k in range(len(a))),
        zero_group=np.arange(len(a)), zero_joints=None,
    )  # fmt: skip


def never_told(
    final: Calibration, there: Measurements, effect: Effect, others: Sequence[Effect]
) -> tuple[str, ...]:
    """Those of `others` that imitate a named effect in all readings of this kind.

    Args:
        final: The calibration, which holds the effect.
        there: Readings at other poses.
        effect: The named effect.
        others: What explains as much here.
    """
    model = final.problem.model
    for other in others:
        model = with_both(model, effect, other)
    here = replace(final.problem, model=model, measurements=there)
    slope = here.of_channels.apply(here.channel_gap(model.values, derivative=True)[1])
    owner = np.array([p.effect.id for p in model.parameters])
    typical = np.array([p.spec.typical for p in model.parameters])
    names = [other.id for other in others]
    free = np.array([p.free for p in model.parameters])
    beside = free & ~np.isin(owner, [effect.id, *names])
    values = (model.values / typical)[owner == effect.id]
    return imitators(slope * typical, owner, beside, effect.id, names, values)


def next_poses(
    final: Calibration, there: Measurements, pairs: Iterable[tuple[Effect, Effect]]
) -> NextPoses | None:
    """Poses at which positions tell a named cause from another that explains as much.

    Of the first of the pairs that any poses tell apart; None where they tell none.
    """
    for effect, rival in list(pairs)[:PAIRS]:
        found = _telling(final, there, effect, rival)
        if found.after >= TOLD:
            return found
    return None


def _telling(final: Calibration, there: Measurements, effect: Effect, rival: Effect) -> NextPoses:
    """The readings of a pool that tell most between two names."""
    problem = final.problem
    pool = replace(problem, measurements=there)
    rivals = rivalry_of(pool, problem.measurements, effect, rival, pool.rows)
    choice = rivals.best(min(COUNT, there.n_readings))
    picked = to_be_read(
        there.select(np.array(choice.rows)),
        f"Poses and loads that tell {effect.id} from {rival.id}.",
    )
    labels = labels_to_come(problem.measurements.pose, picked.n_readings)
    return NextPoses(
        replace(picked, pose=labels), (effect.id, rival.id), choice.before, choice.after
    )
