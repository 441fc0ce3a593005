"""`kinematics_params.yaml`, multiplied out as UR's description does it."""

import numpy as np
import pytest
import yaml

from sk120stiff.errors import InputError
from sk120stiff.model import base_model
from sk120stiff.robot import load_robot
from tests.corpus.robots import example
from tests.exports.arms import exported, public, standing, with_random
from tests.oracles.numpy_kinematics import rotation, transform
from tests.oracles.sample_urdfs import six_axis_arm

X, Y, Z = np.eye(3)
NAMES = ("shoulder", "upper_arm", "forearm", "wrist_1", "wrist_2", "wrist_3")
# d1, a2, a3, d4, d5, d6 [m] as Universal Robots publish them
PUBLISHED = {
    "ur3_robot.urdf": (0.1519, -0.24365, -0.21325, 0.11235, 0.08535, 0.0819),
    "ur5_robot.urdf": (0.089159, -0.425, -0.39225, 0.10915, 0.09465, 0.0823),
    "ur10_robot.urdf": (0.1273, -0.612, -0.5723, 0.163941, 0.1157, 0.0922),
}


def multiplied(text: str, pose: np.ndarray) -> np.ndarray:
    """base_link to wrist_3; base_link_inertia stands turned by π on base_link."""
    steps = yaml.safe_load(text)["kinematics"]
    T = transform(turn=rotation(Z, np.pi))
    for name, value in zip(NAMES, pose, strict=True):
        s = steps[name]
        turn = rotation(Z, s["yaw"]) @ rotation(Y, s["pitch"]) @ rotation(X, s["roll"])
        T = T @ transform([s["x"], s["y"], s["z"]], turn) @ transform(turn=rotation(Z, value))
    return T


@pytest.mark.parametrize("name", PUBLISHED)
def test_the_nominal_arm_has_the_published_lengths(name: str) -> None:
    text = exported(base_model(public(name)), "kinematics_params").text
    k = yaml.safe_load(text)["kinematics"]
    found = (k["shoulder"]["z"], k["forearm"]["x"], k["wrist_1"]["x"], k["wrist_1"]["z"],
             -k["wrist_2"]["y"], k["wrist_3"]["y"])  # fmt: skip
    np.testing.assert_allclose(found, PUBLISHED[name], atol=2e-5)
    assert set(k) == {*NAMES, "hash"} and k["hash"].startswith("sk120stiff_")
    rolls = [k[name]["roll"] for name in NAMES]
    np.testing.assert_allclose(rolls, np.array([0, 1, 0, 0, 1, -1]) * np.pi / 2, atol=1e-8)


@pytest.mark.parametrize("name", PUBLISHED)
def test_the_calibrated_arm_stands_where_the_model_does(name: str) -> None:
    nominal = base_model(public(name))
    arms = nominal.robot.actuated
    model = with_random(nominal, "joint_offset", "joint_frame", *[f"link_length:{link}" for link in
                        ("upper_arm_link", "forearm_link")])  # fmt: skip
    made = exported(model, "kinematics_params")
    zero = np.zeros((1, len(arms)))
    text = exported(nominal, "kinematics_params").text
    behind = np.linalg.inv(multiplied(text, zero[0])) @ standing(nominal, zero)[0]
    a = np.random.default_rng(4).uniform(-3.0, 3.0, (5, 6))
    for pose, T in zip(a, standing(model, a), strict=True):
        np.testing.assert_allclose(multiplied(made.text, pose) @ behind, T, rtol=0.0, atol=1e-9)


def test_what_lies_behind_the_last_joint_is_told() -> None:
    model = with_random(base_model(public("ur5_robot.urdf")), "tool_offset", "link_length")
    told = {told.effect for told in exported(model, "kinematics_params").left_out}
    assert {"tool_offset:tool0", "tool frame", "joint_springs:elbow_joint"} <= told


def test_other_arms_are_refused_with_the_reason() -> None:
    text = example("ur5_robot.urdf").read_text(encoding="utf-8")
    reversed_elbow = text.replace(
        '<joint name="elbow_joint" type="revolute">',
        '<joint name="elbow_joint" type="revolute"><!-- x -->', 1,
    )  # fmt: skip
    head, tail = reversed_elbow.split("<!-- x -->")
    reversed_elbow = head + tail.replace('<axis xyz="0 1 0"/>', '<axis xyz="0 -1 0"/>', 1)
    assert reversed_elbow != text
    for robot, why in (
        (public("panda.urdf"), "six turning joints"),
        (public("motoman_sk120"), "six turning joints"),
        (load_robot(six_axis_arm()), "axis of j3"),
        (load_robot(reversed_elbow), "axis of elbow_joint"),
    ):
        with pytest.raises(InputError, match=why):
            exported(base_model(robot), "kinematics_params")


def test_it_begins_at_the_controllers_base() -> None:
    """The bundled UR5e stands on that base, other files on ROS's base_link: no arm turns round."""
    text = exported(base_model(load_robot("ur5e")), "kinematics_params").text
    shoulder = yaml.safe_load(text)["kinematics"]["shoulder"]
    assert abs(shoulder["yaw"]) < 1e-9
    assert shoulder["z"] == pytest.approx(0.1625)
