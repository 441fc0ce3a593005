"""Chosen readings as measurements that are still to be taken."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from sk120stiff.arrays import Array
from sk120stiff.effects import Effect, load_cases_of
from sk120stiff.errors import InputError
from sk120stiff.measurements import Measurements, NoiseModel
from sk120stiff.model import Model
from sk120stiff.plan.cell import Cell
from sk120stiff.plan.design import d_optimal
from sk120stiff.plan.discriminate import rivalry
from sk120stiff.plan.pool import Pool, feasible_pool
from sk120stiff.robot import Robot

POSES = 400  # to choose from
DIRECTIONS = 12  # of the load at each of them
LITTLE = 0.5  # of a variance: readings that leave more of it tell less than was plausible before


def plan(
    model: Model,
    count: int,
    *,
    loads: int = 1,
    between: tuple[Effect, Effect] | None = None,
    parameters: Sequence[str] | None = None,
    force: float = 400.0,
    point: ArrayLike | None = None,
    sigma: float = 1e-5,
    cell: Cell | None = None,
    seed: int = 0,
) -> Measurements:
    """The poses and loads to measure next, such as can be driven.

    D-optimal for the parameters that count, or T-optimal between two effects.

    Args:
        model: Model with its values; its free parameters are to be known.
        count: Number of poses.
        loads: Number of loads at each of them.
        between: Two effects that are to be told apart instead.
        parameters: Full names of the parameters that count, all free ones by default.
        force: Size of the loads [N], less where the motors cannot hold it.
        point: (3,) measured and loaded point in the tool frame [m]; its origin by default.
        sigma: Standard uncertainty of one reading per axis [m].
        cell: What poses and loads must keep to; what is guessed without one is in `Pool.remarks`.
        seed: Of the poses that are chosen from.

    Raises:
        InputError: Nothing is free, a name is unknown, no pose is left to choose from, or force or
            noise is not positive.

    Examples:
        >>> import sk120stiff as sk
        >>> model = sk.base_model(sk.load_robot("motoman_sk120"))
        >>> next_readings = sk.plan(model, 6, point=[-0.06, 0.04, 0.15])
        >>> next_readings.n_readings, next_readings.displacement is None
        (6, True)
    """
    for name, value in (("force", force), ("sigma", sigma)):
        if not 0.0 < value < np.inf:
            raise InputError(f"a plan with {name} = {value:g}", remedy="Give a positive number.")
    at = np.zeros(3) if point is None else np.asarray(point, dtype=float)
    pool = feasible_pool(
        model.robot,
        poses=POSES,
        directions=DIRECTIONS,
        force=force,
        point=at,
        force_point=at,
        seed=seed,
        cell=cell,
    )
    rows: Sequence[int]
    if between is None:
        rows = d_optimal(
            model, pool, count=count, sigma=sigma, parameters=parameters, loads=loads
        ).rows
    else:
        rows = rivalry(model, *between, pool, sigma=sigma).best(count, pool.pose, loads).rows
    return to_be_taken(model.robot, pool, rows)


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
    span = np.array([model.parameters[k].spec.plausible for k in model.free])
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
