"""A smaller run of scripts/08_coverage.py: intervals hold the truth of independent data."""

from pathlib import Path

from scipy import stats

from tests.identify.coverage import KINDS, experiments, table_of


def test_intervals_hold_the_truth_of_data_from_another_hand(tmp_path: Path) -> None:
    outcomes = [o for found in experiments(100, 11, tmp_path) for o in found]
    table = {group: rest for group, *rest in table_of(outcomes)}
    assert len(table) == 1 + len(KINDS)
    for group, (number, interval, linear, miss) in table.items():
        for share in (interval, linear):
            inside = round(share * number)
            assert stats.binomtest(inside, number, 0.95).pvalue > 1e-3, (group, share)
        assert 0.7 < miss < 1.3, group
    number, interval, *_ = table["springs"]
    assert number == 300
    assert 0.92 <= interval <= 0.98
