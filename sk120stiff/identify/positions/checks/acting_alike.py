"""Springs that do the same at the poses that were read, of which one has what is another's.

A compliance is never negative. So of drives that turn about like axes under like torques, as where
few joints move, a fit takes one and leaves the others rigid, for what the noise says of their small
differences: the value of the one, and how stiff the others are at least, hold for the sum alone.
"""

from __future__ import annotations

import numpy as np

from sk120stiff.errors import listed
from sk120stiff.identify.checks.left_over import beside, orthonormal
from sk120stiff.identify.positions.calibrate import Calibration

FAINT = 1e-6  # of a column, beside all other parameters, below which it is rounding
ALIKE = 0.95  # cosine, beside all other parameters, from which on one may have what is another's


def acting_alike(found: Calibration) -> list[str]:
    """Which springs share what one of them was given, in sentences.

    Told where one came out rigid that acts as another does that did not.

    Args:
        found: The fitted calibration.
    """
    parameters = found.parameters
    shows = np.linalg.norm(found.jacobian, axis=0) > 0.0
    springs = [k for k, p in enumerate(parameters) if p.effect.joint_spring and shows[k]]
    seen = [k for k in springs if found.identifiable[k] or found.at_bound[k]]
    others = [k for k in range(len(parameters)) if k not in seen]
    left = beside(orthonormal(found.jacobian[:, others]), found.jacobian[:, seen].copy())
    length = np.linalg.norm(left, axis=0)
    kept = length > FAINT * np.linalg.norm(found.jacobian[:, seen], axis=0)
    seen, left = [k for k, own in zip(seen, kept, strict=True) if own], left[:, kept] / length[kept]
    cosine = left.T @ left
    said = []
    for i, k in enumerate(seen):
        if found.at_bound[k]:
            continue
        like = [j for j in range(len(seen)) if cosine[i, j] > ALIKE and found.at_bound[seen[j]]]
        if not like:
            continue
        rigid = [parameters[seen[j]].name for j in like]
        least = min(float(cosine[i, j]) for j in like)
        said.append(
            f"{parameters[k].name} does here what {listed(rigid)} would (cosine {least:.3f} beside "
            "all else): these readings tell the sum of their compliances, and which of them has it "
            "is next to chance, whatever the intervals say. Move the joints between them, or fix "
            "all but one (free: false)."
        )
    return said
