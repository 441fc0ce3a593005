"""`loaded_stiffness` for models of more than joint springs, against what the model itself does."""

import warnings

import numpy as np
import pytest

from sk120stiff.effects import CATALOGUE, effect
from sk120stiff.effects.options import Options
from sk120stiff.errors import InputError, ToolkitWarning
from sk120stiff.model import Model, joint_spring_model, loaded_stiffness, model_compliance
from sk120stiff.robot import load_robot
from sk120stiff.stiffness import Definiteness, under_load
from sk120stiff.workspace import elastic_arm
from tests.oracles.sample_urdfs import six_axis_arm

POSE = np.deg2rad([10.0, 20.0, -30.0, 40.0, 50.0, 60.0])
SPRINGS = np.array([1.4e6, 4.0e5, 9.4e5, 1.0e5, 8.0e4, 5.0e4])


@pytest.fixture(scope="module")
def six_springs() -> Model:
    return joint_spring_model(load_robot("motoman_sk120"), SPRINGS)


@pytest.fixture(scope="module")
def soft_tool(six_springs: Model) -> Model:
    tool = effect(six_springs.robot, "tool_compliance", "tool0")
    typical = {"N*m/rad": 3e4, "N/m": 5e6}
    values = {f"{tool.id}.{spec.name}": typical[spec.unit] for spec in tool.parameters}
    return (six_springs + tool).with_public(**values)


def small_loads(model: Model, frame: str | None, size: float) -> np.ndarray:
    """(3, 6) displacement of the frame's origin per wrench, by central differences."""
    T_base_tool = model.robot.placement(POSE)
    T_base_frame = model.robot.placement(POSE, frame)
    point = (np.linalg.inv(T_base_tool) @ T_base_frame)[:3, 3]
    loads = size * np.eye(6)
    poses = np.tile(POSE, (6, 1))
    up, down = (model.deflect(poses, sign * loads, point=point) for sign in (1, -1))
    return (up - down).T / (2.0 * size)


@pytest.mark.parametrize("name", ["six_springs", "soft_tool"])
@pytest.mark.parametrize("frame", [None, "reflector"])
def test_the_compliance_is_what_small_loads_show(
    request: pytest.FixtureRequest, name: str, frame: str | None
) -> None:
    model: Model = request.getfixturevalue(name)
    found = loaded_stiffness(model, POSE, np.zeros(6), frame)
    seen = small_loads(model, frame, 1.0)
    np.testing.assert_allclose(found.compliance_conventional[:3], seen, rtol=1e-6, atol=1e-12)


@pytest.mark.parametrize("stiffness", [5e4, 400.0], ids=["sags", "hangs"])
def test_the_weight_of_the_arm_is_a_load_too(stiffness: float) -> None:
    """Small loads on a heavy arm: exact equilibria give the enhanced compliance, not K_θ's own.

    At 400 N·m/rad the weight more than doubles the stiffness of the arm, which hangs down.
    """
    model = joint_spring_model(load_robot(six_axis_arm()), np.full(6, stiffness))
    hanging = np.array([0.3, 2.9, -0.1, 0.4, 0.2, -0.3])
    point, load = np.array([0.1, -0.2, 0.1]), np.eye(6)
    up, down = (model.deflect(np.tile(hanging, (6, 1)), s * load, point=point) for s in (1, -1))
    seen = 0.5 * (up - down).T  # (3, 6)
    arm = model_compliance(model, None, point)
    want = ("compliance_enhanced", "compliance_conventional", "K_gravity", "critical")
    found = under_load(arm, hanging, np.zeros(6), want)
    size = np.abs(seen[:, :3]).max()
    np.testing.assert_allclose(found.compliance_enhanced[:3], seen, rtol=1e-5, atol=1e-5 * size)
    assert np.abs(found.compliance_conventional[:3] - seen).max() > 1e-3 * size
    one = loaded_stiffness(model, hanging, np.zeros(6))
    np.testing.assert_allclose(one.K_gravity, found.K_gravity, rtol=1e-12, atol=1e-9)


def test_a_column_bears_less_by_its_own_weight() -> None:
    """K = 1000 N·m/rad, 1 m, 20 kg half way up: K − m g L/2 over L is left for the load."""
    text = (
        '<robot name="column"><link name="ground"/><link name="bar"><inertial>'
        '<origin xyz="0 0 0.5"/><mass value="20"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0"'
        ' iyz="0"/></inertial></link><link name="tip"/><joint name="hinge" type="revolute">'
        '<parent link="ground"/><child link="bar"/><axis xyz="0 1 0"/><limit lower="-2" upper="2" '
        'effort="1" velocity="1"/></joint><joint name="end" type="fixed"><parent link="bar"/>'
        '<child link="tip"/><origin xyz="0 0 1"/></joint></robot>'
    )
    model = joint_spring_model(load_robot(text), [1000.0])
    found = loaded_stiffness(model, [0.0], [0.0, 0.0, -100.0, 0.0, 0.0, 0.0])
    left = 1000.0 - 20.0 * 9.80665 * 0.5
    assert found.critical_factor == pytest.approx(left / 100.0, rel=1e-9)
    assert found.principal.values[0] == pytest.approx(left - 100.0, rel=1e-9)
    many = under_load(
        model_compliance(model), np.zeros((3, 1)), [0, 0, -100.0, 0, 0, 0], ("critical", "values")
    )
    np.testing.assert_allclose(many.critical, left / 100.0, rtol=1e-9)
    np.testing.assert_allclose(many.values[:, 0], left - 100.0, rtol=1e-9)


def test_stiffness_and_compliance_are_inverse(six_springs: Model, soft_tool: Model) -> None:
    load = np.array([300.0, -200.0, 400.0, 10.0, -20.0, 30.0])
    for model in (six_springs, soft_tool):
        found = loaded_stiffness(model, POSE, load)
        product = found.K_X_6x6_enhanced @ found.compliance_enhanced
        np.testing.assert_allclose(product, np.eye(6), atol=1e-9)
    stiffer = loaded_stiffness(six_springs, POSE, load).principal.values
    assert (loaded_stiffness(soft_tool, POSE, load).principal.values < stiffer).all()


def test_a_rigid_wrist_leaves_three_directions(six_springs: Model) -> None:
    model = joint_spring_model(six_springs.robot, [*SPRINGS[:3], np.inf, np.inf, np.inf])
    found = loaded_stiffness(model, POSE, np.array([1e3, 0, 0, 0, 0, 0]))
    assert found.soft == six_springs.robot.actuated[:3]
    assert np.isposinf(np.diag(found.K_theta)[3:]).all()
    assert np.isnan(found.K_X_6x6_enhanced).all()
    assert np.isfinite(found.K_X_enhanced).all()


def test_a_negative_spring_is_unstable_without_load(six_springs: Model) -> None:
    """A cross compliance larger than the springs themselves makes one combination negative."""
    coupling = effect(six_springs.robot, "closure_coupling", "joint_2_l,joint_3_u")
    model = (six_springs + coupling).with_public(
        **{f"{coupling.id}.{coupling.parameters[0].name}": 1e5}
    )
    found = loaded_stiffness(model, POSE, np.array([1.0, 0, 0, 0, 0, 0]))
    assert found.critical_factor == 0.0
    assert found.definiteness_of_K_theta_minus_K_C is Definiteness.INDEFINITE


def test_a_rigid_model_has_no_stiffness(six_springs: Model) -> None:
    with pytest.raises(InputError, match="nothing in this model yields"):
        loaded_stiffness(Model(six_springs.robot), POSE, np.zeros(6))


@pytest.mark.parametrize(
    "law",
    [
        {"base_rocking": {f"stiffness_{k}_at_{T}": T or np.inf for T in (0, 9000) for k in "xy"}},
        {"gear_hardening": {"quadratic": 1e-9, "cubic": 0.0}},
        {"lost_motion": {"half_width": 1e-4}},
    ],
)
def test_a_stiffness_that_holds_for_small_loads_alone_says_so(six_springs, law) -> None:
    (name, values), robot = *law.items(), six_springs.robot
    where = CATALOGUE[name].places(robot)[0]
    bent = CATALOGUE[name].at(robot, where, Options(shape=tuple(values)))
    model = six_springs + bent
    told = f"not in proportion to the load: {bent.id}"
    there = model.with_public(**{f"{bent.id}.{key}": value for key, value in values.items()})
    with pytest.warns(ToolkitWarning, match=told):
        loaded_stiffness(there, POSE, np.zeros(6))
    with pytest.warns(ToolkitWarning, match=told):
        elastic_arm(there)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        loaded_stiffness(model, POSE, np.zeros(6))
        elastic_arm(six_springs)
