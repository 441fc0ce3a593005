"""Arms with a few causes of the catalogue and an error that no catalogue has, smooth in the joints.

Laws, kinematics and sag are those of `arm.py`, which shares nothing with the product.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

import sk120stiff as sk
from tests.positions.arm import NAMES, Arm, Array, poses, tracked, write

SIGMA = 2e-5  # m
SPRINGS = {1: 6e5, 2: 4e5, 3: 1e5, 4: 6e4}  # N·m/rad
FIT = "position: {frame: unknown}\npoint: {xyz: [0, 0, 0], unit: mm, fit: true}\n"


@dataclass(frozen=True)
class Drawn:
    """One campaign, and what is true of it.

    Attributes:
        true: Names of what is there.
        a, x: Joints (N, 6) as read and positions (N, 3) as the tracker reads them.
        unknown: Standard size of the error that nobody knows [rad].
        kind: Which law it has; of 0 and 2 it is one of each joint's own waves.
    """

    true: frozenset[str]
    a: Array
    x: Array
    unknown: float
    kind: int

    def holds(self, *names: str) -> bool:
        """Is one of these names there? Waves of a joint are, where each has waves of some order."""
        waves = self.unknown > 0.0 and self.kind != 1
        zeros = {name.replace("joint_frame", "joint_offset") for name in self.true}
        return any(
            name in self.true | zeros or (waves and name.startswith("transmission_error"))
            for name in names
        )

    def read(self, folder: Path) -> tuple[sk.Model, sk.Measurements]:
        """The robot as it was drawn, and the file."""
        path = write(folder, self.a, tracked(self.x), FIT)
        robot = sk.load_robot(path.with_name("six.urdf"), base="base", tool="tool")
        return sk.Model(robot), sk.read(path).with_joints(NAMES)


def drawn(seed: int) -> Drawn:
    """Up to two frames off, up to three springs, often a wave, sometimes a base that rocks."""
    rng = np.random.default_rng([7, seed])
    true = set[str]()
    shift, turn, waves = np.zeros((6, 3)), np.zeros((6, 3)), np.zeros((6, 2))
    compliance, rocks = np.zeros(6), np.zeros(2)
    for k in rng.choice(6, rng.integers(0, 3), replace=False):
        shift[k], turn[k] = 5e-4 * rng.normal(size=3), 4e-4 * rng.normal(size=3)
        true.add(f"joint_frame:j{k + 1}")
    for k in rng.choice([1, 2, 3, 4], rng.integers(0, 4), replace=False):
        compliance[k] = rng.uniform(0.5, 2.0) / SPRINGS[int(k)]
        true.add(f"joint_springs:j{k + 1}")
    if rng.random() < 0.4:
        k = rng.integers(6)
        waves[k] = 3e-4 * rng.normal(size=2)
        true.add(f"transmission_error:j{k + 1}")
    if rng.random() < 0.25:
        rocks[:] = 2e-7 * rng.uniform(0.5, 2.0, 2)
        true.add("base_rocking:base")
    arm = replace(Arm(), shift=shift, turn=turn, waves=waves, compliance=compliance, rocks=rocks)
    count = int(rng.choice([40, 60, 90]))
    a = poses(count, seed)
    size, kind = float(rng.choice([0.0, 5e-5, 1e-4, 2e-4])), int(rng.integers(3))
    off = size * _unknown(a, kind, rng)
    x = arm.stands(a + off)[0] + SIGMA * rng.normal(size=(count, 3))
    return Drawn(frozenset(true), a, x, size, kind)


def _unknown(a: Array, kind: int, rng: np.random.Generator) -> Array:
    """(N, 6) what each joint stands off by, per unit: waves, or waves of all angles together."""
    phase = rng.uniform(0.0, 6.0, (3, 6))
    if kind == 0:
        return np.asarray(np.sin(3.0 * a + phase[0]) + np.sin(5.0 * a + phase[1]))
    if kind == 1:
        turned = np.linalg.qr(rng.normal(size=(6, 6)))[0]
        return np.asarray(1.4 * np.sin(a @ turned + phase[0]))
    own = np.sin(a + np.roll(a, 1, axis=1) + phase[0])
    return np.asarray(own + 0.5 * np.sin(2.0 * a + phase[2]))
