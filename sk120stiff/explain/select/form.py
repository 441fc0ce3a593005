"""Numbers of a law's form between those that are tried, as how far below a base rocks.

The search tries a few. Once one of them is chosen, it goes to where the readings want it: readings
are nearly linear in it too, so a step to the best of it and of all values together is soon there.
What it is known to moves the values with it.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects import Effect
from sk120stiff.effects.form import Form
from sk120stiff.errors import Refusal
from sk120stiff.identify import Fit, solve_near
from sk120stiff.identify.written import with_values
from sk120stiff.model import Model, Parameter

F = TypeVar("F", bound=Fit)
ROUNDED = 1e-3  # m, or another unit: to which names of parameters tell such a number
STEP = 0.01  # m, or another unit: over which the derivative is taken
ROUNDS = 6  # of steps
FARTHEST = 0.12  # m, or another unit: what one step changes at most
DECISIVE = 10.0  # fall of -2 ln L beside the price of its numbers, for which a wider form is taken
NEAR = 0.02  # standard errors from the best, from which on no step is worth while


@dataclass(frozen=True, eq=False)
class Told:
    """The numbers of a law's form, as far as readings tell them.

    Attributes:
        form: The k numbers, and their law.
        step: (k,) how far off the best values lie to first order.
        covariance: (k, k) of them.
        moves: (P_free, k) what the estimates change per unit of each.
    """

    form: Form[Effect]
    step: Array
    covariance: Array
    moves: Array

    @property
    def worth(self) -> float:
        """Fall of -2 ln L that the best values promise, to first order."""
        return float(self.step @ np.linalg.pinv(self.covariance, hermitian=True) @ self.step)

    @property
    def std(self) -> Array:
        """(k,) standard errors of the best values."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def off(self) -> Array:
        """(k, k) by what the numbers may be off: how the best ones err, and how far they are."""
        return self.covariance + np.outer(self.step, self.step)


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
    for k in range(len(out)):
        out, found = _settled(out, k, found, refit)
        form = out[k].form
        if form is None or form.wider is None:
            continue
        more = [*out[:k], form.wider, *out[k + 1 :]]
        try:
            again = refit(_by_law(found.model, out[k], form.wider), more, found)
        except Refusal:
            continue
        numbers = _numbers(more[k]) - _numbers(out[k])
        price = numbers * float(np.log(len(found.residual))) + DECISIVE
        told = told_form(again, more[k])
        if told is None or told.worth < price:
            continue
        more, again = _settled(more, k, again, refit)
        told = told_form(again, more[k])  # what is still under way, or at the end of what is sought
        there = told is not None and bool((np.abs(told.step) <= told.std).all())
        if there and 2.0 * (again.log_likelihood - found.log_likelihood) > price:
            out, found = more, again
    return out, found


def _settled(
    effects: list[Effect], k: int, found: F, refit: Callable[[Model, Sequence[Effect], F], F]
) -> tuple[list[Effect], F]:
    """One law with the best numbers that its form has."""
    for _ in range(ROUNDS):
        told = told_form(found, effects[k])
        if told is None or (np.abs(told.step) <= NEAR * told.std).all():
            break
        step = np.clip(told.step, -FARTHEST, FARTHEST)
        other = told.form.law([*(np.array(told.form.values) + step)])
        if other == effects[k]:
            break
        tried = [*effects[:k], other, *effects[k + 1 :]]
        try:
            again = refit(_by_law(found.model, effects[k], other), tried, found)
        except Refusal:
            break
        if again.log_likelihood < found.log_likelihood:
            break
        effects, found = tried, again
    return effects, found


def _numbers(effect: Effect) -> int:
    """How many numbers a law has that readings have to tell."""
    return len(effect.parameters) + (0 if effect.form is None else len(effect.form.values))


def from_there(model: Model, effects: Sequence[Effect], found: Fit) -> Fit:
    """The fit of a model about the values of another, as `with_best_form` asks for it."""
    del effects
    problem = replace(found.problem, model=model)
    return solve_near(problem, model.values[problem.free] / problem.scale)


def told_form(found: Fit, effect: Effect) -> Told | None:
    """What a fit tells of the form of one of its laws; None where it does not."""
    form = effect.form
    if form is None or not form.values or not np.isfinite(found.unit):
        return None
    try:
        columns = np.column_stack([_slope(found, effect, form, k) for k in range(len(form.values))])
    except Refusal:
        return None
    moving = ~found.at_bound
    J, drawn = found.jacobian[:, moving], np.diag(1.0 / found.problem.span[moving])
    own = np.linalg.pinv(np.vstack([J, drawn]))[:, : len(J)]
    along = -own @ columns  # so values move to make up for it
    beyond = columns + J @ along
    seen = beyond.T @ beyond
    if not np.diag(seen).all():
        return None
    known: Array = np.asarray(np.linalg.pinv(seen, hermitian=True), dtype=float)
    moves = np.zeros((len(found.x), len(form.values)))
    moves[moving] = along
    step = -known @ (beyond.T @ found.residual)
    rounded = ROUNDED**2 / 12.0 * np.eye(len(step))
    return Told(form, step, known * found.unit**2 + rounded, moves)


def beside_form(found: F, named: Collection[Effect]) -> F:
    """The fit, its errors and intervals with what the forms of laws that were named are known to.

    Args:
        found: The fit.
        named: Effects that were looked for; numbers of others are as they were stated.
    """
    more = np.zeros((len(found.x), len(found.x)))
    for told in _told_of(found, named):
        more += told.moves @ told.off @ told.moves.T
    return with_values(replace(found, by_form=more)) if more.any() else found


def forms(found: Fit, named: Collection[Effect]) -> list[str]:
    """What is told of the forms of laws that were named, a sentence each."""
    told = _told_of(found, named)
    return [each.form.sentence(np.sqrt(np.diag(each.off)).tolist()) for each in told]


def alike_but_for_form(one: Effect, other: Effect) -> bool:
    """Do two laws differ in nothing but the numbers of their form, which goes on between them?"""
    form = other.form
    if form is None or not form.values:
        return False
    wider = None if one.form is None else one.form.wider
    laws = [law.form for law in (one, wider) if law is not None]
    return any(
        each is not None and len(each.values) == len(form.values) and each.law(form.values) == other
        for each in laws
    )


def _told_of(found: Fit, named: Collection[Effect]) -> Iterator[Told]:
    ids = {effect.id for effect in named}
    for effect in found.model.effects:
        free = any(p.free for p in found.model.parameters if p.effect == effect)
        told = told_form(found, effect) if free and effect.id in ids else None
        if told is not None:
            yield told


def _slope(found: Fit, effect: Effect, form: Form[Effect], k: int) -> Array:
    """(R,) derivative of the whitened gap by one number of a law's form."""
    laws, ends = [], []
    for change in (STEP, -STEP):
        law = form.law([value + change * (j == k) for j, value in enumerate(form.values)])
        laws.append(law)
        ends.append(0.0 if law.form is None or not law.form.values else law.form.values[k])
    ahead, behind = (_residual(found, effect, law) for law in laws)
    return (ahead - behind) / max(ends[0] - ends[1], 1e-300)


def _residual(found: Fit, effect: Effect, law: Effect) -> Array:
    """(R,) the whitened gap where one effect has another law and the same values."""
    problem = replace(found.problem, model=_by_law(found.model, effect, law))
    return problem.evaluate(found.x)[0]


def _by_law(model: Model, effect: Effect, law: Effect) -> Model:
    """The same model with an effect by another law: its values, and zero for what is more."""
    own = [p for p in model.parameters if p.effect == effect]
    specs = law.parameters
    new = [replace(p, effect=law, spec=spec) for p, spec in zip(own, specs, strict=False)]
    new += [Parameter(law, spec, origin=own[0].origin) for spec in specs[len(own) :]]
    first = model.parameters.index(own[0])
    others = [p for p in model.parameters if p.effect != effect]
    parameters = (*others[:first], *new, *others[first:])
    return replace(model, parameters=parameters, uncertainty=None)
