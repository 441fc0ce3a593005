"""An arm whose base may be turned over: what is up in the file says which way it stands."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.errors import Refusal
from sk120stiff.measurements.importers import Told
from sk120stiff.measurements.importers.run import import_readings
from sk120stiff.measurements.placing import upside_down
from sk120stiff.measurements.placing.cloud import Cloud
from sk120stiff.measurements.placing.slips import Convention, signs_and_turns
from sk120stiff.measurements.placing.upside_down import standing
from tests.measurements.placing.test_conventions import cloud_of

SIGNS = np.array([-1.0, 1.0, 1.0, 1.0, 1.0, 1.0])
QUARTERS = np.array([0.0, -1.0, 1.0, 0.0, 0.0, 0.0])
DOWN = np.array([0.0, 0.0, -9.81])
Y_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])  # y here is z of the base


def told(way: Convention) -> str:
    return ",".join(way.expressions(["A1", "A2", "A3", "A4", "A5", "A6"]))


@pytest.fixture
def cloud() -> Cloud:
    return cloud_of(sk.load_robot("ur5e"), SIGNS, QUARTERS, seed=3)


def test_the_upright_one_of_two_that_fit_alike_is_told(cloud: Cloud) -> None:
    found = standing(cloud, signs_and_turns(cloud), DOWN)
    assert found.upright and found.other is not None and found.other.hangs
    assert np.allclose(cloud.a @ found.way.share.T[:, :2] + found.way.zero[:2],
                       cloud.a[:, :2] * SIGNS[:2] + QUARTERS[:2] * np.pi / 2)  # fmt: skip
    said = found.beside(told)
    assert "-A1" not in said and "A2 + 90 deg" in said and "hangs from a ceiling" in said
    hung = standing(cloud, signs_and_turns(cloud), -DOWN)
    assert hung.upright and hung.way.share[0, 0] > 0.0


def test_an_upright_one_that_leaves_a_little_more_comes_before_one_that_hangs(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Poses that move one joint after the other hardly tell them."""
    robot = sk.load_robot("ur5e")
    n = len(robot.actuated)
    cloud = cloud_of(robot, np.ones(n), np.zeros(n), seed=2)
    noise = 1e-3 * np.random.default_rng(1).normal(size=cloud.x.shape)
    cloud = replace(cloud, x=cloud.x + noise)
    found = signs_and_turns(cloud)
    left = [way.rms for way in (found, *found.others)]
    assert len(left) > 1 and max(left) < 1.5 * min(left)
    upright = standing(cloud, found, DOWN)
    other = upright.other
    assert upright.upright and other is not None and other.hangs
    given = replace(other.way, others=(upright.way,))
    monkeypatch.setattr(upside_down, "_turned_over", lambda *_: None)
    assert standing(cloud, other.way, DOWN).hangs
    again = standing(cloud, given, DOWN)
    assert again.upright and again.other is not None and again.other.hangs
    assert "upside down" in again.beside(told)


def test_where_z_is_not_plumb_both_are_told_with_what_is_up(cloud: Cloud) -> None:
    seen = replace(cloud, x=cloud.x @ Y_UP.T)
    found = standing(seen, signs_and_turns(seen), DOWN)
    assert not found.upright and not found.hangs
    said = found.beside(told)
    assert "(0.00, 1.00, 0.00)" in said and "(0.00, -1.00, 0.00)" in said
    assert "take the one that is so" in said


def test_an_arm_that_positions_tell_has_no_other() -> None:
    robot = sk.load_robot("motoman_sk120")  # its second axis stands off the first
    n = len(robot.actuated)
    cloud = cloud_of(robot, np.ones(n), np.zeros(n), seed=1)
    as_it_is = Convention(0.0, np.eye(n), np.zeros(n))
    found = standing(cloud, as_it_is, DOWN)
    assert found.other is None and found.beside(told) == "" and found.upright
    assert standing(cloud, as_it_is, np.zeros(3)).up is None


def written(folder: Path, cloud: Cloud, name: str = "A{}") -> Path:
    path = folder / "seen.csv"
    joints = (f"{name.format(k)} [rad]" for k in range(1, 7))
    head = ",".join([*joints, "x [m]", "y [m]", "z [m]"])
    rows = (",".join(f"{v:.6f}" for v in row) for row in np.hstack([cloud.a, cloud.x]))
    path.write_text("\n".join([head, *rows]) + "\n")
    return path


def test_an_import_tells_both(tmp_path: Path, cloud: Cloud) -> None:
    with pytest.raises(Refusal) as caught:
        import_readings(written(tmp_path, cloud), cloud.robot)
    remedy = caught.value.remedy or ""
    assert "give --joints '-A1,A2 - 90 deg,A3 + 90 deg,A4,A5,A6'. The base then" in remedy
    assert "--joints 'A1,A2 + 90 deg,A3 + 90 deg,A4,A5,A6'" in remedy


@pytest.mark.parametrize("name", ["A{}", "Axis {}"])
def test_advice_given_about_sums_is_one_that_can_be_given(
    tmp_path: Path, cloud: Cloud, name: str
) -> None:
    """It was told for the YAML file, which an import has yet to write, and about what was given."""
    given = ("-(A1)", "A2", "A3 - 90 deg", "A4", "A5", "A6")
    told = Told(joints=tuple(each.replace("A", name.replace("{}", "")) for each in given))
    path = written(tmp_path, cloud, name)
    with pytest.raises(Refusal) as caught:
        import_readings(path, cloud.robot, told)
    remedy = caught.value.remedy or ""
    advice = re.search("give --joints '([^']*)'", remedy)
    assert advice is not None and "YAML" not in remedy
    again = Told(joints=tuple(advice[1].split(",")))
    found = import_readings(path, cloud.robot, again)
    assert not any("upside down" in doubt for doubt in found.doubts)


@pytest.mark.parametrize(
    ("joints", "doubted"),
    [
        ("A1,A2 + 90 deg,A3 + 90 deg,A4,A5,A6", True),
        ("-A1,A2 - 90 deg,A3 + 90 deg,A4,A5,A6", False),
    ],
)
def test_a_base_upside_down_is_doubted(
    tmp_path: Path, cloud: Cloud, joints: str, doubted: bool
) -> None:
    told = Told(joints=tuple(joints.split(",")))
    found = import_readings(written(tmp_path, cloud), cloud.robot, told)
    assert any("upside down" in doubt for doubt in found.doubts) is doubted
