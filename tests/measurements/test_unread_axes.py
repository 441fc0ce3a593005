"""Blank cells: axes that were not read have no part in anything, and come back blank."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sk120stiff.errors import InputError
from sk120stiff.measurements import (
    Measurements,
    NoiseModel,
    read_measurements,
    write_measurements,
)
from sk120stiff.measurements.noise.repeats import repeated

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
    with pytest.raises(InputError, match=r"uncertainty s[xyz] is blank"):
        replace(m, sigma=np.full(x.shape, np.nan))


def test_repeats_count_the_axes_that_were_read_twice() -> None:
    """Pure error of a one-way layout, axis by axis, with zero readings of their own."""
    m = random_readings("separate", poses=40, rows=3, blank=0.4)
    m = replace(m, wrench=np.ones((m.n_readings, 6)))
    squares, freedom = 0.0, 0
    for pose in range(40):
        for axis in range(3):
            values = m.displacement[3 * pose : 3 * pose + 3, axis]
            values = values[np.isfinite(values)]
            if len(values):
                squares += ((values - values.mean()) ** 2).sum()
                freedom += len(values) - 1
    found = repeated(m, grows=False)
    assert found.freedom == freedom
    assert found.sigma == pytest.approx(np.sqrt(squares / freedom / 1.5), rel=1e-12)
    once = np.eye(3, dtype=bool)[np.arange(m.n_readings) % 3]
    lone = replace(m, displacement=np.where(once, 1e-4, np.nan))
    assert repeated(lone) is None  # three rows of a cell, each of another axis


def test_a_file_comes_back_with_its_blanks(tmp_path: Path) -> None:
    rows = "a,1,10,0,0,,0.2,\na,1,20,0,0,0.1,,0.3\nb,2,10,0,0,,,-0.1\n"
    m = read_measurements(written(tmp_path, rows, "dx[mm],dy[mm],dz[mm]"))
    expected = [[False, True, False], [True, False, True], [False, False, True]]
    np.testing.assert_array_equal(m.read, expected)
    np.testing.assert_array_equal(m.moved[2], [0.0, 0.0, -1e-4])
    again = read_measurements(write_measurements(m, tmp_path / "again.csv"))
    np.testing.assert_array_equal(again.displacement, m.displacement)
    frame = m.to_frame()
    assert frame["dx[mm]"].isna().tolist() == [True, False, True]
    np.testing.assert_array_equal(Measurements.from_frame(frame).displacement, m.displacement)
    np.testing.assert_array_equal((m + m).read, np.vstack([expected, expected]))


def test_positions_subtract_the_zero_reading_axis_by_axis(tmp_path: Path) -> None:
    rows = (
        "a,1,0,0,0,1,2,3\na,1,0,0,0,1.1,,3.2\n"  # the second zero reading lacks an axis
        "a,1,10,0,0,1.5,,3.5\nb,2,0,0,0,4,,6\nb,2,10,0,0,4.5,5.5,6.5\n"
    )
    m = read_measurements(written(tmp_path, rows, "x[mm],y[mm],z[mm]"))
    assert m.absolute is None
    expected = [[0.5e-3, np.nan, 0.5e-3], [0.5e-3, np.nan, 0.5e-3]]
    np.testing.assert_allclose(m.displacement, expected, atol=1e-15)
    assert m.zero_count.tolist() == [1, 1]
    assert "1 rows without load lack an axis that others of their pose have" in " ".join(m.notes)


@pytest.mark.parametrize(
    ("rows", "columns", "line"),
    [
        ("a,1,10,0,0,,0.2,\na,1,20,0,0,,,\n", "dx[mm],dy[mm],dz[mm]", 3),
        ("a,1,0,0,0,1,,\na,1,10,0,0,,2,3\n", "x[mm],y[mm],z[mm]", 3),
    ],
)
def test_a_row_without_any_axis_is_refused(
    tmp_path: Path, rows: str, columns: str, line: int
) -> None:
    file = written(tmp_path, rows, columns)
    with pytest.raises(InputError) as caught:
        read_measurements(file)
    message = str(caught.value)
    assert f"readings.csv, line {line}" in message
    assert "no axis of this displacement was read" in message
    assert "column use" in message


def test_a_masked_row_may_be_blank(tmp_path: Path) -> None:
    rows = "a,1,10,0,0,,0.2,,1\na,1,20,0,0,,,,0\n"
    m = read_measurements(written(tmp_path, rows, "dx[mm],dy[mm],dz[mm],use"))
    assert m.use.tolist() == [True, False]
    assert m.masked().n_readings == 1


def test_single_readings_beside_displacements_are_refused(tmp_path: Path) -> None:
    rows = "a,1,10,0,0,,0.2,,0.1,0,0,1\n"
    columns = "dx[mm],dy[mm],dz[mm],d[mm],ux,uy,uz"
    with pytest.raises(InputError, match="stand in one file"):
        read_measurements(written(tmp_path, rows, columns))
