"""The bundled SK120's geometry against the paper's closed forms, without the product's code."""

import itertools
import xml.etree.ElementTree as ET

import numpy as np
import pinocchio as pin
import pytest

from tests.oracles.mujoco_sk120 import REFLECTOR, sk120_statics
from tests.oracles.numpy_kinematics import UrdfTree, transform
from tests.oracles.table2_reference import ROBOT, jacobian, reach

URDF = ROBOT / "sk120.urdf"
ACTUATED = ["joint_1_s", "joint_2_l", "joint_3_u", "joint_4_r", "joint_5_b", "joint_6_t"]
TREE = UrdfTree(URDF)

# The whole range of joints 2 and 3, ends included; joint 1 turns the plane, so a few values do.
GRID = [
    np.array(pose)
    for pose in itertools.product(
        np.radians([-180, -40, 65, 180]),
        np.radians(np.linspace(-70, 70, 9)),
        np.radians(np.linspace(-115, 35, 11)),
    )
]


def readings(*angles: float) -> dict[str, float]:
    return dict(zip(ACTUATED, [*angles, *[0.0] * 6], strict=False))


def world(r: float, z: float, t1: float) -> np.ndarray:
    return np.array([r * np.cos(t1), r * np.sin(t1), z])


def test_actuated_joints_and_links():
    assert TREE.independent == ACTUATED
    links = ["link_1_s", "link_2_l", "link_3_u", "link_4_r", "link_5_b", "link_6_t"]
    assert [TREE.joints[name].child for name in ACTUATED] == links
    assert TREE.root == "base_link"
    assert {"tool0", "reflector"} <= set(TREE.links)


def test_no_mass_is_invented():
    root = ET.parse(URDF).getroot()
    assert root.findall(".//inertial") == []
    limits = [
        joint.find("limit") for joint in root.findall("joint") if joint.get("type") != "fixed"
    ]
    assert {(x.get("effort"), x.get("velocity")) for x in limits} == {("0", "0")}


def test_published_limits():
    limits = {
        joint.get("name"): [float(joint.find("limit").get(end)) for end in ("lower", "upper")]
        for joint in ET.parse(URDF).getroot().findall("joint")
        if joint.get("name") in ACTUATED[:3]
    }
    assert np.allclose(np.degrees(limits["joint_1_s"]), [-180, 180], atol=1e-12)
    assert np.allclose(np.degrees(limits["joint_2_l"]), [-70, 70], atol=1e-12)
    assert np.allclose(np.degrees(limits["joint_3_u"]), [-115, 35], atol=1e-12)


def test_loop_closes_over_the_whole_range():
    for pose in GRID:
        values = readings(*pose)
        gap = TREE.point(values, "rod_end") - TREE.point(values, "forearm_lever_end")
        assert np.max(np.abs(gap)) < 1e-12


def test_five_bar_lengths_and_angles():
    for pose in GRID[::7]:
        values = readings(*pose)
        shoulder, elbow = TREE.point(values, "link_2_l"), TREE.point(values, "link_3_u")
        start, end = TREE.point(values, "crank_end"), TREE.point(values, "rod_end")
        assert np.linalg.norm(start - shoulder) == pytest.approx(0.542, abs=1e-12)
        assert np.linalg.norm(end - elbow) == pytest.approx(0.542, abs=1e-12)
        assert np.allclose(end - start, elbow - shoulder, atol=1e-12)
        # the crank is antiparallel to the forearm: it points to the rear
        ahead = TREE.placement(values, "link_3_u")[:3, 0]
        assert np.allclose(start - shoulder, -0.542 * ahead, atol=1e-12)


def test_reach_and_height_follow_the_closed_forms():
    for pose in GRID:
        values, (t1, t2, t3) = readings(*pose), pose
        for link, ahead in (("link_4_r", 0.0), ("tool0", 230.0)):
            r, z = reach(t2, t3, ahead)
            expected = world(r, z, t1) / 1e3
            assert np.allclose(TREE.point(values, link), expected, atol=1e-12)


def test_wrist_angle_adds_to_the_elevation():
    for pose, t5 in itertools.product(GRID[::23], np.radians([-130, -40, 25])):
        values, (t1, t2, t3) = readings(*pose, 0.0, t5), pose
        r, z = reach(t2, t3, 0.0)
        tool = 230 * np.array([np.cos(t3 + t5), np.sin(t3 + t5)])
        expected = world(r + tool[0], z + tool[1], t1) / 1e3
        assert np.allclose(TREE.point(values, "tool0"), expected, atol=1e-12)


def test_jacobian_of_the_flange():
    for pose in GRID[::19]:
        J = TREE.jacobian(readings(*pose), "tool0", ACTUATED)
        assert np.allclose(J[:3, :3], jacobian(pose) / 1e3, atol=1e-10)


def test_joint_3_is_the_absolute_elevation():
    for pose in GRID:
        t1, _, t3 = pose
        ahead = TREE.placement(readings(*pose), "link_3_u")[:3, 0]
        assert np.allclose(ahead, world(np.cos(t3), np.sin(t3), t1), atol=1e-12)


def test_signs_of_the_other_joints():
    assert TREE.point(readings(0.1), "tool0")[1] > 0  # about z, up
    assert TREE.point(readings(0, 0.1), "link_3_u")[0] > 0.215  # leans forward
    raised = TREE.point(readings(0, 0, 0, 0, 0.1), "tool0") - TREE.point(readings(), "tool0")
    assert raised[2] > 0
    # about the outward axis: y of the tool, which is left at zero, goes up
    for index in (3, 5):
        angles = [0.0] * 6
        angles[index] = 0.1
        assert TREE.placement(readings(*angles), "tool0")[2, 1] > 0


def test_tool_frame_at_zero():
    tool = TREE.placement(readings(), "tool0")
    assert np.allclose(tool[:3, 2], [1, 0, 0], atol=1e-12)  # out of the flange
    assert np.allclose(tool[:3, 0], [0, 0, -1], atol=1e-12)  # down
    assert np.allclose(tool[:3, 3], [0.215 + 1.3 + 0.23, 0, 1.1 + 0.25], atol=1e-12)


def test_tool_points_straight_down_at_every_printed_pose():
    printed = [
        (-33.2004, 15.9, -55.5957, 0, -34.4045, -90),
        (32.5391, 32.4702, -19.0085, 0, -70.9913, -90),
        (91.0686, 29.4383, 12.7021, 0, -102.702, 90),
        (-167.4226, -47.8021, -20.7957, 0, -69.2041, 90),
    ]
    for pose in printed:
        out = TREE.placement(readings(*np.radians(pose)), "tool0")[:3, 2]
        assert np.allclose(out, [0, 0, -1], atol=1e-5)


def test_reflector_lies_where_the_paper_puts_it():
    offset = TREE.placement({}, "reflector", base="tool0")[:3, 3]
    assert np.allclose(offset, REFLECTOR, atol=1e-15)
    ahead, _, up = TREE.point(readings(), "reflector") - TREE.point(readings(), "tool0")
    assert np.allclose([ahead, up], [0.11265, 0.20532], atol=1e-12)


def test_same_pose_as_the_closed_loop_of_bodies():
    rng = np.random.default_rng(5)
    for _ in range(10):
        angles = np.radians(
            rng.uniform([-180, -70, -115, -180, -130, -180], [180, 70, 35, 180, 130, 180])
        )
        statics = sk120_statics(angles, point=REFLECTOR)
        unloaded = statics.deflection(np.zeros(6), statics.relaxed).unloaded
        here = TREE.placement(readings(*angles), "tool0") @ transform(REFLECTOR)
        assert np.allclose(unloaded, here, atol=1e-12)


def test_pinocchio_reads_the_same_robot():
    model = pin.buildModelFromUrdf(str(URDF))
    data, rng = model.createData(), np.random.default_rng(0)
    assert model.nq == model.nv == 10
    for _ in range(5):
        values = readings(*rng.uniform(-2, 2, 6))
        q = np.array([TREE.value(name, values) for name in list(model.names)[1:]])
        pin.framesForwardKinematics(model, data, q)
        for frame in ("tool0", "reflector", "rod_end", "forearm_lever_end", "link_5_b"):
            assert model.existFrame(frame)
            placement = data.oMf[model.getFrameId(frame)].homogeneous
            assert np.allclose(placement, TREE.placement(values, frame), atol=1e-12)


def test_coupling_of_the_wrong_sign_opens_the_loop():
    text = URDF.read_text(encoding="utf-8")
    for coupling in ('joint_2_l" multiplier="-1"', 'joint_3_u" multiplier="-1"'):
        assert coupling in text
        broken = UrdfTree(text.replace(coupling, coupling.replace("-1", "1")))
        values = readings(0.1, 0.3, -0.4)
        gap = broken.point(values, "rod_end") - broken.point(values, "forearm_lever_end")
        assert np.linalg.norm(gap) > 1e-2
