"""Poses at which to read where markers stand: a calibration by positions, planned.

The choice is that of `design.py` (D-optimal; for calibration Borm & Menq 1991, Joubair & Bonev
2013) and of `discriminate.py`, among the candidates of `positions_pool.py`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from sk120stiff.arrays import Array, Index, on_one_thread
from sk120stiff.effects import Effect, load_cases_of
from sk120stiff.errors import InputError, Refusal
from sk120stiff.identify import why_unseen
from sk120stiff.identify.positions.solve.pose_problem import absolute_of
from sk120stiff.measurements import Measurements
from sk120stiff.model import Model
from sk120stiff.plan.cell import Cell
from sk120stiff.plan.choosing import Chosen, told_apart
from sk120stiff.plan.design import best_design, refuse_count, that_count
from sk120stiff.plan.efforts import poses_held
from sk120stiff.plan.parts_beside import PartsBeside, parts_beside
from sk120stiff.plan.places import Places
from sk120stiff.plan.planned import LITTLE, POSES, TOO_LITTLE, Expected, Plan, drivable
from sk120stiff.plan.pool import poses_in, same_pose
from sk120stiff.plan.positions_pool import (
    PositionsPool,
    labels_of,
    positions_pool,
    readings_like,
    to_be_read,
)
from sk120stiff.plan.rig import HANGING
from sk120stiff.plan.surroundings import assumptions, cell_from_data
from sk120stiff.robot import Robot

NOTHING_BENDS = (
    "neither weight nor payload puts a torque on it that shows; hang a heavier payload, or beside "
    "its axis"
)
PAIRED = (
    "The URDF states no masses: every pose is read under two payloads, so that the arm's own "
    "weight, which is not known, is in no difference."
)
MARKERS = "The instrument's frame and the markers' places are fitted beside what is to be known."


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class PlanOfPositions(Plan):
    """Poses and payloads at which to read positions next.

    Attributes:
        candidates: What they were chosen from; its model is the one that is to be known.
    """

    candidates: PositionsPool

    @cached_property
    def expected(self) -> tuple[Expected, ...]:
        """See `Plan.expected`."""
        design, untold = self.chosen.design, self.chosen.untold
        if design is None:
            return ()
        span = {p.name: self.candidates.problem.reach(p) for p in self.model.parameters}
        own = dict(zip(design.parameters, design.std.tolist(), strict=True))
        names = [self.model.names[k] for k in self.candidates.problem.model.free]
        cases, found = load_cases_of(self.model.robot, self), list[Expected]()
        for name in self.chosen.names:
            parameter, std = self.model.parameter(name), own.get(name, np.inf)
            why, mostly = untold.get(name), ""
            share = (std / span[name]) ** 2  # of what was plausible before: 1, nothing is told
            if why is None and not share < LITTLE:
                std, why = np.inf, TOO_LITTLE
                if parameter.effect.joint_spring and why_unseen(cases, parameter):
                    why = NOTHING_BENDS
            rigid = std
            if why is None:
                k = names.index(name)
                rigid /= float(np.sqrt(1.0 - share))
                std = float(np.hypot(rigid, np.sqrt(self.parts.variance[k])))
                mostly = self.parts.most[k] if std**2 > 2.0 * rigid**2 else ""
            found.append(Expected(parameter, std, why, rigid, mostly))
        return tuple(found)

    @cached_property
    def parts(self) -> PartsBeside:
        """What links, bearings and floors that may yield add to the ± of `expected`."""
        return parts_beside(self.candidates, self.chosen.rows, self.seed)

    @cached_property
    def foretold(self) -> float:
        """Standard uncertainty per axis of where the fitted model will put the marker [m].

        Root mean square over all poses that were chosen from, as far as the model's laws hold; NaN
        where not all readings are positions, or where two effects are told apart.
        """
        design, problem = self.chosen.design, self.candidates.problem
        if design is None or problem.channels.present != ("position",):
            return np.nan
        total = design.known + design.gains[list(design.rows)].sum(axis=0)
        everywhere = self.candidates.information[0].sum(axis=0)
        share = np.trace(np.linalg.solve(total, everywhere)) / len(problem.rows)
        few = len(problem.model.free) > self.candidates.numbers(len(design.rows))
        return np.nan if few else self.standard * float(np.sqrt(share))


@on_one_thread
def plan_positions(
    model: Model,
    count: int | None = None,
    *,
    loads: int | None = None,
    payloads: Sequence[float] = (),
    payload_point: ArrayLike | None = None,
    between: tuple[Effect, Effect] | None = None,
    parameters: Sequence[str] = (),
    point: ArrayLike | None = None,
    sigma: float | None = None,
    cell: Cell | None = None,
    known: Measurements | None = None,
    places: Places | None = None,
    candidates: int = POSES,
    drive: bool = False,
    seed: int = 0,
) -> PlanOfPositions:
    """The poses at which to read where the marker stands next, such as can be driven.

    D-optimal for springs and small errors of geometry, or T-optimal between two effects.

    Args:
        model: Model with its values; its free parameters are to be known, beside the geometry.
        count: Number of poses; with `places` one at each by default.
        loads: Number of payloads at each of them; one by default, two of several where the URDF
            states no masses: the arm's own weight, which nobody knows then, is in no difference.
        payloads: Masses that may hang on the tool [kg]; those of `known`, or none, by default.
        payload_point: (3,) where they hang in the tool frame [m].
        between: Two effects that are to be told apart instead.
        parameters: Full names of the parameters that count; by default all that can be told, but
            for the instrument's frame and the marker's place.
        point: (3,) about where the marker sits in the tool frame [m]; its place is fitted.
        sigma: Standard uncertainty of one length that is read [m]; that of `known`, or 10 µm, by
            default.
        cell: What poses must keep to.
        known: Readings of this kind that there are already: their markers, payloads and columns
            are those of the plan.
        places: Poses to choose from; poses all over the joints' ranges by default.
        candidates: Number of poses to choose from.
        drive: Order the poses for least driving, by a way that is free of collisions.
        seed: Of the poses that are chosen from.

    Raises:
        InputError: Nothing that counts can be told, a name is unknown, or no pose is left.
        Refusal: Next to no pose can be had, or no free way leads to several of them.

    Examples:
        >>> import sk120stiff as sk
        >>> model = sk.base_model(sk.load_robot("motoman_sk120"))
        >>> made = sk.plan_positions(model, 20, payloads=[0, 50], candidates=40)
        >>> made.n_readings, sorted(set(made.absolute.payload.tolist()))
        (40, [0.0, 50.0])
    """
    if count is None and places is None:
        raise InputError("nothing says how many poses to plan", remedy="Give count, or places.")
    if sigma is not None and not 0.0 < sigma < np.inf:
        raise InputError(f"a plan with sigma = {sigma:g}", remedy="Give a positive number.")
    robot, used = model.robot, None
    light = robot.total_mass == 0.0
    if known is not None:
        if known.absolute is None or known.is_plan:
            raise InputError("these readings are no positions", where=str(known.path or "known"))
        used = known.with_joints(robot.actuated, robot.kinds).masked()
    like = readings_like(robot, used, payloads, payload_point, point)
    within, a, remarks = _standing(robot, like, used, cell, places, count or 1, candidates, seed)
    pool = positions_pool(model, like, a, known=used, sigma=sigma)
    hung = np.unique(pool.problem.said.payload)
    if loads is None:
        loads = 2 if light and len(hung) > 1 else 1
        if loads == 2:
            remarks = (PAIRED, *remarks)
    rivals = None if between is None else pool.rivalry(*between)
    wanted, untold = _wanted(pool, parameters) if rivals is None else ((), {})
    gains, before = pool.information

    def choose(banned: Sequence[Array]) -> tuple[Chosen, Measurements]:
        gone = [same_pose(pool.pool.load_cases.a, each) for each in banned]
        left = np.flatnonzero(~np.any(gone, axis=0)) if gone else np.arange(pool.pool.count)
        if places is not None and count is None:
            left = left[places.one_each(pool.pool.rows(left), gains[left])]
        rest = pool.pool.rows(left)
        size = count or len(np.unique(rest.pose))
        _refuse_count(rest.pose, size, loads)
        if rivals is not None and between is not None:
            chosen = told_apart(rivals.of_candidates(left), rest, (size, loads), between)
        else:
            design = best_design(
                pool.problem.model, wanted, gains[left], before, pool.span, size, rest.pose, loads
            )
            names = (*wanted, *untold)
            chosen = Chosen(
                rest, design.rows, names, design.gain_over, untold, design=design, loads=loads
            )
        rows = pool.rows_of(left[list(chosen.rows)])
        if not drive:  # masses are changed as seldom as can be
            rows = rows[np.argsort(pool.problem.said.payload[rows], kind="stable")]
        taken = to_be_read(pool.problem.measurements.select(rows), SOURCE)
        taken = replace(taken, pose=labels_of(taken, used))
        if sigma is not None and taken.absolute is not None:
            stated = {**taken.absolute.channels.sigma, "position": sigma, "distance": sigma}
            channels = replace(taken.absolute.channels, sigma=stated)
            taken = replace(taken, absolute=replace(taken.absolute, channels=channels))
        return chosen, taken if places is None else places.named(taken)

    named = places is not None or used is not None
    chosen, taken, way, left_out = drivable(
        choose, robot, within, drive=drive, named=named, seed=seed
    )
    idle = np.setdiff1d(hung, taken.absolute.payload if taken.absolute is not None else hung)
    if len(idle):
        masses = ", ".join(f"{mass:g} kg" for mass in idle)
        remarks = (*remarks, f"No reading hangs {masses} on the tool: the others tell more.")
    numbers, values = pool.numbers(len(chosen.rows)), len(pool.problem.model.free)
    if numbers < values:
        remarks = (
            f"{numbers} numbers cannot tell {values} values: what a fit of them leaves open rests "
            "on what is plausible. Plan more poses.",
            *remarks,
        )
    return PlanOfPositions.of(
        taken, model=pool.problem.model, chosen=chosen, standard=pool.standard, cell=within,
        known=known, seed=seed, way=way, left_out=left_out, candidates=pool,
        remarks=(*remarks, *pool.remarks),
    )  # fmt: skip


SOURCE = "poses and payloads chosen by 'sk120stiff plan'"


def _refuse_count(pose: Index, count: int, loads: int) -> None:
    """Raise an `InputError` where there are not so many poses, or payloads at them."""
    own = np.bincount(pose)
    if loads > own.max():
        raise InputError(
            f"{loads} payloads at each pose, and {own.max()} "
            f"{'is' if own.max() == 1 else 'are'} stated",
            remedy="State as many masses to choose from (--payload '0; 5; 10 kg').",
        )
    if count > len(own):
        raise InputError(
            f"{count} poses of {len(own)} to choose from",
            remedy="Ask for fewer, or draw more (--candidates).",
        )
    refuse_count(pose, count, loads)


def _wanted(pool: PositionsPool, asked: Sequence[str]) -> tuple[tuple[str, ...], dict[str, str]]:
    """Parameters that are to be known, and those that these candidates do not tell, with why.

    Raises:
        InputError: None that was asked for can be told.
    """
    model = pool.problem.model
    names = list(dict.fromkeys(asked)) or list(pool.of_the_arm)
    missing = [name for name in names if name not in model.names]
    if missing:
        raise InputError(
            " ".join((f"nothing to plan for: {missing[0]} does not show.", *pool.remarks)),
            where="--for",
            remedy="State masses, or payloads; or plan for the geometry alone.",
        )
    untold = {name: pool.untold[name] for name in names if name in pool.untold}
    told = [name for name in names if name not in untold]
    if not told:
        why = untold[names[0]] if names else "no parameter of the model is free"
        raise InputError(f"nothing to plan for: {why}", where=model.robot.name)
    return that_count(model, told), untold


def _standing(
    robot: Robot,
    like: Measurements,
    known: Measurements | None,
    cell: Cell | None,
    places: Places | None,
    asked: int,
    count: int,
    seed: int,
) -> tuple[Cell, Array, tuple[str, ...]]:
    """The cell, poses (K, n) in it at which the motors hold every payload, and what is to be said.

    Raises:
        Refusal: They hold it at fewer than are `asked` for.
    """
    within = replace(cell or Cell(), rig=HANGING)
    said = absolute_of(like)
    at = said.point[0]
    if known is not None:
        cases = load_cases_of(robot, known)
        within = cell_from_data(robot, within, cases.a, np.zeros((1, 6)), at)
    rng = np.random.default_rng(seed)
    a = poses_in(robot, count, rng, within, at) if places is None else places.a
    heaviest = np.full(len(a), said.payload.max())
    held = poses_held(robot, within, a, heaviest, said.payload_point)
    if held.sum() < min(asked, len(a)):
        raise Refusal(
            f"at {int(held.sum()) or 'no'} pose{'' if held.sum() < 2 else 's'} of {len(a)} do the "
            f"motors hold {heaviest[0]:g} kg beside the arm",
            where=robot.name,
            remedy="Give a smaller payload, or correct the efforts of the URDF.",
        )
    remarks = list(places.remarks) if places is not None else []
    if not held.all():
        remarks.append(
            f"{int((~held).sum())} of {len(a)} poses were left out: the motors do not hold the arm "
            "and its payload there."
        )
    return within, a[held], (*remarks, MARKERS, *assumptions(robot, within, at))
