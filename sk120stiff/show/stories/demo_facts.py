"""What the demo has computed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sk120stiff.explain import Explanation
from sk120stiff.explain.candidates.absorbed import Absorbed
from sk120stiff.identify import Fit, fit
from sk120stiff.identify.checks.one_gain import OneGain, one_gain
from sk120stiff.measurements import NoiseModel
from sk120stiff.model import Model
from sk120stiff.show.wording import um

PAPER, OURS = "paper's springs", "identified"


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
    def gains(self) -> tuple[tuple[OneGain, float], ...]:
        """One gain of the force on the paper's springs, and the gap of three new springs [m].

        By the noise with the zero readings that rows share, and by equal weights.
        """
        equal = NoiseModel(self.found.problem.noise.sigma, zero="separate", freedom=0)
        plain = fit(self.paper, self.found.problem.measurements, noise=equal)
        return tuple((one_gain(self.paper, each), each.rms) for each in (self.found, plain))

    def of_the_gain(self) -> str:
        """What one number does in the place of the new springs, in words."""
        (gain, springs), (plain, of_plain) = self.gains
        return (
            f"One force gain of {gain.gain:.3f} on the paper's springs explains as much as three "
            f"new springs: it leaves {um(gain.rms)} µm, they leave {um(springs)} µm (with equal "
            f"weights {plain.gain:.3f}: {1e6 * plain.rms:.2f} and {1e6 * of_plain:.2f} µm)."
        )

    def rms(self, model: Model) -> float:
        """Gap of a model on the readings, rms per axis [m]."""
        problem = self.found.problem
        gap = problem.measured - model.predict(problem.load_cases)
        return float(np.sqrt(np.nanmean(gap**2)))

    @property
    def noise(self) -> float | None:
        """Rms that noise alone makes [m]; None where nothing tells."""
        return self.answer.noise_floor

    @property
    def chance(self) -> float | None:
        """Probability that noise makes the gap that is left."""
        return self.answer.adequacy.chance
