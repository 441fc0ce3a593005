"""Where the arm of every public robot ends. The table was looked at robot by robot, by hand.

`scripts/12_where_arms_end.py` prints it; a line that changes is to be looked at again.
"""

import runpy
from pathlib import Path

import pytest

from sk120stiff.robot.urdf import default_frames, read_urdf
from tests.corpus.robots import example_urdfs

HERE = Path(__file__).resolve().parent
TABLE = dict(
    line.split(maxsplit=1) for line in (HERE / "where_arms_end.txt").read_text().splitlines()
)
EMPTY = {"ur_description/ur3.urdf"}  # the file holds no link


def label(path: Path) -> str:
    return f"{path.parent.parent.name}/{path.name}"


def test_the_table_has_a_line_for_every_robot() -> None:
    assert set(TABLE) == {label(path) for path in example_urdfs()} - EMPTY


@pytest.mark.parametrize("path", example_urdfs(), ids=label)
def test_the_arm_ends_where_the_table_says(path: Path) -> None:
    if label(path) in EMPTY:
        return
    row = runpy.run_path(str(HERE.parents[1] / "scripts/12_where_arms_end.py"))["row"]
    assert row(default_frames(read_urdf(path))) == TABLE[label(path)]
