"""What positions could not have shown, what else is how probable, and which poses would tell."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sk120stiff.arrays import Array, Index
from sk120stiff.effects import Effect
from sk120stiff.errors import Refusal
from sk120stiff.explain.absolute.choose import SHARE, SURE, Chosen, entry_price, standing
from sk120stiff.explain.absolute.linear import Linear
from sk120stiff.explain.advise.detectable import length_named
from sk120stiff.explain.findings import Detectable
from sk120stiff.identify.absolute.calibrate import Calibration
from sk120stiff.identify.absolute.pose_problem import PoseProblem
from sk120stiff.measurements import Measurements
from sk120stiff.plan import Cell, Rig, Rivalry, cell_from_data, random_pool
from sk120stiff.plan.discriminate import over_ranges, with_both

# What is left out by other poses grows by λ ± 2 √λ: √λ at which it is confirmed in 80 % of cases.
CONFIRMED = 2.0 * (SURE + 0.84)
LEAST = 0.01  # probability below which nobody is told
POOL, COUNT = 200, 8  # poses to choose from, and chosen


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


def detectable(linear: Linear, found: Chosen) -> tuple[Detectable, ...]:
    """Smallest size of every candidate's parameters that would have brought a name, its own or that
    of what explains as much.

    See `sk120stiff.explain.advise.detectable`; the price is that of evidence and of confirmation.
    """
    chosen = found.order
    noise = linear.noise(chosen)
    inside = linear.picked(chosen)
    Q = np.asarray(np.linalg.qr(np.column_stack([linear.base, linear.columns])[:, inside])[0])
    left = linear.columns - Q @ (Q.T @ linear.columns)
    out = []
    for e in linear.may_join(chosen):
        effect, own = linear.candidates[e], linear.slices[e]
        block = left[:, own]
        volume = float(np.linalg.slogdet(np.eye(block.shape[1]) + block.T @ block / noise)[1])
        price = 2.0 * entry_price(linear, e) + volume
        fall = max(price, 2.0 * SHARE * len(linear.residual))
        need = max(length_named(round(fall, 1), block.shape[1]), CONFIRMED) * np.sqrt(noise)
        for k, (spec, usual) in enumerate(zip(effect.parameters, linear.sizes[own], strict=True)):
            size = float(np.linalg.norm(block[:, k]))
            value = float(need / size * usual) if size > 0.0 else np.inf
            shown = spec.public(value) if value <= spec.plausible else None
            out.append(Detectable(f"{effect.id}.{spec.name}", shown, spec.unit))
    return tuple(out)


def probabilities(linear: Linear, found: Chosen) -> dict[str, float]:
    """Name → probability of its being at work, of all above `LEAST`.

    Named causes share theirs with what explains as much; others stand beside the named ones. What
    fitted and was not confirmed by poses left out is not counted.
    """
    out: dict[str, float] = {}
    for e in found.order:
        for name, share in standing(linear, found.order, e).items():
            out[name] = max(out.get(name, 0.0), share)
    noise = linear.noise(found.order)
    now = linear.score(found.order, noise)
    for e in linear.may_join(found.order):
        effect = linear.candidates[e]
        if e in found.dropped or effect.id in out:
            continue
        odds = linear.score((*found.order, e), noise) - now - entry_price(linear, e)
        out[effect.id] = float(1.0 / (1.0 + np.exp(-np.clip(odds, -50.0, 50.0))))
    return {name: p for name, p in out.items() if p >= LEAST}


def next_poses(
    final: Calibration,
    effect: Effect,
    rival: Effect,
    *,
    seed: int,
    count: int = COUNT,
    cell: Cell | None = None,
) -> NextPoses | None:
    """Poses at which positions tell a named cause from another that explains as much.

    They keep to the cell, where it names no floor go no lower than the poses that were measured,
    and keep clear of the base column; payload and temperature are as there. None where no such pose
    is found.
    """
    problem = final.problem
    robot, readings = problem.model.robot, problem.measurements
    load_cases = problem.load_cases
    at = load_cases.point[0]
    bare = replace(cell or Cell(), rig=Rig())  # nothing pulls
    within = cell_from_data(robot, bare, load_cases.a, np.zeros((1, 6)), at)
    try:
        pool = random_pool(
            robot, poses=POOL, directions=1, force=1.0, point=at, seed=seed, cell=within
        )  # fmt: skip
    except Refusal:
        return None  # no other pose can be driven as far as is known
    a = pool.load_cases.a
    rows = np.random.default_rng(seed).integers(readings.n_readings, size=len(a))
    like = readings.select(rows)
    drawn = replace(
        like, joints=a, pose=tuple(f"pool_{k + 1}" for k in range(len(a))),
        zero_group=np.arange(len(a)), zero_joints=None,
    )  # fmt: skip
    pairs = ((effect, rival), (rival, effect))
    known = [_columns(problem, readings, *pair)[0] for pair in pairs]
    gains = []
    for A, row in (_columns(problem, drawn, *pair) for pair in pairs):
        each = np.zeros((len(a), A.shape[1], A.shape[1]))
        np.add.at(each, row, A[:, :, None] * A[:, None, :])
        gains.append(each)
    both = Rivalry.of(gains, [A.T @ A for A in known])
    choice = both.best(min(count, len(a)))
    picked = drawn.select(np.array(choice.rows))
    return NextPoses(
        _blank(picked, f"Poses and loads that tell {effect.id} from {rival.id}."),
        (effect.id, rival.id),
        choice.before,
        choice.after,
    )


def _blank(picked: Measurements, source: str) -> Measurements:
    """Readings to take: joint values as people type them, nothing of when or what was read."""
    said, count = picked.absolute, picked.n_readings
    if said is None:
        raise ValueError("these are no positions")
    return replace(
        picked,
        pose=tuple(f"next_{k + 1}" for k in range(count)),
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


def open_pair(named: Sequence[tuple[Effect, tuple[str, ...]]], linear: Linear) -> (
    tuple[Effect, Effect] | None
):  # fmt: skip
    """The first name that something else explains as well, and what."""
    known = {effect.id: effect for effect in linear.candidates}
    for effect, others in named:
        if others:
            return effect, known[others[0]]
    return None
