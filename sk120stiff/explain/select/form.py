"""Numbers of a law's form that lie between those that are tried, as how far below a base rocks.

The search tries a few. Once one of them is chosen, it goes to where the readings want it: readings
are nearly linear in it too, so a step to the best of it and of all values together is soon there.
What it is known to moves the values with it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects import Effect
from sk120stiff.effects.form import Form
from sk120stiff.errors import Refusal
from sk120stiff.identify import Fit, solve_near
from sk120stiff.identify.written import with_values
from sk120stiff.model import Model

F = TypeVar("F", bound=Fit)
STEP = 0.02  # share of the number over which the derivative is taken
ROUNDS = 5  # of steps
FARTHEST = 0.3  # share of the number that one step changes at most
NEAR = 0.02  # standard errors from the best, from which on no step is worth while


@dataclass(frozen=True, eq=False)
class Told:
    """A number of a law's form, as far as readings tell it.

    Attributes:
        form: The number, and its law.
        step: How far off the best value lies to first order.
        std: Standard error.
        moves: (P_free,) what the estimates change per unit of it.
    """

    form: Form[Effect]
    step: float
    std: float
    moves: Array


def with_best_form(
    effects: Sequence[Effect], found: F, refit: Callable[[Model, Sequence[Effect], F], F]
) -> tuple[list[Effect], F]:
    """The effects, and the fit with them, by the laws whose form the readings want.

    Args:
        effects: What joined the base model.
        found: The fit with them.
        refit: Fits a model, of which these are what joined, from the values of a fit.
    """
    out = list(effects)
    for k, effect in enumerate(effects):
        for _ in range(ROUNDS if effect.form is not None else 0):
            told = told_form(found, out[k])
            if told is None or abs(told.step) <= NEAR * told.std:
                break
            now = told.form.value
            step = float(np.clip(told.step, -FARTHEST * now, FARTHEST * now))
            other = told.form.law(now + step)
            if other == out[k]:
                break
            tried = [*out[:k], other, *out[k + 1 :]]
            try:
                again = refit(_by_law(found.model, out[k], other), tried, found)
            except Refusal:
                break
            if again.log_likelihood < found.log_likelihood:
                break
            out, found = tried, again
    return out, found


def from_there(model: Model, effects: Sequence[Effect], found: Fit) -> Fit:
    """The fit of a model about the values of another, as `with_best_form` asks for it."""
    del effects
    return solve_near(replace(found.problem, model=model), found.x)


def told_form(found: Fit, effect: Effect) -> Told | None:
    """What a fit tells of the form of one of its laws; None where it does not."""
    form = effect.form
    if form is None or not np.isfinite(found.unit):
        return None
    laws = [form.law((1.0 + share) * form.value) for share in (STEP, -STEP)]
    ends = [law.form.value for law in laws if law.form is not None]
    ahead, behind = (_residual(found, effect, law) for law in laws)
    column = (ahead - behind) / max(ends[0] - ends[-1], 1e-300)
    moving = ~found.at_bound
    J, drawn = found.jacobian[:, moving], np.diag(1.0 / found.problem.span[moving])
    rows = np.vstack([J, drawn])
    own = np.linalg.pinv(rows)[:, : len(J)]
    along = -own @ column  # so values move to make up for it
    beyond = column + J @ along
    seen = float(beyond @ beyond)
    if seen <= 0.0:
        return None
    moves = np.zeros(len(found.x))
    moves[moving] = along
    step = -float(beyond @ found.residual) / seen
    return Told(form, step, found.unit / np.sqrt(seen), moves)


def beside_form(found: F) -> F:
    """The fit, its standard errors and intervals with what its laws' forms are known to."""
    more = np.zeros((len(found.x), len(found.x)))
    for effect in found.model.effects:
        told = told_form(found, effect)
        if told is not None:
            more += told.std**2 * np.outer(told.moves, told.moves)
    if not more.any():
        return found
    parts = more if found.parts is None else found.parts + more
    return with_values(replace(found, parts=parts))


def forms(found: Fit) -> list[str]:
    """What is told of the laws' forms, a sentence each."""
    told = [told_form(found, effect) for effect in found.model.effects]
    return [each.form.sentence(each.std) for each in told if each is not None]


def _residual(found: Fit, effect: Effect, law: Effect) -> Array:
    """(R,) the whitened gap where one effect has another law and the same values."""
    problem = replace(found.problem, model=_by_law(found.model, effect, law))
    return problem.evaluate(found.x)[0]


def _by_law(model: Model, effect: Effect, law: Effect) -> Model:
    """The same model with an effect by another law that has as many parameters."""
    specs = iter(law.parameters)
    parameters = tuple(
        replace(p, effect=law, spec=next(specs)) if p.effect == effect else p
        for p in model.parameters
    )
    return replace(model, parameters=parameters, uncertainty=None)
