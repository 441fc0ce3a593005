"""Headers that say nothing of units, and joints of which some are radians, some degrees."""

from pathlib import Path

import numpy as np
import pytest

from sk120stiff import load_robot
from sk120stiff.measurements.importers import Told
from sk120stiff.measurements.importers.run import Imported, import_readings
from tests.measurements.importers.tracked import ur5


def displaced(folder: Path, radians: list[int], angle: str = "deg", unit: str = "") -> Imported:
    """Displacements of a UR5 whose joints are degrees, apart from these columns."""
    rng = np.random.default_rng(4)
    q = rng.uniform(-100.0, 100.0, (12, 6))
    q[:, radians] = np.radians(q[:, radians])
    names = [f"q{k}{unit}" for k in range(1, 7)]
    lines = [",".join([*names, "fx", "fy", "fz", "dx", "dy", "dz"])]
    lines += [",".join(f"{v:.4f}" for v in (*row, 10, 20, -90, 1, 2, 3)) for row in q]
    path = folder / "seen.csv"
    path.write_text("\n".join(lines) + "\n")
    told = Told(length="mm", angle=None if unit else angle, load="N")
    return import_readings(path, load_robot(ur5(), tool="tool0"), told)


def test_columns_in_another_unit_are_pointed_out(tmp_path: Path) -> None:
    (doubt,) = displaced(tmp_path, [3, 4, 5]).doubts
    assert doubt.startswith("q4, q5 and q6 stay within ±1.65 deg") and "look like radians" in doubt
    assert "leave --angle out" in doubt
    (doubt,) = displaced(tmp_path, [4], unit="[deg]").doubts
    assert doubt.startswith("q5 stays within") and "write q5[rad] in the header" in doubt


@pytest.mark.filterwarnings("ignore:.*largest joint angle")
def test_degrees_among_radians_are_too(tmp_path: Path) -> None:
    (doubt,) = displaced(tmp_path, [2, 3, 4, 5], angle="rad").doubts
    assert doubt.startswith("q1 and q2 go to") and "look like degrees" in doubt


def test_one_unit_is_not_doubted(tmp_path: Path) -> None:
    assert displaced(tmp_path, []).doubts == ()


def test_rows_below_merged_cells_that_were_saved_as_text(tmp_path: Path) -> None:
    lines = ["pose;q1;q2;q3;q4;q5;q6;Fz;dx;dy;dz"]
    for k in range(4):
        lines += [f"{k};{10 * k};20;30;40;50;60;-90;1;2;3", ";;;;;;;-50;0.5;1;1.5"]
    path = tmp_path / "seen.csv"
    path.write_text("\n".join(lines))
    told = Told(length="mm", angle="deg", load="N")
    (doubt,) = import_readings(path, load_robot(ur5(), tool="tool0"), told).doubts
    assert doubt.startswith("4 rows are left out") and "workbook" in doubt
