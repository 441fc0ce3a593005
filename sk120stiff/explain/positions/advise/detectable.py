"""What positions could not have shown, and what else is how probable."""

from __future__ import annotations

import numpy as np

from sk120stiff.explain.advise.detectable import length_named
from sk120stiff.explain.findings import Detectable
from sk120stiff.explain.positions.judge.posterior import Posterior
from sk120stiff.explain.positions.select.choose import (
    SHARE,
    SURE,
    SURE_OF_USUAL,
    Chosen,
    entry_price,
    usual,
)
from sk120stiff.explain.positions.select.linear import Linear

# What is left out by other poses grows by λ ± 2 √λ: √λ at which it is confirmed in 80 % of cases.
CONFIRMED, CONFIRMED_OF_USUAL = 2.0 * (SURE + 0.84), 2.0 * (SURE_OF_USUAL + 0.84)
LEAST = 0.01  # probability below which nobody is told


def detectable(linear: Linear, found: Chosen) -> tuple[Detectable, ...]:
    """Smallest size of every candidate's parameters that would have brought a name, its own or that
    of what explains as much.

    See `sk120stiff.explain.advise.detectable`; the price is that of evidence and of confirmation.
    """
    chosen = found.order
    noise = linear.noise(chosen)
    inside = linear.picked(chosen)
    Q = np.asarray(np.linalg.qr(np.column_stack([linear.base, linear.columns])[:, inside])[0])
    left = linear.columns - Q @ (Q.T @ linear.columns)
    out = []
    for e in linear.may_join(chosen):
        effect, own = linear.candidates[e], linear.slices[e]
        block = left[:, own]
        volume = float(np.linalg.slogdet(np.eye(block.shape[1]) + block.T @ block / noise)[1])
        price = 2.0 * entry_price(linear, e) + volume
        fall = max(price, 2.0 * SHARE * len(linear.residual))
        least = CONFIRMED_OF_USUAL if usual(effect) > 0.0 else CONFIRMED
        need = max(length_named(round(fall, 1), block.shape[1]), least) * np.sqrt(noise)
        for k, (spec, unit) in enumerate(zip(effect.parameters, linear.sizes[own], strict=True)):
            size = float(np.linalg.norm(block[:, k]))
            value = float(need / size * unit) if size > 0.0 else np.inf
            shown = spec.public(value) if value <= spec.plausible else None
            out.append(Detectable(f"{effect.id}.{spec.name}", shown, spec.unit))
    return tuple(out)


def probabilities(posterior: Posterior, found: Chosen) -> dict[str, float]:
    """Name → probability of its being at work, of all above `LEAST`.

    Named causes share theirs with what explains as much; others have that of the sets that hold
    them.
    """
    out: dict[str, float] = {}
    for e in found.order:
        for name, share in posterior.standing(e).items():
            out[name] = max(out.get(name, 0.0), share)
    for e, effect in enumerate(posterior.linear.candidates):
        if effect.id not in out:
            out[effect.id] = posterior.sets.with_any((e,))
    return {name: p for name, p in out.items() if p >= LEAST}
