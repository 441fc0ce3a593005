"""Which names are two words for one thing, whatever poses are measured."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sk120stiff.arrays import Array, Mask, of_length_one
from sk120stiff.effects import Effect, LoadCases
from sk120stiff.errors import Refusal
from sk120stiff.model import Model
from sk120stiff.plan import random_pool

SHARES_OF_LOAD = (1.0, 0.25, 0.05)  # tried until the model holds the load at every pose
SAME = 1e-3  # share of the signature that may differ
ROUNDING = 1e-9  # share of a signature that is left of it where nothing is
FAINT = 1e-10  # share of the largest singular value below which a direction is rounding


def exact_aliases(
    model: Model, effect: Effect, others: Sequence[Effect], *, point: Array
) -> tuple[str, ...]:
    """Those of `others` that imitate the fitted `effect` at all poses and loads.

    Args:
        model: Fitted model that holds `effect`.
        effect: The named effect.
        others: Contenders.
        point: (3,) measured point in the tool frame [m].
    """
    if not others:
        return ()
    pool = random_pool(model.robot, poses=150, directions=3, force=300.0, point=point, seed=1)
    # Where the effect is absent: in its presence a gain of the sensor holds it already.
    absent = [0.0 if p.effect.id == effect.id else p.internal for p in model.parameters]
    full = model.with_values(np.array(absent))
    present = {e.id for e in model.effects}
    for other in others:
        if other.id not in present:
            full = full + other
    derivative = _derivative(full, pool.load_cases)
    if derivative is None:
        return ()
    typical = np.array([parameter.spec.typical for parameter in full.parameters])
    X = (derivative * typical).reshape(-1, len(typical))
    owner = np.array([parameter.effect.id for parameter in full.parameters])
    values = model.values[[p.effect.id == effect.id for p in model.parameters]]
    values = values / typical[owner == effect.id]
    beside = np.isin(owner, list(present - {effect.id}))
    return imitators(X, owner, beside, effect.id, [other.id for other in others], values)


def imitators(
    X: Array, owner: Array, beside: Mask, name: str, others: Sequence[str], values: Array
) -> tuple[str, ...]:
    """Which effects can be in the place of one, whatever the rest of a model does beside them.

    Args:
        X: (R, P) derivative of readings by parameters in their typical sizes.
        owner: (P,) whose parameter it is.
        beside: (P,) the rest of the model.
        name: Whose sign it is.
        others: Which are looked at.
        values: (p,) parameters of `name`, in their typical sizes.
    """
    base = _directions(of_length_one(X[:, beside]))
    whole = X[:, owner == name] @ values
    signature = _without(base, whole)
    left = float(np.linalg.norm(signature))
    if left <= ROUNDING * float(np.linalg.norm(whole)):
        return ()  # it goes by order or pose, or the others have all of it: no sign of its own
    found = []
    for other in others:
        own = _directions(_without(base, of_length_one(X[:, owner == other])))
        if np.linalg.norm(_without(own, signature)) <= SAME * left:
            found.append(other)
    return tuple(found)


def _derivative(model: Model, load_cases: LoadCases) -> Array | None:
    """(N, 3, P) under the largest share of the loads that the model holds; None: not even a little.

    A curve beyond the torques at which it was measured may not hold.
    """
    for share in SHARES_OF_LOAD:
        weaker = replace(load_cases, wrench=share * load_cases.wrench)
        try:
            return model.predict_with_sensitivities(weaker)[1]
        except Refusal:
            continue
    return None


def aliases_by_design(
    effect: Effect, others: Sequence[Effect], signature: Array, columns: Sequence[Array]
) -> tuple[str, ...]:
    """Names that this kind of experiment, not the arm, makes one.

    Where loads only grow and no torque turns round, friction is lost motion with the other sign.

    Args:
        effect, others: The named effect and its contenders.
        signature: (R,) whitened column of the effect.
        columns: (R, p) whitened columns of each contender.
    """
    found = []
    for other, own in zip(others, columns, strict=True):
        if other.name not in effect.twins or other.where != effect.where:
            continue
        size = float(np.linalg.norm(signature) * np.linalg.norm(own[:, 0]))
        if size > 0.0 and abs(float(signature @ own[:, 0])) > (1.0 - SAME) * size:
            found.append(other.id)
    return tuple(found)


def _directions(columns: Array) -> Array:
    """(R, r) orthonormal directions of columns, each of length one at most."""
    vectors, sizes, _ = np.linalg.svd(columns, full_matrices=False)
    return np.asarray(vectors[:, sizes > FAINT * sizes.max(initial=1.0)])


def _without(directions: Array, y: Array) -> Array:
    return np.asarray(y - directions @ (directions.T @ y))
