"""Arms that the tests of this folder load: skew axes, slides, coupled joints, and the SK120."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from types import SimpleNamespace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sk120stiff.robot import Mechanism, Robot, Screws, load_robot
from sk120stiff.stiffness import ConstantCompliance, complementary_stiffness, under_load
from tests.oracles.numpy_kinematics import UrdfTree
from tests.oracles.table2_reference import ROBOT

Array = NDArray[np.float64]
PAPER_SPRINGS = np.array([1.4098e6, 4.0076e5, 9.3528e5])  # [N·m/rad]
SK120_SPRINGS = np.array([*PAPER_SPRINGS, np.inf, np.inf, np.inf])
FORMULAS = ("conventional", "enhanced", "second_order", "equilibrium")
POINT = np.array([0.1, -0.2, 0.3])


@dataclass(frozen=True, repr=False)
class Arm:
    """A robot, the same robot as plain matrices, and springs for it."""

    robot: Robot
    tree: UrdfTree
    tool: str
    springs: Array  # (n,) [N·m/rad or N/m]

    @property
    def n(self) -> int:
        return self.robot.n

    @property
    def mechanism(self) -> Mechanism:
        return self.robot.mechanism()

    def values(self, a: Array) -> dict[str, float]:
        return dict(zip(self.robot.actuated, a, strict=True))

    def position(self, a: Array, point: Array = POINT) -> Array:
        """(3,) by 4x4 matrices."""
        return self.tree.point(self.values(a), self.tool, point)

    def torques(self, a: Array, wrench: Array, point: Array = POINT) -> Array:
        """(n,) J^T W by finite differences of 4x4 matrices."""
        names = list(self.robot.actuated)
        return self.tree.jacobian(self.values(a), self.tool, names, point).T @ wrench

    def torque_slope(self, a: Array, wrench: Array, step: float = 1e-3) -> Array:
        """(n, n) of J^T W by the coordinates, by fourth-order differences of `torques`."""
        columns = []
        for e in step * np.eye(self.n):
            near = self.torques(a + e, wrench) - self.torques(a - e, wrench)
            far = self.torques(a + 2 * e, wrench) - self.torques(a - 2 * e, wrench)
            columns.append((8 * near - far) / (12 * step))
        return np.array(columns).T

    def poses(self, count: int, seed: int) -> Array:
        return np.random.default_rng(seed).uniform(-1.5, 1.5, (count, self.n))


def deflection(
    mechanism: Mechanism,
    a: ArrayLike,
    wrench: ArrayLike,
    springs: ArrayLike,
    point: ArrayLike | None = None,
) -> SimpleNamespace:
    """The deflections of `under_load`, by formula."""
    arm = ConstantCompliance.of_springs(mechanism, springs, point=point)
    names = {name: f"deflection_{name}" for name in FORMULAS}
    found = under_load(arm, a, wrench, names.values())
    return SimpleNamespace(**{name: found.of(key) for name, key in names.items()})


def critical_load(screws: Screws, springs: Array, wrench: ArrayLike) -> Array:
    """(...,) factor on a wrench: one over the largest eigenvalue of K_θ^(-1/2) K_C K_θ^(-1/2)."""
    root = 1.0 / np.sqrt(springs)
    K_C = complementary_stiffness(screws, wrench)
    K_C = 0.5 * (K_C + np.swapaxes(K_C, -1, -2))
    values = np.linalg.eigvalsh(root[:, None] * K_C * root)
    softens = values[..., -1] > 1e-12 * np.abs(values).max(axis=-1)
    return np.where(softens, 1.0 / np.where(softens, values[..., -1], 1.0), np.inf)


def mixed_urdf(seed: int) -> str:
    """Turning and sliding joints about skew axes; the fourth and sixth follow earlier ones."""
    rng = np.random.default_rng(seed)
    kinds = ["revolute", "prismatic", "revolute", "revolute", "prismatic", "prismatic", "revolute"]
    mimics = {3: ("j0", -1.0, 0.2), 5: ("j4", 0.7, -0.1)}
    text = '<robot name="mixed"><link name="l0"/>'
    for k, kind in enumerate(kinds):
        xyz, rpy, turn = rng.uniform(-0.5, 0.5, 3), rng.uniform(-2, 2, 3), rng.normal(size=3)
        axis = turn / np.linalg.norm(turn)
        mimic = ""
        if k in mimics:
            driver, multiplier, offset = mimics[k]
            mimic = f'<mimic joint="{driver}" multiplier="{multiplier}" offset="{offset}"/>'
        text += (
            f'<joint name="j{k}" type="{kind}"><parent link="l{k}"/><child link="l{k + 1}"/>'
            f'<origin xyz="{_words(xyz)}" rpy="{_words(rpy)}"/><axis xyz="{_words(axis)}"/>'
            f'<limit lower="-9" upper="9" effort="1" velocity="1"/>{mimic}</joint>'
            f'<link name="l{k + 1}"/>'
        )
    return text + "</robot>"


def uncoupled(urdf: str) -> str:
    """The same arm with a motor in every joint."""
    while "<mimic" in urdf:
        start = urdf.index("<mimic")
        urdf = urdf[:start] + urdf[urdf.index("/>", start) + 2 :]
    return urdf


@cache
def mixed_arm(seed: int) -> Arm:
    text = mixed_urdf(seed)
    robot = load_robot(text, base="l0", tool="l7")
    springs = np.random.default_rng(seed).uniform(1e5, 1e6, robot.n)
    return Arm(robot, UrdfTree(text), "l7", springs)


@cache
def sk120() -> Arm:
    """The bundled robot with elastic joints 1 to 3; its tool is `tool0`."""
    urdf = (ROBOT / "sk120.urdf").read_text(encoding="utf-8")
    return Arm(load_robot("motoman_sk120"), UrdfTree(urdf), "tool0", SK120_SPRINGS)


def sk120_poses(count: int, seed: int) -> Array:
    """(count, 6) poses of the published range that are not singular."""
    low, high = np.radians([-180, -70, -115, 0, 0, 0]), np.radians([180, 70, 35, 0, 0, 0])
    poses = np.random.default_rng(seed).uniform(low, high, (20 * count, 6))
    J = sk120().robot.jacobian(poses)[:, :3, :3]
    return poses[np.linalg.svd(J, compute_uv=False)[:, -1] > 0.3][:count]


def _words(numbers: Array) -> str:
    return " ".join(repr(float(x)) for x in numbers)
