"""How much of an effect the fitted springs would cover up on these readings.

Springs that are refitted beside a missing effect take on as much of it as they can. What they leave
is all that any test has to go by; an effect that they absorb whole is no effect but other springs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import rms
from sk120stiff.effects import Effect
from sk120stiff.identify import Fit
from sk120stiff.identify.checks.left_over import orthonormal

WHOLE = 0.99  # share from which an effect counts as absorbed


@dataclass(frozen=True)
class Absorbed:
    """One effect at its usual size.

    Attributes:
        effect: The effect.
        shows: Rms displacement per axis that it brings [m].
        remains: What of it is left once the springs are refitted [m].
        visible: The same as a length in units of the noise, √λ; about 5 is needed to name it.
    """

    effect: Effect
    shows: float
    remains: float
    visible: float

    @property
    def share(self) -> float:
        """Share of the displacement that the springs take on."""
        return 1.0 - self.remains / self.shows if self.shows else 1.0


def absorbed(fit: Fit, effects: Sequence[Effect]) -> tuple[Absorbed, ...]:
    """Effects at their usual sizes, each alone, against a fitted model's own parameters.

    Args:
        fit: The fitted model.
        effects: Effects that are not in it.
    """
    problem = fit.problem
    full = fit.model
    for effect in effects:
        full = full + effect
    _, derivative = full.predict_with_sensitivities(problem.load_cases)
    moving = problem.free[~fit.at_bound]
    own = derivative[:, :, moving] * problem.scale[~fit.at_bound]
    white = problem.whitener.apply(own)
    inside = orthonormal(white)
    noise = 1.0 if fit.sigma_known else fit.noise_factor
    typical = np.array([p.spec.typical for p in full.parameters])
    owner = [p.effect.id for p in full.parameters]
    out = []
    for effect in effects:
        columns = [k for k, name in enumerate(owner) if name == effect.id]
        signature = derivative[:, :, columns] @ typical[columns]
        seen = problem.whitener.apply(signature)
        beyond = seen - inside @ (inside.T @ seen)
        weights = np.linalg.lstsq(white, seen, rcond=1e-10)[0]
        left = signature - own @ weights
        out.append(
            Absorbed(
                effect=effect,
                shows=rms(signature[problem.read]),
                remains=rms(left[problem.read]),
                visible=float(np.linalg.norm(beyond)) / noise,
            )
        )
    return tuple(out)
