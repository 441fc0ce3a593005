"""What names of files and sheets say of order and pose."""

from pathlib import Path

import pytest

from sk120stiff.measurements.importers.numbered_names import (
    in_order,
    labels_of_files,
    says_one_pose,
)


def paths(*names: str) -> list[Path]:
    return [Path(f"{name}.csv") for name in names]


def test_the_order_of_numbers_and_not_of_digits() -> None:
    assert in_order(paths("Pose_1", "Pose_10", "Pose_2")) == paths("Pose_1", "Pose_2", "Pose_10")
    assert in_order(["P2", "P10", "P1"]) == ["P1", "P2", "P10"]
    assert in_order(paths("r2_p1", "r1_p2", "r1_p10")) == paths("r1_p2", "r1_p10", "r2_p1")


@pytest.mark.parametrize("names", [("monday", "friday"), ("b1", "a2"), ("a2", "b")])
def test_other_names_stay_as_they_were_given(names: tuple[str, ...]) -> None:
    assert in_order(paths(*names)) == paths(*names)


@pytest.mark.parametrize(
    ("names", "labels", "said"),
    [
        (("Pose_1", "Pose_10"), ["1", "10"], True),
        (("ur5_pose03_0kg", "ur5_pose03_5kg", "ur5_pose04_5kg"), ["3", "3", "4"], True),
        (("Stellung 1a", "Stellung 2a"), ["1", "2"], True),
        (("posição_1", "posição_2"), ["1", "2"], True),
        (("run_01", "run_12"), ["1", "12"], False),
        (("p_1_0.5kg", "p_2_10kg"), ["1", "2"], True),
        (("2024_5", "2024_7"), ["5", "7"], False),
    ],
)
def test_labels_of_files(names: tuple[str, ...], labels: list[str], said: bool) -> None:
    found = labels_of_files(paths(*names))
    assert found is not None
    assert [each.text for each in found] == labels and {each.said for each in found} == {said}


@pytest.mark.parametrize(
    "names", [("a", "b"), ("run1_2", "run2_3"), ("x_1", "y_2"), ("ur10_0kg", "ur10_5kg")]
)
def test_names_that_tell_no_pose(names: tuple[str, ...]) -> None:
    assert labels_of_files(paths(*names)) is None


@pytest.mark.parametrize(
    ("title", "is_pose"),
    [("Pose 1", True), ("P2", True), ("Stellung B", True), ("Run 1", False), ("Position", False),
     ("Poses all", False), ("Punto_3", True)],
)  # fmt: skip
def test_sheets_called_as_a_pose(title: str, is_pose: bool) -> None:
    assert says_one_pose(title) is is_pose
