"""Names that fall once the arm is fitted with all of them: one at a time, the weakest first.

What was chosen about another arm may be the others' about this one, or comes out as nothing beside
them; and beside an error of the model that nobody knows a name must be likelier than not, which is
the set that foretells best, too (Barbieri & Berger, Ann. Stat. 32, 2004, p. 870).
"""

from __future__ import annotations

from sk120stiff.explain.positions.judge.posterior import Posterior, of_all
from sk120stiff.explain.positions.select.choose import Chosen, confirmed, gain
from sk120stiff.explain.positions.select.linear import Linear
from sk120stiff.identify.positions.calibrate import Calibration

EVEN = 0.5  # probability below which a name is not likely by itself, and falls beside others
TOGETHER = (
    0.8  # of all of them as one, from which on none falls where each may stand for the others
)


def with_own_values(linear: Linear, found: Chosen, final: Calibration) -> Chosen:
    """Without names of which the exact fit tells nothing: all their values are one with others."""
    own = {p.effect.id for p in final.model.parameters if p.free}
    apart = tuple(e for e in found.order if linear.candidates[e].id in own)
    why = "fits, but all its values are counted in others, which explain as much."
    gone = {e: f"{linear.candidates[e].id} {why}" for e in found.order if e not in apart}
    return Chosen(apart, {**found.dropped, **gone}) if gone else found


def with_one_less(posterior: Posterior, found: Chosen, final: Calibration) -> Chosen | None:
    """Without the weakest name that does not stand; None: all do.

    Of the last one the caller says what becomes of it where it is not likely.

    Args:
        posterior: The chosen beside what errors of the model may be.
        found: The chosen, and what fell before.
        final: The calibration with them.
    """
    linear = posterior.linear
    if len(found.order) < 2:
        return None
    gains = {e: gain(linear, found.order, e) for e in found.order}
    weak = [e for e, each in gains.items() if not confirmed(each, linear)]
    if weak:
        why = "is not confirmed by poses left out, beside the others as they were fitted."
        return _fallen(linear, found, min(weak, key=lambda e: gains[e].errors), why)
    if gone := _nothing_left(linear, found, final):
        why = "fits alone, but beside the others as they were fitted comes out as nothing."
        return _fallen(linear, found, gone[0], why)
    if linear.errors is None:
        return None
    likely = {e: probability for e, (_, probability) in posterior.names.items()}
    weakest = min(likely, key=lambda e: likely[e])
    if likely[weakest] >= EVEN:
        return None
    if max(likely.values()) < EVEN and of_all(linear, found.order) >= TOGETHER:
        return None  # each may stand for the others
    why = (
        f"fits, and at poses left out takes off {100 * gains[weakest].share:.1f} % of the gap; but "
        f"an error of the model that nobody knows may do as much (P = {likely[weakest]:.2f})."
    )
    return _fallen(linear, found, weakest, why)


def _nothing_left(linear: Linear, found: Chosen, final: Calibration) -> list[int]:
    """Names whose values the exact fit has at nothing, but for springs that another bends."""
    nothing = dict[str, bool]()
    for p, bound in zip(final.parameters, final.at_bound, strict=True):
        nothing[p.effect.id] = nothing.get(p.effect.id, True) and bool(bound) and p.internal == 0.0
    bent = {linear.bent[e] for e in found.order if e in linear.bent}
    return [e for e in found.order if nothing.get(linear.candidates[e].id) and e not in bent]


def _fallen(linear: Linear, found: Chosen, e: int, why: str) -> Chosen:
    """Without a name and what bends it. A load moves what else yields, and stays."""
    gone = {c for c in found.order if c == e or linear.bent.get(c) == e}
    own = linear.candidates[e].id
    said = {c: f"{linear.candidates[c].id} bends {own}, which falls." for c in gone - {e}}
    order = tuple(c for c in found.order if c not in gone)
    return Chosen(order, {**found.dropped, **said, e: f"{own} {why}"})
