"""Directions of the parameters that the readings say nothing or little about, in words."""

from __future__ import annotations

import numpy as np

from sk120stiff.identify.fit import Fit

VAGUE = 0.5  # relative standard error beyond which a value is no knowledge


def weak_directions(fit: Fit) -> tuple[str, ...]:
    """Sentences on what cannot be told apart or is hardly known.

    A singular value of the scaled derivative that nearly vanishes names parameters that move
    together; a relative error above one half names single ones.
    """
    names = [parameter.name for parameter in fit.parameters]
    moving = np.flatnonzero(~fit.at_bound)
    sentences = [
        f"{names[k]} lies on its physical bound." for k in np.flatnonzero(fit.at_bound)
    ]
    J = fit.jacobian[:, moving]
    norms = np.linalg.norm(J, axis=0)
    for k in np.flatnonzero(norms == 0.0):
        sentences.append(f"{names[moving[k]]} does not show in these readings at all.")
    seen = np.flatnonzero(norms > 0.0)
    if len(seen):
        _, singular, Vt = np.linalg.svd(J[:, seen] / norms[seen], full_matrices=False)
        for value, direction in zip(singular, Vt, strict=True):
            together = np.flatnonzero(np.abs(direction) > 0.3)
            if value < 0.05 and len(together) > 1:
                listed = " and ".join(names[moving[seen[k]]] for k in together)
                signs = {bool(direction[k] * direction[together[0]] > 0) for k in together}
                known = "difference" if len(signs) == 1 else "sum"
                sentences.append(
                    f"{listed} move together: only the {known} of their compliances is well known."
                )
    for k, parameter in enumerate(fit.parameters):
        std = parameter.std
        if std is not None and parameter.value and np.isfinite(std):
            if std > VAGUE * abs(parameter.value):
                share = 100.0 * std / abs(parameter.value)
                sentences.append(f"{names[k]} is known to ±{share:.0f} % only.")
    return tuple(sentences)
