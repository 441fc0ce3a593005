"""Springs typical of an arm's size: the rule, and what makers' catalogues say of such arms."""

import numpy as np
import pytest

from sk120stiff import base_model, fit, joint_spring_model, load_robot
from sk120stiff.effects import load_case
from sk120stiff.measurements import Measurements, NoiseStatement
from sk120stiff.model import typical_model, typical_parameters
from sk120stiff.model.typical import typical_stiffness
from tests.corpus.robots import example

pytestmark = pytest.mark.filterwarnings("ignore::sk120stiff.errors.ToolkitWarning")

ARM = """<robot name="two"><link name="ground"/><link name="upper"/><link name="fore"/>
<link name="tip"/>
<joint name="shoulder" type="revolute"><parent link="ground"/><child link="upper"/>
  <axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="{0}" velocity="1"/></joint>
<joint name="elbow" type="revolute"><parent link="upper"/><child link="fore"/>
  <origin xyz="{1} 0 0"/><axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="{0}" velocity="1"/>
</joint>
<joint name="flange" type="fixed"><parent link="fore"/><child link="tip"/>
  <origin xyz="{1} 0 0"/></joint></robot>"""


def test_a_stated_effort_winds_the_joint_up_by_3_mrad() -> None:
    found = typical_stiffness(load_robot(example("panda.urdf")))
    np.testing.assert_allclose(found, [29e3] * 4 + [4e3] * 3)  # 87 and 12 N·m


@pytest.mark.parametrize("effort", [0.0, 1e6, 1e-3])
def test_without_a_believable_effort_the_size_counts(effort: float) -> None:
    """The cube of the length, and the lever: the elbow carries half the arm."""
    small, large = (typical_stiffness(load_robot(ARM.format(effort, x))) for x in (0.5, 1.0))
    np.testing.assert_allclose(large / small, 8.0, rtol=0.1)
    np.testing.assert_allclose(large[1] / large[0], 0.5, rtol=0.1)


def test_the_order_of_magnitude_is_that_of_published_values() -> None:
    """SK120 (2005 paper): 1.41e6, 4.0e5, 9.4e5 N·m/rad at the three main joints."""
    found = typical_stiffness(load_robot("motoman_sk120"))[:3]
    assert (np.abs(np.log10(found / [1.4098e6, 4.0076e5, 9.3528e5])) < 1.0).all()


def test_the_base_model_of_an_unknown_arm_can_be_fitted() -> None:
    robot = load_robot(example("ur5_robot.urdf"))
    model = base_model(robot)
    assert typical_parameters(model) == model.parameters
    assert [p.effect.where for p in model.parameters] == list(robot.actuated)
    rng = np.random.default_rng(5)
    a = rng.uniform(-1.5, 1.5, (15, 6))
    wrench = np.hstack([rng.normal(0.0, 60.0, (15, 3)), np.zeros((15, 3))])
    point = np.array([0.05, 0.0, 0.1])
    truth = np.array([5e4, 4e4, 3e4, 2e4, 1e4, 1e4])
    exact = joint_spring_model(robot, truth).predict(load_case(robot, a, wrench, point=point))
    readings = Measurements(
        pose=tuple(map(str, range(15))), joint_names=robot.actuated, joint_kinds=("angle",) * 6,
        joints=a, wrench=wrench, displacement=exact, point=point, force_point=point,
        noise=NoiseStatement(1e-6),
    )  # fmt: skip
    found = fit(model, readings)
    np.testing.assert_allclose(found.model.joint_stiffness(), truth, rtol=1e-6)
    assert not typical_parameters(found.model)  # they are measured now


def test_the_bundled_robot_keeps_its_own_model() -> None:
    assert not typical_parameters(base_model(load_robot("motoman_sk120")))
    assert typical_parameters(typical_model(load_robot("motoman_sk120")))
