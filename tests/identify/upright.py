"""A six-axis arm that stands upright: joints 2, 4 and 6 lie in parallel, one above the other."""

from dataclasses import replace

import numpy as np

from sk120stiff.measurements import Measurements, NoiseModel
from sk120stiff.model import joint_spring_model
from sk120stiff.plan import Schedule, simulate
from sk120stiff.robot import Robot, load_robot

RISES = (0.16, 0.20, 0.20, 0.22, 0.20, 0.20)  # m from one joint to the next
AXES = ("0 0 1", "0 1 0") * 3
POINT = np.array([0.0, 0.0, 0.05])
SIGMA = 15e-6


def upright() -> Robot:
    joints = "".join(
        f'<link name="link_{k}"/><joint name="joint_{k}" type="revolute">'
        f'<parent link="{f"link_{k - 1}" if k > 1 else "base"}"/><child link="link_{k}"/>'
        f'<origin xyz="0 0 {rise}"/><axis xyz="{axis}"/>'
        '<limit lower="-2.9" upper="2.9" effort="1" velocity="1"/></joint>'
        for k, (rise, axis) in enumerate(zip(RISES, AXES, strict=True), 1)
    )
    flange = (
        '<link name="flange"/><joint name="end" type="fixed"><parent link="link_6"/>'
        '<child link="flange"/><origin xyz="0 0 0.12"/></joint>'
    )
    return load_robot(f'<robot name="upright"><link name="base"/>{joints}{flange}</robot>')


def pushed_upright(robot: Robot, stiffness: list[float], *, seed: int = 0) -> Measurements:
    """Readings at six poses, straight but for a ten-thousandth; pushes from the side to 100 N."""
    rng = np.random.default_rng(seed)
    joints = rng.normal(size=(6, 6)) * 1e-4
    joints[:, 0] = rng.uniform(-2.0, 2.0, 6)
    angle = rng.uniform(0.0, 2.0 * np.pi, 6)
    sideways = 100.0 * np.column_stack([np.cos(angle), np.sin(angle)])
    return measured_at(robot, stiffness, joints, sideways, seed=seed)


def measured_at(
    robot: Robot, stiffness: list[float], joints: np.ndarray, sideways: np.ndarray, *, seed: int = 0
) -> Measurements:
    """What a tracker reads of an arm with these springs [N·m/rad] under forces (K, 2) [N]."""
    wrench = np.zeros((len(joints), 6))
    wrench[:, :2] = sideways
    plan = Measurements(
        pose=tuple(f"p{k}" for k in range(len(joints))),
        joint_names=robot.actuated,
        joints=joints,
        wrench=wrench,
        displacement=None,
        robot=robot.source,
        point=POINT,
    )
    truth = joint_spring_model(robot, stiffness)
    steps = Schedule("ascending", 4)
    readings = simulate(truth, plan, noise=NoiseModel(SIGMA), schedule=steps, seed=seed)
    return replace(readings.measurements)
