"""The verdict does not depend on how soft an arm is."""

from dataclasses import replace

import numpy as np
import pytest

from sk120stiff import load_robot
from sk120stiff.effects import effect, load_cases_of
from sk120stiff.explain import Options
from sk120stiff.measurements import Measurements, NoiseStatement
from sk120stiff.model import joint_spring_model
from tests.corpus.robots import example
from tests.explain.readings import answered

SIGMA = 10e-6
STIFFNESS = (5.5e5, 5.5e5, 2.75e5, 5.5e4, 5.5e4, 5.5e4)  # N·m/rad
KINDS = Options(
    only=("joint_tilt", "link_bending", "base_rocking", "gear_hardening", "force_rotation")
)


@pytest.fixture(scope="module")
def ur10():
    return load_robot(str(example("ur10_robot.urdf")))


@pytest.mark.parametrize(
    ("softer", "bearing", "largest"),
    [(1.0, 1.0, 0.5e-3), (5.0, 12.0, 4.5e-3), (100.0, 100.0, 50e-3)],
)
def test_an_arm_a_hundred_times_softer_has_the_same_name(ur10, softer, bearing, largest):
    """100 N bend it by half a millimetre or by five centimetres; 10 µm stay what was stated.

    A bearing of 5·10⁴ N·m/rad is none of an arm with drives of 5·10⁵, and one of an arm of 10⁵.
    """
    rng = np.random.default_rng(3)
    tilt = effect(ur10, "joint_tilt", "shoulder_lift_joint")
    values = {
        f"joint_springs:{joint}.stiffness": k / softer
        for joint, k in zip(ur10.actuated, STIFFNESS, strict=True)
    }
    values |= {f"{tilt.id}.{p.name}": 6e5 / bearing for p in tilt.parameters}
    true = (joint_spring_model(ur10) + tilt).with_public(**values)
    poses, loads = 14, 3
    force = rng.normal(size=(poses * loads, 3))
    force *= 100.0 / np.linalg.norm(force, axis=1, keepdims=True)
    plan = Measurements(
        pose=tuple(str(k // loads) for k in range(poses * loads)),
        joint_names=ur10.actuated,
        joints=np.repeat(rng.uniform(-1.2, 1.2, (poses, 6)), loads, axis=0),
        wrench=np.hstack([force, np.zeros_like(force)]),
        displacement=np.zeros_like(force),
        zero="separate",
        noise=NoiseStatement(sigma=SIGMA),
    )
    moved = true.predict(load_cases_of(ur10, plan))
    assert np.linalg.norm(moved, axis=1).max() == pytest.approx(largest, rel=0.5)
    noise = np.sqrt(2.0) * SIGMA * rng.normal(size=moved.shape)
    readings = replace(plan, displacement=moved + noise)
    answer = answered(joint_spring_model(ur10), readings, options=KINDS)
    assert answer.verdict == "named"
    assert [finding.effect.id for finding in answer.findings] == [tilt.id]
    assert answer.yardstick.sigma == SIGMA
    assert not answer.remainder.significant
