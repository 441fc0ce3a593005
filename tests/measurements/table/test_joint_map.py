"""Linear expressions of columns, read without evaluating anything."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sk120stiff.errors import InputError
from sk120stiff.measurements import read_measurements
from sk120stiff.measurements.table.joint_map import parse_linear


@pytest.mark.parametrize(
    ("text", "terms"),
    [
        ("-(J2 + J3)", {"J2": -1.0, "J3": -1.0}),
        ("J4/101", {"J4": 1 / 101}),
        ("0.5*J1 - 2*(J2 - J1)", {"J1": 2.5, "J2": -2.0}),
        ("J1*3/2 + 90 deg", {"J1": 1.5, "": np.pi / 2}),
        ("-1*-J1", {"J1": 1.0}),
        ("1e-2*J.1", {"J.1": 0.01}),
        ("(2*3)*J1", {"J1": 6.0}),
    ],
)
def test_linear_expressions(text: str, terms: dict[str, float]) -> None:
    assert parse_linear(text, "here").terms == pytest.approx(terms)


@pytest.mark.parametrize(
    "text",
    ["J1*J2", "J1 + 90", "1/J1", "J1 J2", "(J1", "J1 +", "__import__('os')", "J1/0", "", "J1 ** 2"],
)
def test_what_is_not_linear_is_refused(text: str) -> None:
    with pytest.raises(InputError, match="no linear expression"):
        parse_linear(text, "data.yaml, key joints.a")


def test_columns_become_joints(tmp_path: Path) -> None:
    path = tmp_path / "r.csv"
    path.write_text("pose,J1[deg],J2[deg],M3[deg],dx[mm],dy[mm],dz[mm],fx[N],fy[N],fz[N]\n"
                    "A,10,20,300,0,0,1,0,0,5\n")  # fmt: skip
    path.with_suffix(".yaml").write_text("joints: {a: J1, b: -(J1 + J2), c: M3/100}\n")
    found = read_measurements(path, ("a", "b", "c"))
    assert found.joint_names == ("a", "b", "c")
    assert np.degrees(found.joints[0]) == pytest.approx([10, -30, 3])
    # Without a robot nobody knows which columns are joints of their own.
    assert set(read_measurements(path).spare) == {"J1", "J2", "M3"}
    path.with_suffix(".yaml").write_text("joints: {a: J1 + J9}\n")
    with pytest.raises(InputError, match="no column is called 'J9'"):
        read_measurements(path)
