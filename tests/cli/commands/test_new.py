"""`sk120stiff new`: a folder that the other commands can go on with."""

from pathlib import Path

import numpy as np
import pytest

from sk120stiff import load_robot, read_measurements, read_model
from tests.corpus.robots import example

FILES = ["model.yaml", "readings.csv", "readings.yaml", "robot.yaml"]


@pytest.fixture
def here(tmp_path: Path, monkeypatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_the_folder_is_a_robot_with_a_model(run, here: Path) -> None:
    done = run("new", str(example("ur5_robot.urdf")), "--out", "arm", "--json")
    assert done.code == 0, done.stderr
    assert sorted(path.name for path in Path("arm").iterdir()) == FILES
    robot, given = load_robot("arm"), load_robot(example("ur5_robot.urdf"))
    assert (robot.actuated, robot.base_frame, robot.tool_frame) == (
        given.actuated, given.base_frame, given.tool_frame,
    )  # fmt: skip
    a = np.array([0.3, -1.0, 0.8, 0.2, 0.5, -0.4])
    np.testing.assert_allclose(robot.placement(a), given.placement(a), atol=1e-15)
    model = read_model("arm/model.yaml")
    assert [spring["stiffness"] for spring in done.document["springs"]] == pytest.approx(
        list(model.joint_stiffness())
    )
    assert all("typical of an arm of this size, not measured" in p.origin for p in model.parameters)
    assert "winds up 3 mrad" in model.provenance["springs"]
    assert list(done.document["cannot_be_seen"]) == ["wrist_3_joint"]


def test_a_row_that_is_filled_in_is_read_in_its_units(run, here: Path) -> None:
    assert run("new", "motoman_sk120", "--out", "arm").code == 0
    row = "a,10,20,-30,0,0,0,100,0,-200,0.1,0.0,-0.3\n"
    with Path("arm/readings.csv").open("a", encoding="utf-8") as file:
        file.write(row)
    readings = read_measurements("arm/readings.csv")
    np.testing.assert_allclose(readings.joints[0, :3], np.deg2rad([10, 20, -30]))
    np.testing.assert_allclose(readings.displacement, [[1e-4, 0.0, -3e-4]])
    predicted = run("predict", "arm", "arm/readings.csv", "--json")
    assert predicted.code == 0, predicted.stderr
    assert predicted.document["rms_um"] > 0.0


def test_an_empty_file_says_what_it_lacks(run, here: Path) -> None:
    assert run("new", "motoman_sk120", "--out", "arm").code == 0
    outcome = run("identify", "arm/readings.csv", "--json")
    assert (outcome.code, outcome.error["kind"]) == (2, "input")
    assert "no row of data" in outcome.error["message"]


@pytest.mark.parametrize("name", FILES)
def test_nothing_is_replaced(run, here: Path, name: str) -> None:
    Path("arm").mkdir()
    Path("arm", name).write_text("mine", encoding="utf-8")
    outcome = run("new", "motoman_sk120", "--out", "arm")
    assert outcome.code == 2
    assert f"{name} is there already" in outcome.stderr
    assert [path.name for path in Path("arm").iterdir()] == [name]
    assert Path("arm", name).read_text(encoding="utf-8") == "mine"


def test_what_robot_yaml_said_is_kept(run, here: Path) -> None:
    assert run("new", "motoman_sk120", "--out", "arm").code == 0
    robot, bundled = load_robot("arm"), load_robot("motoman_sk120")
    a = np.array([0.3, 0.2, -0.7, 0.4, 0.5, -0.2])
    np.testing.assert_allclose(robot.placement(a), bundled.placement(a), atol=1e-15)
    assert robot.followers.keys() == bundled.followers.keys()
    assert robot.linkages == bundled.linkages
    np.testing.assert_allclose(robot.foundation, bundled.foundation)


def test_a_relative_urdf_is_found_from_the_folder(run, here: Path) -> None:
    Path("mine.urdf").write_bytes(example("ur3_robot.urdf").read_bytes())
    assert run("new", "mine.urdf", "--out", "deep/arm").code == 0
    assert "urdf: ../../mine.urdf" in Path("deep/arm/robot.yaml").read_text(encoding="utf-8")
    assert load_robot("deep/arm").n == 6
    assert read_model("deep/arm/model.yaml").robot.n == 6


def test_a_plan_written_beside_the_folder_finds_its_robot(run, here: Path) -> None:
    assert run("new", str(example("ur5_robot.urdf")), "--out", "cell").code == 0
    few = ("--count", "6", "--candidates", "20", "--directions", "2")
    for plan in ("plan.csv", "cell/plan.csv"):
        planned = run("plan", "--model", "cell/model.yaml", *few, "--out", plan)
        assert planned.code == 0, planned.stderr
        made = run("simulate", "cell/model.yaml", plan, "--out", f"made_{len(plan)}.csv")
        assert made.code == 0, made.stderr


def test_a_robot_named_from_here_is_found_from_the_folder_of_the_plan(
    run, here: Path, monkeypatch
) -> None:
    assert run("new", str(example("ur5_robot.urdf")), "--out", "cell").code == 0
    Path("cell/model.yaml").unlink()
    few = ("--count", "6", "--candidates", "20", "--directions", "2")
    Path("plans").mkdir()
    assert run("plan", "--model", "cell", *few, "--out", "plans/plan.csv").code == 0
    monkeypatch.chdir("plans")
    made = run("simulate", "../cell", "plan.csv", "--out", "made.csv")
    assert made.code == 0, made.stderr
