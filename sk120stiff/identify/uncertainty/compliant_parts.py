"""What links, bearings and a floor that a model leaves rigid may make of its springs.

No link is rigid. What one yields as a spring does is counted in that spring; what shows beside it,
and is too little for a name, moves the springs all the same, each part by its probability.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import replace

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects import Catalogue, Effect, LinearElastic
from sk120stiff.effects.options import Options
from sk120stiff.errors import listed
from sk120stiff.identify.checks.left_over import beside, orthonormal
from sk120stiff.identify.fit import Fit
from sk120stiff.identify.uncertainty.parts import moved_by_parts, taken, weights, yields
from sk120stiff.model import Parameter

ROUNDING = 1e-9  # of the largest singular value, below which columns tell nothing new


def beside_parts(found: Fit, catalogue: Catalogue, without: Collection[str] = ()) -> Fit:
    """The fit of displacements, its values uncertain by parts that may yield.

    Before anything is read one of all their K compliances is at work in the mean, as `explain` has
    it: each has odds of 1 to K. What the readings show beyond doubt has a name.

    Args:
        found: The fit.
        catalogue: All that may be at work.
        without: Effects that are known to be rigid, by ``name`` or ``name:where``.
    """
    springs = np.array([p.effect.joint_spring for p in found.parameters], dtype=bool)
    springs &= (found.x > 0.0) & found.identifiable
    if not springs.any() or not np.isfinite(found.unit) or not found.unit:
        return found
    parts = [e for e in _parts(found, catalogue) if not {e.id, e.name} & set(without)]
    if not parts:
        return found
    moving = ~found.at_bound
    kept = -found.jacobian[:, moving] / found.unit
    ways = _shown(found, parts) / found.unit
    takes = np.zeros((ways.shape[1], len(found.x)))
    takes[:, moving] = taken(kept, 1.0 / found.problem.plausible[moving] ** 2, ways)
    left = beside(orthonormal(kept, ROUNDING), ways)
    share = np.abs(takes[:, springs] / found.x[springs]).max(axis=1)
    told = left.T @ (found.residual / found.unit)
    effects = [effect for effect in parts for _ in effect.parameters]
    moves = np.sqrt(weights(left, share, told, 1.0 / len(effects)))[:, None] * takes
    return moved_by_parts(found, moves, effects)


def if_parts_yield(found: Fit, catalogue: Catalogue) -> tuple[str, ...]:
    """A sentence on springs that parts which count as rigid may have taken on, and by how much."""
    wide = beside_parts(found, catalogue)
    if wide.parts is None:
        return ()
    pairs = zip(wide.parameters, wide.parts_by, np.diag(wide.parts), strict=True)
    by = [
        f"{p.effect.id} ({part}: {100.0 * np.sqrt(moved) / found.x[k]:.2g} %)"
        for k, (p, part, moved) in enumerate(pairs)
        if p.effect.joint_spring and moved > found.covariance[k, k] > 0.0
    ]
    if not by:
        return ()
    return (
        "The ± hold where links, bearings and the floor are rigid. The part in brackets may have "
        f"moved {listed(by)}, which these readings leave open: 'sk120stiff explain' counts it.",
    )


def _parts(found: Fit, catalogue: Catalogue) -> Iterator[Effect]:
    """Parts that the model has not and that such loads bend."""
    robot, present = found.model.robot, {effect.id for effect in found.model.effects}
    for kind in catalogue:
        if issubclass(kind, LinearElastic):
            for where in kind.places(robot):
                effect = kind.at(robot, where, Options())
                fits = yields(effect) and effect.applies_to(found.problem.load_cases)
                if fits and effect.parameters and effect.id not in present:
                    yield effect


def _shown(found: Fit, parts: list[Effect]) -> Array:
    """(R, K) whitened change of the readings by each part's compliance of its usual size."""
    more = tuple(Parameter(effect, spec) for effect in parts for spec in effect.parameters)
    problem, values = found.problem, found.problem.values(found.x)
    wider = replace(found.model, parameters=found.model.parameters + more, uncertainty=None)
    at = np.concatenate([values, np.zeros(len(more))])
    slope = wider.predict_with_sensitivities(problem.load_cases, at)[1][:, :, len(values) :]
    return problem.whitener.apply(slope * [p.spec.usual for p in more])
