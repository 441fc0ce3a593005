"""Exported SDF, read back by hand: the same geometry, the same rest under a load."""

import xml.etree.ElementTree as ET

import numpy as np
import pytest

from sk120stiff.model import joint_spring_model
from sk120stiff.robot import load_robot
from tests.exports.arms import exported, miscalibrated, standing
from tests.oracles.mujoco_serial import Spring, serial_statics
from tests.oracles.numpy_kinematics import rotation, transform
from tests.oracles.sample_urdfs import six_axis_arm
from tests.workspace.test_arm import sk120_with, with_effect

POSE = np.array([0.4, 0.35, -0.5, 0.3, -0.9, 0.2])
WRENCH = np.array([300.0, -250.0, -400.0, 30.0, -20.0, 10.0])


def pose_of(element: ET.Element) -> np.ndarray:
    x, y, z, roll, pitch, yaw = map(float, element.findtext("pose", "0 0 0 0 0 0").split())
    turn = rotation([0, 0, 1], yaw) @ rotation([0, 1, 0], pitch) @ rotation([1, 0, 0], roll)
    return transform([x, y, z], turn)


class Sdf:
    """Links, joints and frames of an exported model."""

    def __init__(self, text: str) -> None:
        self.model = ET.fromstring(text).find("model")
        self.links = {link.get("name"): link for link in self.model.iter("link")}
        self.joints = {j.findtext("child"): j for j in self.model.iter("joint")}
        self.gains = {p.findtext("joint_name"): p for p in self.model.iter("plugin")}

    def value(self, name: str) -> float:
        """Of a joint at the pose: its command, what it follows, or nothing."""
        joint = next(j for j in self.joints.values() if j.get("name") == name)
        mimic = joint.find("axis/mimic")
        if mimic is not None:
            leader = self.value(mimic.get("joint"))
            return float(mimic.findtext("multiplier")) * leader + float(mimic.findtext("offset"))
        return float(self.gains[name].findtext("initial_position")) if name in self.gains else 0.0

    def chain(self, frame: str) -> tuple[list[Spring], np.ndarray]:
        """Joints from the ground to a frame, relaxed at the pose; and the frame on the last."""
        found = next(f for f in self.model.iter("frame") if f.get("name") == frame)
        link, tip, springs = found.get("attached_to"), pose_of(found), []
        while self.joints[link].findtext("parent") != "world":
            joint, element = self.joints[link], self.links[link]
            parent = joint.findtext("parent")
            assert element.find("pose").get("relative_to") == parent
            name, own = joint.get("name"), joint.findtext("axis/dynamics/spring_stiffness")
            servo = self.gains[name].findtext("p_gain") if name in self.gains else None
            springs.append(
                Spring(
                    origin=pose_of(element),
                    axis=np.array([float(x) for x in joint.findtext("axis/xyz").split()]),
                    angle=self.value(name),
                    stiffness=float(own or servo) if own or servo else None,
                    slide=joint.get("type") == "prismatic",
                )
            )
            link = parent
        return springs[::-1], tip


def without_masses(text: str) -> str:
    root = ET.fromstring(text)
    for link in root.iter("link"):
        for inertial in link.findall("inertial"):
            link.remove(inertial)
    return ET.tostring(root, encoding="unicode")


def test_read_back_it_deflects_the_same() -> None:
    robot = load_robot(six_axis_arm(seed=5))
    model = with_effect(
        joint_spring_model(robot, [2e5, 3e5, 1e5, np.inf, 4e4, 3e4]), "joint_tilt:j2"
    )
    springs, tip = Sdf(exported(model, "sdf", pose=POSE).text).chain("tool")
    found = serial_statics(springs, tip).deflection(WRENCH)
    massless = load_robot(without_masses(six_axis_arm(seed=5)))
    light = with_effect(joint_spring_model(massless, model.joint_stiffness()), "joint_tilt:j2")
    expected = light.deflect(POSE[None], WRENCH[None])[0]
    assert np.linalg.norm(expected) > 1e-3
    np.testing.assert_allclose(found.displacement, expected, atol=3e-7)  # a servo is not rigid


@pytest.mark.parametrize("name", ["motoman_sk120", "ur5_robot.urdf", "panda.urdf"])
def test_read_back_it_stands_where_the_model_does(name: str) -> None:
    model = miscalibrated(name)
    pose = np.random.default_rng(2).uniform(-1.0, 1.0, model.robot.n)
    sdf = Sdf(exported(model, "sdf", pose=pose).text)
    springs, T = sdf.chain(f"{model.robot.tool_frame}_measured")
    for spring in reversed(springs):
        turn = transform(turn=rotation(spring.axis, spring.angle))
        T = spring.origin @ turn @ T
    np.testing.assert_allclose(T, standing(model, pose[None])[0], rtol=0.0, atol=1e-9)
    for frame in model.robot.frames[2:]:  # every link is there, as a link or as a frame
        names = {*sdf.links, *(f.get("name") for f in sdf.model.iter("frame"))}
        assert frame in names


def test_one_name_stands_for_one_thing() -> None:
    """URDF may call a joint like a link; SDF may not."""
    text = six_axis_arm().replace('"j3"', '"link_3"')
    model = joint_spring_model(load_robot(text), np.full(6, 1e5))
    made = exported(model, "sdf", pose=POSE)
    sdf = Sdf(made.text)
    names = [e.get("name") for e in sdf.model if e.tag in ("link", "joint", "frame")]
    assert len(set(names)) == len(names)
    assert "link_3.joint" in sdf.gains and len(sdf.gains) == 6
    assert len(sdf.chain("tool")[0]) == 12


def test_followers_follow_motor_and_spring() -> None:
    sdf = Sdf(exported(sk120_with("link_bending:link_2_l"), "sdf", pose=POSE).text)
    mimics = {
        j.get("name"): (m.get("joint"), float(m.findtext("multiplier")))
        for j in sdf.joints.values()
        if (m := j.find("axis/mimic")) is not None
    }
    assert mimics["joint_elbow_parallel"] == ("joint_2_l", -1.0)
    assert mimics["joint_elbow_parallel.1"] == ("joint_2_l.spring", -1.0)
    assert sum(name.startswith("joint_elbow_parallel") for name in mimics) == 5  # three stations
    assert set(sdf.gains) == set(sk120_with().robot.actuated)


def test_springs_between_joints_are_told() -> None:
    model = sk120_with("closure_coupling:joint_2_l,joint_3_u")
    made = exported(model, "sdf", pose=POSE)
    told = {told.effect: told.how for told in made.left_out}
    assert "SDF has no such spring" in told["closure_coupling:joint_2_l,joint_3_u"]
    assert [s["stiffness"] for s in made.details["springs"]] == pytest.approx(
        [1.4098e6, 4.0076e5, 9.3528e5]
    )


def test_gravity_of_an_arm_that_hangs_is_told() -> None:
    text = six_axis_arm().replace('<robot name="six_axis"><link name="base"/>', (
        '<robot name="six_axis"><link name="wall"/><link name="base"/><joint name="hung" '
        'type="fixed"><parent link="wall"/><child link="base"/>'
        '<origin rpy="1.5707963267948966 0 0"/></joint>'
    ))  # fmt: skip
    model = joint_spring_model(load_robot(text, base="base"), np.full(6, 1e5))
    made = exported(model, "sdf")
    assert any("Gravity is the world's" in note and "-1.0" in note for note in made.notes)
