"""Table III: an identity that proves nothing, a balance that does, a unit and a repeated row."""

import csv

import numpy as np
import pytest

from tests.oracles.table2_reference import ROBOT, SPRINGS, columns, jacobian


def printed():
    with open(ROBOT / "data" / "printed" / "table3.csv", encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_enhanced_works_agree_for_any_displacement(found):
    table = found.table3
    assert table.identity_error < 1e-12
    assert np.max(np.abs(table.works.joint_conventional / table.works.cartesian - 1)) > 1e-5


def test_eq_14_by_hand(found):
    """N·mm and mm: F.d + d.K.d / 2 is three halves of F.d for d = C F."""
    names = ["joint_1_s[deg]", "joint_2_l[deg]", "joint_3_u[deg]"]
    for k, row in enumerate(printed()):
        J = jacobian(np.radians(columns(row, names)))
        force = columns(row, ["fx[N]", "fy[N]", "fz[N]"])
        by_hand = 1.5 * force @ J @ (J.T @ force / SPRINGS)
        assert 1e3 * found.table3.works.cartesian[k] == pytest.approx(by_hand, rel=2e-3)


def test_true_balance_along_the_path(found):
    assert found.table3.balance_error < 1e-9
    assert np.allclose(found.table3.overcount, 3.0, atol=0.002)


def test_printed_works_are_newton_millimetres(found):
    table = found.table3
    theirs = np.array([float(row["work_cartesian[as printed]"]) for row in printed()])
    assert np.allclose(table.printed_cartesian, theirs / 1e3)
    typical = np.exp(np.mean(np.log(table.ratio)))
    assert 0.3 < typical < 10  # as joule it would be a thousand times that
    assert 5 < (table.printed_cartesian > table.largest).sum() < 20


def test_no_force_of_that_size_does_more(found):
    """`largest` is reached by the softest direction and by no other."""
    assert (found.table3.works.cartesian <= found.table3.largest * 1.001).all()


def test_repeated_row(found):
    table = found.table3
    assert table.repeated == ((12, 13),)
    assert [table.printed.pose[k] for k in (12, 13)] == ["3", "3"]
    usual = table.work_per_force_squared[[10, 11, 13, 14]]
    assert table.work_per_force_squared[12] < 0.7 * usual.min()
    assert np.ptp(usual) < 0.06 * usual.mean()


def test_differences_have_the_printed_sign(found):
    table = found.table3
    theirs = table.printed_conventional - table.printed_cartesian
    ours = table.works.joint_conventional - table.works.cartesian
    assert np.array_equal(np.sign(theirs), np.sign(ours))
