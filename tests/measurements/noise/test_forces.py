"""Errors of forces as noise: against a dense covariance, in files, and where they mean nothing."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.errors import InputError
from sk120stiff.measurements import Measurements, NoiseModel, NoiseStatement

RNG = np.random.default_rng(8)
SHARE, SIGMA = 0.02, 10e-6


def readings(*, lost: bool = False) -> Measurements:
    pose = tuple(str(k // 4) for k in range(22))  # the last pose has two readings
    displacement = RNG.normal(size=(22, 3)) * 5e-4
    if lost:
        displacement[[3, 7, 20], [0, 2, 1]] = np.nan
    return Measurements(
        pose=pose,
        joint_names=("q",),
        joints=np.array([[float(p)] for p in pose]),
        wrench=RNG.normal(size=(22, 6)),
        displacement=displacement,
        zero="shared",
        by_force=RNG.normal(size=(22, 3, 3)) * 1e-3,
    )


def dense(m: Measurements, growth: float) -> np.ndarray:
    """(3N, 3N), reading by reading and axis by axis, as the law is written."""
    assert m.by_force is not None
    size = np.linalg.norm(m.moved, axis=1)
    V = np.zeros((66, 66))
    for i in range(22):
        B = m.by_force[i]
        own = (SIGMA**2 + (growth * size[i]) ** 2) * np.eye(3) + SHARE**2 * B @ B.T
        for j in range(22):
            shared = SIGMA**2 * np.eye(3) if m.pose[i] == m.pose[j] else np.zeros((3, 3))
            V[3 * i : 3 * i + 3, 3 * j : 3 * j + 3] = shared + (own if i == j else 0.0)
    read = m.read.ravel()
    return V[np.ix_(read, read)]


@pytest.mark.parametrize("lost", [False, True])
@pytest.mark.parametrize("growth", [0.0, 0.01])
def test_whitening_is_that_of_the_dense_covariance(growth: float, lost: bool) -> None:
    m = readings(lost=lost)
    V = dense(m, growth)
    whitener = NoiseModel(SIGMA, growth, "shared", force=SHARE).whitener(m)
    x = RNG.normal(size=(22, 3, 5))
    white, plain = whitener.apply(x), x[m.read]
    np.testing.assert_allclose(white.T @ white, plain.T @ np.linalg.solve(V, plain), rtol=1e-9)
    assert whitener.logdet == pytest.approx(np.linalg.slogdet(V)[1], rel=1e-12)
    assert np.bincount(whitener.reading).tolist() == m.read.sum(axis=1).tolist()


def test_a_reading_that_counts_for_less_has_as_much_more_of_it() -> None:
    m = readings()
    noise = NoiseModel(SIGMA, zero="separate", force=SHARE)
    half = noise.whitener(m, weights=np.full(22, 0.5)).apply(m.moved)
    assert m.by_force is not None
    each = [2.0 * SIGMA**2 * np.eye(3) + SHARE**2 * B @ B.T for B in m.by_force]  # own zeros
    squares = [d @ np.linalg.solve(2.0 * V, d) for d, V in zip(m.moved, each, strict=True)]
    assert half @ half == pytest.approx(sum(squares), rel=1e-9)


def test_variances_of_the_axes_hold_it() -> None:
    m = readings()
    own, zero = NoiseModel(SIGMA, zero="shared", force=SHARE).variances(m)
    np.testing.assert_allclose(own + zero, np.diag(dense(m, 0.0)).reshape(22, 3), rtol=1e-12)


def test_it_takes_a_model_of_the_arm() -> None:
    bare = replace(readings(), by_force=None)
    with pytest.raises(InputError, match="only with a model of the arm"):
        NoiseModel(SIGMA, force=SHARE).whitener(bare)


@pytest.mark.parametrize("share", [-0.01, 1.0, np.nan])
def test_a_share_that_is_none_is_refused(share: float) -> None:
    with pytest.raises(InputError, match="error of forces"):
        NoiseModel(SIGMA, force=share)
    with pytest.raises(InputError, match="error of forces"):
        NoiseStatement(SIGMA, force=share)


def test_a_file_says_it_and_is_written_with_it(tmp_path: Path) -> None:
    source = sk.bundled_robots()["motoman_sk120"] / "data" / "table2_measured.csv"
    said = replace(sk.read(source), noise=NoiseStatement(SIGMA, force=SHARE))
    sk.write_measurements(said, tmp_path / "pulls.csv")
    assert "force: 0.02" in (tmp_path / "pulls.yaml").read_text()
    assert sk.read(tmp_path / "pulls.csv").noise == NoiseStatement(SIGMA, force=SHARE)


def test_it_stands_beside_the_noise_of_a_reading(tmp_path: Path) -> None:
    source = sk.bundled_robots()["motoman_sk120"] / "data" / "table2_measured.csv"
    bare = replace(sk.read(source), noise=NoiseStatement(force=SHARE))
    sk.write_measurements(bare, tmp_path / "pulls.csv")
    with pytest.raises(InputError, match=r"noise\.force.*what one reading is worth is not"):
        sk.read(tmp_path / "pulls.csv")


def test_what_cannot_be_whitened_is_refused() -> None:
    with pytest.raises(InputError, match="cannot be whitened"):
        NoiseModel(SIGMA, force=SHARE).whitener(readings()).apply(np.zeros((3, 22)))


def test_positions_have_none(tmp_path: Path) -> None:
    (tmp_path / "p.csv").write_text(
        "pose,shoulder_pan_joint[deg],x[mm],y[mm],z[mm]\nA,0,1,2,3\nB,10,2,3,4\n"
    )
    (tmp_path / "p.yaml").write_text(
        "position: {frame: base}\nnoise: {sigma: 10, unit: um, force: 0.02}\n"
    )
    with pytest.raises(InputError, match="other readings are here"):
        sk.read(tmp_path / "p.csv")
