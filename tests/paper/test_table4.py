"""Table IV against K_C by hand: true classes, and what the paper counted instead."""

import csv

import numpy as np

from sk120stiff.paper.setting import motion_grid
from tests.oracles.table2_reference import ROBOT
from tests.paper.closed_forms import K_C, SPRINGS, grid


def printed():
    with open(ROBOT / "data" / "printed" / "table4.csv", encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_grid_of_section_vi():
    assert motion_grid().shape == (32 * 13 * 14, 3)
    assert np.allclose(motion_grid(), grid(), rtol=0, atol=1e-12)


def test_counts_by_hand(found):
    table = found.table4
    assert table.configurations == 5824
    for k, row in enumerate(printed()):
        force = np.array([100.0 if sign == "+" else -100.0 for sign in row["force_signs_xyz"]])
        by_hand = K_C(grid(), force)
        values = np.linalg.eigvalsh(by_hand)
        positive, negative = (values > 0).all(axis=1).sum(), (values < 0).all(axis=1).sum()
        assert list(table.counts[k]) == [positive, 0, negative, 0, 5824 - positive - negative]
        assert table.determinant[k] == (np.prod(values, axis=1) > 0).sum()
        difference = np.linalg.eigvalsh(np.diag(SPRINGS) - by_hand)
        assert table.difference_positive[k] == (difference > 0).all(axis=1).sum() == 5824


def test_what_the_paper_counted(found):
    table = found.table4
    assert table.reproduced == (2, 4)
    assert table.reproduced_determinant == (2, 3, 4)
    assert list(table.determinant_counts[1]) == [2785, 360, 2679]
    assert list(table.determinant_counts[3]) == [3041, 706, 2077]
    assert (table.counts[1, 0], table.counts[3, 0]) == (703, 369)


def test_opposite_forces_swap_the_classes(found):
    table = found.table4
    assert table.opposites == ((1, 2), (3, 6), (4, 7), (5, 8))
    assert all(table.mirrored(table.counts).values())
    assert not any(table.mirrored(table.printed).values())
    sums = table.printed_determinant_sums
    assert sums[5, 8] == 5824
    assert [sums[pair] for pair in ((1, 2), (3, 6), (4, 7))] == [5832, 5854, 5832]
    for i, k in table.opposites:
        assert table.determinant[i - 1] + table.determinant[k - 1] == 5824
