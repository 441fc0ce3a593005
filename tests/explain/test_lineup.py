"""Names and suspects side by side, on small arrays: what takes whose place, and what it costs."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from sk120stiff import base_model, load_robot
from sk120stiff.effects import Effect, effect
from sk120stiff.explain.judge import imitation
from sk120stiff.explain.judge.imitation import Instead, Lineup, instead_of
from sk120stiff.explain.judge.imitation import _precision as precision
from sk120stiff.explain.localise.suspect import Suspect
from sk120stiff.explain.select.stepwise import refit
from sk120stiff.identify import Fit, fit
from sk120stiff.measurements import ModelForm
from tests.explain.readings import NOISE, hidden
from tests.hidden.generator.causes_elastic import JointTilt

ROUGH = replace(NOISE, form=ModelForm(0.01, 0.0))
TILT = JointTilt("joint_2_l", {"first": 8e-7, "second": 0.0})


@pytest.fixture(scope="module")
def springs():
    return base_model(load_robot("motoman_sk120"))


def beside(line: Lineup, found: Fit, names: Sequence[Effect]) -> Instead | None:
    """What would do in the place of names, were this the lineup of a fit."""
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(imitation, "line_up_with", lambda *_: line)
        return instead_of(found, names)


def tilted(springs):
    """Springs and a tilt beside a hundredth of every pose's compliance."""
    base = fit(springs, hidden(TILT), noise=ROUGH)
    return refit(base, [effect(springs.robot, "joint_tilt", "joint_2_l")])


def test_the_strongest_name_stands_where_all_do_better_beside_another_suspect(springs):
    """Alone against the gap it would lose; with the foreign cause let in beside it, it wins."""
    found = tilted(springs)
    foreign, mimic, true = np.eye(3)
    true = (true + 0.8 * mimic + 0.4 * foreign) / np.linalg.norm([1.0, 0.8, 0.4])
    columns = np.stack([true, foreign, mimic + 0.9 * foreign], axis=1)
    columns /= np.linalg.norm(columns, axis=0)
    gap = 10.0 * columns[:, 0] + 30.0 * foreign
    line = Lineup(
        suspects=tuple(Suspect("place", name, np.zeros((1, 3, 1)), gap, "") for name in "fm"),
        gram=columns.T @ columns,
        moment=columns.T @ gap,
        names=[np.array([0])],
        parts=[np.array([1]), np.array([2])],
        unit=1.0,
        drawn={},
    )
    assert line.score([0], 0) < line.score([], 1) < line.score([0])
    assert beside(line, found, found.model.effects[-1:]) is None


def test_name_and_suspect_give_way_to_one_suspect_that_does_as_well_by_itself(springs):
    """Both accounts hold a cause without a name; that of fewer parts needs no margin over it."""
    found = tilted(springs)
    columns = np.array([[1.0, 0.0, 0.8], [0.0, 1.0, 0.6]])  # name, a suspect beside it, the mimic
    gap = 5.0 * columns[:, 2]
    line = Lineup(
        suspects=tuple(
            Suspect("place", name, np.zeros((1, 3, 1)), columns[0], "") for name in "fm"
        ),
        gram=columns.T @ columns,
        moment=columns.T @ gap,
        names=[np.array([0])],
        parts=[np.array([1]), np.array([2])],
        unit=1.0,
        drawn={},
    )
    apart = line.score([0], 0) - line.score([], 1)
    assert 0.0 < apart < imitation.BETTER < line.score([0]) - line.score([], 1)
    other = beside(line, found, found.model.effects[-1:])
    assert other is not None and other.name == "m"


@pytest.mark.parametrize(("noise", "fall"), [(NOISE, False), (ROUGH, True)])
def test_only_where_something_has_no_name_a_suspect_stands_for_several(springs, noise, fall):
    names = [effect(springs.robot, "joint_tilt", where) for where in ("joint_2_l", "joint_3_u")]
    found = refit(fit(springs, hidden(TILT), noise=noise), names)
    columns = np.array([[1.0, 0.0, np.sqrt(0.5)], [0.0, 1.0, np.sqrt(0.5)]])
    line = Lineup(
        suspects=(Suspect("place", "both", np.zeros((1, 3, 1)), columns[:, 0], ""),),
        gram=columns.T @ columns,
        moment=columns.T @ np.array([10.0, 10.0]),
        names=[np.array([0]), np.array([1])],
        parts=[np.array([2])],
        unit=10.0,
        drawn={},
    )
    other = beside(line, found, names)
    assert (other is not None and len(other.effects) == 2) == fall


@pytest.mark.parametrize("own", [6.0, 40.0])
def test_what_a_name_does_not_do_anyway_no_suspect_takes_from_it(springs, own):
    """Its price is saved beside any suspect: that tells nothing of the suspect."""
    names = [effect(springs.robot, "joint_tilt", where) for where in ("joint_2_l", "joint_3_u")]
    found = refit(fit(springs, hidden(TILT), noise=NOISE), names)
    columns = np.eye(8)
    columns[1, 7] = 0.99 if own > 20.0 else 0.0  # the suspect lies along the second name
    columns[7, 7] = np.sqrt(1.0 - columns[1, 7] ** 2)
    gap = np.zeros(8)
    gap[0], gap[1], gap[7] = 30.0, np.sqrt(own), 3.0
    line = Lineup(
        suspects=(Suspect("place", "one", np.zeros((1, 3, 1)), gap, ""),),
        gram=columns.T @ columns,
        moment=columns.T @ gap,
        names=[np.array([0]), np.arange(1, 7)],
        parts=[np.array([7])],
        unit=4.0,
        drawn={},
    )
    other = beside(line, found, names)
    assert (other is not None and other.effects == (names[1].id,)) == (own > 24.0)


def test_random_effects_are_scored_by_their_marginal_likelihood():
    rng = np.random.default_rng(2)
    columns = np.linalg.qr(rng.normal(size=(40, 13)))[0] @ rng.normal(size=(13, 13))
    columns /= np.linalg.norm(columns, axis=0)
    gap, lam, unit = 3.0 * rng.normal(size=40), 0.2, 4.0
    line = Lineup(
        suspects=(),
        gram=columns.T @ columns,
        moment=columns.T @ gap,
        names=[np.array([0]), np.arange(1, 13)],
        parts=[],
        unit=unit,
        drawn={1: lam},
    )
    with_draws = np.eye(40) + columns[:, 1:] @ columns[:, 1:].T / lam
    gained = multivariate_normal(cov=with_draws).logpdf(gap) - multivariate_normal(
        cov=np.eye(40)
    ).logpdf(gap)
    assert line.score([1]) == pytest.approx(unit - 2.0 * gained, rel=1e-9)
    solved = np.linalg.inv(with_draws)
    first = columns[:, 0]
    beside = (first @ solved @ gap) ** 2 / (first @ solved @ first)
    assert line.takes([0, 1]) - line.takes([1]) == pytest.approx(beside, rel=1e-9)


def test_how_widely_random_effects_scatter_comes_from_their_sizes():
    rng = np.random.default_rng(5)
    length, scale = rng.uniform(0.5, 2.0, 4000), 2.0
    sizes = 3.0 * rng.normal(size=4000) * np.sqrt(scale) / length
    estimated = sizes + rng.normal(size=4000) * np.sqrt(scale) / length
    assert precision(estimated, length, scale) == pytest.approx(1.0 / 9.0, rel=0.1)
