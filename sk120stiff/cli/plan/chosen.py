"""How the readings of a plan are chosen, and what is said of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from sk120stiff.cli.plan.effects import named_parameters, two_effects
from sk120stiff.cli.tables import table
from sk120stiff.effects import load_cases_of
from sk120stiff.identify import why_unseen
from sk120stiff.measurements import Measurements
from sk120stiff.model import Model
from sk120stiff.plan import (
    Pool,
    d_optimal,
    promised,
    random_choice,
    rivalry,
    to_be_taken,
    well_spread,
)
from sk120stiff.plan.design import refuse_count

DRAWS = 50  # random and well-spread choices that a plan is held against

Chosen = tuple[Sequence[int], dict[str, object], list[object]]


def precise(
    model: Model,
    pool: Pool,
    known: Measurements | None,
    wanted: Sequence[str] | None,
    count: tuple[int, int],
    sigma: float,
    seed: int,
) -> Chosen:
    """Readings that make parameters well known."""
    names: list[str] = []
    for text in wanted or ():
        model, found = named_parameters(model, text)
        names += found
    before = None if known is None else Pool(load_cases_of(model.robot, known.masked()))
    design = d_optimal(
        model, pool, count=count[0], loads=count[1], sigma=sigma, parameters=names or None,
        known=before,
    )  # fmt: skip
    random, spread = _held_against(design.gain_over, pool, len(design.rows), seed)
    zero = "unknown" if known is None else known.zero
    plan = to_be_taken(model.robot, pool, design.rows, zero=zero)
    every = dict(
        zip((model.names[k] for k in model.free), promised(model, plan, sigma, known), strict=True)
    )
    expected: list[dict[str, object]] = []
    rows: list[tuple[object, ...]] = []
    chosen = pool.load_cases.rows(np.array(design.rows, dtype=np.intp))
    blind: list[object] = []
    for name in design.parameters:
        std = every[name]
        p = model.parameter(name)
        public, unit = p.spec.public_std(p.internal, float(std)), p.spec.unit
        why = why_unseen(chosen, p)
        expected.append(
            {
                "name": name,
                "value": p.value,
                "std": None if why else public,
                "unit": unit,
                "internal_std": None if why else float(std),
                "internal_unit": p.spec.internal_unit,
                "reason": why,
            }
        )
        if why:
            blind.append(f"{name} cannot be seen: {why}.")
            rows.append((name, p.value, "cannot be seen", unit))
            continue
        shown = (public, unit) if np.isfinite(public) else (float(std), p.spec.internal_unit)
        rows.append((name, p.value, *shown))
    document: dict[str, object] = {
        "criterion": "D-optimal",
        "for": design.parameters,
        "gain": random,
        "gain_over_spread": spread,
        "expected": expected,
    }
    said: list[object] = [
        table("To expect", ["parameter", "value", "std. error", "unit"], rows),
        f"Standard errors {random:.2f} times smaller than with random poses, {spread:.2f} times "
        "smaller than with well-spread ones.",
        *blind,
    ]
    return design.rows, document, said


def telling(
    model: Model,
    pool: Pool,
    before: Pool | None,
    between: str,
    count: tuple[int, int],
    sigma: float,
    seed: int,
) -> Chosen:
    """Readings that tell two effects apart."""
    first, second = two_effects(model, between)
    rivals = rivalry(model, first, second, pool, sigma=sigma, known=before)
    refuse_count(pool, *count)
    choice = rivals.best(count[0], pool.pose, count[1])

    def gain_over(rows: Sequence[int]) -> float:
        return choice.after / max(rivals.evidence_of(rows), 1e-12)

    random, spread = _held_against(gain_over, pool, len(choice.rows), seed)
    document: dict[str, object] = {
        "criterion": "T-optimal",
        "between": [first.id, second.id],
        "gain": random,
        "gain_over_spread": spread,
        "evidence": choice.after,
        "evidence_before": choice.before,
    }
    verdict = (
        "enough to tell them apart" if choice.after > 3.3 else "not enough: plan more readings"
    )
    said: list[object] = [
        f"Evidence between {first.id} and {second.id}: {choice.after:.2f} standard errors "
        f"({verdict}), {choice.before:.2f} before.",
        f"{random:.2f} times that of random poses, {spread:.2f} times that of well-spread ones.",
    ]
    return choice.rows, document, said


def _held_against(
    gain_over: Callable[[Sequence[int]], float], pool: Pool, count: int, seed: int
) -> tuple[float, float]:
    """Median gain over random and over well-spread choices."""
    rng = np.random.default_rng(seed + 1)
    random = [gain_over(random_choice(pool, count, rng)) for _ in range(DRAWS)]
    spread = [gain_over(well_spread(pool, count, rng)) for _ in range(DRAWS)]
    return float(np.median(random)), float(np.median(spread))
