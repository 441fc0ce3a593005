"""Estimated parameters as the JSON of several commands states them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from sk120stiff.identify import Fit, unseen_reasons

Interval = tuple[float, float]


def parameter_rows(
    found: Fit,
    profile: Sequence[Interval] | None = None,
    unseen: Mapping[str, str] | None = None,
) -> list[dict[str, object]]:
    """The estimated parameters as the JSON of several commands states them.

    `value` ± `std` are the estimate and its standard error to first order; `interval_95` is made in
    compliances, where the readings are linear, and is the better one for soft data. A value that
    the readings do not show is null, and `reason` says why.
    """
    rows: list[dict[str, object]] = []
    starts = found.problem.model.values[found.problem.free]
    ends = found.intervals()
    reasons = unseen_reasons(found) if unseen is None else unseen
    for k, p in enumerate(found.parameters):
        shown = bool(found.identifiable[k])
        row: dict[str, object] = {
            "name": p.name,
            "value": p.value if shown else None,
            "std": p.std if shown else None,
            "unit": p.spec.unit,
            "meaning": p.spec.meaning,
            "interval_95": ends[k],
            "start": p.spec.public(float(starts[k])),
            "at_bound": bool(found.at_bound[k]),
            "identifiable": shown,
            "reason": reasons.get(p.name),
            "plausible": abs(p.internal) <= p.spec.plausible,
        }
        if profile is not None:
            row["profile_95"] = profile[k]
        rows.append(row)
    return rows
