"""Exported arms come to rest in MuJoCo where the model does, at any command, under any load."""

from pathlib import Path

import mujoco
import numpy as np
import pinocchio as pin
import pytest

from sk120stiff.effects import CATALOGUE, effect, load_case
from sk120stiff.effects.options import Options
from sk120stiff.errors import InputError
from sk120stiff.exports import export
from sk120stiff.model import Model, base_model, joint_spring_model
from sk120stiff.robot import load_robot
from sk120stiff.robot.anatomy import sample_poses
from sk120stiff.robot.visuals import visuals
from tests.exports.arms import exported, public, with_random
from tests.oracles.sample_urdfs import mimic_tree, six_axis_arm
from tests.robot.loop_arms import four_bar
from tests.workspace.test_arm import sk120_with, with_effect

POSE = np.array([0.4, 0.35, -0.5, 0.3, -0.9, 0.2])
WRENCH = np.array([300.0, -250.0, -400.0, 30.0, -20.0, 10.0])


def loaded(model: Model, folder: Path, **request: object) -> mujoco.MjModel:
    export(model, folder / "arm.xml", **request)
    return mujoco.MjModel.from_xml_path(str(folder / "arm.xml"))


def settled(
    arm: mujoco.MjModel, site: str, command: np.ndarray, wrench: np.ndarray, steps: int = 6000
) -> np.ndarray:
    """Position of a site at rest under a wrench that acts there; time is stepped from the key."""
    data = mujoco.MjData(arm)
    mujoco.mj_resetDataKeyframe(arm, data, 0)
    data.ctrl[:] = command
    number = arm.site(site).id
    for step in range(steps):
        mujoco.mj_kinematics(arm, data)
        mujoco.mj_comPos(arm, data)
        data.qfrc_applied[:] = 0.0
        mujoco.mj_applyFT(
            arm, data, wrench[:3], wrench[3:], data.site_xpos[number],
            arm.site_bodyid[number], data.qfrc_applied,
        )  # fmt: skip
        mujoco.mj_step(arm, data)
        if step % 50 == 49 and np.abs(data.qvel).max() < 1e-9:
            break
    assert np.abs(data.qvel).max() < 1e-8
    mujoco.mj_kinematics(arm, data)
    return data.site_xpos[number].copy()


def resting(model: Model, a: np.ndarray, wrench: np.ndarray) -> np.ndarray:
    """(3,) where the model says that the loaded tool stands."""
    load_cases = load_case(model.robot, a, wrench)
    return model.physical().solve(load_cases).rest.screws.position[0]


def heavy(name: str) -> Model:
    model = base_model(public(name))
    robot = model.robot
    base = robot.base_frame
    for each in (f"joint_tilt:{robot.actuated[1]}", f"base_rocking:{base}",
                 f"base_sliding:{base}", f"tool_compliance:{robot.tool_frame}"):  # fmt: skip
        model = with_effect(model, each)
    return with_random(model, "joint_frame", "joint_offset")


MODELS = {
    "springs": sk120_with,
    "tilt, base and tool": lambda: sk120_with(
        "joint_tilt:joint_2_l", "base_rocking:base_link", "base_sliding:base_link",
        "tool_compliance:tool0",
    ),
    "beams that a linkage passes on": lambda: sk120_with(
        "link_bending:link_2_l", "link_bending:link_3_u"
    ),
    "coupled through the linkage": lambda: sk120_with("closure_coupling:joint_2_l,joint_3_u"),
    "wrong geometry": lambda: with_random(
        sk120_with("joint_tilt:joint_3_u"), "joint_offset", "joint_frame", "link_length",
        "tool_offset",
    ),
    "UR5 under its weight": lambda: heavy("ur5_robot.urdf"),
    "Panda under its weight": lambda: heavy("panda.urdf"),
}  # fmt: skip


@pytest.mark.parametrize("name", MODELS)
def test_at_rest_at_ten_commands(name: str, tmp_path: Path) -> None:
    """One file, driven to ten poses by its actuators; 1 µm was asked for."""
    model = MODELS[name]()
    robot = model.robot
    a = sample_poses(robot, 10, seed=4)
    arm = loaded(model, tmp_path)
    site = arm.site(0).name  # the measured point, where the model knows one
    wrench = WRENCH * (0.2 if "weight" in name else 1.0)
    for k, pose in enumerate(a):
        found = settled(arm, site, pose, wrench if k % 2 else -wrench)
        wanted = resting(model, pose, wrench if k % 2 else -wrench)
        np.testing.assert_allclose(found, wanted, rtol=0.0, atol=1e-7)
    bent = np.linalg.norm(wanted - robot.placement(a[-1])[:3, 3])
    assert bent > 3e-4


@pytest.mark.parametrize("heavier", [0.0, 0.4])
def test_the_weight_alone_bends_an_arm(tmp_path: Path, heavier: float) -> None:
    """That of the URDF, or another that was found."""
    model = joint_spring_model(load_robot(six_axis_arm(seed=2)), [2e5, 2e5, 1e5, 5e4, np.inf, 3e4])
    model = model + effect(model.robot, "link_masses", model.robot.base_frame)
    model = model.with_values(np.array([*model.values[:-1], heavier]))
    arm = loaded(model, tmp_path, pose=POSE)
    found = settled(arm, "tool", POSE, np.zeros(6), steps=20_000)
    np.testing.assert_allclose(found, resting(model, POSE, np.zeros(6)), atol=1e-7)
    assert np.linalg.norm(found - model.robot.placement(POSE)[:3, 3]) > 1e-3
    assert arm.body_mass[arm.body_gravcomp == 0.0].sum() == pytest.approx(
        (1.0 + heavier) * model.robot.mechanism().chain.masses.sum()
    )


def test_inertia_is_that_of_the_links(tmp_path: Path) -> None:
    """Kinetic energy of the free tree against the robot's own mass matrix, by Pinocchio."""
    robot = load_robot(six_axis_arm(seed=6))
    model = joint_spring_model(robot, np.full(6, 1e5))
    arm = loaded(model, tmp_path, pose=POSE)
    data = mujoco.MjData(arm)
    mujoco.mj_resetDataKeyframe(arm, data, 0)
    mujoco.mj_forward(arm, data)
    M = np.zeros((arm.nv, arm.nv))
    mujoco.mj_fullM(arm, data, M)
    motors = [arm.joint(name).dofadr[0] for name in robot.actuated]
    gears = [arm.joint(f"{name}.spring").dofadr[0] for name in robot.actuated]
    built = pin.buildModelFromXML(robot.document.xml)
    wanted = pin.crba(built, built.createData(), POSE)
    wanted = np.triu(wanted) + np.triu(wanted, 1).T
    np.testing.assert_allclose(M[np.ix_(motors, gears)], wanted, rtol=1e-4, atol=1e-2)


def test_other_frames_and_slides(tmp_path: Path) -> None:
    model = sk120_with()
    arm = loaded(model, tmp_path, pose=POSE, frame="reflector")
    robot = model.robot
    point = (np.linalg.inv(robot.placement(POSE)) @ robot.placement(POSE, "reflector"))[:3, 3]
    expected = model.deflect(POSE[None], WRENCH[None], point=point)[0]
    moved = settled(arm, "reflector", POSE, WRENCH) - robot.placement(POSE, "reflector")[:3, 3]
    np.testing.assert_allclose(moved, expected, atol=1e-7)

    slides = joint_spring_model(load_robot(mimic_tree()), [3e5, 1e7])
    pose = np.array([0.3, 0.1])
    arm = loaded(slides, tmp_path, pose=pose)
    moved = settled(arm, "e", pose, WRENCH) - slides.robot.placement(pose)[:3, 3]
    np.testing.assert_allclose(moved, slides.deflect(pose[None], WRENCH[None])[0], atol=1e-7)


def driven_from_the_side() -> str:
    """Joint j2 of a slanting, heavy arm mimics a motor that sits beside the chain; j4 slides."""

    def joint(name: str, ends: str, axis: str, more: str = "", kind: str = "revolute") -> str:
        parent, child = ends
        return (
            f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
            f'<origin xyz="0.3 0.1 0.4" rpy="0.1 -0.2 0.3"/><axis xyz="{axis}"/>'
            f'<limit lower="-2" upper="2" effort="1" velocity="1"/>{more}</joint>'
        )

    heavy = "".join(
        f'<link name="{name}"><inertial><origin xyz="0.1 0 0.1"/><mass value="20"/><inertia '
        'ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
        for name in "abcdm"
    )
    return (
        '<robot name="side"><link name="world"/><link name="o"/><link name="t"/>'
        '<joint name="up" type="fixed"><parent link="world"/><child link="o"/>'
        f'<origin xyz="0 0 1" rpy="0.4 0 0"/></joint>{heavy}'
        + joint("j1", "oa", "0 0 1")
        + joint("motor", "am", "0 1 0")
        + joint("j2", "ab", "0 1 0", '<mimic joint="motor" multiplier="-0.5" offset="0.2"/>')
        + joint("j3", "bc", "1 0 0")
        + joint("j4", "cd", "0 0 1", kind="prismatic")
        + '<joint name="tool" type="fixed"><parent link="d"/><child link="t"/>'
        '<origin xyz="0 0 0.3" rpy="0 0.7 0"/></joint></robot>'
    )


def test_commands_have_the_order_of_the_actuated_joints(tmp_path: Path) -> None:
    robot = load_robot(
        driven_from_the_side(), base="o", tool="t", actuated=["j3", "motor", "j4", "j1"]
    )
    model = with_random(joint_spring_model(robot, [1e5, 2e5, 1e6, 1e5]), "joint_offset")
    model = with_effect(model, "joint_tilt:j3")
    arm = loaded(model, tmp_path)
    assert [arm.actuator(k).name for k in range(arm.nu)] == list(robot.actuated)
    for pose in np.random.default_rng(8).uniform(-1.0, 1.0, (2, 4)):
        found = settled(arm, "t", pose, 0.3 * WRENCH)
        np.testing.assert_allclose(found, resting(model, pose, 0.3 * WRENCH), atol=1e-7)


@pytest.mark.parametrize("name", ["ur5_robot.urdf", "panda.urdf", "motoman_sk120"])
def test_it_has_the_users_shapes_and_frames(name: str, tmp_path: Path) -> None:
    model = base_model(public(name))
    robot = model.robot
    arm = loaded(model, tmp_path)
    assert arm.ngeom == len(visuals(robot).shapes) > 5
    data = mujoco.MjData(arm)
    data.qpos[:] = arm.key_qpos[0]
    mujoco.mj_kinematics(arm, data)
    rest = robot.rest
    for frame in (robot.tool_frame, robot.document.root, *[j.child for j in robot.document.joints]):
        try:
            wanted = robot.placement(rest, frame)
        except InputError:  # not carried by the base frame
            continue
        np.testing.assert_allclose(data.body(frame).xpos, wanted[:3, 3], atol=1e-9)
        found = data.body(frame).xmat.reshape(3, 3)
        np.testing.assert_allclose(found, wanted[:3, :3], atol=1e-9)


def test_a_missing_mesh_costs_its_shape_alone(tmp_path: Path) -> None:
    text = six_axis_arm().replace(
        '<link name="link_2">',
        '<link name="link_2"><visual><geometry><mesh filename="gone.stl"/></geometry></visual>'
        '<visual><geometry><box size="1 2 3"/></geometry></visual>',
    )
    model = base_model(load_robot(text))
    made = exported(model, "mjcf", tmp_path / "arm.xml")
    assert any("gone.stl" in note for note in made.notes)
    assert loaded(model, tmp_path).ngeom == 1


def test_it_can_be_driven(tmp_path: Path) -> None:
    """A ramp of all commands under a load: the tool goes along, and ends where it should."""
    model = sk120_with("base_rocking:base_link")
    robot = model.robot
    arm = loaded(model, tmp_path, pose=POSE)
    data = mujoco.MjData(arm)
    mujoco.mj_resetDataKeyframe(arm, data, 0)
    site, goal, time = arm.site("tool0").id, POSE + 0.1, 2.0
    far = 0.0
    for step in range(4000):
        share = min(step * arm.opt.timestep / time, 1.0)
        data.ctrl[:] = POSE + share * (goal - POSE)
        mujoco.mj_step(arm, data)
        wanted = robot.placement(data.ctrl)[:3, 3]
        far = max(far, np.linalg.norm(data.site_xpos[site] - wanted))
    assert 1e-4 < far < 3e-3  # it moves at 0.2 m/s, 4 ms behind the command
    np.testing.assert_allclose(data.site_xpos[site], robot.placement(goal)[:3, 3], atol=1e-7)


def test_what_springs_cannot_be_is_told() -> None:
    model = sk120_with(
        "closure_rod:rod", "gravity_compensator:joint_2_l", "gear_hardening:joint_3_u",
        "lost_motion:joint_2_l", "friction_hysteresis:joint_2_l", "force_scale:sensor",
    )  # fmt: skip
    made = exported(model, "mjcf", pose=POSE)
    told = {told.effect: told.how for told in made.left_out}
    assert "with the pose" in told["closure_rod:rod"]
    assert "with the pose" in told["gravity_compensator:joint_2_l"]
    assert "with the load" in told["gear_hardening:joint_3_u"]
    assert "jumps" in told["lost_motion:joint_2_l"]
    assert "instrument" in told["force_scale:sensor"]
    assert {e.id for e in model.effects} == {t.effect for t in (*made.carried, *made.left_out)}
    header = made.text[: made.text.index("<compiler")]
    assert all(name in header for name in told)


def test_what_yields_under_load_alone_is_no_spring() -> None:
    names = [f"stiffness_{axis}_at_{load}" for load in (0, 9000) for axis in "xy"]
    rocks = CATALOGUE["base_rocking"].at(
        (arm := sk120_with()).robot, "base_link", Options(shape=tuple(names))
    )
    later = {f"{rocks.id}.stiffness_x_at_9000": 1e7}
    made = exported((arm + rocks).with_public(later), "mjcf", pose=POSE)
    assert rocks.id not in {told.effect for told in made.carried}
    assert "with the load" in {told.effect: told.how for told in made.left_out}[rocks.id]


def test_a_compliance_that_goes_with_the_pose_is_right_at_the_pose(tmp_path: Path) -> None:
    model = sk120_with("closure_rod:rod")
    arm = loaded(model, tmp_path, pose=POSE)
    found = settled(arm, "tool0", POSE, WRENCH)
    np.testing.assert_allclose(found, resting(model, POSE, WRENCH), atol=1e-7)


def test_what_cannot_be_exported_is_refused(tmp_path: Path) -> None:
    robot = four_bar(tmp_path)
    with pytest.raises(InputError, match="closed loop"):
        exported(joint_spring_model(robot, np.full(robot.n, 3e5)), "mjcf")
    with pytest.raises(InputError, match="yields"):
        exported(Model(load_robot("motoman_sk120")), "sdf")
