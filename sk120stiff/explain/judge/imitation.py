"""Does a name only imitate part of a cause that the catalogue lacks?

Beside whatever comes nearest to it, such a cause leaves something over, and two questions tell the
impostor from a cause that stands beside the foreign one.

Do the poses agree about its size? A parameter is a constant of the arm. With s_p what the effect
explains at pose p, V + κ² Σ_p s_p s_pᵀ lets every pose have a share of its own; restricted
likelihood says how far they differ (a random coefficient: Searle, Casella & McCulloch, *Variance
Components*). Half of a real cause's size at every pose is no constant.

Does something without a name do better in its place? Of all that `localise` suspects, from base to
tool, one may explain the gap better and leave nothing to the effect.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize

from sk120stiff.arrays import Array, Mask
from sk120stiff.effects import Effect
from sk120stiff.explain.localise.places import line_up, look_at
from sk120stiff.identify import Fit, yardstick
from sk120stiff.identify.checks.left_over import orthonormal
from sk120stiff.identify.uncertainty.variance_components import Deviance
from sk120stiff.measurements.model_form import ModelForm

DIFFER = 0.5  # spread of its size over the poses, relative to it, from which on it is no constant
BEYOND_CHANCE = 9.55  # gain in -2 ln L that chance brings in one of a thousand, half a χ² of one
BETTER = 6.0  # evidence (BIC) by which something without a name has to win
NOTHING = 0.3  # share of its length that is left to an effect of which another does the work
STARTS = (0.1, 0.3, 1.0)  # spreads from which the likeliest is looked for
FAR = 4.0  # ln of the factor by which a size is sought away from its start
VISIBLE = 1e-6  # share of a column that must remain beyond the model's own


@dataclass(frozen=True)
class Instead:
    """What would do in the place of an effect.

    Attributes:
        name: Completes the sentence "The gap goes with ...".
        better: Evidence (BIC) by which it wins.
        share: Share of the effect's length √λ that remains beside it.
    """

    name: str
    better: float
    share: float

    @property
    def does_the_work(self) -> bool:
        """It wins, and hardly anything is left for the effect."""
        return self.better > BETTER and self.share < NOTHING


def own_columns(fit: Fit, effect: Effect) -> Mask:
    """(P_free,) which of a fit's parameters are the effect's."""
    return np.array([parameter.effect.id == effect.id for parameter in fit.parameters], dtype=bool)


def spread_over_poses(fit: Fit, effect: Effect) -> tuple[float, float]:
    """How far poses differ in the size of one effect, and how sure that is.

    Returns:
        spread, gain: Standard deviation κ over the poses, relative to the size; and the fall of
            -2 ln L against a size that is the same everywhere.
    """
    full = fit.model.predict_with_sensitivities(fit.problem.situation)[1]
    own = np.array([parameter.effect.id == effect.id for parameter in fit.model.parameters])
    sums = Deviance.of(fit, signature=full[:, :, own] @ fit.model.values[own])
    form = fit.problem.noise.form
    free = np.array([form.proportional, form.constant]) > 0.0

    def least(spread: float) -> tuple[float, float]:
        """-2 ln L and spread where it is least, near a spread; zero stays zero."""

        def at(logarithms: Array) -> float:
            factor = np.ones(2)
            factor[free] = np.exp(np.clip(logarithms[1:], -FAR, FAR))
            moved = ModelForm(form.proportional * factor[0], form.constant * factor[1])
            return sums(moved, spread * float(np.exp(np.clip(logarithms[0], -FAR, FAR))))

        start = np.zeros(1 + free.sum())
        steps = np.vstack([start, 0.5 * np.eye(len(start))])
        rough = {"initial_simplex": steps, "xatol": 0.03, "fatol": 0.02, "maxiter": 200}
        found = minimize(at, start, method="Nelder-Mead", options=rough)
        return float(found.fun), spread * float(np.exp(np.clip(found.x[0], -FAR, FAR)))

    value, spread = min(least(begin) for begin in STARTS)
    return spread, least(0.0)[0] - value


def instead_of(fit: Fit, effect: Effect) -> Instead | None:
    """The best of all suspects in the place of one effect; None where nothing can be compared."""
    look = look_at(fit, yardstick(fit))
    lineup = line_up(look)
    own = own_columns(fit, effect)
    moving = ~fit.at_bound
    others = orthonormal(fit.jacobian[:, moving & ~own])
    gap = fit.jacobian[:, own] @ fit.x[own] - fit.residual
    gap = gap - others @ (others.T @ gap)
    columns = fit.jacobian[:, own & moving]
    basis = orthonormal(columns - others @ (others.T @ columns))
    scale, price = look.noise.scale, float(np.log(max(len(gap), 2)))
    length = float(((basis.T @ gap) ** 2).sum()) / scale
    if not basis.shape[1] or length <= 0.0:
        return None
    found = []
    for suspect, part in zip(lineup.suspects, lineup.parts, strict=True):
        white = lineup.white[:, part]
        beyond = white - others @ (others.T @ white)
        whole, left = np.linalg.norm(white, axis=0), np.linalg.norm(beyond, axis=0)
        other = orthonormal(beyond[:, left > VISIBLE * np.maximum(whole, 1e-300)])
        if not other.shape[1]:
            continue
        takes = float(((other.T @ gap) ** 2).sum()) / scale
        better = takes - length - price * (other.shape[1] - basis.shape[1])
        rest = orthonormal(basis - other @ (other.T @ basis))
        remains = gap - other @ (other.T @ gap)
        share = float(((rest.T @ remains) ** 2).sum()) / scale / length
        found.append(Instead(suspect.name, better, float(np.sqrt(share))))
    working = [each for each in found if each.does_the_work]
    return max(working or found, key=lambda each: each.better, default=None)


def imitates(fit: Fit, effect: Effect) -> str | None:
    """Why an effect may be no cause of its own, in a sentence; None where nothing says so."""
    other = instead_of(fit, effect)
    if other is not None and other.does_the_work:
        return (
            f"{effect.id} fits, but the gap goes better with {other.name}, beside which nothing "
            "is left for it; it may imitate part of another cause and is not named."
        )
    spread, gain = spread_over_poses(fit, effect)
    if spread > DIFFER and gain > BEYOND_CHANCE:
        return (
            f"{effect.id} fits, but poses differ in its size by {100.0 * min(spread, 9.99):.0f} %; "
            "what is no constant of the arm may imitate part of another cause, and is not named."
        )
    return None
