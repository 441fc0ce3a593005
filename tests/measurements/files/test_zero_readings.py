"""Positions minus their zero readings, by hand."""

from pathlib import Path

import numpy as np
import pytest

from sk120stiff.errors import InputError
from sk120stiff.measurements import read_measurements

HEAD = "pose,q1[deg],fx[N],fy[N],fz[N],x[mm],y[mm],z[mm]"


def read(folder: Path, text: str, yaml: str = ""):
    path = folder / "data.csv"
    path.write_text(text)
    path.with_suffix(".yaml").write_text(yaml)
    return read_measurements(path)


def test_a_pose_shares_the_mean_of_its_zero_rows(tmp_path: Path) -> None:
    m = read(
        tmp_path,
        f"""{HEAD},order,time[s]
A,0,0,0,0,1000,500,0,1,10
A,0,5,0,0,1003,500,1,2,20
B,9,0,5,0,7,7,7,3,30
A,0,9,0,0,1004,500,2,4,40
B,9,0,0,0,5,7,8,5,50
A,0,0,0,0,1002,500,0,6,60
""",
    )
    np.testing.assert_allclose(m.displacement, [[2e-3, 0, 1e-3], [2e-3, 0, -1e-3], [3e-3, 0, 2e-3]])
    assert m.pose == ("A", "B", "A")
    assert m.zero == "shared"
    np.testing.assert_array_equal(m.zero_group, [0, 1, 0])
    np.testing.assert_array_equal(m.zero_count, [2, 1, 2])
    np.testing.assert_allclose(m.zero_order, [3.5, 5, 3.5])
    np.testing.assert_allclose(m.zero_time, [35, 50, 35])
    np.testing.assert_allclose(m.time_since_zero, [20 - 35, 30 - 50, 40 - 35])
    np.testing.assert_array_equal(m.line, [3, 4, 5])
    assert "3 rows without load" in m.notes[-1]
    assert "1 to 2" in m.notes[-1]


RUNS = f"""{HEAD},order
A,0,1,0,0,11,0,0,2
A,0,0,0,0,10,0,0,1
A,0,2,0,0,12,0,0,3
A,0,0,0,0,20,0,0,4
A,0,0,0,0,22,0,0,5
A,0,3,0,0,23,0,0,6
A,0,0,0,0,99,0,0,7
"""


def test_a_zero_reading_that_was_written_down_again_counts_once(tmp_path: Path) -> None:
    """Sheets have the unloaded position beside every load: that is no mean of three."""
    rows = """
A,0,0,0,0,1000.25,500.5,0.125
A,0,5,0,0,1003,500,1
A,0,0,0,0,1000.25,500.5,0.125
A,0,9,0,0,1004,500,2
A,0,0,0,0,1000.75,500.5,0.125
"""
    m = read(tmp_path, HEAD + rows)
    np.testing.assert_array_equal(m.zero_count, [2, 2])
    np.testing.assert_allclose(m.displacement[:, 0], [2.5e-3, 3.5e-3])
    assert any("written down again counts once" in note for note in m.notes)
    ordered = [f"{row},{k}" for k, row in enumerate(rows.split())]
    m = read(tmp_path, "\n".join([f"{HEAD},order", *ordered]))  # three readings, and it says so
    np.testing.assert_array_equal(m.zero_count, [3, 3])


def test_separate_zeros_are_those_taken_last_before(tmp_path: Path) -> None:
    m = read(tmp_path, RUNS, "displacement: {zero: separate}")
    np.testing.assert_allclose(m.displacement[:, 0], [1e-3, 2e-3, 2e-3])
    np.testing.assert_array_equal(m.zero_group, [0, 0, 1])
    np.testing.assert_array_equal(m.zero_count, [1, 1, 2])
    np.testing.assert_allclose(m.zero_order, [1, 1, 4.5])


def test_masked_zero_rows_do_not_count(tmp_path: Path) -> None:
    rows = RUNS.strip().split("\n")
    masked = [rows[0] + ",use"] + [
        r + (",0" if r.endswith((",4", ",7")) else ",1") for r in rows[1:]
    ]
    m = read(tmp_path, "\n".join(masked), "displacement: {zero: separate}")
    np.testing.assert_allclose(m.displacement[:, 0], [1e-3, 2e-3, 1e-3])
    shared = read(tmp_path, "\n".join(masked))
    np.testing.assert_allclose(shared.displacement[:, 0], [-5e-3, -4e-3, 7e-3])
    np.testing.assert_array_equal(shared.zero_count, [2, 2, 2])


def test_a_pose_masked_as_a_whole_still_shows_its_displacement(tmp_path: Path) -> None:
    m = read(
        tmp_path,
        f"{HEAD},use\nA,0,0,0,0,1,0,0,0\nA,0,1,0,0,2,0,0,0\nB,0,0,0,0,1,0,0,1\nB,0,1,0,0,4,0,0,1\n",
    )
    np.testing.assert_allclose(m.displacement[:, 0], [1e-3, 3e-3])
    np.testing.assert_array_equal(m.use, [False, True])


def test_groups_may_be_given(tmp_path: Path) -> None:
    text = f"{HEAD},zero_group\nA,0,0,0,0,1,0,0,7\nA,0,0,0,0,5,0,0,9\nA,0,1,0,0,6,0,0,7\n"
    m = read(tmp_path, text + "A,0,1,0,0,6,0,0,9\n")
    np.testing.assert_allclose(m.displacement[:, 0], [5e-3, 1e-3])
    assert len(set(m.zero_group)) == 2
    with pytest.raises(InputError) as caught:
        read(tmp_path, text + "B,0,1,0,0,6,0,0,9\n")
    assert "line 5, column zero_group" in str(caught.value)
    assert "'A' and 'B'" in str(caught.value)


def test_a_pose_with_zero_rows_only_is_noted(tmp_path: Path) -> None:
    m = read(tmp_path, f"{HEAD}\nA,0,0,0,0,1,0,0\nA,0,1,0,0,2,0,0\nB,0,0,0,0,1,0,0\n")
    assert m.n_readings == 1
    assert any("pose B" in note for note in m.notes)


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        (f"{HEAD}\nA,0,0,0,0,1,0,0\nA,0,1,0,0,2,0,0\nB,0,1,0,0,1,0,0\n",
         ["line 4", "column x[mm]", "'B'", "fx = fy = fz = 0", "dx dy dz"]),
        (f"{HEAD},use\nA,0,0,0,0,1,0,0,0\nA,0,1,0,0,2,0,0,1\n", ["line 3", "'A'"]),
        (f"{HEAD},use\nA,0,0,0,0,1,0,0,1\nA,0,1,0,0,2,0,0,0\n", ["every loaded row is masked"]),
        (f"{HEAD}\nA,0,0,0,0,1,0,0\nA,1,1,0,0,2,0,0\n",
         ["line 3", "q1", "1 deg", "0 deg in line 2"]),
        (f"{HEAD},zero_count\nA,0,0,0,0,1,0,0,1\nA,0,1,0,0,2,0,0,1\n",
         ["column zero_count", "not to positions"]),
    ],
)  # fmt: skip
def test_what_cannot_be_subtracted(tmp_path: Path, text: str, parts: list[str]) -> None:
    with pytest.raises(InputError) as caught:
        read(tmp_path, text)
    for part in parts:
        assert part in str(caught.value)


DISPLACED = "pose,q1[deg],fx[N],fy[N],fz[N],dx[mm],dy[mm],dz[mm],order"


@pytest.mark.parametrize(
    ("zero", "since"), [("shared", [-1, 2, 2]), ("unknown", [-1, 2, 2]), ("separate", [2, 2, 2])]
)
def test_order_since_zero_of_displacements(tmp_path: Path, zero: str, since: list[int]) -> None:
    """Rows without load tell when the zero was; else it was one interval (3, 1: 2) before."""
    text = f"{DISPLACED}\nA,0,1,0,0,1,0,0,3\nA,0,2,0,0,1,0,0,6\nB,0,1,0,0,1,0,0,7\n"
    m = read(tmp_path, text + "A,0,0,0,0,0,0,0,4\n", f"displacement: {{zero: {zero}}}").masked()
    np.testing.assert_allclose(m.order_since_zero, since)
    if zero != "separate":
        np.testing.assert_array_equal(m.zero_order, [4, 4, np.nan])
