"""Does a name explain less than what remains without one?

A cause that the catalogue lacks shows best in the effect that comes nearest to it, and seldom for
more than half of its own size; a law of a gear stands for more of another memory of the same gear.
So where something structured remains beside which a name takes off no more than that, the name may
as well imitate part of it. What no structure bears out, a σ that was stated too small, is not held
against a name; nor is what every arm has beyond its laws, be it as large as the name's own part.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sk120stiff.effects import Effect
from sk120stiff.errors import Refusal, short
from sk120stiff.explain.judge.remainder import remainder_of
from sk120stiff.explain.select.stepwise import Selection, refit
from sk120stiff.identify import Fit
from sk120stiff.identify.solving import against_noise_alone

# Of its own size, what a cause without a name shows in the nearest effect: at most, and where both
# are of one gear; there what is left must be the smaller part.
HALF, ALL = 0.5, 0.5**0.5


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
        most = ALL if names[k].of_gear else HALF
        if taken < most * float(np.hypot(taken, left.rms)):
            return names[k].id, (
                f"{names[k].id} fits, but takes off {short(1e6 * taken)} µm where "
                f"{short(1e6 * left.rms)} µm remain without a name; it may imitate part of that "
                "and is not named."
            )
    return None


def _of_free_noise(fit: Fit) -> Fit:
    """The same fit, were its σ not known."""
    return replace(fit, problem=replace(fit.problem, noise=replace(fit.problem.noise, freedom=0)))
