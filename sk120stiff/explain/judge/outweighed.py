"""Does a name explain less than what remains without one?

A cause that the catalogue lacks shows best in the effect that comes nearest to it, and seldom for
more than half of its own size. So where something structured remains that is larger than what a
name takes off, the name may as well imitate part of that. What no structure bears out, a σ that was
stated too small, is not held against a name.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from sk120stiff.effects import Effect
from sk120stiff.errors import Refusal, short
from sk120stiff.explain.judge.remainder import remainder_of
from sk120stiff.explain.select.stepwise import Selection, refit
from sk120stiff.identify import Fit
from sk120stiff.identify.solving import against_noise_alone


def outweighed(found: Selection, names: Sequence[Effect]) -> tuple[str, str] | None:
    """The weakest name that explains less than what remains, and why; None: no name.

    Args:
        found: The selection beside model-form error.
        names: Effects that were added to the base model, the strongest first.
    """
    if not names or not found.base.problem.noise.form:
        return None
    left = remainder_of(_of_free_noise(found.final))
    if not left.significant:
        return None
    base = against_noise_alone(found.base)
    try:
        squares = [refit(base, names[:count]).rms ** 2 for count in range(len(names) + 1)]
    except Refusal:
        return None
    for k in reversed(range(len(names))):
        taken = max(squares[k] - squares[k + 1], 0.0) ** 0.5
        if taken < left.rms:
            return names[k].id, (
                f"{names[k].id} fits, but takes off {short(1e6 * taken)} µm where "
                f"{short(1e6 * left.rms)} µm remain without a name; it may imitate part of that "
                "and is not named."
            )
    return None


def _of_free_noise(fit: Fit) -> Fit:
    """The same fit, were its σ not known."""
    return replace(fit, problem=replace(fit.problem, noise=replace(fit.problem.noise, freedom=0)))
