"""Labels of others in CSV files: no spreadsheet takes them for formulas, and they come back."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sk120stiff.files import guarded_cell, plain_cell
from sk120stiff.measurements import read_measurements, write_measurements
from sk120stiff.measurements.poses import rows_by_label

DATA = Path(__file__).resolve().parents[3] / "robots/motoman_sk120/data/table2_measured.csv"
LABELS = ("=1+1", "+cmd|' /C calc'!A0", "-2+3", "@SUM(A1)", "'=1", "''=1", "'", "'a", "a=1", "p 1",
          "-1.5", "1e3", "−3", "=", "-", "'-1")  # fmt: skip


@pytest.mark.parametrize("label", LABELS)
def test_a_label_comes_back(label: str) -> None:
    assert plain_cell(guarded_cell(label)) == label


def test_files_hold_no_formula(tmp_path: Path) -> None:
    data = read_measurements(DATA)
    labels = tuple(LABELS[k % len(LABELS)] for k in data.pose_index)
    extra = {"remark": tuple(LABELS[k % len(LABELS)] for k in range(data.n_readings))}
    write_measurements(replace(data, pose=labels, extra=extra), tmp_path / "m.csv")
    for line in (tmp_path / "m.csv").read_text().splitlines():
        for cell in (line.split(",")[0].strip('"'), line.split(",")[-1].strip('"')):
            assert not cell.startswith(("=", "+", "@")) and cell not in ("-2+3", "-")
    again = read_measurements(tmp_path / "m.csv")
    assert again.pose == labels and again.extra == extra
    assert np.array_equal(again.displacement, data.displacement)


def test_rows_of_every_label_in_one_sort() -> None:
    labels = np.array([3, 1, 3, 0, 1, 3])
    assert [rows.tolist() for rows in rows_by_label(labels)] == [[3], [1, 4], [0, 2, 5]]
    assert rows_by_label(np.zeros(0, dtype=int)) == []
