"""± of what `loaded_stiffness` answers.

A compliance is linear in the compliances that it is made of, so its derivative carries drawn
parameters exactly, and 3×3 eigenvalues of thousands of draws cost nothing. Principal values must be
drawn: where two are nearly equal, they push each other apart, and no derivative says by how much.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy import stats

from sk120stiff.arrays import Array, Mask
from sk120stiff.effects import load_case
from sk120stiff.errors import Refusal
from sk120stiff.model.compliance import ModelCompliance, seen_from
from sk120stiff.model.loaded import LoadedStiffness
from sk120stiff.model.model import Model
from sk120stiff.model.predicted import Predicted, blamed, predict_with_uncertainty
from sk120stiff.model.uncertainty import spread
from sk120stiff.stiffness import symmetric_part, under_load

STEP = 1e-3  # of a usual size; compliances enter linearly, so it does not matter
SLIGHT = 0.01  # share of a stiffness that nobody asks about
DRAWS, SEED = 4000, 1  # of parameters; the same question has the same answer


@dataclass(frozen=True, eq=False)
class LoadedUncertainty:
    """± of principal stiffness and deflection at one pose under one load.

    Attributes:
        principal: (3,) standard uncertainty of the principal stiffness [N/m]; infinite where a
            value counts that the readings of the fit do not show.
        principal_interval: (3, 2) 95 % intervals [N/m]. They are made of compliances and turned
            over: so one that reaches to a compliance of zero is open upwards.
        deflection: Of the point at exact equilibrium, base axes (one reading); None where there is
            none.
        blame: Parameters that make a ± infinite.
    """

    principal: Array
    principal_interval: Array
    deflection: Predicted | None
    blame: tuple[str, ...]


def loaded_uncertainty(
    model: Model,
    a: ArrayLike,
    wrench: ArrayLike,
    found: LoadedStiffness,
    frame: str | None = None,
) -> LoadedUncertainty | None:
    """The uncertainty of `found`, `loaded_stiffness` of the same arguments.

    None if the model does not know how well its parameters are known.
    """
    known = model.uncertainty
    if known is None:
        return None
    model, point = seen_from(model.physical(), frame or model.robot.tool_frame, np.zeros(3))
    load = np.asarray(wrench, dtype=float)
    C = _compliance(model, model.values, a, load, point)
    derivatives = by_parameters(model, lambda values: _compliance(model, values, a, load, point))
    change = np.stack(derivatives, axis=-1)  # (3, 3, P)
    change = 0.5 * (change + np.swapaxes(change, 0, 1))
    directions = found.principal.directions  # (3, 3), one per row
    by_parameter = np.einsum("ki,ijp,kj->kp", directions, change, directions)
    L, B = known.factors(model.names)
    softness = np.asarray(np.linalg.eigvalsh(symmetric_part(C))[::-1], dtype=float)
    lost = np.isinf(spread(by_parameter @ L, by_parameter @ B, SLIGHT * np.abs(softness)))
    drawn = _drawn(symmetric_part(C), change @ np.concatenate([L, B], axis=1))
    stiffness = found.principal.values
    with np.errstate(invalid="ignore"):
        std = np.where(lost | np.isinf(stiffness), np.inf, drawn.std(axis=0) * stiffness**2)
    stretch = known.reach(0.95) / float(stats.norm.ppf(0.975))
    ends = np.quantile(drawn, [0.025, 0.975], axis=0)  # (2, 3)
    low, high = (softness + stretch * (end - softness) for end in ends)
    deflection = _deflection(model, a, load, point)
    blame = [*blamed(known, model.names, by_parameter[lost])] if lost.any() else []
    blame += [name for names in (deflection.blame if deflection else ()) for name in names]
    return LoadedUncertainty(
        std, _reciprocals(softness, low, high, lost), deflection, tuple(dict.fromkeys(blame))
    )


def _drawn(C: Array, change: Array) -> Array:
    """(DRAWS, 3) principal compliances, largest first, for changes (3, 3, r) of unit variance."""
    normal = np.random.default_rng(SEED).normal(size=(DRAWS // 2, change.shape[-1]))
    every = C + np.einsum("ijr,dr->dij", change, np.concatenate([normal, -normal]))
    return np.asarray(np.linalg.eigvalsh(every)[:, ::-1])


def _deflection(model: Model, a: ArrayLike, load: Array, point: Array) -> Predicted | None:
    try:
        return predict_with_uncertainty(model, load_case(model.robot, a, load, point=point))
    except Refusal:
        return None


def _compliance(model: Model, values: Array, a: ArrayLike, load: Array, point: Array) -> Array:
    """(3, 3) compliance of the point under the load for other parameter values."""
    arm = ModelCompliance(model.with_values(values), point)
    return under_load(arm, model.robot.coordinates(a), load, ("compliance",)).of("compliance")


def by_parameters(model: Model, of: Callable[[Array], Array]) -> list[Array]:
    """Derivatives of a function of the parameter values by each of them, by central differences."""
    changes = []
    for k, parameter in enumerate(model.parameters):
        step = STEP * max(abs(parameter.internal), parameter.spec.typical)
        ends = []
        for side in (step, -step):
            values = model.values.copy()
            values[k] += side
            ends.append(of(values))
        changes.append((ends[0] - ends[1]) / (2.0 * step))
    return changes


def _reciprocals(softness: Array, low: Array, high: Array, lost: Mask) -> Array:
    """(3, 2) stiffness of an interval of compliance.

    Open where that reaches to a compliance of zero: upwards from the stable side; from the
    unstable one, or where nothing is known, nothing is excluded at all.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        ends = np.stack([1.0 / high, 1.0 / low], axis=-1)
    across = (low <= 0.0) & (high >= 0.0)
    ends[across, 1] = np.inf
    ends[(across & (softness < 0.0)) | lost] = (-np.inf, np.inf)
    return ends
