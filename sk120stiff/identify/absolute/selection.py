"""Which transmission errors show beyond doubt: what they leave out would be taken for springs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects import Catalogue, Effect
from sk120stiff.identify.fit import Fit


def waves_that_show(found: Fit, catalogue: Catalogue) -> tuple[Effect, ...]:
    """Transmission errors that the BIC asks for, one after the other, beside a fitted model."""
    from sk120stiff.identify.absolute.pose_problem import PoseProblem

    problem = found.problem
    if not isinstance(problem, PoseProblem):
        raise TypeError("a fit of poses")
    model, kind = found.model, catalogue["transmission_error"]
    present = {effect.id for effect in model.effects}
    effects = [
        effect
        for effect in (kind.at(model.robot, where, _none()) for where in kind.places(model.robot))
        if effect.id not in present
    ]
    if not effects:
        return ()
    wider = model
    for effect in effects:
        wider = wider + effect
    every = replace(problem, model=wider)
    slope = every.channel_gap(wider.values, derivative=True)[1]
    first = len(model.parameters)
    white = slope[:, first:] / problem.of_channels.sigma[:, None]
    Q = np.linalg.qr(found.jacobian)[0]
    white = white - Q @ (Q.T @ white)
    residual = found.residual - Q @ (Q.T @ found.residual)
    per = white.shape[1] // len(effects)
    groups = [slice(per * k, per * (k + 1)) for k in range(len(effects))]
    return tuple(effects[k] for k in _forward(white, residual, groups, len(found.x)))


def _forward(columns: Array, residual: Array, groups: list[slice], spent: int) -> list[int]:
    count = len(residual)
    chosen: list[int] = []
    scale = np.linalg.norm(columns, axis=0)
    columns = columns / np.where(scale > 0.0, scale, 1.0)
    while len(chosen) < len(groups):
        tried = []
        for k in range(len(groups)):
            if k in chosen:
                continue
            pick = np.concatenate([np.arange(g.start, g.stop) for g in (*map(groups.__getitem__, chosen), groups[k])])
            fitted = np.linalg.lstsq(columns[:, pick], residual, rcond=1e-6)[0]
            left = residual - columns[:, pick] @ fitted
            rank = 4 * (len(chosen) + 1)
            tried.append((count * np.log(left @ left / count) + rank * np.log(count), k, left))
        best = min(tried, key=lambda item: item[0])
        fitted_now = [g for g in map(groups.__getitem__, chosen)]
        pick = np.concatenate([np.arange(g.start, g.stop) for g in fitted_now]) if chosen else None
        now = residual
        if pick is not None:
            now = residual - columns[:, pick] @ np.linalg.lstsq(columns[:, pick], residual, rcond=1e-6)[0]
        score = count * np.log(now @ now / count) + 4 * len(chosen) * np.log(count)
        if best[0] >= score - 6.0 or spent + 4 * (len(chosen) + 1) >= count // 2:
            break
        chosen.append(best[1])
    return chosen


def _none():  # type: ignore[no-untyped-def]
    from sk120stiff.effects.base import Options

    return Options()
