"""Rows of one pose: their labels may differ where their joint values do not."""

from pathlib import Path

import numpy as np
import pytest

from sk120stiff.measurements.importers.columns.pose_labels import _begin_of, _end_of
from tests.measurements.importers.campaign.test_several_files import brought
from tests.measurements.importers.reading import draft_of, written
from tests.measurements.importers.tracked import campaign

HEAD = "pose," + ",".join(f"q{k}[deg]" for k in range(1, 7)) + ",payload[kg],x[mm],y[mm],z[mm]"


def passes(labels: list[str], loads: list[float], at: list[int]) -> str:
    rows = [
        f"{label},{place},0,0,0,0,{place},{load},{100 * place + load},0,0"
        for label, load, place in zip(labels, loads, at, strict=True)
    ]
    return "\n".join([HEAD, *rows])


def test_two_passes_under_other_names_are_of_the_same_poses(tmp_path: Path) -> None:
    text = passes(["P1_A", "P2_A", "P1_B", "P2_B"], [0, 0, 5, 5], [1, 2, 1, 2])
    draft = draft_of(tmp_path, text)
    assert draft.pose == ("P1", "P2", "P1", "P2")
    assert written(draft)["name"] == ("P1_A", "P2_A", "P1_B", "P2_B")
    assert any("P1_A, P1_B are P1, and so on at 2 poses" in said for said in draft.said)


@pytest.mark.parametrize(
    ("labels", "loads", "at"),
    [
        (["A", "A", "B", "B"], [0, 5, 0, 5], [1, 1, 1, 1]),  # each with a reading of its own
        (["A", "B", "C", "D"], [5, 5, 5, 5], [1, 2, 1, 2]),  # no two loads
        (["A", "B", "C", "D"], [0, 0, 5, 5], [1, 2, 3, 4]),  # no pose twice
    ],
)
def test_labels_that_say_more_stay(
    tmp_path: Path, labels: list[str], loads: list[float], at: list[int]
) -> None:
    assert draft_of(tmp_path, passes(labels, loads, at)).pose == tuple(labels)


def test_labels_of_displacements_stay(tmp_path: Path) -> None:
    text = passes(["P1_A", "P1_B"], [1, 5], [1, 1]).replace(",x[", ",dx[")
    text = text.replace(",y[", ",dy[").replace(",z[", ",dz[")
    assert draft_of(tmp_path, text).pose == ("P1_A", "P1_B")


@pytest.mark.parametrize(
    ("labels", "shared"),
    [
        (["P1_A", "P1_B"], "P1"), (["P1a", "P1b"], "P1"), (["P1", "P1_loaded"], "P1"),
        (["empty/P7", "full/P7"], "P7"), (["0kg/P7", "5kg/P7"], "P7"),
        (["12a", "13a"], ""), (["P1", "P37"], ""), (["12", "13"], ""), (["A", "B"], ""),
        (["P1.1", "P1.2"], "P1"),
    ],
)  # fmt: skip
def test_what_labels_share(labels: list[str], shared: str) -> None:
    assert (_begin_of(labels) or _end_of(labels)) == shared


def test_files_of_one_campaign_share_poses(tmp_path: Path) -> None:
    """Each under its own load, at the same poses under the same labels."""
    seen, head = campaign(12), HEAD.replace("payload[kg],", "")
    for name, load in (("ur_0kg", 0.0), ("ur_5kg", 1.0)):
        x = seen.x + load * np.array([0.1, 0.2, -0.5])
        rows = zip(seen.names, seen.q, x, strict=True)
        lines = [",".join([n, *(f"{v:.5f}" for v in (*q, *p))]) for n, q, p in rows]
        (tmp_path / f"{name}.csv").write_text("\n".join([head, *lines]))
    found = brought([tmp_path / "ur_0kg.csv", tmp_path / "ur_5kg.csv"])
    assert len(found.readings.poses) == 12 and found.useful_poses == 12
    assert found.mode == "positions" and found.differences == 12
    assert dict(found.columns)["pose"][:2] == ("P1", "P2")
