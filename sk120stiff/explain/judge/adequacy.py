"""Is anything left over once the named effects are in the model?"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace

import numpy as np
from scipy import stats

from sk120stiff.explain.localise.places import localise
from sk120stiff.identify import Fit, LackOfFit, Yardstick, lack_of_fit, yardstick
from sk120stiff.identify.checks.left_over import orthonormal
from sk120stiff.identify.checks.yardstick import scatter
from sk120stiff.identify.noise.saturated import load_basis, pose_columns
from sk120stiff.identify.solving import against_noise_alone
from sk120stiff.identify.uncertainty.variance_components import variance_components
from sk120stiff.measurements.poses import rows_by_label

LEVEL = 1e-3  # probability below which something is missing beyond doubt
FOUND = 8.0  # times a stated σ beyond which no statement is merely too small
WITHOUT_SCATTER = 2.0  # the same where nothing within poses bears it out
LIKELIER = 6.0  # evidence by which every reading has to err by itself, rather than every pose
OWN = {
    "proportional": "in proportion to the load at single poses",
    "constant": "constant at single poses",
    "drift": "drifting at single poses",
    "branches": "other when unloading",
}
ORDERS = {
    "constant": "constant at single poses, beyond what is in proportion to the load",
    "curved": "curved in the load at single poses",
}
WHOLE = "whole misfit"
Tests = dict[str, tuple[float, float]]  # name → probability, excess in noise variances
FEWEST = 3  # degrees of freedom without which the scatter of a pose says nothing


@dataclass(frozen=True)
class Adequacy:
    """Tests of what a model leaves over.

    Attributes:
        probability: Smallest probability of the tests, times their number (Bonferroni).
        excess: Size of the left-over structure in units of the noise, √λ.
        explained: Size of what the named effects explain beyond the base model, in the same units.
        tests: For each test its name and probability.
        whole: The test of the whole misfit; None where nothing tells the noise.
        understated: By how much a stated σ looks too small, where that is all that is wrong; else
            None.
        closest: The suspect that the gap goes with most closely; None where there is none.
        undecided: A stated σ is exceeded by so much that it is hardly a slip, with no structure and
            nothing within poses that tells noise: that of another size, or what no suspect is like.
    """

    probability: float
    excess: float
    explained: float
    tests: dict[str, float]
    whole: LackOfFit | None = None
    understated: float | None = None
    closest: str | None = None
    undecided: bool = False

    @property
    def lacking(self) -> bool:
        """Something is missing beyond doubt."""
        return self.probability < LEVEL

    @property
    def chance(self) -> float | None:
        """The one probability of the gap that is left; None where nothing tells the noise."""
        return None if self.whole is None else self.whole.probability

    @property
    def of_time(self) -> tuple[str, ...]:
        """That readings of single poses wander, where nothing else is as sure; in a sentence.

        Where loads grow in the order in which they are put on, the order and the load say the same.
        """
        name = OWN["drift"]
        p = self.tests.get(name, 1.0)
        others = [each for key, each in self.tests.items() if key not in (name, WHOLE)]
        if p >= LEVEL / max(len(self.tests), 1) or p >= min(others, default=1.0):
            return ()
        return (
            "Readings of single poses wander as the measurement goes on, along no course that the "
            "catalogue has, as with the warmth of a hall that comes and goes: look at the times.",
        )

    def of_the_statement(self) -> tuple[str, ...]:
        """What is to be said of a stated σ that the readings do not bear out."""
        whole = self.whole
        if whole is None or whole.against != "stated":
            return ()
        if self.understated is not None:
            return (
                f"σ looks {self.understated:.2f} times too small; nothing structured is left. It "
                "stays the yardstick, and the standard errors are inflated by as much.",
            )
        if self.undecided:
            return (
                f"What is left is {whole.factor:.3g} times the stated uncertainty and has no "
                "structure: readings that are noisier by as much, or something that none of the "
                "suspects looks like. Nothing here tells which; repeats (same pose, load and "
                "branch) would. The standard errors account for it.",
            )
        if whole.probability < LEVEL:
            return (
                f"What is left is {whole.factor:.3g} times the stated uncertainty. Noise of that "
                "size was not stated, and repeats (same pose, load and branch) would show it. "
                "The standard errors account for it.",
            )
        said = whole.too_large()
        return (said,) if said else ()


def adequacy(fit: Fit, named: Collection[str]) -> Adequacy:
    """Test the gap that a fitted model leaves.

    Tested are the whole misfit; the parts that go at single poses in proportion to the load, as
    every elastic cause does, known or not, that are constant there, that are curved, go with the
    order or with unloading; and whatever the gap goes with most closely of all that `localise`
    suspects. Where a stated σ is exceeded, but nothing structured is left once the size of the
    noise is free, the statement is too small and no cause is missing. The more it is exceeded, the
    less structure it takes to think otherwise.

    Args:
        fit: The fitted model, held against the noise that counts.
        named: Ids of the effects that were added to it.
    """
    noise, whole = yardstick(fit), lack_of_fit(fit)
    size = explained(fit, named) / float(np.sqrt(noise.scale))
    undecided = False
    if noise.source == "stated" and whole is not None and whole.probability < LEVEL:
        free, closest = _structure(fit, _free(fit))
        free |= unlike_scatter(fit)
        if _bare(free, whole.factor):
            told = whole.factor < WITHOUT_SCATTER or _reading_by_reading(fit)
            if told and whole.factor < FOUND:
                return _judged(free, size / whole.factor, whole, closest, whole.factor)
            undecided = not told
    tests, closest = _structure(fit, noise)
    if whole is not None:
        taken = whole.freedom[0]
        beyond = whole.statistic * (1 if whole.freedom[1] is None else taken) - taken
        tests[WHOLE] = whole.probability, beyond
    return replace(_judged(tests, size, whole, closest), undecided=undecided)


def _judged(
    tests: Tests,
    explained: float,
    whole: LackOfFit | None,
    closest: str | None,
    understated: float | None = None,
) -> Adequacy:
    excess = max((beyond for _, beyond in tests.values()), default=0.0)
    return Adequacy(
        probability=_smallest(tests),
        excess=float(np.sqrt(max(excess, 0.0))),
        explained=explained,
        tests={name: chance for name, (chance, _) in tests.items()},
        whole=whole,
        understated=understated,
        closest=closest,
    )


def _smallest(tests: Tests) -> float:
    return min(1.0, len(tests) * min((chance for chance, _ in tests.values()), default=1.0))


def _free(fit: Fit) -> Yardstick:
    """The noise as the readings scatter, whatever was stated."""
    found = scatter(fit)
    return found or Yardstick("unknown", fit.noise_factor**2, 0.0, None, None)


def _reading_by_reading(fit: Fit) -> bool:
    """Do poses tell noise from what every pose has of its own?

    By readings about a line in the load, or where there are too few of them by the likelihood: a
    larger noise makes the gap likelier than any such error beside the noise that was stated.
    """
    if scatter(fit) is not None:
        return True
    found = variance_components(against_noise_alone(fit))
    return bool(found.inflation_gain > found.gain + LIKELIER)


def _bare(tests: Tests, factor: float) -> bool:
    """No structure: the more a statement is exceeded, the less it takes to think otherwise."""
    return _smallest(tests) >= min(LEVEL * factor**4, 0.05)


def _structure(fit: Fit, noise: Yardstick) -> tuple[Tests, str | None]:
    """All that noise cannot have made, and the suspect that it goes with most closely."""
    found, tests = localise(fit, noise), Tests()
    if noise.freedom:
        for order in found.orders:
            if order.probability is not None and order.name in ORDERS:
                tests[ORDERS[order.name]] = order.probability, order.excess
    for own in found.own:
        tests[OWN[own.name]] = own.probability, own.statistic - own.freedom
    if not found.suspects:
        return tests, None
    closest = min(found.suspects, key=lambda suspicion: suspicion.probability)
    beyond = closest.statistic - closest.freedom
    tests[f"together with {closest.name}"] = closest.probability, beyond
    return tests, closest.name


def explained(fit: Fit, named: Collection[str]) -> float:
    """‖M_B S v‖: what some effects explain that the others cannot imitate, in units of the noise.

    Args:
        fit: The fitted model; its noise is the unit.
        named: Ids of the effects.
    """
    own = np.array([p.effect.id in named for p in fit.parameters], dtype=bool)
    if not own.any():
        return 0.0
    signature = fit.jacobian[:, own] @ fit.x[own]
    base = orthonormal(fit.jacobian[:, ~own])
    return float(np.linalg.norm(signature - base @ (base.T @ signature)))


def unlike_scatter(fit: Fit) -> dict[str, tuple[float, float]]:
    """Bartlett's test (1937) of equal scatter within poses: its name, probability and excess.

    Empty where fewer than two poses have readings enough.
    """
    load_cases = fit.problem.load_cases
    basis = load_basis(load_cases, jump=True, cubic=True, branches=True)
    columns = fit.problem.whitener.apply(pose_columns(basis))
    squares, freedom = [], []
    for rows in rows_by_label(fit.problem.pose):
        block = orthonormal(columns[rows])
        white = fit.residual[rows]
        left = white - block @ (block.T @ white)
        if len(white) - block.shape[1] >= FEWEST:
            squares.append(float(left @ left))
            freedom.append(len(white) - block.shape[1])
    if len(squares) < 2 or min(squares) <= 0.0:
        return {}
    nu, variance = np.array(freedom, dtype=float), np.array(squares) / np.array(freedom)
    pooled = float(nu @ variance / nu.sum())
    T = float(nu.sum() * np.log(pooled) - nu @ np.log(variance))
    T /= 1.0 + (float((1.0 / nu).sum()) - 1.0 / nu.sum()) / (3.0 * (len(nu) - 1))
    chance = float(stats.chi2.sf(T, len(nu) - 1))
    return {"scatter that differs between poses": (chance, T - (len(nu) - 1))}
