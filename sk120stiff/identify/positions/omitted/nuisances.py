"""What errors of geometry and springs that a model leaves out do to the others' standard errors.

A joint frame that is frozen, or that nothing asked for, is not exact: it is off by as much as those
that could be told, as far as the readings allow. So with springs: where some joints yield, those
that nothing asked for are not rigid; so with an arm whose masses nobody stated. With such a prior
beside the readings the information on all parameters together is inverted; what that adds to the
variance of an estimate, and how far it would move, is its doubt (Bayes' rule with Gaussian
nuisances, e.g. Tarantola 2005, ch. 3). Errors of geometry themselves have none: where their sum is
counted is a convention, and said.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sk120stiff.arrays import Array, rms
from sk120stiff.effects import Catalogue, Effect, Mounting, Viewpoint
from sk120stiff.effects.geometry import JointOffset, LinkLength, ToolOffset
from sk120stiff.effects.joint_frame import JointFrame
from sk120stiff.identify.fit import Fit
from sk120stiff.identify.positions.omitted.own_weight import own_weight
from sk120stiff.identify.positions.solve.pose_problem import PoseProblem
from sk120stiff.identify.solve.covariance import posterior
from sk120stiff.identify.written import leaving_out
from sk120stiff.model import Model, Parameter

COUNTED = (JointFrame, JointOffset, LinkLength, Mounting, ToolOffset, Viewpoint)
NORMAL = 0.6745  # median of |x| of a standard normal x


def doubted(found: Fit, catalogue: Catalogue) -> Fit:
    """The fit with standard errors that know of what it leaves out: frames, springs, own weight."""
    problem = found.problem
    if not isinstance(problem, PoseProblem) or not np.isfinite(found.unit):
        return found
    wide, sizes = _with_left_out(found.model, catalogue)
    counted = np.array([isinstance(p.effect, COUNTED) for p in found.parameters])
    heavy = own_weight(problem)
    if counted.all() or not (sizes or heavy.size):
        return found
    slope = replace(problem, model=wide).channel_gap(wide.values, derivative=True)[1]
    slope = problem.of_channels.apply(slope) / found.unit
    kept = slope[:, found.problem.free] * problem.scale
    more = slope[:, list(sizes)] * np.array(list(sizes.values()))
    more = np.column_stack([more, problem.of_channels.apply(heavy) / found.unit])
    moving = ~found.at_bound
    left = found.residual / found.unit
    drawn = 1.0 / problem.prior[moving] ** 2
    return leaving_out(found, moved_by(more, kept[:, moving], drawn, left), ~counted)


def moved_by(more: Array, kept: Array, prior: Array, left: Array) -> Array:
    """(P, P) covariance of what further parameters of unit size bring to others.

    The square of the move to the values beside them is in it.

    Args:
        more: (M, k) derivative by them.
        kept, prior, left: As of `posterior`, of the others.
    """
    here, alone = posterior(kept, prior, left)
    both = np.concatenate([prior, np.ones(more.shape[1])])
    there, beside = posterior(np.column_stack([kept, more]), both, left)
    count = len(here)
    step = there[:count] - here
    size = np.sqrt(np.diag(beside)[:count])
    more_unsure = (beside[:count, :count] - alone) / np.outer(size, size)
    spread, ways = np.linalg.eigh(more_unsure)
    half = size[:, None] * ways * np.sqrt(np.maximum(spread, 0.0))  # rounding is no variance
    return np.asarray(np.outer(step, step) + half @ half.T)


def _with_left_out(model: Model, catalogue: Catalogue) -> tuple[Model, dict[int, float]]:
    """The model with all joint frames and springs, and those of their parameters that it leaves
    out, by index, with the size that those it has are of; none where it has none.
    """
    size = frames_off(model) | compliances(model)
    present = {effect.id for effect in model.effects}
    for name in ("joint_frame", "joint_springs"):
        for where in catalogue[name].places(model.robot):
            effect: Effect = catalogue.effect(model.robot, name, where)
            specs = effect.parameters
            if effect.id not in present and any(spec.unit in size for spec in specs):
                model = model + [Parameter(effect, spec, 0.0, free=False) for spec in specs]
                present.add(effect.id)
    return model, {
        k: size[p.spec.unit]
        for k, p in enumerate(model.parameters)
        if _may_be_left_out(p.effect) and not p.free and size.get(p.spec.unit)
    }


def _may_be_left_out(effect: Effect) -> bool:
    return isinstance(effect, JointFrame) or effect.joint_spring


def frames_off(model: Model) -> dict[str, float]:
    """Standard size of the errors of joint frames that a model has, by unit: m and rad."""
    told: dict[str, list[float]] = {}
    for p in model.parameters:
        if p.free and isinstance(p.effect, JointFrame):
            told.setdefault(p.spec.unit, []).append(abs(p.internal))
    return {unit: float(np.median(sizes)) / NORMAL for unit, sizes in told.items()}


def compliances(model: Model) -> dict[str, float]:
    """Scale of the compliances of springs that a model has, by unit: that of a half-normal law."""
    told: dict[str, list[float]] = {}
    for p in model.parameters:
        if p.free and p.effect.joint_spring:
            told.setdefault(p.spec.unit, []).append(p.internal)
    return {unit: rms(np.asarray(sizes)) for unit, sizes in told.items()}
