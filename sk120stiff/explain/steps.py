"""The gap with every effect that joins the model, on fitted and on held-out poses."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sk120stiff.effects import Effect
from sk120stiff.errors import Refusal
from sk120stiff.explain.confirm import pose_folds
from sk120stiff.explain.explanation import Step
from sk120stiff.explain.settling import refit
from sk120stiff.identify import Fit, Problem, solve_near
from sk120stiff.measurements import Measurements


def gap_steps(
    base: Fit, effects: Sequence[Effect], holdout: Measurements | None, *, seed: int
) -> tuple[Step, ...]:
    """The base model, then one effect more at each step.

    Halfway, where an effect is still missing, a fit may have no answer; that step is told together
    with the next.

    Parameters
    ----------
    base
        Fit of the base model.
    effects
        In the order in which they were added.
    holdout
        Readings of other poses; without them poses are left out of the fit in turn.
    seed
        Of the folds.
    """
    steps = []
    joined: list[str] = []
    for count in range(len(effects) + 1):
        if count:
            joined.append(f"+ {effects[count - 1].id}")
        try:
            found = refit(base, effects[:count])
        except Refusal:
            if count == len(effects):
                raise
            continue
        label = " ".join(joined) if count else _base_name(base)
        joined.clear()
        held = _on_poses_left_out(found, seed) if holdout is None else _on_file(found, holdout)
        steps.append(Step(label, found.rms, held))
    return tuple(steps)


def _base_name(base: Fit) -> str:
    """Names of the base model's effects, each once."""
    return " + ".join(dict.fromkeys(effect.name for effect in base.model.effects))


def _on_file(found: Fit, holdout: Measurements) -> float:
    """Gap on a hold-out file, per axis [m]."""
    other = Problem(found.model, holdout.masked(), found.problem.noise)
    gap = other.measured - found.model.predict(other.situation)
    return float(np.sqrt(np.mean(gap**2)))


def _on_poses_left_out(found: Fit, seed: int) -> float:
    """Gap on poses left out of the fit in turn, per axis [m]."""
    measurements, noise = found.problem.measurements, found.problem.noise
    folds = pose_folds(len(measurements.poses), np.random.default_rng(seed))
    fold = folds[measurements.pose_index]
    squares, axes = 0.0, 0
    for k in np.unique(fold):
        train = Problem(found.model, measurements.select(fold != k), noise)
        try:
            part = solve_near(train, found.x)
        except Refusal:
            continue  # the poses that are left do not hold the model; the other folds speak
        test = Problem(part.model, measurements.select(fold == k), noise)
        squares += float(((test.measured - part.model.predict(test.situation)) ** 2).sum())
        axes += test.measured.size
    return float(np.sqrt(squares / axes)) if axes else float("nan")
