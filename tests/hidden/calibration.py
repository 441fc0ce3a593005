"""Are stated probabilities frequencies? Reliability, expected calibration error, Brier score."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .answers import Answer
from .judge import at_work, kin

BINS = 10


@dataclass(frozen=True)
class Bin:
    """Names whose probability lies in [low, high): their mean and how often they were true."""

    low: float
    high: float
    count: int
    stated: float
    true: float


@dataclass(frozen=True)
class Calibration:
    """`error` is the expected calibration error: the mean gap of the bins, by their counts."""

    count: int
    error: float
    brier: float
    bins: Sequence[Bin]


def calibration(pairs: Sequence[tuple[float, bool]]) -> Calibration | None:
    """Of (probability, truth) pairs; None without any."""
    if not pairs:
        return None
    stated = np.array([p for p, _ in pairs])
    true = np.array([hit for _, hit in pairs], float)
    place = np.clip((stated * BINS).astype(int), 0, BINS - 1)
    bins = []
    for k in range(BINS):
        own = place == k
        if own.any():
            bins.append(
                Bin(k / BINS, (k + 1) / BINS, int(own.sum()), float(stated[own].mean()),
                    float(true[own].mean()))
            )  # fmt: skip
    error = sum(b.count * abs(b.stated - b.true) for b in bins) / len(pairs)
    return Calibration(len(pairs), float(error), float(np.mean((stated - true) ** 2)), bins)


def stated(judged: Iterable[tuple[dict[str, Any], Answer]]) -> dict[str, list[tuple[float, bool]]]:
    """Pairs of all answers: of the names that they give, and of all candidates that they list."""
    out: dict[str, list[tuple[float, bool]]] = {"named effects": [], "listed candidates": []}
    for truth, answer in judged:
        for what, entries in (
            ("named effects", answer.named),
            ("listed candidates", by_family(truth, answer.listed)),
        ):
            out[what] += [(p, at_work(truth, group)) for group, p in entries]
    return out


def by_family(
    truth: dict[str, Any], listed: Iterable[tuple[frozenset[str], float]]
) -> list[tuple[frozenset[str], float]]:
    """At L10 the family counts, and so does its probability: the sum over its members."""
    if truth["level"] != "L10":
        return list(listed)
    found: dict[frozenset[frozenset[str]], tuple[frozenset[str], float]] = {}
    for group, p in listed:
        key = frozenset(kin(name) for name in group)
        before, sofar = found.get(key, (frozenset(), 0.0))
        found[key] = before | group, min(sofar + p, 1.0)
    return list(found.values())


def reliability(what: str, found: Calibration) -> str:
    """The reliability table as Markdown, with its two numbers above it."""
    lines = [
        f"probabilities of {found.count} {what}: expected calibration error {found.error:.3f}, "
        f"Brier score {found.brier:.3f}",
        "| stated | count | mean stated | true |",
        "|---|---|---|---|",
    ]
    lines += [
        f"| {b.low:.1f} to {b.high:.1f} | {b.count} | {b.stated:.2f} | {b.true:.2f} |"
        for b in found.bins
    ]
    return "\n".join(lines)
