"""A plan as JSON and for people."""

from __future__ import annotations

import numpy as np

from sk120stiff.cli.tables import plan_table, table
from sk120stiff.errors import listed, short
from sk120stiff.plan import Plan, PlanOfPositions

Told = tuple[dict[str, object], list[object]]


def told(plan: Plan) -> Told:
    """Keys of the JSON that say what was chosen and what for, and the same for people."""
    document, said = _parameters(plan) if plan.chosen.evidence is None else _effects(plan)
    return {"poses": _rows(plan), **document}, [plan_table("Measure", plan), *said]


def _rows(plan: Plan) -> list[dict[str, object]]:
    rows: list[dict[str, object]] = [
        {
            "pose": label,
            "joints": dict(zip(plan.joint_names, a.tolist(), strict=True)),
            "wrench": wrench.tolist(),
        }
        for label, a, wrench in zip(plan.pose, plan.joints, plan.wrench, strict=True)
    ]
    if plan.absolute is not None:
        said = zip(rows, plan.absolute.payload.tolist(), plan.absolute.markers, strict=True)
        rows = [row | {"payload_kg": mass, "marker": marker} for row, mass, marker in said]
    return rows


def _parameters(plan: Plan) -> Told:
    random, spread = plan.gain
    expected: list[dict[str, object]] = []
    rows: list[tuple[object, ...]] = []
    blind: list[object] = []
    beside: list[str] = []
    for item in plan.expected:
        p, why = item.parameter, item.reason
        public, unit = p.spec.public_std(p.internal, item.std), p.spec.unit
        expected.append(
            {
                "name": p.name,
                "value": p.value,
                "std": None if why else public,
                "std_if_rigid": None if why else p.spec.public_std(p.internal, item.if_rigid),
                "unit": unit,
                "internal_std": None if why else item.std,
                "internal_unit": p.spec.internal_unit,
                "reason": why,
                "mostly": item.mostly or None,
            }
        )
        if why:
            blind.append(f"{p.name} cannot be seen: {why}.")
            rows.append((p.name, p.value, "cannot be seen", unit))
            continue
        if item.mostly:
            beside.append(f"{p.effect.id} ({item.mostly})")
        if p.effect.joint_spring and item.std > p.internal:
            blind.append(f"{p.name} will hardly be told: its error is larger than itself.")
        shown = (public, unit) if np.isfinite(public) else (item.std, p.spec.internal_unit)
        rows.append((p.name, p.value, *shown))
    document: dict[str, object] = {
        "criterion": "D-optimal",
        "for": list(plan.chosen.names),
        "gain": random,
        "gain_over_spread": spread,
        "expected": expected,
    }
    said: list[object] = [
        table("To expect", ["parameter", "value", "std. error", "unit"], rows),
        f"Standard errors {_times(random)} than with random poses, {_times(spread)} than with "
        "well-spread ones.",
    ]
    if isinstance(plan, PlanOfPositions) and np.isfinite(plan.foretold):
        document["foretold_um"] = 1e6 * plan.foretold
        size = f"{short(1e6 * plan.foretold)} um"
        said.append(
            f"Where the marker stands will be foretold to {size} (standard error per axis, over "
            "all poses to choose from), as far as the model's laws hold."
        )
    if beside:
        blind.append(
            f"Most of the standard error of {listed(beside)} is what the part in brackets may "
            "yield in its place: other payloads, or poses that load the two differently, tell "
            "them apart."
        )
    return document, [*said, *blind]


def _effects(plan: Plan) -> Told:
    random, spread = plan.gain
    first, second = plan.chosen.names
    before, after = plan.chosen.evidence or (0.0, 0.0)
    document: dict[str, object] = {
        "criterion": "T-optimal",
        "between": [first, second],
        "gain": random,
        "gain_over_spread": spread,
        "evidence": after,
        "evidence_before": before,
    }
    verdict = "enough to tell them apart" if after > 3.3 else "not enough: plan more readings"
    return document, [
        f"Evidence between {first} and {second}: {after:.2f} standard errors ({verdict}), "
        f"{before:.2f} before.",
        f"{random:.2f} times that of random poses, {spread:.2f} times that of well-spread ones.",
    ]


def _times(gain: float) -> str:
    """By how much standard errors are smaller, or larger, in words."""
    return f"{gain:.2f} times smaller" if gain >= 1.0 else f"{1.0 / gain:.2f} times larger"
