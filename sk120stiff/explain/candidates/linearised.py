"""Readings to first order in everything that a model has and may lack.

Sensitivities change no more than what the model predicts: those of a scale or of an offset are in
proportion to the deflection, those of a spring hardly depend on it. So where two fits of the same
model to the same readings, under other noise, predict nearly the same, the sensitivities taken at
one serve at the other. What the model predicts there is computed anew.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from itertools import chain

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects import Effect
from sk120stiff.identify import Fit
from sk120stiff.measurements import Measurements
from sk120stiff.model import Model, Parameter

NEAR = 0.01  # change of the predictions, of their size, over which sensitivities serve


@dataclass(frozen=True, eq=False)
class Linearised:
    """Sensitivities of readings at one fit, over its own parameters and those of candidates.

    Attributes:
        measurements: The N readings.
        model: With everything that may be missing.
        candidates: The effects that are no part of every model.
        laws: For each of them the other laws by which it may act.
        predicted: (N, 3) readings where the sensitivities were taken, in reading axes [m].
        sensitivities: (N, 3, P) change of the readings by each parameter's typical size [m].
    """

    measurements: Measurements
    model: Model
    candidates: tuple[Effect, ...]
    laws: tuple[tuple[Effect, ...], ...]
    predicted: Array
    sensitivities: Array

    def serves(self, fit: Fit, model: Model, laws: tuple[tuple[Effect, ...], ...]) -> bool:
        """Do its sensitivities hold at a fit too, of a model with the same effects and laws?"""
        if self.measurements is not fit.problem.measurements or self.laws != laws:
            return False
        if self.model.effects != model.effects:
            return False
        change = fit.problem.measured - fit.gap - self.predicted
        size = np.nansum(self.predicted**2, axis=0)
        return bool((np.nansum(change**2, axis=0) <= NEAR**2 * size).all())


def linearised_at(
    fit: Fit,
    candidates: Sequence[Effect],
    base_effects: Collection[str],
    near: Linearised | None = None,
) -> Linearised:
    """Sensitivities at a fit.

    Args:
        fit: A fitted model.
        candidates: Effects to consider besides; those that the model holds already are skipped.
        base_effects: Ids of the effects that belong to every model.
        near: Sensitivities at another fit, which do where they serve here.
    """
    full, problem = fit.model, fit.problem
    present = {effect.id for effect in full.effects}
    joining = [effect for effect in candidates if effect.id not in present]
    full = full + [Parameter(e, spec) for e in joining for spec in e.parameters]
    chosen = [effect for effect in full.effects if effect.id not in base_effects]
    others = [tuple(dict.fromkeys(effect.other_laws(problem.load_cases))) for effect in chosen]
    if not problem.noise.form:  # beside model-form error no law is right in detail
        for k in [k for k, effect in enumerate(chosen) if effect.id in present]:
            others[k] = (*others[k], *chosen[k].nearby_laws(problem.load_cases))
    extra = tuple(Parameter(e, spec) for e in chain.from_iterable(others) for spec in e.parameters)
    full = replace(full, parameters=full.parameters + extra)  # two laws of one effect, so no sum
    laws = tuple(others)
    if near is not None and near.serves(fit, full, laws):
        return replace(near, model=full, candidates=tuple(chosen))
    typical = np.array([parameter.spec.typical for parameter in full.parameters])
    predicted, derivative = full.predict_with_sensitivities(problem.load_cases)
    derivative *= typical
    return Linearised(problem.measurements, full, tuple(chosen), laws, predicted, derivative)
