"""The noise law against simulated readings, and its whitening against dense matrix algebra."""

import re
import time

import numpy as np
import pytest
from numpy.typing import NDArray

from sk120stiff.errors import InputError
from sk120stiff.measurements import Measurements, NoiseModel, NoiseStatement, Whitener, candidates

Floats = NDArray[np.float64]
SIGMA = 10e-6


def make(
    poses: list[str],
    displacement: Floats | None = None,
    zero: str = "shared",
    zero_count: list[int] | None = None,
    **more: object,
) -> Measurements:
    rng = np.random.default_rng(4)
    count = len(poses)
    if displacement is None:
        displacement = rng.normal(size=(count, 3)) * 5e-4
    names = sorted(set(poses))
    return Measurements(
        pose=tuple(poses),
        joint_names=("q",),
        joints=np.array([[float(names.index(p))] for p in poses]),
        wrench=rng.normal(size=(count, 6)),
        displacement=displacement,
        zero=zero,  # type: ignore[arg-type]
        zero_count=np.array(zero_count or [1] * count),
        **more,  # type: ignore[arg-type]
    )


MIXED = ["a", "b", "a", "c", "a", "b", "d", "a"]
COUNTS = [2, 1, 2, 4, 2, 1, 1, 2]


@pytest.mark.parametrize("zero", ["shared", "separate"])
@pytest.mark.parametrize("growth", [0.0, 0.02])
@pytest.mark.parametrize("own", [False, True])
def test_covariance_is_that_of_simulated_readings(zero: str, growth: float, own: bool) -> None:
    """Readings are drawn one by one: zero readings, their mean, the loaded reading minus it."""
    stated = np.linspace(5e-6, 30e-6, 24).reshape(8, 3) if own else None
    idle = np.full((8, 3), SIGMA)  # of one zero reading: as those state that subtract it
    if stated is not None:
        alike = [[k for k, p in enumerate(MIXED) if p == pose] for pose in MIXED]
        idle = np.array([np.sqrt((stated[rows] ** 2).mean(axis=0)) for rows in alike])
        idle = idle if zero == "shared" else stated
    m = make(MIXED, zero=zero, zero_count=COUNTS, sigma=stated)
    rng = np.random.default_rng(8)
    draws = 16_000
    size = np.linalg.norm(m.displacement, axis=1)
    means = {}
    noise = np.empty((draws, 8, 3))
    for i, pose in enumerate(MIXED):
        if zero == "separate" or pose not in means:
            zeros = idle[i] * rng.normal(size=(draws, COUNTS[i], 3))
            means[pose] = zeros.mean(axis=1)
        loaded = rng.normal(size=(draws, 3)) * (SIGMA if stated is None else stated[i])
        loaded += rng.normal(scale=growth * size[i], size=(draws, 3))
        noise[:, i] = loaded - means[pose]
    model = NoiseModel(SIGMA, growth, zero)
    for axis, expected in enumerate(model.covariance(m)):
        found = np.cov(noise[:, :, axis].T)
        spread = np.sqrt(np.outer(np.diag(expected), np.diag(expected)) / draws)
        assert np.max(np.abs(found - expected) / spread) < 5.5
    white = np.stack([model.whitener(m).apply(x) for x in noise[:2000]])
    found = np.cov(white.T)
    assert np.max(np.abs(found - np.eye(24))) < 6 / np.sqrt(2000)


def dense(model: NoiseModel, m: Measurements, sizes: Floats | None = None) -> Floats:
    """(3N, 3N) covariance, row by row, built from the law in words and not from the module."""
    count = m.n_readings
    if sizes is None:
        sizes = np.linalg.norm(m.displacement, axis=1)
    sizes = np.broadcast_to(sizes.T, (3, count)).T
    full = np.zeros((3 * count, 3 * count))
    for i in range(count):
        for j in range(count):
            for axis in range(3):
                share = i == j or (model.zero == "shared" and m.zero_group[i] == m.zero_group[j])
                idle = model.sigma**2
                if m.sigma is not None:  # the zero reading is as good as those that subtract it
                    same = m.zero_group == m.zero_group[i]
                    rows = [i] if model.zero == "separate" else np.flatnonzero(same)
                    idle = float(np.mean(m.sigma[rows, axis] ** 2))
                value = idle / m.zero_count[i] if share else 0.0
                if i == j:
                    value += model.sigma**2 if m.sigma is None else m.sigma[i, axis] ** 2
                    value += (model.growth * sizes[i, axis]) ** 2
                full[3 * i + axis, 3 * j + axis] = value
    return full


@pytest.mark.parametrize("zero", ["shared", "separate"])
@pytest.mark.parametrize("growth", [0.0, 0.03])
@pytest.mark.parametrize("per_axis", [False, True])
def test_whitening_is_the_exact_cholesky_factor(zero: str, growth: float, per_axis: bool) -> None:
    rng = np.random.default_rng(1)
    stated = rng.uniform(1e-6, 50e-6, size=(8, 3)) if per_axis else None
    m = make(MIXED, zero=zero, zero_count=COUNTS, sigma=stated)
    sizes = rng.uniform(0, 1e-3, size=(8, 3) if per_axis else 8)
    model = NoiseModel(SIGMA, growth, zero)
    covariance = dense(model, m, sizes)
    factor = np.linalg.cholesky(covariance)
    whitener = model.whitener(m, sizes)
    x = rng.normal(size=(8, 3)) * SIGMA
    np.testing.assert_allclose(
        whitener.apply(x), np.linalg.solve(factor, x.ravel()), rtol=1e-12, atol=1e-12
    )
    many = rng.normal(size=(8, 3, 5))
    np.testing.assert_allclose(
        whitener.apply(many) * SIGMA,
        np.linalg.solve(factor, many.reshape(24, 5)) * SIGMA,
        rtol=1e-11,
        atol=1e-11,
    )
    assert whitener.logdet == pytest.approx(np.linalg.slogdet(covariance)[1], rel=1e-13)
    np.testing.assert_allclose(
        np.stack([model.covariance(m, sizes)[k] for k in range(3)]),
        np.stack([covariance[k::3, k::3] for k in range(3)]),
        rtol=1e-14,
    )


def test_shared_errors_far_larger_than_own_ones_keep_their_digits() -> None:
    rng = np.random.default_rng(5)
    own = np.full((50, 3), 1e-14)
    shared = np.full((50, 3), 1e-4)
    whitener = Whitener(own, shared, np.zeros(50, dtype=np.int64))
    level = whitener.apply(np.ones((50, 3))).reshape(50, 3)
    np.testing.assert_allclose(level[0], 100.0, rtol=1e-9)  # 1 m in units of the shared 10 mm
    assert np.abs(level[1:]).max() < 1e-2  # the rest is known from the first row
    x = rng.normal(size=(50, 3)) * 1e-7
    white = whitener.apply(x).reshape(50, 3)
    centred = x - x.mean(axis=0)
    np.testing.assert_allclose((white**2).sum(0), (centred**2).sum(0) / 1e-14, rtol=1e-6)


def test_masked_rows_leave_their_group_without_trace() -> None:
    use = np.array([1, 1, 0, 1, 1, 1, 0, 1], dtype=bool)
    m = make(MIXED, zero_count=COUNTS, use=use)
    covariance = NoiseModel(SIGMA, 0.01).covariance(m)
    np.testing.assert_allclose(
        NoiseModel(SIGMA, 0.01).covariance(m.masked()), covariance[:, use][:, :, use]
    )


def test_a_displacement_with_its_own_zero_has_root_two_sigma() -> None:
    m = make(["a", "b"], zero="separate")
    np.testing.assert_allclose(
        NoiseModel(SIGMA).covariance(m), np.eye(2)[None] * 2 * SIGMA**2 * np.ones((3, 1, 1))
    )
    np.testing.assert_allclose(
        NoiseModel(SIGMA).whitener(m).apply(np.full((2, 3), SIGMA)), 0.5**0.5
    )


def test_zeros_that_nobody_described_are_as_the_model_says() -> None:
    """Rows of one pose subtract one zero reading, or each its own: σ² more in the variance."""
    m = make(["a", "a", "b"], zero="unknown")
    x = np.full((3, 3), SIGMA)
    own = NoiseModel(SIGMA, zero="separate").whitener(m)
    np.testing.assert_allclose(own.apply(x), 0.5**0.5)
    assert own.logdet == pytest.approx(9 * np.log(2 * SIGMA**2))
    shared = NoiseModel(SIGMA, zero="shared").whitener(m)
    assert shared.logdet == pytest.approx(np.log(3.0 * 2.0) * 3 + 9 * np.log(SIGMA**2))


def test_a_reading_of_a_quarter_of_the_weight_has_twice_the_sigma() -> None:
    weights = np.array([1.0, 0.25, 1.0, 1.0, 0.04, 1.0, 1.0, 1.0])
    x = np.random.default_rng(2).normal(size=(8, 3)) * SIGMA
    m, model = make(MIXED, zero_count=COUNTS), NoiseModel(SIGMA)
    covariance = dense(model, m, np.zeros(8))
    covariance += np.diag(np.repeat((1.0 / weights - 1.0) * SIGMA**2, 3))
    expected = np.linalg.solve(np.linalg.cholesky(covariance), x.ravel())
    np.testing.assert_allclose(model.whitener(m, weights=weights).apply(x), expected, rtol=1e-12)


def test_a_zero_reading_is_as_good_as_those_that_subtract_it() -> None:
    """What rows state of their displacements is what the noise has, whatever else is told."""
    stated = np.linspace(3e-6, 30e-6, 24).reshape(8, 3)
    own, zero = NoiseModel(SIGMA, zero="separate").variances(make(MIXED, sigma=stated))
    np.testing.assert_allclose(own + zero, 2.0 * stated**2, rtol=1e-14)
    _, shared = NoiseModel(SIGMA).variances(make(["a", "b", "a"], sigma=stated[:3]))
    np.testing.assert_allclose(shared[0], 0.5 * (stated[0] ** 2 + stated[2] ** 2), rtol=1e-14)
    np.testing.assert_allclose(shared[1], stated[1] ** 2, rtol=1e-14)
    blank = np.array([[3e-6, np.nan, 3e-6]])
    moved = np.array([[1e-4, np.nan, 1e-4]])
    _, alone = NoiseModel(SIGMA).variances(make(["a"], displacement=moved, sigma=blank))
    np.testing.assert_allclose(alone, [[9e-12, SIGMA**2, 9e-12]], rtol=1e-14)


def test_large_data_are_whitened_in_milliseconds() -> None:
    rng = np.random.default_rng(0)
    m = make([str(i // 5) for i in range(2000)], displacement=rng.normal(size=(2000, 3)) * 1e-4)
    whitener = NoiseModel(SIGMA, 0.01).whitener(m)
    x = rng.normal(size=(2000, 3, 100))
    seconds = []
    for _ in range(5):
        start = time.process_time()
        whitener.apply(x)
        seconds.append(time.process_time() - start)
    assert min(seconds) < 0.1  # some 8 ms on a quiet machine


def test_what_cannot_be_whitened() -> None:
    m = make(MIXED)
    with pytest.raises(InputError, match="shape"):
        NoiseModel(SIGMA).whitener(m).apply(np.zeros((7, 3)))
    with pytest.raises(InputError, match="sizes have shape"):
        NoiseModel(SIGMA, 0.01).whitener(m, np.zeros(7))
    with pytest.raises(InputError, match="variance"):
        Whitener(np.zeros((2, 3)), np.zeros((2, 3)), np.arange(2))
    plan = Measurements(
        pose=("a",), joint_names=("q",), joints=[[0.0]], wrench=np.zeros((1, 6)), displacement=None
    )
    with pytest.raises(InputError, match="plan"):
        NoiseModel(SIGMA, 0.01).whitener(plan)


@pytest.mark.parametrize(
    "bad",
    [{"sigma": 0.0}, {"sigma": -1e-6}, {"sigma": np.nan}, {"sigma": 1e-6, "growth": -0.1},
     {"sigma": 1e-6, "growth": 1.0}, {"sigma": 1e-6, "zero": "unknown"}],
)  # fmt: skip
def test_impossible_models_are_refused(bad: dict[str, float]) -> None:
    with pytest.raises(InputError):
        NoiseModel(**bad)  # type: ignore[arg-type]


@pytest.mark.parametrize("bad", [{"sigma": 0.0}, {"growth": -0.1}, {"growth": 1.5}])
def test_impossible_statements_are_refused(bad: dict[str, float]) -> None:
    with pytest.raises(InputError):
        NoiseStatement(**bad)


def test_candidates_are_what_the_data_leave_open() -> None:
    def models(*args: object, **more: object) -> list[tuple[str, float, float, bool]]:
        found = candidates(make(*args, **more))  # type: ignore[arg-type]
        return [(c.zero, c.sigma, c.growth, c.stated) for c in found]

    said = {"noise": NoiseStatement(7e-6, 0.0)}
    assert models(MIXED, zero="shared", **said) == [("shared", 7e-6, 0.0, True)]
    both = [("shared", 7e-6, 0.0, True), ("separate", 7e-6, 0.0, True)]
    assert models(MIXED, zero="unknown", **said) == both
    alone = models(["a", "b", "c"], zero="unknown", **said)
    assert alone == [("separate", 7e-6, 0.0, True)]  # one row per pose: sharing makes no difference
    rows = models(MIXED, zero="separate", sigma=np.full((8, 3), 3e-6))
    assert rows == [("separate", 3e-6, 0.0, True)]  # the rows' own uncertainties hold any growth
    silent = models(MIXED, zero="shared")
    assert [(zero, growth, stated) for zero, _, growth, stated in silent] == [("shared", 0, False)]
    grown = models(MIXED, zero="shared", noise=NoiseStatement(7e-6, 0.02))
    assert grown == [("shared", 7e-6, 0.02, True)]


def test_models_speak_plainly() -> None:
    text = NoiseModel(SIGMA, 0.01, "shared").of_growth_and_zero()
    assert re.search(r"1 % of its displacement.*share its error", text)
    assert "independent" in NoiseModel(SIGMA, zero="separate").of_growth_and_zero()


def test_rows_that_each_subtract_a_zero_of_their_own_share_none() -> None:
    shared = NoiseModel(SIGMA, zero="shared")
    assert "share its error" in shared.of_growth_and_zero(make(["a", "a", "b"]))
    apart = make(["a", "a", "b"], zero_group=np.arange(3))
    assert "a zero reading of its own" in shared.of_growth_and_zero(apart)


def test_scaling_scales_the_covariance() -> None:
    m = make(MIXED, zero_count=COUNTS)
    model = NoiseModel(SIGMA, 0.02)
    np.testing.assert_allclose(model.scaled(3.0).covariance(m), 9 * model.covariance(m))
