"""What is left once everything that can be named is in the model: how large, how surely, where.

Its size is that of `identify/uncertainty/left_over.py`; here are the words, and whether it speaks
for a cause that no effect in the model is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import expit
from scipy.special import logit as _logit

from sk120stiff.errors import short, two_digits
from sk120stiff.explain.judge.adequacy import Adequacy
from sk120stiff.explain.judge.goes_with import GoesWith
from sk120stiff.explain.localise.suspects import suspect_named
from sk120stiff.explain.priors import SOMETHING_ELSE
from sk120stiff.identify import Fit
from sk120stiff.identify.uncertainty.left_over import LeftOver, going_with, left_over
from sk120stiff.identify.uncertainty.variance_components import Components
from sk120stiff.measurements.noise.model_form import ModelForm

LEVEL = 1e-3  # below this probability of noise alone something is left


@dataclass(frozen=True)
class Remainder:
    """What a model leaves beyond the noise.

    Attributes:
        left: Its size and how sure it is; the model's file has the same.
        shows: Where it shows, in sentences; what it goes with says more where that is known.
        closest: The suspect that it goes with most closely; None: there is none, or not asked.
        goes_with: That beside which less of it is left, or nothing; None: there is none.
        something_else: Probability that a cause is at work which no effect in the model is.
    """

    left: LeftOver
    shows: tuple[str, ...] = ()
    closest: str | None = None
    goes_with: GoesWith | None = None
    something_else: float = 0.0

    @property
    def where(self) -> tuple[str, ...]:
        """Where it lives, in sentences: of another suspect no more need be said."""
        goes_with = self.goes_with
        return self.shows if goes_with is None else (*goes_with.sentences(), *self.shows)

    @property
    def rms(self) -> float:
        """Its size at the measured loads, rms per axis [m]."""
        return self.left.rms

    @property
    def interval(self) -> tuple[float, float]:
        """95 % interval of `rms`."""
        return self.left.interval

    @property
    def probability(self) -> float:
        """Probability that noise alone leaves as much."""
        return self.left.probability

    @property
    def form(self) -> ModelForm:
        """How it goes with the load at single poses."""
        return self.left.found.form

    @property
    def significant(self) -> bool:
        """Noise alone does not explain it."""
        return self.probability < LEVEL

    def beside(self, chance: float) -> Remainder:
        """The same where another test of what is left has this probability of noise alone.

        Such a test speaks for something else by 1 / (-e p ln p) at most (Sellke, Bayarri & Berger
        2001).
        """
        if not self.rms or chance >= self.probability:
            return self
        return replace(
            self,
            left=replace(self.left, probability=chance),
            something_else=max(self.something_else, _at_most(chance)),
        )

    def unless_noise(self, chance: float) -> Remainder:
        """The same where tests of what is left, of this probability, leave it to the noise.

        Gaps whose size goes with the load look as if poses had something in common, and are noise
        that grows all the same: what all tests together do not say is not said.
        """
        if chance <= self.probability:
            return self
        return replace(
            self,
            left=replace(self.left, probability=chance),
            something_else=min(self.something_else, _at_most(chance)),
        )

    def unless(self, instead: Sequence[float]) -> Remainder:
        """The same where causes without a name may stand in the place of names too."""
        named = (1.0 - self.something_else) * float(np.prod(1.0 - np.array(instead)))
        return replace(self, something_else=1.0 - named) if len(instead) else self

    def sentence(self) -> str:
        """How large it is, in plain words."""
        low, high = (short(1e6 * end) for end in self.interval)
        if not self.significant:
            if not np.isfinite(self.interval[1]):
                return "The readings do not tell how large an error of the model's form is."
            return f"Beyond the noise the model's form is off by {high} µm rms per axis at most."
        parts = []
        if self.form.proportional:
            parts.append(f"{two_digits(100.0 * self.form.proportional)} % of a pose's compliance")
        if self.form.constant:
            parts.append(f"{short(1e6 * self.form.constant)} µm of its own")
        as_if = f", as if every pose had {' and '.join(parts)} that no effect explains"
        return (
            f"Left over beyond the noise are {short(1e6 * self.rms)} µm rms per axis (95 %: {low} "
            f"to {high}){as_if if parts else ''}."
        )


def remainder_of(fit: Fit, test: Adequacy | None = None, suspect: str | None = None) -> Remainder:
    """The remainder of a fitted model, the one that its model's file has.

    Args:
        fit: The fitted model.
        test: What else was asked of what it leaves.
        suspect: What it is known to go with; else what `test` found to come closest.
    """
    left = left_over(fit)
    something_else = _something_else(left.found, len(fit.problem.measurements.poses))
    if test is None:
        return Remainder(left, something_else=something_else)
    if not test.lacking:
        found = Remainder(left, something_else=something_else)
        return found.unless_noise(test.probability) if test.tests else found
    load_cases = fit.problem.load_cases
    closest = suspect_named(suspect or test.closest, fit.model, load_cases)
    if closest is not None:
        columns = np.swapaxes(load_cases.reading_axes, 1, 2) @ closest.columns
        left = going_with(left, fit, columns, grows=closest.family != "series")
    return Remainder(left, something_else=something_else).beside(test.probability)


def _at_most(chance: float) -> float:
    """What a test of this probability says for something without a name, at most."""
    p = float(np.clip(chance, 1e-300, np.exp(-1.0)))
    return float(expit(_logit(SOMETHING_ELSE) - 1.0 - float(np.log(-p * np.log(p)))))


def _something_else(found: Components, poses: int) -> float:
    """By the gain of random effects, each of whose sizes costs ln of the number of poses (BIC)."""
    sizes = max(int(found.form.proportional > 0.0) + int(found.form.constant > 0.0), 1)
    logit = _logit(SOMETHING_ELSE) + 0.5 * (max(found.gain, 0.0) - sizes * np.log(max(poses, 2)))
    return float(expit(logit))
