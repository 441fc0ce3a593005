"""What was looked for beside a calibration and has no name: its place in the model's uncertainty.

A spring that positions do not show is not rigid for that. A load that they never had turns it all
the same, so a model that goes to other loads has to know how little is known of it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields, replace

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects import Effect
from sk120stiff.identify.fit import Fit
from sk120stiff.identify.positions.calibrate import Calibration
from sk120stiff.identify.positions.noise.sizes import of_poses
from sk120stiff.identify.solve.polish import Minimum
from sk120stiff.identify.solving import as_fit
from sk120stiff.identify.written import with_values


def beside_not_named(found: Calibration, effects: Sequence[Effect]) -> Calibration:
    """The calibration with further effects at zero, known as well as these positions tell them.

    No estimate moves; standard errors are those of all values together.

    Args:
        found: The calibration.
        effects: What was looked for and not named, none of which it has.
    """
    model = found.model
    for effect in effects:
        model = model + effect
    of_effects = set(model.names) - set(found.model.names)  # what stands fixed there stays
    model = replace(
        model,
        parameters=tuple(
            replace(each, internal=0.0) if each.name in of_effects else each
            for each in model.parameters
        ),
    )
    problem = replace(of_poses(found), model=model)
    more = len(problem.free) - len(found.x)
    x = np.concatenate([found.x, np.zeros(more)])
    residual, jacobian = problem.evaluate(x)
    held = np.concatenate([found.at_bound, np.ones(more, dtype=bool)])
    at = Minimum(x, residual, jacobian, held, found.iterations)
    wide = replace(
        as_fit(problem, at),
        selection_uncertainty=_padded(found.selection_uncertainty, more),
        left_out=_padded(found.left_out, more),
        omitted=_padded(found.omitted, more),
        foreign=_padded(found.foreign, more),
        parts=_padded(found.parts, more),
        by_form=_padded(found.by_form, more),
        parts_by=found.parts_by and (*found.parts_by, *[""] * more),
    )
    own = {each.name for each in fields(Calibration)} - {each.name for each in fields(Fit)}
    told = {name: getattr(found, name) for name in own}
    return Calibration.of(with_values(wide), **told)


def _padded(known: Array | None, more: int) -> Array | None:
    """A vector or a matrix with so many zeros behind it."""
    return None if known is None else np.pad(known, [(0, more)] * known.ndim)
