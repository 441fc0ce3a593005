"""What follows from an answer: what the readings could not have shown, what to measure next."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sk120stiff.effects import effect
from sk120stiff.explain.explanation import Detectable, Explanation
from sk120stiff.explain.localise import localise
from sk120stiff.explain.regression import Regression
from sk120stiff.explain.score import score_set
from sk120stiff.explain.where_words import where_sentences
from sk120stiff.plan import Region, discriminating_readings, feasible_pool, lowest_points

SEEN = 4.6  # √λ at which a one-parameter effect is named in four of five cases
READINGS_TO_MEASURE = 10


def completed(answer: Explanation, regression: Regression, *, seed: int) -> Explanation:
    """The answer with where the gap lives, detectable sizes, what is hidden, the next poses."""
    smallest, invisible = detectable(answer, regression)
    found = localise(answer.base)
    return replace(
        answer,
        where=where_sentences(found),
        details={**answer.details, "localisation": found},
        smallest_detectable=smallest,
        not_observable=invisible,
        next_poses=next_poses(answer, seed=seed),
    )


def detectable(
    answer: Explanation, regression: Regression
) -> tuple[tuple[Detectable, ...], tuple[str, ...]]:
    """Smallest size of every parameter that would have shown, and effects that never would."""
    sums = regression.sums()
    chosen = {finding.effect.id for finding in answer.findings}
    named = chosen.union(*(finding.alternatives for finding in answer.findings))
    inside = [k for k, e in enumerate(regression.candidates) if e.id in chosen]
    columns = score_set(regression, sums, inside).solved.columns
    basis, _ = np.linalg.qr(_unit(regression.X[:, columns]))
    left = regression.X - basis @ (basis.T @ regression.X)
    size = np.linalg.norm(left, axis=0)
    noise = 1.0 if regression.sigma_known else answer.final.noise_factor
    found: list[Detectable] = []
    invisible: list[str] = []
    for candidate, own in zip(regression.candidates, regression.columns, strict=True):
        seen = False
        for spec, column in zip(candidate.parameters, own, strict=True):
            need = SEEN * noise / size[column] if size[column] > 0.0 else np.inf
            visible = need <= regression.plausible[column]
            seen = seen or bool(visible)
            value = spec.public(need * spec.typical) if visible else None
            found.append(Detectable(f"{candidate.id}.{spec.name}", value, spec.unit))
        if not seen and candidate.id not in named:
            invisible.append(candidate.id)
    return tuple(found), tuple(invisible)


def next_poses(
    answer: Explanation, *, seed: int, count: int = READINGS_TO_MEASURE
) -> tuple[np.ndarray, np.ndarray] | None:
    """Poses (K, n) and wrenches (K, 6) that tell the first unsettled pair of names apart.

    They go no lower than the poses that were measured: what was measured could be driven.
    """
    for finding in answer.findings:
        rivals = [name for name in finding.alternatives if name not in finding.exact]
        if not rivals:
            continue
        situation = answer.final.problem.situation
        model = answer.final.model
        force = float(np.linalg.norm(situation.wrench[:, :3], axis=1).max())
        floor = float(lowest_points(model.robot, situation.a, situation.point).min())
        pool = feasible_pool(
            model.robot,
            poses=400,
            directions=3,
            force=max(force, 1.0),
            point=situation.point,
            force_point=situation.force_point,
            seed=seed,
            region=Region(lowest=floor),
        )
        name, _, where = rivals[0].partition(":")
        rival = effect(model.robot, name, where, poses=situation.poses)
        choice = discriminating_readings(
            model, finding.effect, rival, pool, count=count, sigma=answer.final.sigma
        )
        rows = list(choice.rows)
        return pool.situation.a[rows], pool.situation.wrench[rows]
    return None


def _unit(matrix: np.ndarray) -> np.ndarray:
    norms = np.linalg.norm(matrix, axis=0)
    return np.asarray(matrix[:, norms > 0.0] / norms[norms > 0.0])
