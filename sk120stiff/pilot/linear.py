"""All effects of the catalogue as one linear map: what each would do to a reading.

Around the base model a reading is linear in the parameters to very good accuracy: y ≈ y₀ + X v, X
the exact sensitivities, v internal values in typical sizes. Everything that the pilot weighs works
on sums XᵀX and Xᵀy, so a reading is taken in within milliseconds.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from sk120stiff.arrays import Array, Index
from sk120stiff.effects import CATALOGUE, Catalogue, Effect, LoadCases, all_effects
from sk120stiff.explain.options import soft_joints
from sk120stiff.model import Model

FAINT = 0.5  # of the noise: an effect whose usual size shows less at every reading is not weighed
SPREAD = 3.0  # typical sizes by which base parameters may be off; at least what is plausible
NEAR = 0.5  # of its value by which a base parameter is off where the model is a good one


@dataclass(frozen=True, eq=False)
class LinearMap:
    """Base model and candidates, linearised.

    Attributes:
        model: Base model with all candidates in it, those at zero.
        scale: (P,) typical sizes of the parameters.
        base: Columns of the base model's free parameters.
        spread: (2, len(base)) standard deviations that they are given beforehand, typical sizes:
            where the model is a good one, and where it says nothing about them.
        effects: The candidates.
        columns: For each candidate its columns.
        positive: (P,) parameters that cannot be negative.
    """

    model: Model
    scale: Array
    base: Index
    spread: Array
    effects: tuple[Effect, ...]
    columns: tuple[Index, ...]
    positive: Array

    @classmethod
    def of(
        cls, model: Model, load_cases: LoadCases, sigma: float, catalogue: Catalogue = CATALOGUE
    ) -> tuple[Self, Array]:
        """The map of what readings at a pool could show, and its columns there (M, 3, P).

        Args:
            model: Base model.
            load_cases: The pool.
            sigma: Standard uncertainty of one displacement per axis [m].
            catalogue: What may be missing.
        """
        present = {effect.id for effect in model.effects}
        soft = soft_joints(model)
        everything = all_effects(model.robot, poses=(), timed=False, catalogue=catalogue)
        fit_for = [
            effect
            for effect in everything
            if effect.id not in present
            and not effect.random_effects
            and effect.applies_to(load_cases)
            and (not effect.bends_a_spring or effect.where in soft)
        ]
        full = model
        for effect in fit_for:
            full = full + effect
        scale = np.array([p.spec.typical for p in full.parameters])
        owner: dict[str, list[int]] = {}
        for k, p in enumerate(full.parameters):
            if p.free:
                owner.setdefault(p.effect.id, []).append(k)
        base = np.array([k for i in present for k in owner.get(i, [])], dtype=np.intp)
        base.sort()
        plausible = np.array([p.spec.plausible for p in full.parameters]) / scale
        wide = np.maximum(plausible[base], SPREAD)
        values = np.abs(full.values[base]) / scale[base]
        found = cls(
            model=full,
            scale=scale,
            base=base,
            spread=np.array(
                [np.where(values > 0.0, np.minimum(NEAR * values, wide), SPREAD), wide]
            ),
            effects=tuple(fit_for),
            columns=tuple(np.array(owner[e.id], dtype=np.intp) for e in fit_for),
            positive=np.array([p.spec.lower == 0.0 for p in full.parameters]),
        )
        X = found.rows(load_cases)[1] / sigma
        shown = [k for k, own in enumerate(found.columns) if np.abs(X[:, :, own]).max() > FAINT]
        return replace(
            found,
            effects=tuple(found.effects[k] for k in shown),
            columns=tuple(found.columns[k] for k in shown),
        ), X

    def rows(self, load_cases: LoadCases) -> tuple[Array, Array]:
        """(N, 3) displacements of the base model, and (N, 3, P) change per typical size [m]."""
        predicted, derivative = self.model.predict_with_sensitivities(load_cases)
        return predicted, derivative * self.scale
