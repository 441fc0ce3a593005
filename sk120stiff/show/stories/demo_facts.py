"""What the demo has computed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.optimize import minimize_scalar

from sk120stiff.arrays import Array, rms
from sk120stiff.explain import Explanation
from sk120stiff.explain.candidates.absorbed import Absorbed
from sk120stiff.identify import Fit, fit
from sk120stiff.measurements import NoiseModel
from sk120stiff.model import Model
from sk120stiff.show.stories.gap_section import pose_rms
from sk120stiff.show.wording import um

PAPER, OURS = "paper's springs", "identified"
REACH = (0.5, 2.0)  # of a gain; beyond it no sensor is misread, but a unit is wrong


@dataclass(frozen=True, eq=False)
class Demo:
    """What the demo has computed.

    Attributes:
        paper: The model with the springs that the paper gives.
        found, other: Springs identified by the trust-region and by the Levenberg–Marquardt
            algorithm.
        answer: What `explain` says of the same readings.
        hidden: Other effects at their usual size against the identified springs.
    """

    paper: Model
    found: Fit
    other: Fit
    answer: Explanation
    hidden: Sequence[Absorbed]

    @property
    def model(self) -> Model:
        """The model to go on with: identified springs, and an effect only if it is settled."""
        settled = self.answer.verdict == "named"
        return self.answer.final.model if settled else self.found.model

    @property
    def models(self) -> dict[str, Model]:
        """Before and after identification."""
        return {PAPER: self.paper, OURS: self.found.model}

    @cached_property
    def gains(self) -> tuple[tuple[float, float, float], ...]:
        """Gain of the force, the gap that it leaves on the paper's springs, that of new ones [m].

        By the noise with the zero readings that rows share, and by equal weights.
        """
        equal = NoiseModel(self.found.problem.noise.sigma, zero="separate", freedom=0)
        plain = fit(self.paper, self.found.problem.measurements, noise=equal)
        return tuple((*one_gain(self.paper, each), each.rms) for each in (self.found, plain))

    def of_the_gain(self) -> str:
        """What one number does in the place of the new springs, in words."""
        (gain, left, springs), (plain, left_plain, springs_plain) = self.gains
        return (
            f"One force gain of {gain:.3f} on the paper's springs explains as much as three "
            f"new springs: it leaves {um(left)} µm, they leave {um(springs)} µm (with equal "
            f"weights {plain:.3f}: {1e6 * left_plain:.2f} and {1e6 * springs_plain:.2f} µm)."
        )

    @cached_property
    def per_pose(self) -> list[tuple[str, float, float]]:
        """Every pose, its gap with the paper's springs and with the identified ones [µm rms]."""
        poses = self.found.problem.load_cases.poses
        gaps = (1e6 * pose_rms(self.found, model) for model in self.models.values())
        return [(p, float(b), float(a)) for p, b, a in zip(poses, *gaps, strict=True)]

    def rms(self, model: Model) -> float:
        """Gap of a model on the readings, rms per axis [m]."""
        problem = self.found.problem
        gap = problem.measured - model.predict(problem.load_cases)
        return rms(gap)

    @property
    def noise(self) -> float | None:
        """Rms that noise alone makes [m]; None where nothing tells."""
        return self.answer.noise_floor

    @property
    def chance(self) -> float | None:
        """Probability that noise makes the gap that is left."""
        return self.answer.adequacy.chance


def one_gain(model: Model, fitted: Fit) -> tuple[float, float]:
    """True force over the force as it was read that suits a model best, and the gap left [m rms].

    Force, compliance and displacement enter as one product, so a force that is misread by a
    constant factor looks like springs that are all softer by it. Springs that explain no more than
    that factor does are no better founded than it.
    """
    problem = fitted.problem
    load_cases = problem.load_cases

    def gap(gain: float) -> Array:
        loaded = replace(load_cases, wrench=gain * load_cases.wrench)
        return np.asarray(problem.measured - model.predict(loaded))

    def misfit(gain: float) -> float:
        return float(np.sum(problem.whitener.apply(gap(gain)) ** 2))

    gain = float(minimize_scalar(misfit, bounds=REACH, method="bounded").x)
    return gain, rms(gap(gain))
