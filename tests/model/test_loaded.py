"""`loaded_stiffness` for models of more than joint springs, against what the model itself does."""

import numpy as np
import pytest

from sk120stiff.effects import effect
from sk120stiff.errors import InputError
from sk120stiff.model import Model, joint_spring_model, loaded_stiffness
from sk120stiff.robot import load_robot
from sk120stiff.stiffness import Definiteness

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
