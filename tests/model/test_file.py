"""Model files: what is written is read, and what people get wrong is named."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

from sk120stiff.effects import effect
from sk120stiff.errors import InputError, ToolkitWarning
from sk120stiff.model import (
    base_model,
    joint_spring_model,
    model_from_text,
    model_text,
    read_model,
    write_model,
)
from sk120stiff.robot import load_robot

GOOD = """
robot: motoman_sk120
effects:
  - name: joint_springs
    where: joint_1_s
    parameters:
      stiffness: {value: 1.4e6, unit: N*m/rad, std: 2.0e4, origin: bench}
"""


def test_a_file_written_by_hand_is_read():
    model = model_from_text(GOOD)
    (spring,) = model.parameters
    assert spring.name == "joint_springs:joint_1_s.stiffness"
    assert np.isclose(spring.value, 1.4e6) and np.isclose(spring.std, 2e4)
    assert spring.free and spring.origin == "bench" and model.robot.name == "motoman_sk120"


def test_the_bundled_robot_brings_its_model():
    model = base_model(load_robot("motoman_sk120"))
    assert np.allclose(model.joint_stiffness()[:3], [1.4098e6, 4.0076e5, 9.3528e5])
    assert base_model(load_robot("motoman_sk120", base="link_1_s")) is not None


def test_files_are_replaced_whole(tmp_path):
    path = tmp_path / "model.yaml"
    model = model_from_text(GOOD)
    assert write_model(model, path) == path
    first = path.read_text(encoding="utf-8")
    write_model(model + effect(model.robot, "base_rocking"), path)
    assert read_model(path).names[-1] == "base_rocking:base_link.stiffness_y"
    write_model(model, path)
    assert path.read_text(encoding="utf-8") == first
    assert [p.name for p in tmp_path.iterdir()] == ["model.yaml"]


def test_a_robot_beside_the_model_is_found(tmp_path):
    from sk120stiff.robot.bundled import bundled_robots

    urdf = bundled_robots()["motoman_sk120"] / "sk120.urdf"
    (tmp_path / "arm.urdf").write_bytes(urdf.read_bytes())
    path = tmp_path / "model.yaml"
    path.write_text(GOOD.replace("motoman_sk120", "arm.urdf"), encoding="utf-8")
    assert read_model(path).robot.actuated[0] == "joint_1_s"


def test_a_model_keeps_its_frames_and_finds_its_robot_from_its_own_folder(tmp_path, monkeypatch):
    from sk120stiff.robot.bundled import bundled_robots

    urdf = bundled_robots()["motoman_sk120"] / "sk120.urdf"
    (tmp_path / "arm.urdf").write_bytes(urdf.read_bytes())
    (tmp_path / "results").mkdir()
    monkeypatch.chdir(tmp_path)
    robot = load_robot("arm.urdf", base="link_1_s", tool="reflector")
    path = write_model(joint_spring_model(robot), "results/model.yaml")
    monkeypatch.chdir("/")
    again = read_model(tmp_path / path).robot
    assert (again.base_frame, again.tool_frame) == ("link_1_s", "reflector")
    assert again.actuated == robot.actuated


def test_a_model_of_another_robot_is_used_with_a_warning(tmp_path):
    robot = load_robot("motoman_sk120")
    for said in ("motoman_sk120", robot.name, str(robot.source)):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            model_from_text(GOOD.replace("motoman_sk120", said), robot=robot)
    with pytest.warns(ToolkitWarning, match="of the robot 'ur10'"):
        model_from_text(GOOD.replace("motoman_sk120", "ur10"), robot=robot)


@pytest.mark.parametrize("number", [1.0 / 3.0, np.pi * 1e-7, 1e-300, 123456.7])
def test_numbers_keep_all_their_digits(number):
    robot = load_robot("motoman_sk120")
    model = joint_spring_model(robot, [1 / number, *[np.inf] * 5])
    again = model_from_text(model_text(model))
    assert np.isclose(again.values[0], model.values[0], rtol=4e-16, atol=0)


def test_gears_in_steps_come_back_from_the_names_of_their_parameters():
    robot = load_robot("motoman_sk120")
    gear = effect(robot, "gear_hardening", "joint_2_l", breaks=(120.0, 400.0))
    model = joint_spring_model(robot) + gear
    model = model.with_public(**{f"{gear.id}.extra_below_120": 3e-7})
    again = model_from_text(model_text(model))
    assert again.effects[-1] == gear and np.array_equal(again.values, model.values)


@pytest.mark.parametrize("unit", ["Nm/rad", "N·m/rad", "N m/rad"])
def test_a_unit_may_be_spelled_another_way(unit):
    model = model_from_text(GOOD.replace("N*m/rad", unit))
    assert np.array_equal(model.values, model_from_text(GOOD).values)
    assert "unit: N*m/rad" in model_text(model)


BAD = {
    "no YAML": ("robot: [", "not YAML.*"),
    "a list": ("- robot", "key"),
    "no robot": ("effects: []", "key 'robot'"),
    "unknown key": (GOOD + "notes: none\n", "key 'notes'"),
    "unknown effect": (GOOD.replace("joint_springs", "joint_spring"), "no effect 'joint_spring'"),
    "unknown place": (GOOD.replace("joint_1_s", "joint_7"), "cannot act at 'joint_7'"),
    "unknown parameter": (GOOD.replace("stiffness:", "stifness:"), "missing|unknown"),
    "wrong unit": (GOOD.replace("N*m/rad", "N*mm/rad"), r"'N\*mm/rad', not in 'N\*m/rad'"),
    "no number": (GOOD.replace("1.4e6", "stiff"), "parameters.stiffness.value"),
    "not a number": (GOOD.replace("1.4e6", ".nan"), "no usable value"),
    "zero stiffness": (GOOD.replace("1.4e6", "0.0"), "no usable value"),
    "negative": (GOOD.replace("1.4e6", "-1.4e6"), "physics forbids"),
    "unknown robot": (GOOD.replace("motoman_sk120", "motoman"), "no such robot"),
    "twice": (GOOD + GOOD.split("effects:\n")[1], "already in the model"),
}


@pytest.mark.parametrize("why", BAD)
def test_files_that_make_no_sense_are_refused(why):
    text, message = BAD[why]
    with pytest.raises(InputError, match=message) as caught:
        model_from_text(text, where="model.yaml")
    assert caught.value.remedy or why in ("not a number", "zero stiffness")


def test_an_infinite_stiffness_is_an_absent_effect():
    model = model_from_text(GOOD.replace("1.4e6", ".inf").replace("std: 2.0e4, ", ""))
    assert model.values[0] == 0.0
    assert np.isinf(model_from_text(model_text(model)).parameters[0].value)


def test_a_robot_named_from_the_models_folder_is_found_again_from_anywhere(tmp_path, monkeypatch):
    """`robot: .`, which a new folder's model says, is the folder of the model, not the caller's."""
    from sk120stiff.robot.bundled import bundled_robots

    cell = tmp_path / "cell"
    cell.mkdir()
    urdf = bundled_robots()["motoman_sk120"] / "sk120.urdf"
    (cell / "arm.urdf").write_bytes(urdf.read_bytes())
    (cell / "robot.yaml").write_text("urdf: arm.urdf\n", encoding="utf-8")
    (cell / "model.yaml").write_text(GOOD.replace("motoman_sk120", "."), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    model = read_model("cell/model.yaml")
    assert load_robot(model.robot.source).actuated == model.robot.actuated
    (tmp_path / "results").mkdir()
    write_model(model, "results/model.yaml")
    monkeypatch.chdir("/")
    assert read_model(tmp_path / "results" / "model.yaml").robot.actuated == model.robot.actuated
