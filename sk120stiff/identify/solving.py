"""A `Problem` becomes a `Fit`: first to first order in load, then at exact equilibrium."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import Refusal
from sk120stiff.identify.fit import Fit
from sk120stiff.identify.solve.passive import passive
from sk120stiff.identify.solve.polish import TRIAL, Minimum, polish
from sk120stiff.identify.solve.problem import Problem
from sk120stiff.identify.solve.solvers import Method, minimise
from sk120stiff.identify.written import with_values
from sk120stiff.measurements import EXACT

NEAR = 0.05  # standard deviations within which draws and instruments are as likely as can be
ROUNDS = 5  # of weighing draws, whose size is smaller once others have what is theirs
HALVINGS = 12  # of estimates under which the arm has no equilibrium
VALLEY = 15  # steps after which a gain that is still on its way leads down a valley


def solve(problem: Problem, *, method: Method = "trf") -> Fit:
    """Solve a least-squares problem at exact equilibrium.

    To first order in load the readings are linear in the parameters, so the first answer does not
    depend on the starting values. From there one of the two algorithms goes on at exact
    equilibrium. Only what the readings do not show at all stays at its start.

    Raises:
        Refusal: The fit did not converge, or no equilibrium exists.
    """
    residual_0, jacobian_0 = problem.first_order

    def linear(x: Array) -> tuple[Array, Array]:
        return residual_0 + jacobian_0 @ x, jacobian_0

    rough = polish(linear, problem.start, problem.bounds, problem.span)
    start = _with_equilibrium(problem, rough.x)
    found = passive(
        problem, minimise(problem.evaluate, start, problem.bounds, problem.span, method)
    )
    return with_values(_likeliest_before(_as_fit(problem, found)))


def solve_near(problem: Problem, x: Array, most: float = np.inf) -> Fit:
    """Solve a problem whose answer lies near scaled values `x` that are known.

    It is done when no estimate moves by more than 1e-5 of its error: of a model that is tried, no
    more is asked.

    Args:
        problem: What to solve.
        x: (P_free,) values near the answer.
        most: Misfit beyond which what is found is not the answer.

    Raises:
        Refusal: It does not converge, or leaves more than `most` by the readings alone.
    """
    calibrated = bool(np.isfinite(problem.usual).any())
    steps = VALLEY if calibrated else None
    try:
        found = polish(problem.evaluate, x, problem.bounds, problem.span, faint=TRIAL, steps=steps)
    except Refusal:
        if not calibrated:
            raise
        found = _held_by_calibrations(problem, x)
    return with_values(_likeliest_before(_as_fit(problem, passive(problem, found)), most))


def _held_by_calibrations(problem: Problem, x: Array) -> Minimum:
    """Where a gain leads down a valley without end: calibrations count from the start."""
    known = np.flatnonzero(np.isfinite(problem.usual))
    return _polished_with(problem, x, np.diag(1.0 / problem.usual)[known])


def _likeliest_before(fit: Fit, most: float = np.inf) -> Fit:
    """Where readings hardly tell draws and errors of instruments, those that are likeliest before.

    A direction that is hardly seen at one place is not at another: on the way there what is known
    beforehand counts as readings of it. Draws that have become smaller tell more.

    Raises:
        Refusal: More than `most` is left by the readings alone.
    """
    problem = fit.problem
    for _ in range(ROUNDS):
        if float(fit.residual @ fit.residual) > most:
            raise Refusal("the fit ends where more is left than there is to be")
        known = fit.beforehand
        step = known.step(fit.x)
        if np.abs(known.slope @ step).max(initial=0.0) < NEAR:
            break
        weight = fit.unit if np.isfinite(fit.unit) else 1.0
        start = np.clip(fit.x + step, *problem.bounds)
        best = _polished_with(problem, start, weight * known.slope)
        moved = known.slope @ (best.x - fit.x)
        fit = replace(
            fit,
            x=best.x,
            residual=best.residual,
            jacobian=best.jacobian,
            at_bound=best.at_bound,
            iterations=fit.iterations + best.iterations,
        )
        if not problem.draws or np.abs(moved).max(initial=0.0) < NEAR:
            break
    return fit


def _polished_with(problem: Problem, x: Array, rows: Array) -> Minimum:
    """Least squares near `x` where `rows` (b, P) @ x count as residuals beside the readings'."""

    def evaluate(x: Array) -> tuple[Array, Array]:
        residual, jacobian = problem.evaluate(x)
        return np.concatenate([residual, rows @ x]), np.vstack([jacobian, rows])

    best = polish(evaluate, x, problem.bounds, problem.span, faint=TRIAL)
    R = len(best.residual) - len(rows)
    return replace(best, residual=best.residual[:R], jacobian=best.jacobian[:R])


def against_noise_alone(fit: Fit) -> Fit:
    """The same model fitted under the noise of the instrument alone, without model-form error."""
    problem = fit.problem
    if not problem.noise.form:
        return fit
    exact = replace(problem.noise, form=EXACT)
    found = solve_near(Problem(problem.model, problem.measurements, exact, problem.weights), fit.x)
    return widened_as(found, fit)


def as_fit(problem: Problem, found: Minimum) -> Fit:
    """What a solver found, as a `Fit` of the problem."""
    return with_values(_as_fit(problem, found))


def _as_fit(problem: Problem, found: Minimum) -> Fit:
    return Fit(
        problem=problem,
        model=problem.model,
        x=found.x,
        residual=found.residual,
        jacobian=found.jacobian,
        at_bound=found.at_bound,
        iterations=found.iterations,
    )


def _with_equilibrium(problem: Problem, x: Array) -> Array:
    """`x`, or as large a part of it as leaves the loads an equilibrium."""
    for _ in range(HALVINGS):
        try:
            problem.evaluate(x)
        except Refusal:
            x = 0.5 * x
        else:
            return x
    problem.evaluate(np.zeros_like(x))  # refuses in its own words where even this fails
    return x


def widened_as(found: Fit, other: Fit) -> Fit:
    """The fit with what moves another's estimates beside the noise."""
    return with_values(
        replace(
            found,
            selection_uncertainty=other.selection_uncertainty,
            left_out=other.left_out,
            omitted=other.omitted,
            foreign=other.foreign,
            parts=other.parts,
            by_form=other.by_form,
            parts_by=other.parts_by,
        )
    )
