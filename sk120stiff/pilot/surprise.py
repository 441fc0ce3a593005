"""Is a reading what anybody would expect here? A slip of the keyboard is asked about at once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import two_digits
from sk120stiff.pilot.belief import Belief
from sk120stiff.pilot.campaign import Campaign
from sk120stiff.plan.design import DISPLACEMENT

DOUBTED = 5.5  # standard errors that a right reading exceeds once in a million (χ², three axes)
TIMES = 10.0  # larger than expected: a unit that slipped, whatever the springs may be
IMPLAUSIBLE = 0.1  # m; no arm is measured while it yields so far
WEIGHED = 30  # hypotheses of which one may explain it


@dataclass(frozen=True, eq=False)
class Surprise:
    """A reading beside what was expected.

    Attributes:
        expected, std: (3,) by the most probable hypothesis, and its standard error [m].
        off: Standard errors that it lies away from the nearest hypothesis.
        read, noise: (3,) the reading, and its noise per axis [m].
    """

    expected: Array
    std: Array
    off: float
    read: Array
    noise: float

    @property
    def words(self) -> str:
        """Why a person should look again before it counts; empty where nothing is odd."""
        size, usual = float(np.linalg.norm(self.read)), float(np.linalg.norm(self.expected))
        if size > IMPLAUSIBLE or size > TIMES * usual + DOUBTED * self.noise:
            far, near = f"{1e3 * size:.3g} mm", f"{two_digits(1e3 * usual)} mm"
            return f"This moves by {far}, where {near} were expected."
        if self.off > DOUBTED:
            mean, std = (
                ", ".join(f"{1e3 * x + 0.0:.3f}" for x in v) for v in (self.expected, self.std)
            )
            return f"Expected were {mean} mm (± {std}): this is {self.off:.0f} standard errors off."
        return ""


def surprise(campaign: Campaign, belief: Belief, row: int, displacement: Array) -> Surprise:
    """Hold a displacement (3,) [m] at a row of the pool against all that may be true.

    Where readings before it leave more than noise, so may this one: by so much doubt is widened.
    """
    unit = campaign.sigma * DISPLACEMENT
    base = campaign.linear.model.predict(campaign.load_cases(row))[0]
    freedom = max(belief.sums.count - len(belief.leader.columns), 1)
    wide = max(np.sqrt(belief.leader.misfit / freedom), 1.0) if belief.sums.count else 1.0
    found: list[tuple[float, Array, Array]] = []
    for _, h in belief.likely(WEIGHED):
        own = campaign.X[row][:, h.columns]
        mean, S = base / unit + own @ h.mean, wide**2 * np.eye(3) + own @ h.covariance @ own.T
        left = displacement / unit - mean
        off = float(np.sqrt(left @ np.linalg.solve(S, left)))
        found.append((off, unit * mean, unit * np.sqrt(np.diag(S))))
    return Surprise(found[0][1], found[0][2], min(off for off, *_ in found), displacement, unit)
