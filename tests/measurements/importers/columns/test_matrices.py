"""Poses as the numbers of a matrix, from 0 or 1, row by row or column by column."""

from itertools import product
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sk120stiff.measurements.importers.columns.matrices import with_matrices
from tests.measurements.importers.reading import sheet_of

TWO = ("joint_1", "joint_2")


def poses() -> np.ndarray:
    out = np.tile(np.eye(4), (3, 1, 1))
    out[:, :3, :3] = Rotation.from_rotvec([[0.1, 0.2, 0.3], [1, -1, 0], [0, 0, 2]]).as_matrix()
    out[:, :3, 3] = [[1, 2, 3], [4, 5, 6], [7, 8, 9]]
    return out


def text(form: str, first: int, matrices: np.ndarray, rows: int = 4) -> str:
    places = list(product(range(rows), range(4)))
    head = [form.format(i + first, j + first) for i, j in places]
    lines = [[k, k + 1, *(repr(float(T[i, j])) for i, j in places)] for k, T in enumerate(matrices)]
    return "\n".join(";".join(map(str, line)) for line in (["q1", "q2", *head], *lines))


@pytest.mark.parametrize(
    ("form", "first", "rows"),
    [("T{}{}", 0, 4), ("T{}{}", 1, 4), ("m{}{}", 0, 3), ("pose_{}_{}", 1, 3), ("T[{}][{}]", 0, 4)],
)
def test_position_and_rotation_of_a_matrix(
    tmp_path: Path, form: str, first: int, rows: int
) -> None:
    sheet = sheet_of(tmp_path, text(form, first, poses(), rows), TWO)
    assert [sheet.get(axis).cells[1] for axis in "xyz"] == ["4.0", "5.0", "6.0"]  # type: ignore[union-attr]
    column = sheet.get("orientation r21")
    assert column is not None and column.header == form.format(1 + first, first)
    assert any("row by row" in note for note in sheet.notes)


def test_a_matrix_column_by_column(tmp_path: Path) -> None:
    sheet = sheet_of(tmp_path, text("T{}{}", 0, np.swapaxes(poses(), 1, 2)), TWO)
    assert [sheet.get(axis).cells[1] for axis in "xyz"] == ["4.0", "5.0", "6.0"]  # type: ignore[union-attr]
    column = sheet.get("orientation r21")
    assert column is not None and column.header == "T01"
    assert any("column by column" in note for note in sheet.notes)


def test_what_is_no_rotation_is_no_pose() -> None:
    names = [f"C{i}{j}" for i, j in product(range(4), range(4))]
    rows = [[str(k * 1.5) for k in range(16)]]
    assert with_matrices(names, [None] * 16, rows) == ([None] * 16, [])


def test_positions_beside_it_count() -> None:
    names = ["x", *(f"T{i}{j}" for i, j in product(range(4), range(4)))]
    rows = [["1", *(str(v) for v in np.eye(4).ravel())]]
    assert with_matrices(names, [("x", 1.0), *[None] * 16], rows)[1] == []
