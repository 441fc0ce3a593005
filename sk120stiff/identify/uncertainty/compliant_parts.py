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
from sk120stiff.identify.fit import Fit
from sk120stiff.identify.uncertainty.parts import moved_by_parts, springs_told, yields
from sk120stiff.model import Parameter


def beside_parts(found: Fit, catalogue: Catalogue, without: Collection[str] = ()) -> Fit:
    """The fit of displacements, its values uncertain by parts that may yield.

    Before anything is read one of all their K compliances is at work in the mean, as `explain` has
    it: each has odds of 1 to K. What the readings show beyond doubt has a name.

    Args:
        found: The fit.
        catalogue: All that may be at work.
        without: Effects that are known to be rigid, by ``name`` or ``name:where``.
    """
    if not springs_told(found).any():
        return found
    parts = [e for e in _parts(found, catalogue) if not {e.id, e.name} & set(without)]
    if not parts:
        return found
    effects = [effect for effect in parts for _ in effect.parameters]
    moving, known = ~found.at_bound, found.beforehand.rows()  # no part bends what is known before
    apart = np.zeros((len(known), len(effects)))
    kept = np.vstack([-found.jacobian, known])[:, moving] / found.unit
    return moved_by_parts(
        found,
        kept,
        1.0 / found.problem.plausible[moving] ** 2,
        np.vstack([_shown(found, parts), apart]) / found.unit,
        effects,
        base=kept,
        left=np.append(found.residual, apart[:, 0]) / found.unit,
        odds=1.0 / len(effects),
    )


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
