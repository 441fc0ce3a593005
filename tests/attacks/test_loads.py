"""A share of the large sizes, each in a process of its own."""

from pathlib import Path

import pytest

from tests.attacks.loads import SIZES, measured

SHARE = {"readings": (10_000, 12.0), "path points": (5_000, 12.0), "joints": (8, 40.0)}


@pytest.mark.parametrize("what", SIZES)
def test_cost_is_linear_and_memory_bounded(what: str, tmp_path: Path) -> None:
    made, whole = SIZES[what]
    count, seconds = SHARE[what]
    assert count < whole
    found = measured(what, made(tmp_path, count), tmp_path, memory=0.5e9)
    assert not found.loss
    assert found.seconds < seconds
