"""The calibrated URDF stands in other programs where the model does, and keeps the user's file."""

import io
from collections.abc import Callable
from pathlib import Path

import mujoco
import numpy as np
import pinocchio as pin
import pytest
import yourdfpy
from lxml import etree

from sk120stiff.effects import effect
from sk120stiff.exports import FORMATS, Request
from sk120stiff.exports import exported as exported_with_notes
from sk120stiff.model import base_model, probing_poses
from sk120stiff.robot import Robot, load_robot
from tests.exports.arms import PUBLIC, exported, miscalibrated, public, standing, with_random
from tests.oracles.sample_urdfs import six_axis_arm

Placed = Callable[[str, Robot, np.ndarray, str], np.ndarray]


def in_pinocchio(text: str, robot: Robot, a: np.ndarray, frame: str) -> np.ndarray:
    model = pin.buildModelFromXML(text)
    data = model.createData()
    v = np.zeros(model.nv)
    for name, value in robot.joint_values(a).items():
        v[model.joints[model.getJointId(name)].idx_v] = value
    pin.framesForwardKinematics(model, data, pin.integrate(model, pin.neutral(model), v))
    base, tool = (data.oMf[model.getFrameId(name)] for name in (robot.base_frame, frame))
    return (base.inverse() * tool).homogeneous


def in_yourdfpy(text: str, robot: Robot, a: np.ndarray, frame: str) -> np.ndarray:
    loaded = yourdfpy.URDF.load(io.BytesIO(text.encode()), load_meshes=False)
    values = robot.joint_values(a)
    loaded.update_cfg({name: float(values[name]) for name in loaded.actuated_joint_names})
    return np.asarray(loaded.get_transform(frame, robot.base_frame))


def in_mujoco(text: str, robot: Robot, a: np.ndarray, frame: str) -> np.ndarray:
    root = etree.fromstring(text.encode())
    for shape in root.xpath("//visual | //collision"):
        shape.getparent().remove(shape)  # MuJoCo reads no COLLADA
    settings = {"fusestatic": "false", "boundmass": "1", "boundinertia": "1"}
    etree.SubElement(etree.SubElement(root, "mujoco"), "compiler", settings, balanceinertia="true")
    model = mujoco.MjModel.from_xml_string(etree.tostring(root).decode())
    data = mujoco.MjData(model)
    for name, value in robot.joint_values(a).items():
        data.qpos[model.joint(name).qposadr[0]] = value
    mujoco.mj_kinematics(model, data)
    T = {}
    for name in (robot.base_frame, frame):
        T[name] = np.eye(4)
        number = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, name)
        if number > 0:  # the root is the world itself
            T[name][:3, :3] = data.xmat[number].reshape(3, 3)
            T[name][:3, 3] = data.xpos[number]
    return np.linalg.inv(T[robot.base_frame]) @ T[frame]


@pytest.mark.parametrize("reader", [in_pinocchio, in_yourdfpy, in_mujoco])
@pytest.mark.parametrize("name", PUBLIC)
def test_others_place_the_unloaded_arm_where_the_model_does(name: str, reader: Placed) -> None:
    model = miscalibrated(name)
    robot = model.robot
    text = exported(model, "urdf").text
    a = np.random.default_rng(3).uniform(-1.0, 1.0, (4, robot.n))
    wanted = standing(model, a)
    nominal = robot.placement(a)
    assert np.linalg.norm((wanted - nominal)[:, :3, 3], axis=1).min() > 2e-3
    for pose, T in zip(a, wanted, strict=True):
        found = reader(text, robot, pose, f"{robot.tool_frame}_measured")
        np.testing.assert_allclose(found, T, rtol=0.0, atol=1e-9)


def test_the_tool_frame_stays_at_the_flange() -> None:
    """A marker that sits elsewhere on the tool moves no frame that programs are written for."""
    model = with_random(base_model(public("ur5_robot.urdf")), "tool_offset")
    robot, made = model.robot, exported(model, "urdf")
    again = load_robot(made.text, base=robot.base_frame, tool=robot.tool_frame)
    a = np.full(6, 0.3)
    np.testing.assert_array_equal(again.placement(a), robot.placement(a))
    offset = np.array([p.value for p in model.parameters if p.effect.name == "tool_offset"])
    there = again.placement(a, "tool0_measured")[:3, 3] - again.placement(a)[:3, 3]
    np.testing.assert_allclose(again.placement(a)[:3, :3].T @ there, offset, atol=1e-12)


def test_an_offset_moves_what_follows_the_joint_too() -> None:
    model = with_random(base_model(public("motoman_sk120")), "joint_offset:joint_3_u")
    made = exported(model, "urdf")
    again, offset = load_robot(made.text), model.values[-1]
    a = np.array([0.1, 0.2, -0.3, 0.0, 0.4, 0.0])
    for frame in ("crank_end", "link_3_u", "rod_end"):
        wanted = model.robot.placement(a + offset * np.eye(6)[2], frame)
        np.testing.assert_allclose(again.placement(a, frame), wanted, atol=1e-12)
    assert {one["joint"] for one in made.details["origins"]} == {
        "joint_3_u", "joint_crank", "joint_crank_parallel",
    }  # fmt: skip


def test_nothing_else_of_the_file_changes() -> None:
    model = with_random(base_model(public("motoman_sk120")), "joint_frame:joint_2_l")
    before = model.robot.document.path.read_text(encoding="utf-8").splitlines()
    after = exported(model, "urdf", model.robot.document.path.parent / "new.urdf").text
    end = after.index("<sk120stiff")
    gone = [line for line in before if line.strip() and line not in after[:end]]
    assert [line.strip() for line in gone if "<?xml" not in line] == [
        '<origin xyz="0.215 0 0"/><axis xyz="0 1 0"/>', "</robot>",
    ]  # fmt: skip
    assert "The parallelogram. A massless link" in after


def test_springs_and_their_source_stand_in_the_extension() -> None:
    model = with_random(
        base_model(public("motoman_sk120")), "base_rocking", "joint_offset:joint_1_s"
    )
    made = exported(model, "urdf")
    extension = etree.fromstring(made.text.encode()).find("sk120stiff")
    found = {(e.get("name"), e.get("where")): e for e in extension.iter("effect")}
    spring = found["joint_springs", "joint_2_l"]
    assert spring.get("carried") == "here"
    assert float(spring.find("parameter").get("value")) == pytest.approx(4.0076e5)
    assert spring.find("parameter").get("unit") == "N*m/rad"
    assert spring.find("parameter").get("origin")
    assert found["joint_offset", "joint_1_s"].get("carried") == "origins"
    told = {told.effect for told in made.left_out}
    assert told == {e.id for e in model.effects} - {"joint_offset:joint_1_s"}
    once_more = exported(model, "urdf").text
    again = base_model(load_robot(once_more))
    assert exported(again, "urdf").text.count("<sk120stiff") == 1


def test_masses_that_were_found_are_written() -> None:
    """Read back it weighs as much; a table, which has none, says so."""
    model = with_random(base_model(public("ur5_robot.urdf")), "link_masses")
    heavier = 1.0 + model.values[-1]
    made = exported(model, "urdf")
    assert [told.how for told in made.carried] == ["in the masses of the links"]
    again = load_robot(made.text)
    assert again.total_mass == pytest.approx(heavier * model.robot.total_mass)
    a = np.array([0.3, -0.8, 0.5, 0.2, 0.4, 0.1])
    np.testing.assert_allclose(
        again.gravity_torque(a[None]),
        heavier * model.robot.gravity_torque(a[None]),
        rtol=1e-12,
        atol=1e-12,
    )
    element = etree.fromstring(made.text.encode()).find("sk120stiff/effect[@name='link_masses']")
    assert element.get("carried") == "masses"
    for kind in ("dh", "kinematics_params"):
        told = {each.effect: each.how for each in exported(model, kind).left_out}
        assert "holds no masses" in told[model.effects[-1].id]


def test_what_no_origin_can_be_is_told_by_name() -> None:
    model = with_random(
        base_model(public("ur5_robot.urdf")),
        "transmission_error:elbow_joint", "joint_coupling:wrist_1_joint,wrist_2_joint",
        "approach_side:elbow_joint", "tracker_frame", "force_bias",
    )  # fmt: skip
    made = exported(model, "urdf")
    told = {told.effect: told.how for told in made.left_out}
    assert "changes with the pose" in told["transmission_error:elbow_joint"]
    assert "changes with the pose" in told["joint_coupling:wrist_1_joint,wrist_2_joint"]
    assert "a side of approach" in told["approach_side:elbow_joint"]
    assert "instrument" in told["tracker_frame:tracker"] and "load" in told["force_bias:sensor"]
    assert not made.carried and not made.details["origins"]


def test_how_far_the_file_stands_off_the_model_is_told() -> None:
    """Waves of a gear may be worth millimetres; the reader of the file must know."""
    model = with_random(base_model(public("ur5_robot.urdf")), "joint_frame", "tool_offset")
    exact = exported_with_notes(model, Request(Path("arm.urdf")), FORMATS["urdf"])
    assert exact.details["departure_max_m"] < 1e-12 and "moves the unloaded" not in exact.notes[0]
    waves = with_random(model, "transmission_error:shoulder_pan_joint")
    made = exported_with_notes(waves, Request(Path("arm.urdf")), FORMATS["urdf"])
    robot, a = model.robot, probing_poses(model.robot)
    file = load_robot(made.text, base=robot.base_frame, tool="tool0_measured")
    off = np.linalg.norm((file.placement(a) - standing(waves, a))[:, :3, 3], axis=1)
    assert made.details["departure_max_m"] == pytest.approx(off.max(), rel=1e-9)
    assert made.details["departure_rms_m"] == pytest.approx(np.sqrt((off**2).mean()), rel=1e-9)
    assert off.max() > 1e-4 and "moves the unloaded tool by" in made.notes[0]


def test_couplings_and_meshes_of_a_folder(tmp_path: Path) -> None:
    """Rules of robot.yaml become mimic elements; relative meshes are found from the new place."""
    text = six_axis_arm().replace(
        "</robot>",
        '<link name="finger"><visual><geometry><mesh filename="meshes/f.stl"/></geometry></visual>'
        '<visual><geometry><mesh filename="meshes/gone.stl"/></geometry></visual></link>'
        '<joint name="jf" type="revolute"><parent link="base"/><child link="finger"/>'
        '<axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>',
    )
    home = tmp_path / "home"
    (home / "meshes").mkdir(parents=True)
    (home / "meshes" / "f.stl").write_bytes(b"solid\nendsolid\n")
    (home / "arm.urdf").write_text(text)
    joints = ", ".join(f"j{k}" for k in range(1, 7))
    (home / "robot.yaml").write_text(
        f"urdf: arm.urdf\nactuated: [{joints}]\n"
        "couplings: {jf: {driver: j2, multiplier: -0.5, offset: 0.1}}\n"
    )
    robot = load_robot(home)
    added = effect(robot, "joint_offset", "j2")
    model = base_model(robot) + added
    model = model.with_values(np.array([*model.values[:-1], 0.01]))
    made = exported(model, "urdf", tmp_path / "out" / "arm.urdf")
    root = etree.fromstring(made.text.encode())
    assert [m.get("filename") for m in root.iter("mesh")] == [
        "../home/meshes/f.stl", "meshes/gone.stl",
    ]  # fmt: skip
    assert made.details["meshes_missing"] == ["meshes/gone.stl"]
    again = load_robot(made.text, tool="finger", actuated=["j2"])
    wanted = robot.placement([0.0, 0.41, 0.0, 0.0, 0.0, 0.0], "finger")
    np.testing.assert_allclose(again.placement([0.4], "finger"), wanted, atol=1e-12)
