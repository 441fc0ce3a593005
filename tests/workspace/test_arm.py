"""The arm that a model describes, against `loaded_stiffness` at single poses."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sk120stiff.effects import effect, load_case
from sk120stiff.errors import InputError
from sk120stiff.model import Model, base_model, joint_spring_model, loaded_stiffness
from sk120stiff.robot import load_robot
from sk120stiff.stiffness import CLASSES, COMPILED, ConstantCompliance
from sk120stiff.workspace import STATUS, Axis, Grid, JointGrid, MapJob, elastic_arm
from tests.oracles.sample_urdfs import six_axis_arm
from tests.robot.loop_arms import four_bar
from tests.workspace.arms import LOADS

POSES = np.random.default_rng(6).uniform([-2, -1, -1.8, -2, -2, -2], [2, 1, 0.5, 2, 2, 2], (9, 6))


def sk120_with(*names: str) -> Model:
    """The paper's springs and more effects, at sizes that show."""
    robot = load_robot("motoman_sk120")
    model = base_model(robot)
    assert model is not None
    for name in names:
        model = with_effect(model, name)
    return model


def with_effect(model: Model, name: str) -> Model:
    kind, _, where = name.partition(":")
    added = effect(model.robot, kind, where)
    model = model + added
    values = model.values.copy()
    values[-len(added.parameters) :] = [spec.typical for spec in added.parameters]
    return model.with_values(values)


MODELS = {
    "springs": (),
    "tilt and base": ("joint_tilt:joint_2_l", "base_rocking:base_link", "base_sliding:base_link"),
    "beam": ("link_bending:link_2_l",),
    "coupled": ("closure_coupling:joint_2_l,joint_3_u",),
    "offset": ("joint_offset:joint_2_l",),
    "rod": ("closure_rod:rod",),
}


@pytest.mark.parametrize("names", MODELS.values(), ids=MODELS)
@pytest.mark.parametrize("frame", [None, "reflector", "link_4_r"])
def test_stiffness_is_that_of_the_model(names: tuple[str, ...], frame: str | None) -> None:
    model = sk120_with(*names)
    arm = elastic_arm(model, frame=frame)
    found = arm.batch(POSES, LOADS[:, None], COMPILED)
    for number, load in enumerate(LOADS):
        for k, a in enumerate(POSES):
            one = loaded_stiffness(model, a, load, frame)
            compliance = one.compliance_enhanced[:3, :3]
            np.testing.assert_allclose(
                found.of("compliance")[number, k],
                compliance,
                atol=1e-11 * np.abs(compliance).max(),
            )
            K_class = CLASSES[found.of("stiffness_class")[number, k]]
            assert K_class == one.definiteness_of_K_theta_minus_K_C
            assert found.of("critical")[number, k] == pytest.approx(one.critical_factor, rel=1e-6)
    offset = arm.elastic.start(np.zeros((1, arm.n)))[0, : arm.n]
    where = model.robot.placement(POSES + offset, frame)
    there = arm.kinematics(POSES)
    np.testing.assert_allclose(there.position, where[:, :3, 3], atol=1e-12)
    np.testing.assert_allclose(there.rotation, where[:, :3, :3], atol=1e-12)
    np.testing.assert_allclose(found.of("position"), where[:, :3, 3], atol=1e-12)


def test_a_rod_makes_the_compliance_change_with_the_pose() -> None:
    assert not elastic_arm(sk120_with("closure_rod:rod")).compiled
    assert elastic_arm(sk120_with("link_bending:link_2_l")).compiled


def test_a_point_of_a_frame() -> None:
    model = sk120_with()
    point = np.array([0.1, -0.2, 0.3])
    for frame in ("tool0", "reflector", "link_4_r"):
        there = elastic_arm(model, frame=frame, point=point).kinematics(POSES)
        where = model.robot.placement(POSES, frame, point)
        np.testing.assert_allclose(there.position, where[:, :3, 3], atol=1e-12)


def test_closed_loops_are_followed(tmp_path: Path) -> None:
    robot = four_bar(tmp_path)
    model = joint_spring_model(robot, np.full(robot.n, 3e5))
    arm = elastic_arm(model)
    a = np.linspace(-0.2, 0.2, 5)[:, None] * np.ones(robot.n)
    found = arm.batch(a, LOADS[0], ("compliance", "condition", "position"))
    for k in range(5):
        one = loaded_stiffness(model, a[k], LOADS[0])
        expected = one.compliance_enhanced[:3, :3]
        np.testing.assert_allclose(
            found.of("compliance")[k], expected, atol=1e-11 * np.abs(expected).max()
        )
    np.testing.assert_allclose(arm.kinematics(a).position, found.of("position"), atol=1e-12)
    # far away the loop opens: such points of a map have no values, and it says why
    axis = Axis("drive", np.linspace(-3.0, 3.0, 41))
    job = MapJob(arm, JointGrid(Grid((axis,)), np.zeros(arm.n)), LOADS)
    values = job.compute(0, 41)
    opened = values["status"] == STATUS.index("a closed loop cannot be closed")
    poses = np.zeros((41, arm.n))
    poses[:, arm.joints.index("drive")] = axis.values
    np.testing.assert_array_equal(opened, ~robot.closes(poses))
    assert 0 < opened.sum() < 41
    assert (np.isnan(values["minimum_stiffness"]) == opened).all()


@pytest.mark.parametrize("extra", [(), ("link_bending:link_2", "joint_tilt:j1")])
def test_a_heavy_arm_sags_before_the_load_comes(extra: tuple[str, ...]) -> None:
    robot = load_robot(six_axis_arm())
    assert robot.total_mass > 100.0
    model = joint_spring_model(robot, np.full(6, 5e4))  # soft, so that it shows
    for name in extra:
        model = with_effect(model, name)
    arm = elastic_arm(model)
    assert arm.compiled
    assert isinstance(arm.elastic, ConstantCompliance) and arm.elastic.gravity is not None
    found = arm.batch(POSES, LOADS[:, None], ("compliance", "position"))
    straight = arm.kinematics(POSES)
    np.testing.assert_allclose(straight.position, robot.placement(POSES)[:, :3, 3], atol=1e-12)
    assert np.abs(straight.position - found.of("position")).max() > 1e-3
    for number, load in enumerate(LOADS):
        for k, a in enumerate(POSES):
            expected = loaded_stiffness(model, a, load).compliance_enhanced[:3, :3]
            ours = found.of("compliance")[number, k]
            np.testing.assert_allclose(ours, expected, atol=1e-10 * np.abs(expected).max())
    load_cases = load_case(robot, POSES, np.zeros(6))
    rest = model.solve(load_cases).rest.screws.position
    np.testing.assert_allclose(found.of("position"), rest, atol=1e-12)


def test_an_arm_that_hangs_on_soft_springs_has_numbers_too() -> None:
    """Its weight pulls it back harder than its springs do."""
    model = joint_spring_model(load_robot(six_axis_arm()), np.full(6, 400.0))
    arm, hanging = elastic_arm(model), np.array([[0.3, 2.9, -0.1, 0.4, 0.2, -0.3]])
    found = arm.batch(hanging, LOADS[0], ("compliance", "critical", "K_gravity"))
    expected = loaded_stiffness(model, hanging[0], LOADS[0])
    assert arm.compiled
    np.testing.assert_allclose(
        found.of("compliance")[0], expected.compliance_enhanced[:3, :3], rtol=1e-8, atol=1e-9
    )
    assert found.of("critical")[0] == pytest.approx(expected.critical_factor, rel=1e-8)
    assert np.linalg.eigvalsh(found.of("K_gravity")[0])[0] < -400.0


def test_springs_too_soft_for_the_weight_give_no_numbers() -> None:
    robot = load_robot(six_axis_arm())
    arm = elastic_arm(joint_spring_model(robot, np.full(6, 5e4)))
    soft = replace(arm, elastic=replace(arm.elastic, compliance=np.diag(np.full(6, 1.0 / 30.0))))
    found = soft.batch(POSES, LOADS[0], ("values", "stiffness_class"))
    lost = np.isnan(found.of("values")).all(axis=1)
    assert lost.any()
    assert (found.of("stiffness_class")[lost] == 255).all()


def test_what_does_not_yield_is_refused() -> None:
    with pytest.raises(InputError, match="yields"):
        elastic_arm(Model(load_robot("motoman_sk120")))
    with pytest.raises(InputError, match="base_link: no joint moves this frame"):
        elastic_arm(sk120_with(), frame="base_link")
    with pytest.raises(InputError, match="no_such"):
        elastic_arm(sk120_with(), frame="no_such")
    with pytest.raises(InputError, match="three finite"):
        elastic_arm(sk120_with(), point=[0.0, np.nan, 0.0])
