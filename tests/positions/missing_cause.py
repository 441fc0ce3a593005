"""Positions without and with a payload, of an arm whose cause of sag the model may lack."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

import sk120stiff as sk
from tests.positions.arm import NAMES, Arm, poses, tracked, write

FIT = (
    "position: {frame: unknown}\npoint: {xyz: [0, 0, 0], unit: mm, fit: true}\n"
    "payload: {point: {xyz: [0, 0, 0], unit: mm}}\n"
)
YIELDS = np.array([3e-7, 4e-7])  # rad/(N·m)
SOFTENS = np.array([0.0, 2e-9, 0.0, 0.0, 0.0, 0.0])  # rad/(N·m)²
COUNT, SLIPPED = 40, 55


def campaign(
    folder: Path, arm: Arm, seed: int, slip: float = 0.0
) -> tuple[sk.Model, sk.Measurements]:
    """Positions without and with 40 kg; one is off by a slip [m]."""
    a, x, cells = poses(COUNT, seed), [], []
    for load in (0.0, 40.0):
        x.append(tracked(replace(arm, payload=load).stands(a)[0]))
        cells += [f"{load},p{k}" for k in range(COUNT)]
    noisy = np.concatenate(x)
    noisy += 2e-5 * np.random.default_rng(seed).normal(size=noisy.shape)
    noisy[SLIPPED, 0] += slip
    path = write(folder, np.tile(a, (2, 1)), noisy, FIT, more=",payload[kg],pose",
                 cells=cells)  # fmt: skip
    data = sk.read(path)
    robot = sk.load_robot(data.robot, base="base", tool="tool")
    return sk.base_model(robot), data.with_joints(NAMES)
