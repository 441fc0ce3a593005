"""Names that no other poses tell apart, and the poses that tell the others."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sk120stiff.arrays import Array, Index
from sk120stiff.effects import Effect
from sk120stiff.errors import Refusal
from sk120stiff.explain.candidates.aliases import imitators
from sk120stiff.explain.options import Options
from sk120stiff.identify.absolute.calibrate import Calibration
from sk120stiff.identify.absolute.pose_problem import PoseProblem
from sk120stiff.measurements import Measurements
from sk120stiff.measurements.poses import labels_to_come
from sk120stiff.plan import Cell, Rig, Rivalry, cell_from_data, random_pool
from sk120stiff.plan.discriminate import over_ranges, with_both

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
    both = ((effect, rival), (rival, effect))
    known = [_columns(problem, problem.measurements, *pair)[0] for pair in both]
    gains = []
    for A, row in (_columns(problem, there, *pair) for pair in both):
        each = np.zeros((there.n_readings, A.shape[1], A.shape[1]))
        np.add.at(each, row, A[:, :, None] * A[:, None, :])
        gains.append(each)
    choice = Rivalry.of(gains, [A.T @ A for A in known]).best(min(COUNT, there.n_readings))
    picked = there.select(np.array(choice.rows))
    labels = labels_to_come(problem.measurements.pose, picked.n_readings)
    return NextPoses(
        _blank(picked, labels, f"Poses and loads that tell {effect.id} from {rival.id}."),
        (effect.id, rival.id),
        choice.before,
        choice.after,
    )


def _blank(picked: Measurements, pose: tuple[str, ...], source: str) -> Measurements:
    """Readings to take: joint values as people type them, nothing of when or what was read."""
    said, count = picked.absolute, picked.n_readings
    if said is None:
        raise ValueError("these are no positions")
    return replace(
        picked,
        pose=pose,
        joints=np.where(
            [kind == "angle" for kind in picked.joint_kinds],
            np.radians(np.round(np.degrees(picked.joints), 4)),
            np.round(picked.joints, 7),
        ),
        absolute=replace(
            said,
            channels=replace(said.channels.without(np.ones(count, bool)), sigma_of_rows=None),
            temperature=None,
        ),
        sigma=None, order=None, time=None, branch=None, repeat=None, use=np.ones(count, dtype=bool),
        line=np.zeros(count, dtype=np.int64), path=None, source=source, extra={}, notes=(),
        data_hash="",
    )  # fmt: skip


def _columns(
    problem: PoseProblem, readings: Measurements, effect: Effect, rival: Effect
) -> tuple[Array, Index]:
    """(R, k) columns of R numbers in units of the noise, see `over_ranges`; and their readings."""
    model = with_both(problem.model, effect, rival)
    here = replace(problem, model=model, measurements=readings)
    slope = here.of_channels.apply(here.channel_gap(model.values, derivative=True)[1])
    return over_ranges(model, slope, effect), here.rows
