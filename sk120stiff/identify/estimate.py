"""From readings and a model to a `Fit`."""

from __future__ import annotations

from dataclasses import replace

from sk120stiff.effects import situation_of
from sk120stiff.errors import InputError, Refusal
from sk120stiff.identify.fit import Fit
from sk120stiff.identify.problem import Problem
from sk120stiff.identify.robust import robust_noise, solve_robustly
from sk120stiff.identify.saturated import STRONG, choose_noise
from sk120stiff.identify.solvers import Method
from sk120stiff.identify.solving import solve
from sk120stiff.measurements import Measurements, NoiseModel, candidates
from sk120stiff.model import Model

AGREES = 0.01  # probabilities of a larger misfit, up to 1 less this, that stated noise explains
FEWEST = 2  # readings; one alone leaves nothing to judge a fit by


def fit(
    model: Model,
    measurements: Measurements,
    *,
    noise: NoiseModel | None = None,
    method: Method = "trf",
    robust: bool = False,
) -> Fit:
    """Estimate a model's free parameters from readings, at exact equilibrium.

    Parameters
    ----------
    model
        Starting values, and which parameters are free (`Parameter.free`).
    measurements
        Readings with displacements; masked rows are left out.
    noise
        Covariance of the readings. Default: what the data say of themselves (`choose_noise`); a σ
        that they do not state is estimated with the fit.
    method
        ``"trf"`` (trust region, bounds) or ``"lm"`` (Levenberg–Marquardt); both reach the same.
    robust
        Trust readings less that lie far from all others (Huber's loss on whole readings).

    Raises
    ------
    InputError
        No displacements, no loads, nothing free, or too few readings for the parameters.
    Refusal
        The fit did not converge, no equilibrium exists, or the readings show none of the
        parameters.
    """
    refuse_unusable(model, measurements)
    used = measurements.masked()
    reasons: tuple[str, ...] = ()
    if noise is None:
        noise, said = choose_noise(used, situation_of(model.robot, used))
        reasons = tuple(said)
        if robust:
            noise, reasons = robust_noise(used, noise, reasons)
        else:
            found = solve(Problem(model, used, noise), method=method)
            return _checked(_reconsidered(found, reasons, method), measurements)
    problem = Problem(model, used, noise)
    found = solve_robustly(problem, method=method) if robust else solve(problem, method=method)
    return _checked(replace(found, reasons=reasons), measurements)


def _reconsidered(found: Fit, reasons: tuple[str, ...], method: Method) -> Fit:
    """The fit under the plain noise as described, unless its gaps ask for more than that too.

    What a model explains (a jump in a gear, say) may look like noise as long as no model is there.
    The gaps of a fitted model hold all the noise, so noise cannot be larger than they are.
    """
    problem = found.problem
    noise = problem.noise
    plain = next(n for n in candidates(problem.measurements) if n.zero == noise.zero)
    if plain.growth == noise.growth and (plain.sigma == noise.sigma or not noise.stated):
        return replace(found, reasons=reasons)
    other = solve(Problem(problem.model, problem.measurements, plain), method=method)
    if plain.stated and other.lack_of_fit is not None:
        enough = AGREES < other.lack_of_fit < 1.0 - AGREES
    else:
        enough = 2.0 * (found.log_likelihood - other.log_likelihood) < STRONG
    if not enough:
        return replace(found, reasons=reasons)
    kept = tuple(reason for reason in reasons if "zero readings" in reason)
    return replace(other, reasons=kept)


def _checked(found: Fit, measurements: Measurements) -> Fit:
    if not found.estimated and not found.at_bound.any():
        raise Refusal(
            "these readings show none of the free parameters",
            where=_place(measurements),
            remedy=f"Free are: {', '.join(p.name for p in found.parameters)}. Measure poses and "
            "loads that put torque on them.",
        )
    return found


def refuse_unusable(model: Model, measurements: Measurements) -> None:
    """Raise an `InputError` for readings that no fit of this model can be made of."""
    where = _place(measurements)
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
    if 3 * count < len(model.free):
        line = int(measurements.line[measurements.use][-1])
        raise InputError(
            f"{len(model.free)} parameters cannot be estimated from {count} readings of three axes",
            where=f"{where}, line {line}" if line else where,
            remedy="Measure more poses, or fix parameters in the model (free: false).",
        )


def _place(measurements: Measurements) -> str:
    return str(measurements.path or "measurements")
