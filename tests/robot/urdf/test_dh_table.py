"""A table of Denavit and Hartenberg's numbers is an arm like any other."""

from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.errors import InputError

Q = np.pi / 2

# Universal Robots, "DH parameters for calculations of kinematics and dynamics", UR5e.
UR5E = """convention,theta[deg],d[mm],a[mm],alpha[deg]
standard,0,162.5,0,90
standard,0,0,-425,0
standard,0,0,-392.2,0
standard,0,133.3,0,90
standard,0,99.7,0,-90
standard,0,99.6,0,0
"""
# A slide between two turning joints, the last one the other way round, with limits and a tool.
SLIDING = """convention,joint,moves,theta[rad],d[m],a[m],alpha[rad],factor,lower[mm],upper[mm]
{convention},turn,theta,0.3,0.5,0.2,-1.1,,,
{convention},lift,d,-0.7,0.1,0.3,0.9,,-200,900
{convention},wrist,theta,0.2,-0.4,0.1,0.4,-1,,
{convention},tool,,0.6,0.2,0.05,-0.3,,,
"""


def load(tmp_path: Path, text: str) -> sk.Robot:
    """The robot of a table."""
    path = tmp_path / "arm.csv"
    path.write_text(text, encoding="utf-8")
    return sk.load_robot(path)


def turn(axis: str, angle: float) -> np.ndarray:
    """(4, 4) about x or z."""
    c, s = np.cos(angle), np.sin(angle)
    T = np.eye(4)
    i, j = {"x": (1, 2), "z": (0, 1)}[axis]
    T[[i, i, j, j], [i, j, i, j]] = c, -s, s, c
    return T


def shift(axis: str, by: float) -> np.ndarray:
    """(4, 4) along x or z."""
    T = np.eye(4)
    T["xyz".index(axis), 3] = by
    return T


def test_the_makers_table_is_the_makers_urdf(tmp_path):
    table, urdf = load(tmp_path, UR5E), sk.load_robot("ur5e")
    assert table.actuated == tuple(f"joint_{k}" for k in range(1, 7))
    assert (table.base_frame, table.tool_frame) == ("base_link", "tool0")
    for q in np.random.default_rng(3).uniform(-3.0, 3.0, (20, 6)):
        np.testing.assert_allclose(table.placement(q), urdf.placement(q), atol=1e-12)


@pytest.mark.parametrize("convention", ["standard", "modified"])
def test_both_conventions_are_the_products_that_they_name(tmp_path, convention):
    arm = load(tmp_path, SLIDING.format(convention=convention))
    assert arm.actuated == ("turn", "lift", "wrist")
    assert arm.prismatic == (False, True, False)
    assert (arm.lower[1], arm.upper[1]) == (-0.2, 0.9)
    rows = [(0.3, 0.5, 0.2, -1.1), (-0.7, 0.1, 0.3, 0.9), (0.2, -0.4, 0.1, 0.4)]
    for q in np.random.default_rng(4).uniform(-0.2, 0.9, (10, 3)):
        T = np.eye(4)
        moved = [(q[0], 0.0), (0.0, q[1]), (-q[2], 0.0), (0.0, 0.0)]
        for (theta, d, a, alpha), (by, along) in zip(
            [*rows, (0.6, 0.2, 0.05, -0.3)], moved, strict=True
        ):
            screw = turn("z", theta + by) @ shift("z", d + along)
            ahead = shift("x", a) @ turn("x", alpha)
            T = T @ (screw @ ahead if convention == "standard" else ahead @ screw)
        np.testing.assert_allclose(arm.placement(q), T, atol=1e-14)


@pytest.mark.parametrize(
    ("was", "becomes", "told"),
    [
        ("convention,", "kind,", "line 1: .* lacks convention"),
        ("a[mm]", "a[mm],a[m]", "line 1: .* double columns"),
        ("alpha[deg]", "alpha[deg],mass[kg]", r"line 1: .* \['mass'\]"),
        ("alpha[deg]", "alpha[mm]", "line 2, column alpha: the unit 'mm'"),
        ("d[mm]", "d", "line 2, column d: the unit is missing"),
        ("standard,0,0,-392", "craig,0,0,-392", "line 4: the convention 'craig'"),
        ("-392.2", "q3 - 90", "line 4: 'q3 - 90' in column a is no number"),
        ("standard,0,133.3,0,90", "standard,,133.3,0,90", "line 5: '' in column theta"),
        (UR5E[UR5E.index("\n") + 1 :], "", "no row of this table moves"),
    ],
)
def test_what_is_wrong_is_told_with_its_place(tmp_path, was, becomes, told):
    assert was in UR5E
    with pytest.raises(InputError, match=rf"(?s)arm\.csv.*{told}"):
        load(tmp_path, UR5E.replace(was, becomes, 1))


@pytest.mark.parametrize(
    ("was", "becomes", "told"),
    [
        ("-200,900", ",", "line 3: this joint slides, and nobody says how far"),
        ("0.4,-1,,", "0.4,2,,", "line 4: .* its factor is 2"),
        ("wrist,theta", "turn,theta", "two rows are named 'turn'"),
        ("lift,d", "lift,a", "line 3: moves is 'a'"),
        ("-200,900", "-200,", "line 3: lower is stated without the other limit"),
    ],
)
def test_joints_that_cannot_be_are_refused(tmp_path, was, becomes, told):
    table = SLIDING.format(convention="standard")
    assert was in table
    with pytest.raises(InputError, match=rf"(?s)arm\.csv.*{told}"):
        load(tmp_path, table.replace(was, becomes, 1))


def test_comments_and_blank_lines_are_passed_over_and_counted(tmp_path):
    noted = "# of the maker's data sheet\n\n" + UR5E.replace(
        "standard,0,0,-392", "# upper arm\n,,\nstandard,0,0,-392"
    )
    plain, table = load(tmp_path, UR5E), load(tmp_path, noted)
    q = np.linspace(-1.0, 1.0, 6)
    np.testing.assert_array_equal(table.placement(q), plain.placement(q))
    with pytest.raises(InputError, match="line 8: 'x' in column a"):
        load(tmp_path, noted.replace("-392.2", "x"))


def test_a_driver_that_is_no_joint_is_refused(tmp_path):
    table = UR5E.replace("alpha[deg]\n", "alpha[deg],driver\n").replace(
        "-392.2,0\n", "-392.2,0,crank\n"
    )
    with pytest.raises(InputError, match="line 4: the driver 'crank' is no joint"):
        load(tmp_path, table)
