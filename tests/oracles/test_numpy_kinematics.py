"""The matrix kinematics against hand arithmetic and against MuJoCo's own URDF reader."""

import mujoco
import numpy as np

from tests.oracles.numpy_kinematics import UrdfTree, rotation, rotation_vector
from tests.oracles.sample_urdfs import mimic_tree, six_axis_arm

PENDULUM = """
<robot name="two">
  <link name="base"/>
  <joint name="a" type="revolute"><parent link="base"/><child link="u"/><axis xyz="0 -1 0"/></joint>
  <link name="u"><inertial><origin xyz="0.5 0 0"/><mass value="2"/></inertial></link>
  <joint name="b" type="revolute"><parent link="u"/><child link="v"/><origin xyz="1 0 0"/>
    <axis xyz="0 -1 0"/></joint>
  <link name="v"><inertial><origin xyz="0.3 0 0"/><mass value="5"/></inertial></link>
</robot>
"""


def test_two_links_by_hand():
    tree, values = UrdfTree(PENDULUM), {"a": 0.4, "b": 0.3}
    tip = tree.point(values, "v", (0.6, 0, 0))
    by_hand = [np.cos(0.4) + 0.6 * np.cos(0.7), 0, np.sin(0.4) + 0.6 * np.sin(0.7)]
    assert np.allclose(tip, by_hand, atol=1e-15)
    J = tree.jacobian(values, "v", ["a", "b"], (0.6, 0, 0))
    assert np.allclose(J[0], [-np.sin(0.4) - 0.6 * np.sin(0.7), -0.6 * np.sin(0.7)], atol=1e-12)
    assert np.allclose(J[2], [np.cos(0.4) + 0.6 * np.cos(0.7), 0.6 * np.cos(0.7)], atol=1e-12)
    assert np.allclose(J[4], -1, atol=1e-12)
    torque = tree.gravity_torque(values, ["a", "b"])
    lever = 5 * 0.3 * np.cos(0.7)
    by_hand = [9.81 * (2 * 0.5 * np.cos(0.4) + 5 * np.cos(0.4) + lever), 9.81 * lever]
    assert np.allclose(torque, by_hand, atol=1e-9)


def test_rotation_vector_inverts_rotation():
    axis = np.array([2.0, -1, 2]) / 3
    for angle in (1e-9, 1e-3, 1.0, 3.0):
        assert np.allclose(rotation_vector(rotation(axis, angle)), axis * angle, rtol=1e-7)


def test_mimics_chain_and_may_come_before_their_driver():
    tree, values = UrdfTree(mimic_tree()), {"z": 0.8, "s": 0.25}
    assert tree.independent == ["z", "s"]
    assert tree.value("m", values) == 0.5 * 0.8 + 0.1
    assert tree.value("a_last", values) == -2 * (0.5 * 0.8 + 0.1)
    slide = tree.placement(values, "f", base="e") - tree.placement(
        {**values, "s": 0}, "f", base="e"
    )
    along_x_of_joint = tree.joints["t"].origin[:3, 0] * 0.75
    assert np.allclose(slide[:3, 3], along_x_of_joint, atol=1e-12)


def test_agrees_with_mujocos_urdf_reader():
    text = six_axis_arm(seed=4)
    compiler = '<mujoco><compiler fusestatic="false"/></mujoco>'
    model = mujoco.MjModel.from_xml_string(text.replace("</robot>", compiler + "</robot>"))
    data, tree = mujoco.MjData(model), UrdfTree(text)
    rng = np.random.default_rng(0)
    for _ in range(5):
        values = dict(zip(tree.independent, rng.uniform(-2, 2, 6), strict=True))
        for name, value in values.items():
            data.qpos[model.joint(name).qposadr[0]] = value
        mujoco.mj_forward(model, data)
        tool = tree.placement(values, "tool")
        assert np.allclose(data.body("tool").xpos, tool[:3, 3], atol=1e-12)
        assert np.allclose(data.body("tool").xmat.reshape(3, 3), tool[:3, :3], atol=1e-12)
        linear, angular = np.zeros((3, 6)), np.zeros((3, 6))
        mujoco.mj_jacBody(model, data, linear, angular, data.body("tool").id)
        J = tree.jacobian(values, "tool", tree.independent)
        assert np.allclose(J, np.vstack([linear, angular]), atol=1e-10)
        torque = tree.gravity_torque(values, tree.independent)
        assert np.allclose(torque, data.qfrc_bias, atol=1e-6)
