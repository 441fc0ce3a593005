"""Chosen readings as measurements that are still to be taken."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any, Literal, Self

import numpy as np
from numpy.typing import ArrayLike

from sk120stiff.arrays import Array, on_one_thread
from sk120stiff.effects import Effect, load_cases_of
from sk120stiff.errors import InputError
from sk120stiff.identify import why_unseen
from sk120stiff.measurements import Measurements, NoiseModel
from sk120stiff.measurements.noise_statement import NoiseStatement
from sk120stiff.model import Model, Parameter
from sk120stiff.plan.cell import Cell
from sk120stiff.plan.choosing import Chosen, precise, telling
from sk120stiff.plan.design import information, plausible_sizes
from sk120stiff.plan.places import Places
from sk120stiff.plan.pool import Pool, feasible_pool
from sk120stiff.plan.route import NoWay, Route, in_order
from sk120stiff.plan.surroundings import as_measured
from sk120stiff.robot import Robot

POSES = 400  # to choose from
DIRECTIONS = 12  # of the load at each of them
USUAL = 1e-5  # m; standard uncertainty of a reading of which nobody said it
LITTLE = 0.5  # of a variance: readings that leave more of it tell less than was plausible before
OTHERS = 2  # times that other poses are chosen in the place of those to which no way is found
MOST_LOST = 1.0 / 3.0  # of the poses of a plan: where more are cut off, that is the answer


@dataclass(frozen=True)
class Expected:
    """What a plan will tell of a parameter.

    Attributes:
        std: Standard error of the internal value; infinite where it tells less than is plausible.
        reason: Why it cannot be seen; None: it can.
        if_rigid: The same of an arm of which no part yields beside what the model has; of
            displacements, where a plan counts no others, `std` itself.
        mostly: The part of which most of a spring's `std` is, since it may yield in its place
            (``name:where``); empty: none.
    """

    parameter: Parameter
    std: float
    reason: str | None
    if_rigid: float
    mostly: str = ""


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Plan(Measurements):
    """Poses and loads to measure next: `Measurements` that are still to be taken.

    Attributes:
        model: For which they were chosen.
        chosen: Of which candidates, and how much better than others.
        standard: Standard uncertainty of one reading per axis that was taken for granted [m].
        cell: What they keep to.
        known: Readings that were taken already, or None.
        seed: Of the poses that were chosen from.
        remarks: What was done so that they can be driven, and what nobody checked, in sentences.
        way: Order and way of least driving, where it was asked for.
        left_out: Poses to which no free way was found; others stand in their places.
    """

    model: Model
    chosen: Chosen
    standard: float
    cell: Cell
    known: Measurements | None
    seed: int
    remarks: tuple[str, ...]
    way: Route | None
    left_out: int

    @classmethod
    def of(cls, readings: Measurements, **told: Any) -> Self:
        """Readings to be taken, with what is told beside them."""
        own = {each.name: getattr(readings, each.name) for each in fields(Measurements)}
        return cls(**own, **told)

    @cached_property
    def gain(self) -> tuple[float, float]:
        """Precision, or evidence, over that of random and of well-spread readings (medians)."""
        return self.chosen.gains(self.seed)

    @cached_property
    def expected(self) -> tuple[Expected, ...]:
        """What will be known of the parameters that count."""
        model = self.model
        std = dict(
            zip(
                (model.names[k] for k in model.free),
                promised(model, self, self.standard, self.known).tolist(),
                strict=True,
            )
        )
        load_cases, out = load_cases_of(model.robot, self), []
        for name in self.chosen.names if self.chosen.evidence is None else ():
            parameter = model.parameter(name)
            why = why_unseen(load_cases, parameter)
            if why is None and not np.isfinite(std[name]):
                why = self.chosen.untold.get(name, TOO_LITTLE)
            out.append(Expected(parameter, std[name], why, std[name]))
        return tuple(out)


TOO_LITTLE = "these readings tell less of it than is plausible of any arm"


@on_one_thread
def plan(
    model: Model,
    count: int | None = None,
    *,
    loads: int = 1,
    between: tuple[Effect, Effect] | None = None,
    parameters: Sequence[str] = (),
    force: float = 400.0,
    point: ArrayLike | None = None,
    sigma: float | None = None,
    cell: Cell | None = None,
    known: Measurements | None = None,
    places: Places | None = None,
    candidates: int = POSES,
    directions: int = DIRECTIONS,
    drive: bool = False,
    seed: int = 0,
) -> Plan:
    """The poses and loads to measure next, such as can be driven.

    D-optimal for the parameters that count, or T-optimal between two effects.

    Args:
        model: Model with its values; its free parameters are to be known.
        count: Number of poses; with `places` one at each by default.
        loads: Number of loads at each of them.
        between: Two effects that are to be told apart instead.
        parameters: Full names of the parameters that count, all free ones by default.
        force: Size of the loads [N], less where the motors cannot hold it.
        point: (3,) measured and loaded point in the tool frame [m]; that of `known`, or the
            frame's origin, by default.
        sigma: Standard uncertainty of one reading per axis [m]; what `known` states, or 10 µm, by
            default.
        cell: What poses and loads must keep to; what is guessed without one is in `Plan.remarks`.
        known: Readings there are already.
        places: Poses to choose from, see `sk120stiff.workspace.places_of`; poses all over the
            joints' ranges by default.
        candidates, directions: Number of poses to choose from, and of load directions at each.
        drive: Order the poses for least driving, by a way that is free of collisions.
        seed: Of the poses that are chosen from.

    Raises:
        InputError: Nothing is free, a name is unknown, no pose is left to choose from, or force or
            noise is not positive.
        Refusal: Next to no pose can be had, or no free way leads to several of them.

    Examples:
        >>> import sk120stiff as sk
        >>> model = sk.base_model(sk.load_robot("motoman_sk120"))
        >>> next_readings = sk.plan(model, 6, point=[-0.06, 0.04, 0.15])
        >>> next_readings.n_readings, next_readings.displacement is None
        (6, True)
        >>> print(f"{next_readings.gain[0]:.1f} times as precise as random poses")
        1.7 times as precise as random poses
    """
    stated = USUAL if known is None else known.noise.sigma or USUAL
    standard = stated if sigma is None else sigma
    for name, value in (("force", force), ("sigma", standard)):
        if not 0.0 < value < np.inf:
            raise InputError(f"a plan with {name} = {value:g}", remedy="Give a positive number.")
    if count is None and places is None:
        raise InputError("nothing says how many poses to plan", remedy="Give count, or places.")
    robot, before = model.robot, None
    at = force_at = np.zeros(3) if point is None else np.asarray(point, dtype=float)
    within = cell or Cell()
    if known is not None:
        before = Pool(load_cases_of(robot, known.masked()))
        at, force_at = (known.point, known.force_point) if point is None else (at, force_at)
        within = as_measured(robot, within, known)
    pool = feasible_pool(
        robot,
        poses=candidates if places is None else places.a,
        directions=directions,
        force=force,
        point=at,
        force_point=force_at,
        seed=seed,
        cell=within,
    )
    unheld = () if places is None else places.lost(pool)

    def choose(banned: Sequence[Array]) -> tuple[Chosen, Measurements]:
        choice, poses = pool, count
        for a in banned:
            choice = choice.without(a)
        if places is not None and count is None:
            gains = information(model, choice, plausible_sizes(model))
            choice = choice.rows(places.one_each(choice, gains))
            poses = len(np.unique(choice.pose))
        size = poses or 0, loads
        if between is None:
            chosen = precise(model, choice, size, sigma=standard, asked=parameters, known=before)
        else:
            chosen = telling(model, choice, size, sigma=standard, between=between, known=before)
        found = to_be_taken(
            robot, choice, chosen.rows, zero="unknown" if known is None else known.zero
        )
        if sigma is not None:
            found = replace(found, noise=NoiseStatement(sigma))
        return chosen, found if places is None else places.named(found)

    chosen, found, way, left_out = drivable(
        choose, robot, within, drive=drive, named=places is not None, seed=seed
    )
    return Plan.of(
        found, model=model, chosen=chosen, standard=standard, cell=within, known=known, seed=seed,
        remarks=pool.remarks if places is None else _remarks(places, chosen.pool, unheld),
        way=way, left_out=left_out,
    )  # fmt: skip


def drivable(
    choose: Callable[[Sequence[Array]], tuple[Chosen, Measurements]],
    robot: Robot,
    cell: Cell,
    *,
    drive: bool,
    named: bool,
    seed: int,
) -> tuple[Chosen, Measurements, Route | None, int]:
    """What is chosen, in an order of little driving by a free way where one is wanted.

    Args:
        choose: Chooses readings without some poses (n,), to which no way leads.
        robot, cell: What is driven, and what stands about it.
        drive: Order them, and find the way.
        named: The poses have labels of their own, which they keep.
        seed: Of the ways.

    Returns:
        tuple: What was chosen, the readings, their way, and how many poses were left out.

    Raises:
        Refusal: No free way leads to several of them.
    """
    chosen, found = choose([])
    if not drive:
        return chosen, found, None, 0
    ordered, way, lost = _reached(found, robot, cell, seed)
    banned = [*lost]
    for _ in range(OTHERS):
        if not lost:
            break
        chosen, found = choose(banned)
        ordered, way, lost = _reached(found, robot, cell, seed)
        banned += lost
    if lost:  # there are fewer then
        chosen = chosen.without(lost)
    if not named:
        ordered = replace(ordered, pose=numbered(ordered.pose))
    return chosen, ordered, way, len(banned)


def _reached(
    found: Measurements, robot: Robot, cell: Cell, seed: int
) -> tuple[Measurements, Route, list[Array]]:
    """Readings in the order of a free way, and the poses (n,) to which none was found.

    Raises:
        NoWay: To a third of them.
    """
    lost: list[Array] = []
    most = max(1, int(MOST_LOST * len(found.poses)))
    while True:
        labels = found.poses
        try:
            return *in_order(found, robot, cell, seed), lost
        except NoWay as error:
            if len(lost) == most:
                raise
            trapped = labels[error.pose]
            lost.append(found.joints[found.pose.index(trapped)])
            found = found.select(np.flatnonzero([own != trapped for own in found.pose]))


def _remarks(places: Places, pool: Pool, unheld: Sequence[str]) -> tuple[str, ...]:
    """What became of places, and what else is to be said."""
    return (
        *places.remarks,
        *(f"{name}: the motors hold no load there." for name in unheld),
        *(
            f"{name}: no free way to it was found."
            for name in places.lost(pool)
            if name not in unheld
        ),
        *pool.remarks,
    )


def promised(
    model: Model, plan: Measurements, sigma: float, known: Measurements | None = None
) -> Array:
    """(P_free,) standard errors that a plan will leave, internal values; infinite where it leaves
    what was plausible before.

    From the very covariance of the readings that the fit will have: rows that subtract one zero
    reading share its error, where nobody said otherwise.

    Args:
        model: Model with its values; its free parameters are estimated.
        plan: Poses and loads.
        sigma: Standard uncertainty of one reading per axis [m].
        known: Readings that were taken already.
    """
    span = plausible_sizes(model)
    total = np.eye(len(span))
    for rows in (plan, known):
        if rows is None:
            continue
        used = rows.masked()
        load_cases = load_cases_of(model.robot, used)
        zero: Literal["shared", "separate"] = "separate" if used.zero == "separate" else "shared"
        whitener = NoiseModel(sigma, zero=zero).whitener(used, np.zeros(used.n_readings))
        derivative = model.predict_with_sensitivities(load_cases)[1][:, :, model.free] * span
        A = whitener.apply(derivative)
        total += A.T @ A
    share = np.diag(np.linalg.inv(total))  # of the plausible range's variance: 1, nothing is told
    told = share < LITTLE
    return np.where(told, span * np.sqrt(share / np.where(told, 1.0 - share, 1.0)), np.inf)


def to_be_taken(
    robot: Robot,
    pool: Pool,
    rows: Sequence[int],
    *,
    zero: Literal["shared", "separate", "unknown"] = "unknown",
) -> Measurements:
    """Rows of a pool as measurements without displacements, those of one pose together."""
    load_cases = pool.load_cases.rows(np.array(sorted(rows), dtype=np.intp))
    _, index = np.unique(load_cases.a, axis=0, return_inverse=True)
    return Measurements(
        pose=numbered(index.tolist()),
        joint_names=robot.actuated,
        joint_kinds=robot.kinds,
        joints=load_cases.a,
        wrench=load_cases.wrench,
        displacement=None,
        robot=robot.source,
        base_frame=robot.base_frame,
        tool_frame=robot.tool_frame,
        point=load_cases.point,
        force_point=load_cases.force_point,
        zero=zero,
        source="poses and loads chosen by 'sk120stiff plan'",
    )


def numbered(poses: Iterable[object]) -> tuple[str, ...]:
    """Labels p1, p2, … of the rows' poses, in the order in which these come."""
    rows = list(poses)
    labels = {pose: f"p{k}" for k, pose in enumerate(dict.fromkeys(rows), 1)}
    return tuple(labels[pose] for pose in rows)
