"""Every pose has its own size of the model-form error: few poses do not set it for all."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize

from sk120stiff.explain.candidates.regression import regression_at
from sk120stiff.explain.options import Options, candidates_for
from sk120stiff.explain.select.own_sizes import price_of_factors, with_settled_sizes
from sk120stiff.explain.select.stepwise import with_own_sizes
from sk120stiff.identify import Fit, Problem, fit
from sk120stiff.measurements import Measurements, ModelForm, NoiseModel
from tests.explain.readings import SIGMA, base_fit, hidden
from tests.explain.test_beside_form import roughened
from tests.hidden.generator.causes_elastic import JointTilt

SHARE = 0.06
NOISE = NoiseModel(SIGMA, form=ModelForm(proportional=SHARE))


def own_factors(readings: Measurements) -> dict[str, float]:
    """Factors on the variance of each pose, beside springs and the whole catalogue."""
    return dict(_sized(readings).problem.noise.form.of_poses)


def _sized(readings: Measurements, noise: NoiseModel = NOISE) -> Fit:
    base = fit(base_fit(readings).model, readings, noise=noise)
    candidates = candidates_for(base.model, readings, Options())
    regression = regression_at(base, candidates, ("joint_springs",), alpha=0.01)
    return with_own_sizes(base, regression)[0]


def off_at(readings: Measurements, pose: str, share: float) -> Measurements:
    """The same with one pose that is off by far more than the others."""
    wild = roughened(readings, share, seed=11).displacement
    there = np.array([label == pose for label in readings.pose])
    return replace(readings, displacement=np.where(there[:, None], wild, readings.displacement))


def test_a_pose_that_is_off_far_more_than_the_others_has_its_own_size():
    rough = roughened(hidden(poses=36), SHARE)
    worst = rough.poses[20]
    factors = own_factors(off_at(rough, worst, 8 * SHARE))
    assert max(factors, key=factors.__getitem__) == worst
    assert factors[worst] > 5.0
    assert np.median(list(factors.values())) == pytest.approx(1.0, abs=0.35)


def test_where_all_poses_are_alike_none_is_far_from_one():
    factors = np.array(list(own_factors(roughened(hidden(poses=36), SHARE)).values()))
    assert factors.min() > 0.4
    assert factors.max() < 5.0


def test_what_a_cause_of_the_catalogue_does_is_no_size_of_its_own():
    """It bends some poses far more than others, and is left to be found."""
    tilt = JointTilt("joint_2_l", {"first": 6e-7, "second": 0.0})
    plain, hurt = (
        own_factors(roughened(hidden(*causes, poses=36), 0.02)) for causes in ((), (tilt,))
    )
    largest = max(hurt.values())
    assert largest < 2.0 * max(plain.values())


def test_the_fit_weighs_a_pose_by_its_own_size():
    rough = roughened(hidden(poses=36), SHARE)
    wild = off_at(rough, rough.poses[20], 8 * SHARE)
    even = fit(base_fit(wild).model, wild, noise=NOISE)
    true = fit(base_fit(rough).model, rough, noise=NOISE)

    def beside(found: Fit) -> float:
        return float(np.linalg.norm(np.log(found.x / true.x)))

    assert beside(_sized(wild)) < 0.5 * beside(even)


def test_noise_without_model_form_error_has_no_factors():
    readings = hidden()
    found = _sized(readings, NoiseModel(SIGMA))
    assert not found.problem.noise.form.of_poses
    assert price_of_factors(found.problem.noise.form) == 0.0


def test_factors_cost_what_their_distribution_says():
    """-2 ln p of ln s under a t of four degrees of freedom, beside s = 1."""
    form = ModelForm(0.1, of_poses=(("a", 1.0), ("b", 4.0)))
    assert price_of_factors(form) == pytest.approx(4.0 * (np.log(4.0) + 0.25 - 1.0))


def test_settled_values_are_those_of_maximum_likelihood_of_the_t_distribution():
    """Against a direct minimisation, where the noise is nothing beside the model-form error."""
    rough = roughened(hidden(poses=36, sigma=1e-8), SHARE)
    wild = off_at(rough, rough.poses[20], 8 * SHARE)
    noise = NoiseModel(3e-7, form=ModelForm(proportional=SHARE))
    even = fit(base_fit(wild).model, wild, noise=noise)
    found = with_settled_sizes(even)
    scale = NoiseModel(3e-7, form=ModelForm(proportional=SHARE * float(np.sqrt(0.5))))
    problem = Problem(even.model, wild, scale)
    whitener = problem.whitener
    free = (wild.displacement.size - even.estimated) / wild.displacement.size

    def deviance(x: np.ndarray) -> float:
        white = whitener.apply(problem.gap(x))
        drawn = [(rows, U[:, size > 1.0]) for rows, U, size in whitener.strengths]
        squares = [((U.T @ white[rows]) ** 2).sum() / free for rows, U in drawn]
        axes = [U.shape[1] for _, U in drawn]
        return sum((4.0 + k) * np.log1p(s / 4.0) for s, k in zip(squares, axes, strict=True))

    best = minimize(lambda v: deviance(v * even.x), np.ones(len(even.x)), method="Nelder-Mead",
                    options={"xatol": 1e-6, "fatol": 1e-8, "maxiter": 4000}).x * even.x  # fmt: skip
    assert np.abs(found.x - best).max() < 0.1 * np.abs(even.x - best).max()


def test_settled_factors_leave_the_errors_the_size_of_the_whole():
    even = fit(base_fit(hidden()).model, roughened(hidden(poses=36), SHARE), noise=NOISE)
    found = with_settled_sizes(even)
    weights = [1.0 / s for _, s in found.problem.noise.form.of_poses]
    assert np.mean(weights) == pytest.approx(1.0)
    errors = [np.sqrt(np.diag(each.covariance)) for each in (found, even)]
    assert errors[0] == pytest.approx(errors[1], rel=0.25)


def test_beside_exact_laws_nothing_is_settled():
    found = fit(base_fit(hidden()).model, hidden(), noise=NoiseModel(SIGMA))
    assert with_settled_sizes(found) is found
