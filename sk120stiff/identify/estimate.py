"""From readings and a model to a `Fit`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from sk120stiff.errors import InputError, Refusal
from sk120stiff.identify.fit import Fit
from sk120stiff.identify.noise.growing import may_be_noise
from sk120stiff.identify.robust import far_off, solve_robustly
from sk120stiff.identify.solve.forces import with_by_force
from sk120stiff.identify.solve.problem import Problem
from sk120stiff.identify.solve.solvers import Method
from sk120stiff.identify.solving import solve
from sk120stiff.measurements import (
    Measurements,
    NoiseModel,
    candidates,
    decided,
    may_have_rays,
    seen_from,
)
from sk120stiff.model import Model
from sk120stiff.robot import Robot

IN_DOUBT = 4.6  # twice the log-likelihood, a tenfold one, that separate zero readings must gain
FEWEST = 2  # readings; one alone leaves nothing to judge a fit by


def fit_displacements(
    model: Model,
    measurements: Measurements,
    *,
    noise: NoiseModel | None = None,
    method: Method = "trf",
    robust: bool = False,
) -> Fit:
    """See `sk120stiff.identify.run.fit`."""
    refuse_unusable(model, measurements)
    model = model.under(measurements.gravity)
    used = as_seen(model.robot, measurements).masked()
    open_ = [noise] if noise is not None else candidates(used)
    if open_[0].force and used.by_force is None:
        first = solve(Problem(model, used, replace(open_[0], force=0.0)), method=method)
        used = with_by_force(first.model, used)
    fits = [solve(Problem(model, used, each), method=method) for each in open_]
    found = fits[likelier(support(fits, method))]
    told = None if noise is not None or robust else may_be_noise(found)
    if robust:
        found = solve_robustly(found.problem, method=method)
    reasons = () if noise is not None else decided(found.problem.noise, used)
    reasons += () if told is None else (told,)
    return _checked(replace(found, reasons=reasons), measurements)


def support(fits: Sequence[Fit], method: Method = "trf") -> list[float]:
    """Twice the log-likelihood of the readings under each of one or two noise models.

    Readings far off the others under any of them have no say: a slip at one load of a pose looks
    like a zero reading of its own. `explain` sets them aside before it decides.
    """
    slips = {int(row) for each in fits for row in far_off(each)} if len(fits) > 1 else set()
    if slips:
        whole = fits[0].problem.measurements
        others = whole.select([row for row in range(whole.n_readings) if row not in slips])
        problems = [Problem(each.problem.model, others, each.problem.noise) for each in fits]
        fits = [solve(problem, method=method) for problem in problems]
    return [2.0 * each.log_likelihood for each in fits]


def as_seen(robot: Robot, measurements: Measurements) -> Measurements:
    """The readings with what their instrument makes the axes of each have in common.

    See `line_of_sight.seen_from`.
    """
    if not may_have_rays(measurements):
        return measurements
    known = measurements.with_joints(robot.actuated, robot.kinds)
    return seen_from(measurements, robot.screws(known.joints, point=known.point).position)


def likelier(support: Sequence[float]) -> int:
    """Which of one or two noise models to take, the simpler one first: in doubt that.

    Args:
        support: Twice the log-likelihood of the readings under each, or a score's negative.
    """
    return int(len(support) > 1 and support[1] > support[0] + IN_DOUBT)


def _checked(found: Fit, measurements: Measurements) -> Fit:
    if not found.estimated and not found.at_bound.any():
        raise Refusal(
            "these readings show none of the free parameters",
            where=measurements.place,
            remedy=f"Free are: {', '.join(p.name for p in found.parameters)}. Measure poses and "
            "loads that put torque on them.",
        )
    return found


def refuse_unusable(model: Model, measurements: Measurements) -> None:
    """Raise an `InputError` for readings that no fit of this model can be made of."""
    where = measurements.place
    if not len(model.free):
        raise InputError(
            "no parameter of the model is free, so there is nothing to identify",
            where=model.robot.name,
            remedy="Write 'free: true' at a parameter of the model, or use 'sk120stiff predict'.",
        )
    count = int(measurements.use.sum())
    if not count:
        raise InputError(
            "every reading is masked",
            where=f"{where}, column use",
            remedy="Write 1 in the rows to be used.",
        )
    Problem(model, measurements, NoiseModel(1.0))  # refuses plans and readings without loads
    if count < FEWEST:
        line = int(measurements.line[measurements.use][0])
        raise InputError(
            "one reading alone leaves nothing to judge a fit by",
            where=f"{where}, line {line}" if line else where,
            remedy="Measure other loads, and other poses.",
        )
    used = measurements.read & measurements.use[:, None]
    if measurements.displacement is not None and not measurements.displacement[used].any():
        raise InputError(
            "every displacement is zero: nothing moved, so nothing is told of what yields",
            where=where,
            remedy="Check that the columns hold what was read under load, and not a zero reading.",
        )
    numbers = int(used.sum())
    if numbers < len(model.free):
        line = int(measurements.line[measurements.use][-1])
        raise InputError(
            f"{len(model.free)} parameters cannot be estimated from {count} readings of "
            + ("three axes" if numbers == 3 * count else f"{numbers} numbers together"),
            where=f"{where}, line {line}" if line else where,
            remedy="Measure more poses, or fix parameters in the model (free: false).",
        )
