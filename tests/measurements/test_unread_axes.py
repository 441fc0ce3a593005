"""Blank cells: axes that were not read have no part in anything, and come back blank."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sk120stiff.measurements import (
    Measurements,
    NoiseModel,
)

HEAD = "pose,q[deg],fx[N],fy[N],fz[N],{}\n"
SIGMA = 10e-6
RNG = np.random.default_rng(5)


def written(folder: Path, rows: str, columns: str, settings: str = "") -> Path:
    file = folder / "readings.csv"
    file.write_text(HEAD.format(columns) + rows, encoding="utf-8")
    file.with_suffix(".yaml").write_text(settings, encoding="utf-8")
    return file


def random_readings(zero: str, *, poses: int = 5, rows: int = 4, blank: float = 0.3):
    """Random displacements with blank cells, at least one number a row, and zeros of a kind."""
    count = poses * rows
    d = 1e-4 * RNG.normal(size=(count, 3))
    read = RNG.random((count, 3)) > blank
    read[np.arange(count), RNG.integers(0, 3, count)] = True
    return Measurements(
        pose=tuple(str(k // rows) for k in range(count)),
        joint_names=("q",),
        joints=np.repeat(np.arange(poses, dtype=float), rows)[:, None],
        wrench=RNG.normal(size=(count, 6)),
        displacement=np.where(read, d, np.nan),
        zero=zero,
        zero_count=np.full(count, 2),
    )


def dense(m: Measurements, noise: NoiseModel) -> np.ndarray:
    """Covariance (R, R) of the numbers that were read, row by row: plain loops over the law."""
    cells = [(row, axis) for row in range(m.n_readings) for axis in range(3) if m.read[row, axis]]
    V = np.zeros((len(cells), len(cells)))
    for i, (row, axis) in enumerate(cells):
        for j, (other, same) in enumerate(cells):
            shared = noise.zero == "shared" and m.zero_group[row] == m.zero_group[other]
            if axis == same and (i == j or shared):
                V[i, j] = noise.sigma**2 / m.zero_count[row]
        grown = noise.growth * np.sqrt(np.nansum(m.displacement[row] ** 2))
        V[i, i] += noise.sigma**2 + grown**2
    return V


@pytest.mark.parametrize("zero", ["shared", "separate"])
def test_whitening_is_that_of_the_numbers_that_were_read(zero: str) -> None:
    m, noise = random_readings(zero), NoiseModel(SIGMA, 0.05, zero)
    V, whitener = dense(m, noise), noise.whitener(m)
    x = RNG.normal(size=(m.n_readings, 3, 7))
    white = whitener.apply(x)
    assert white.shape == (m.read.sum(), 7)
    np.testing.assert_allclose(white.T @ white, x[m.read].T @ np.linalg.solve(V, x[m.read]))
    assert whitener.logdet == pytest.approx(np.linalg.slogdet(V)[1], rel=1e-12)
    np.testing.assert_array_equal(m.row_of_number, np.nonzero(m.read)[0])
    x[~m.read] = np.nan  # what stands there does not matter
    np.testing.assert_array_equal(whitener.apply(x), white)


def test_weights_and_uncertainties_of_rows_go_with_blanks() -> None:
    m = random_readings("shared")
    weights = RNG.uniform(0.2, 1.0, m.n_readings)
    x = RNG.normal(size=(m.n_readings, 3))

    def squares(white: np.ndarray) -> float:
        return float(white @ white)

    V = dense(m, NoiseModel(SIGMA))
    weighted = V + np.diag(((1.0 / weights - 1.0) * SIGMA**2)[m.row_of_number])
    found = NoiseModel(SIGMA).whitener(m, weights=weights).apply(x)
    assert squares(found) == pytest.approx(x[m.read] @ np.linalg.solve(weighted, x[m.read]))
    stated = replace(m, sigma=np.where(m.read, 3.0 * SIGMA, np.nan))
    found = NoiseModel(SIGMA).whitener(stated).apply(x)
    assert squares(found) == pytest.approx(x[m.read] @ np.linalg.solve(9.0 * V, x[m.read]))
