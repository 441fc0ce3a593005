"""Campaigns of positions of arms that sag: errors of springs against the Cramér-Rao bound."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import sk120stiff as sk
from sk120stiff.identify.positions.calibrate import calibrate
from tests.positions.arm import NAMES, bound, errors, poses, tracked, write

SIGMA = 3e-5
SETTINGS = (
    "position: {frame: unknown}\npoint: {xyz: [0, 0, 0], unit: mm, fit: true}\n"
    "noise: {sigma: 30, unit: um}\n"
)
TELLS = 0.5  # share of a compliance below which its bound is worth a judgement


@dataclass(frozen=True)
class Outcome:
    """One spring of one campaign: its error over the bound, and whether its interval held it."""

    joint: str
    error: float
    held: bool


def campaigns(count: int, arms: int, seed: int) -> list[Outcome]:
    """`count` campaigns spread over `arms` arms, each with its own poses and errors of geometry."""
    with tempfile.TemporaryDirectory() as folder:
        return _campaigns(Path(folder), count, arms, seed)


def _campaigns(folder: Path, count: int, arms: int, seed: int) -> list[Outcome]:
    out: list[Outcome] = []
    for number in range(arms):
        arm, a = errors(1000 * seed + number), poses(50, 77 + 1000 * seed + number)
        exact = tracked(arm.stands(a)[0])
        limits = bound(arm, a, SIGMA)
        told = [k for k in range(6) if limits[k] < TELLS * arm.compliance[k]]
        for draw in range(number, count, arms):
            rng = np.random.default_rng((seed, draw))
            path = write(folder, a, exact + SIGMA * rng.normal(size=exact.shape), SETTINGS)
            data = sk.read(path)
            robot = sk.load_robot(data.robot, base="base", tool="tool")
            fit = calibrate(sk.base_model(robot), data.with_joints(robot.actuated))
            names, intervals = [p.name for p in fit.parameters], fit.intervals()
            for k in told:
                own = names.index(f"joint_springs:{NAMES[k]}.stiffness")
                low, high = intervals[own]
                error = (fit.parameters[own].internal - arm.compliance[k]) / limits[k]
                out.append(Outcome(NAMES[k], error, low <= 1.0 / arm.compliance[k] <= high))
    return out


def told(outcomes: list[Outcome]) -> str:
    """A line for every joint and one for all."""
    lines = []
    for joint in (*NAMES, "all"):
        own = [o for o in outcomes if joint in (o.joint, "all")]
        if own:
            error = np.sqrt(np.mean([o.error**2 for o in own]))
            held = 100.0 * np.mean([o.held for o in own])
            lines.append(
                f"{joint}: rms error {error:.2f} of the Cramér-Rao bound, 95 % intervals hold "
                f"{held:.1f} % ({len(own)})"
            )
    return "\n".join(lines)
