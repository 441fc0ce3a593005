"""Standard errors that hold what another possible name would make of a parameter.

Where the readings cannot tell two names apart, or two laws of one gear, the springs come out
differently under each. What a single model calls its standard error is then too small by far: the
largest difference is added in squares.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from sk120stiff.effects import Effect
from sk120stiff.errors import Refusal
from sk120stiff.explain.explanation import Finding
from sk120stiff.explain.settling import Attempt, refit
from sk120stiff.identify import Fit

REFUTED = 10.0  # rise of the misfit from which another law is out of the question
LOOKED_AT = 8  # alternatives of one name


def with_doubt(found: Attempt, findings: Sequence[Finding]) -> Fit:
    """The final fit, its standard errors widened by the models that remain possible.

    Parameters
    ----------
    found
        The attempt with its final fit.
    findings
        The named effects with their alternatives.
    """
    final = found.final
    values = {parameter.name: parameter.value for parameter in final.model.parameters}
    spread = dict.fromkeys(values, 0.0)
    for effects, must_fit in _others(found, findings):
        try:
            other = refit(found.base, effects)
        except Refusal:
            continue
        if must_fit and other.chi_square > final.chi_square + REFUTED:
            continue
        for parameter in other.model.parameters:
            if parameter.name in values:
                apart = abs(parameter.value - values[parameter.name])
                spread[parameter.name] = max(spread[parameter.name], apart)
    widened = tuple(
        p if p.std is None else replace(p, std=float(np.hypot(p.std, spread[p.name])))
        for p in final.model.parameters
    )
    return replace(final, model=replace(final.model, parameters=widened))


def _others(found: Attempt, findings: Sequence[Finding]) -> Iterator[tuple[list[Effect], bool]]:
    """Sets of effects that may be meant as well; and whether they have to prove that they fit."""
    regression = found.regression
    where = {effect.id: k for k, effect in enumerate(regression.candidates)}
    for finding in findings:
        rest = [other.effect for other in findings if other is not finding]
        for name in finding.alternatives[:LOOKED_AT]:
            yield [*rest, regression.candidates[where[name]]], False
        for law in set(regression.laws[where[finding.effect.id]]) - {finding.effect}:
            yield [*rest, law], True
