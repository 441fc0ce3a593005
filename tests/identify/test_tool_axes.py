"""Forces that were turned into the tool's axes by the joint angles are told from a sensor's."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.effects import load_cases_of
from sk120stiff.identify import axes_of_joint_angles
from sk120stiff.measurements import Measurements, NoiseStatement
from sk120stiff.model import joint_spring_model

SOFT = np.array([1.2e4, 1.0e4, 1.1e4, 8e3, 6e3, 5e3])
FORCES = 130.0 * np.array([[0, 0, -1.0], [1, 0, 0], [0, 1, 0], [-0.6, 0.6, -0.7]])


@pytest.fixture(scope="module")
def cobot() -> sk.Model:
    return joint_spring_model(sk.load_robot("ur5e"), SOFT)


def readings(cobot: sk.Model, *, follows: bool, frame: str = "tool") -> Measurements:
    """Displacements under forces along axes of the tool, as a sensor or as the joints have it."""
    rng = np.random.default_rng(4)
    joints = np.repeat(rng.uniform(-1.5, 1.5, (18, 6)), len(FORCES), axis=0)
    force = np.tile(FORCES, (18, 1))
    data = Measurements(
        robot="ur5e",
        joint_names=cobot.robot.actuated,
        pose=tuple(str(k // len(FORCES)) for k in range(len(joints))),
        joints=joints,
        wrench=np.concatenate([force, 0.0 * force], axis=1),
        displacement=np.zeros_like(force),
        point=np.array([0.06, 0.0, 0.15]),
        force_frame="tool",
        zero="separate",
        noise=NoiseStatement(sigma=3e-5),
    )
    cases = replace(load_cases_of(cobot.robot, data), follows=follows)
    moved = cobot.predict(cases) + 3e-5 * np.sqrt(2.0) * rng.normal(size=force.shape)
    if frame == "base":
        return replace(data, displacement=moved, force_frame="base", wrench=cases.wrench)
    return replace(data, displacement=moved)


def test_what_a_sensor_read_fits_and_nothing_is_told(cobot: sk.Model) -> None:
    found = sk.fit(cobot, readings(cobot, follows=True))
    assert axes_of_joint_angles(found) is None and not found.exceeds


def test_what_the_joint_angles_turned_is_told_with_what_mends_it(cobot: sk.Model) -> None:
    data = readings(cobot, follows=False)
    found = sk.fit(cobot, data)
    said = axes_of_joint_angles(found)
    assert found.exceeds and said is not None and "write 'force: {frame: base}'" in said
    assert "turned into axes of the tool by the joint angles alone" in said
    assert said in sk.explain(cobot, data).unnamed
    mended = sk.fit(cobot, readings(cobot, follows=False, frame="base"))
    assert axes_of_joint_angles(mended) is None and not mended.exceeds
