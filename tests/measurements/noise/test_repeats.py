"""Pure error of simulated repeats: the right σ and the right degrees of freedom."""

import dataclasses

import numpy as np
import pytest

from sk120stiff.measurements import Measurements, candidates
from sk120stiff.measurements.noise.repeats import repeated as noise_of_repeats

SIGMA = 10e-6


def pure_error(m: Measurements, zero: str | None = None) -> tuple[float, int] | None:
    found = noise_of_repeats(m, zero, grows=False)
    return None if found is None else (found.sigma, found.freedom)


def repeated(
    rng: np.random.Generator, zero: str, poses: int = 6, loads: int = 3, times: int = 4
) -> Measurements:
    pose, wrench, displacement = [], [], []
    for p in range(poses):
        shared = rng.normal(scale=SIGMA, size=3)
        for load in range(loads):
            for _ in range(times):
                own_zero = shared if zero == "shared" else rng.normal(scale=SIGMA, size=3)
                pose.append(str(p))
                wrench.append([100.0 * (load + 1), p, 0, 0, 0, 0])
                truth = np.array([1e-4 * load, 2e-4 * p, 1e-4])
                displacement.append(truth + rng.normal(scale=SIGMA, size=3) - own_zero)
    return Measurements(
        pose=tuple(pose),
        joint_names=("q",),
        joints=np.array([[float(p)] for p in pose]),
        wrench=np.array(wrench),
        displacement=np.array(displacement),
        zero=zero,  # type: ignore[arg-type]
    )


@pytest.mark.parametrize("zero", ["shared", "separate"])
def test_sigma_of_one_reading_comes_back(zero: str) -> None:
    rng = np.random.default_rng(3)
    found = [pure_error(repeated(rng, zero)) for _ in range(40)]
    squares = []
    for one in found:
        assert one is not None
        assert one[1] == 6 * 3 * 3 * 3  # poses x loads x (times - 1) x axes
        squares.append(one[0] ** 2)
    # The mean of 40 variances with 162 degrees of freedom each: standard error 1.75 %.
    assert np.mean(squares) == pytest.approx(SIGMA**2, rel=0.07)


def test_the_wrong_word_about_the_zero_shows() -> None:
    separate = repeated(np.random.default_rng(6), "separate")
    m = dataclasses.replace(separate, zero="unknown", zero_group=separate.pose_index)
    right, wrong = pure_error(m, "separate"), pure_error(m)
    assert right is not None
    assert wrong is not None
    assert wrong[0] == pytest.approx(right[0] * 2**0.5, rel=0.1)


def test_repeats_after_a_new_zero_count_what_that_zero_adds() -> None:
    """Two series per pose, each with its own zero reading: by hand, with one load and one axis."""
    d = np.zeros((4, 3))
    d[:, 0] = [1e-6, 3e-6, 8e-6, 10e-6]
    m = Measurements(
        pose=("a",) * 4,
        joint_names=("q",),
        joints=np.zeros((4, 1)),
        wrench=np.ones((4, 6)),
        displacement=d,
        zero="shared",
        zero_group=np.array([0, 0, 1, 1]),
    )
    # Within series: 2·(1e-6)² each. Series means 2 and 9 differ by 7 with variance 2·(1/2 + 1)σ².
    expected = np.sqrt((2e-12 + 2e-12 + (7e-6) ** 2 / 3) / 9)
    found = pure_error(m)
    assert found is not None
    assert found == (pytest.approx(expected), 9)


def test_without_repeats_there_is_no_pure_error() -> None:
    m = repeated(np.random.default_rng(0), "shared", times=1)
    assert pure_error(m) is None
    assert not candidates(m)[0].known


def test_masked_rows_and_other_branches_are_no_repeats() -> None:
    m = repeated(np.random.default_rng(0), "shared", poses=1, loads=1, times=2)
    assert pure_error(m) is not None
    kwargs = {name: getattr(m, name) for name in ("pose", "joint_names", "joints", "wrench")}
    for more in ({"use": np.array([True, False])}, {"branch": ("load", "unload")}):
        assert pure_error(Measurements(**kwargs, displacement=m.displacement, **more)) is None
    assert pure_error(Measurements(**kwargs, displacement=None)) is None


def test_candidates_take_sigma_from_repeats() -> None:
    m = repeated(np.random.default_rng(2), "shared")
    first = candidates(m)[0]
    assert first.known
    assert not first.stated  # known is not stated: it has degrees of freedom
    assert first.freedom == 162
    assert first.sigma == pytest.approx(SIGMA, rel=0.2)


def test_copied_rows_state_no_noise() -> None:
    """Their scatter is zero but for rounding, and no instrument reads to a nanometre."""
    displacement = np.random.default_rng(1).normal(0.0, 1e-4, (4, 3))
    m = Measurements(
        pose=("A", "A", "B", "B") * 2,
        joint_names=("q",),
        joints=np.array([[0.0], [0.0], [1.0], [1.0]] * 2),
        wrench=np.array([[k, 0, 0, 0, 0, 0] for k in (1.0, 2.0, 1.0, 2.0)] * 2),
        displacement=np.vstack([displacement, displacement]),
        zero="separate",
    )
    assert all(not noise.known and noise.sigma > 1e-6 for noise in candidates(m))
