"""The smallest detectable size is one at which the name comes in four of five cases."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from sk120stiff.explain.advise.detectable import POWER, length_named
from sk120stiff.explain.candidates.regression import Regression, regression_at
from sk120stiff.explain.judge.attribution import MARGIN
from sk120stiff.explain.judge.confirm import confirm
from sk120stiff.explain.options import Options, candidates_for
from sk120stiff.explain.select.beam import beam_search
from sk120stiff.explain.select.score import entry_fall, score_set
from sk120stiff.identify import fit
from sk120stiff.measurements import NoiseModel
from sk120stiff.model import Model, base_model, joint_spring_model
from sk120stiff.plan import Schedule
from sk120stiff.robot import load_robot
from tests.corpus.robots import example
from tests.identify.conftest import readings_of

DRAWS = 15
NOISE = NoiseModel(10e-6, 0.0, "shared")


def sk120() -> Model:
    model = base_model(load_robot("motoman_sk120"))
    assert model is not None
    return model


def ur5() -> Model:
    return joint_spring_model(load_robot(str(example("ur5_robot.urdf"))))


def regression_of(model: Model) -> Regression:
    readings = readings_of(model, poses=15, schedule=Schedule("ascending", 4))
    base = fit(model, readings, noise=NOISE)
    candidates = candidates_for(model, readings, Options())
    return regression_at(base, candidates, [e.id for e in model.effects], alpha=0.01)


def drawn(regression: Regression, name: str) -> Callable[[int], Regression]:
    """Readings with the one effect at its detectable size, and new noise for every seed."""
    (k,) = (k for k, e in enumerate(regression.candidates) if e.id == name)
    own = regression.columns[k]
    base, _ = np.linalg.qr(regression.X[:, regression.base])
    column = regression.X[:, own[0]]
    left = float(np.linalg.norm(column - base @ (base.T @ column)))
    length = length_named(entry_fall(regression, k), len(own))
    springs = regression.X[:, regression.base] @ np.full(len(regression.base), 1.0)
    signal = springs + column * length / left

    def at(seed: int) -> Regression:
        noise = np.random.default_rng(seed).normal(size=regression.rows)
        return replace(regression, y=signal + noise)

    return at


def is_named(regression: Regression, name: str) -> bool:
    """The rule that names: the best set, its price, its confirmation; rivals within the margin."""
    best = beam_search(regression, max_effects=1)[0]
    if not best.effects:
        return False
    (winner,) = best.effects
    if not confirm(regression, best, winner, [], seed=0).holds:
        return False
    (k,) = (k for k, e in enumerate(regression.candidates) if e.id == name)
    score = score_set(regression, regression.sums(), (k,)).score
    return winner == k or score - best.score < max(MARGIN, np.log(regression.rows) + 0.5)


@pytest.mark.parametrize(
    ("arm", "name"),
    [(sk120, "joint_tilt:joint_1_s"), (ur5, "base_rocking:world")],
)
def test_it_is_named_in_four_of_five_cases(arm, name) -> None:
    regression = regression_of(arm())
    at = drawn(regression, name)
    share = np.mean([is_named(at(seed), name) for seed in range(DRAWS)])
    spread = np.sqrt(POWER * (1.0 - POWER) / DRAWS)
    assert POWER - 2.0 * spread <= share


def test_the_length_is_a_quantile_of_the_fall() -> None:
    """Against drawn sums of squares, not against the quantile itself."""
    rng = np.random.default_rng(0)
    for fall, count in ((17.0, 1), (23.0, 2), (40.0, 6)):
        length = length_named(fall, count)
        draws = rng.normal(size=(20000, count))
        draws[:, 0] += length
        assert np.mean((draws**2).sum(axis=1) > fall) == pytest.approx(POWER, abs=0.01)


def test_the_fall_that_is_needed_is_the_price_that_is_paid() -> None:
    """Just beyond it a model with the effect scores better than the one without."""
    regression = regression_of(sk120())
    (k,) = (k for k, e in enumerate(regression.candidates) if e.id == "link_torsion:link_2_l")
    fall = entry_fall(regression, k)
    assert fall > stats.chi2.isf(regression.alpha / len(regression.candidates), 1)
    base, _ = np.linalg.qr(regression.X[:, regression.base])
    column = regression.X[:, regression.columns[k][0]]
    along = column - base @ (base.T @ column)
    along /= np.linalg.norm(along)
    springs = regression.X[:, regression.base] @ np.full(len(regression.base), 1.0)
    for factor, better in ((0.97, False), (1.03, True)):
        only = replace(regression, y=springs + factor * np.sqrt(fall) * along)
        sums = only.sums()
        gain = score_set(only, sums, ()).score - score_set(only, sums, (k,)).score
        assert (gain > 0.0) is better
