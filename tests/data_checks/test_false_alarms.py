"""Sound readings are not doubted: other arms, missing effects, foreign causes, messy noise.

The long table is scripts/11_data_checks.py.
"""

import pytest

from tests.data_checks.table import blind_readings, sound_readings


def test_drawn_readings_of_other_arms_are_not_doubted() -> None:
    outcomes = list(sound_readings(range(3), ["ur10", "panda", "z1"]))
    assert len(outcomes) == 9
    assert [each for each in outcomes if not each.right] == []


@pytest.mark.parametrize("level", ["L1", "L6", "L7", "L8"])
def test_blind_cases_are_not_doubted(level: str) -> None:
    """Another generator: effects stronger than noise, foreign ones, several at once, outliers."""
    (only,) = blind_readings([level], 1, 4711)
    assert only.said == ""
