"""Displacements beside turns on the command line: the answer is that of one point, in kind."""

from pathlib import Path

from tests.cli.conftest import Run
from tests.positions.loaded_arm import write_moved
from tests.positions.test_moved import POINT, STATED, pulls, six_columns

STATED_TWICE = POINT + STATED + ", rotation: 20, rotation_unit: urad}\n"


def test_turns_of_a_plain_arm_show_nothing_missing(run: Run, tmp_path: Path) -> None:
    """Springs are no news, and nothing that moves as they do is held against them."""
    a, force = pulls(12, 3)
    data = str(write_moved(tmp_path, a, force, six_columns(a, force), STATED_TWICE))
    found = run("explain", data, "--out", str(tmp_path / "found"))
    assert found.code == 0, found.stderr
    assert "nothing is missing that these readings show" in found.stdout
    assert "a spring in every actuated joint is assumed" in found.stdout + found.stderr
    report = (tmp_path / "found" / "report.html").read_text()
    assert "Displacements explained" in report and "joint_springs" in report
