"""A share of the large sizes, each in a process of its own."""

from pathlib import Path

import pytest

from tests.attacks.loads import SIZES, measured

SHARE = {"readings": 10_000, "path points": 5_000, "joints": 5}


@pytest.mark.parametrize("what", SIZES)
def test_a_large_size_is_answered_in_bounded_memory(what: str, tmp_path: Path) -> None:
    made, whole = SIZES[what]
    assert SHARE[what] < whole
    assert not measured(what, made(tmp_path, SHARE[what]), tmp_path, memory=0.5e9).loss
