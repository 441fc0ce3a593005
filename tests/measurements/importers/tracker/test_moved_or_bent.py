"""A tracker that moved from file to file, or an arm that other loads bend: which takes what off."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sk120stiff import load_robot
from sk120stiff.measurements.importers.tracker import moved_or_bent
from tests.measurements.importers.campaign.test_several_files import (
    WHOLE,
    brought,
    labels,
    moved,
    part,
    written,
)
from tests.measurements.importers.tracked import TURN, Campaign, ur5

SPRINGS = np.array([6e4, 6e4, 3e4, 1e4, 1e4, 1e4])  # N·m/rad; 5 kg bend such an arm by 0.5 mm
HALF, REST = part(WHOLE, slice(0, 30)), part(WHOLE, slice(30, 60))


def sagged(seen: Campaign, mass: float, seed: int = 1) -> Campaign:
    """The same poses read once more, with a mass on the tool."""
    J = load_robot(ur5(), tool="tool0").jacobian(np.radians(seen.q))[:, :3]
    bent = np.einsum("pik,pk->pi", J, (J[:, 2] * -9.81 * mass) / SPRINGS)
    noise = np.random.default_rng(seed).normal(0.0, 0.03, bent.shape)
    return replace(seen, x=seen.x + TURN.apply(1e3 * bent) + noise)


def pushed(seen: Campaign, shift: float, degrees: float = 0.0) -> Campaign:
    """From a place of the tracker that is `shift` mm aside."""
    turn = Rotation.from_rotvec([0.0, 0.0, np.radians(degrees)])
    return replace(seen, x=turn.apply(seen.x) + [shift, shift / 2, 0.0])


def files(folder: Path, *parts: tuple[str, Campaign]) -> list[Path]:
    return [written(folder, f"{name}.csv", seen) for name, seen in parts]


@pytest.mark.parametrize("names", [("a_0kg", "a_5kg", "a_9kg"), ("a", "b", "c")])
def test_sag_is_no_place_of_the_tracker(tmp_path: Path, names: tuple[str, ...]) -> None:
    """Whether the masses are known or not: one frame leaves what loads do to be seen."""
    seen = [sagged(HALF, mass, k) for k, mass in enumerate((0.0, 5.0, 9.0))]
    found = brought(files(tmp_path, *zip(names, seen, strict=True)))
    assert labels(found, "station") is None and labels(found, "series") is None
    known = "kg" in names[0]
    assert found.mode == "positions" and (found.differences == 60) == known
    (said,) = [s for s in found.said if "to have stood in one place for all 3" in s]
    assert ("--payload 'FILE=5 kg'" in said) != known and "column station" in said


def test_a_file_for_each_pose_tells_no_frame(tmp_path: Path) -> None:
    """Read five times each: five rows of one pose place no tracker."""
    parts = []
    for k in range(12):
        own = part(WHOLE, slice(k, k + 1))
        rows = Campaign(own.names * 5, own.q.repeat(5, axis=0), own.x.repeat(5, axis=0))
        parts += [(f"p{k}_{m}kg", sagged(rows, m, seed=k + 50 * m)) for m in (0, 3)]
    found = brought(files(tmp_path, *parts))
    assert labels(found, "station") is None and labels(found, "series") is None
    assert found.mode == "positions" and found.useful_poses == 12
    assert found.fitted is not None and found.fitted.rms > 2e-4  # what the arm's zeros are off
    assert any("fewer than 3 poses, as of p0_0kg, p0_3kg" in said for said in found.said)


@pytest.mark.parametrize(("shift", "degrees"), [(1.0, 0.0), (0.0, 0.05), (500.0, 30.0)])
def test_a_push_between_two_loads_is_seen_beside_the_sag(
    tmp_path: Path, shift: float, degrees: float
) -> None:
    parts = ("a_0kg", sagged(HALF, 0.0)), ("a_5kg", pushed(sagged(HALF, 5.0, 2), shift, degrees))
    found = brought(files(tmp_path, *parts))
    assert labels(found, "station") == ("a_0kg",) * 30 + ("a_5kg",) * 30
    assert found.mode == "positions" and labels(found, "payload[kg]") is not None
    assert found.readings.absolute is not None


def test_of_three_loads_the_two_from_one_place_share_its_frame(tmp_path: Path) -> None:
    parts = [(f"a_{m}kg", sagged(HALF, m, m)) for m in (0, 5, 9)]
    parts[1] = (parts[1][0], moved(parts[1][1]))
    found = brought(files(tmp_path, *parts))
    assert labels(found, "station") == ("a_0kg",) * 30 + ("a_5kg",) * 30 + ("a_0kg",) * 30
    assert any("where it did at a_0kg" in s and s.endswith("a_9kg.") for s in found.said)


def test_other_poses_without_loads_have_frames_of_their_own(tmp_path: Path) -> None:
    found = brought(files(tmp_path, ("monday", HALF), ("friday", pushed(REST, 0.3))))
    assert labels(found, "station") == ("monday",) * 30 + ("friday",) * 30


def test_few_poses_from_a_place_that_is_far_off_have_its_frame(tmp_path: Path) -> None:
    parts = [(f"f{k}", part(WHOLE, slice(8 * k, 8 * k + 8))) for k in range(4)]
    parts[3] = ("f3", pushed(parts[3][1], 40.0))
    found = brought(files(tmp_path, *parts))
    assert labels(found, "station") == ("f0",) * 24 + ("f3",) * 8


def told(rng: np.random.Generator, push: float) -> float | None:
    """What is found of poses close together, read with a mass that hangs aside of the marker."""
    robot, marker = load_robot(ur5(), tool="tool0"), np.array([0.03, 0.01, 0.09])
    q = rng.uniform(-0.35, 0.35, (40, 6)) + 0.8 * np.array([0, -1, 1, 0, 1, 0])
    J, hung = robot.jacobian(q, point=marker)[:, :3], marker + rng.normal(0.0, 0.05, 3)
    turn = robot.jacobian(q, point=hung)[:, 2] * -50.0 / (SPRINGS * rng.uniform(0.5, 2.0, 6))
    apart = np.einsum("pik,pk->pi", J, turn) + rng.normal(0.0, 1e-5, (40, 3)) + [push, 0.0, push]
    draft: Any = SimpleNamespace(
        measured=np.concatenate([np.zeros((40, 3)), apart]),
        joints=SimpleNamespace(values=np.concatenate([q, q])),
    )
    rows, laid = np.arange(40), SimpleNamespace(turns=np.eye(3)[None], marker=marker)
    poses = np.concatenate([rows, rows])
    return moved_or_bent.moved(draft, rows, rows + 40, poses, robot, laid)  # type: ignore[arg-type]


def test_at_poses_close_together_sag_is_told_from_a_push_by_the_springs() -> None:
    rng = np.random.default_rng(0)
    assert [told(rng, 0.0) for _ in range(30)] == [0.0] * 30
    assert all(told(rng, 1e-3) for _ in range(10))


def test_few_common_poses_tell_nothing() -> None:
    robot = load_robot(ur5(), tool="tool0")
    draft: Any = SimpleNamespace(
        measured=np.zeros((4, 3)), joints=SimpleNamespace(values=np.zeros((4, 6)))
    )
    laid: Any = SimpleNamespace(turns=np.eye(3)[None], marker=np.zeros(3))
    first, second = np.array([0, 1]), np.array([2, 3])
    for poses in ([0, 1, 0, 1], [0, 1, 2, 3]):
        found = moved_or_bent.moved(draft, first, second, np.array(poses), robot, laid)
        assert found is None
