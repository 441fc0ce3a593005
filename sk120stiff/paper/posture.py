"""Remarks of the text that a printed row can confirm or not: tool direction, loads, stiffness."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.paper.printed import DEADWEIGHTS, FIGURE_POSES, PrintedLoads
from sk120stiff.paper.setting import Setting, motion_grid
from sk120stiff.robot import STANDARD_GRAVITY
from sk120stiff.stiffness import cartesian_compliance, principal_stiffness


@dataclass(frozen=True, eq=False)
class Posture:
    """Findings about the printed configurations and loads.

    Attributes
    ----------
    tool_error
        Largest deviation of the tool from straight down over all printed configurations [rad].
    force_share
        (2,) smallest and largest printed force over the weight of its deadweight, k · 10 kg for
        the k-th load of a pose.
    softest
        (5,) smallest principal stiffness over the motion range: quantiles 0, 0.25, 0.5, 0.75, 1
        [N/m].
    softest_of_figures
        Figure → smallest principal stiffness at its configuration [N/m].
    """

    tool_error: float
    force_share: Array
    softest: Array
    softest_of_figures: dict[str, float]


def posture(setting: Setting, tables: tuple[PrintedLoads, ...]) -> Posture:
    """Look at every printed configuration and load."""
    joints = np.concatenate(
        [table.joints for table in tables] + [np.array([*FIGURE_POSES.values()])]
    )
    out = setting.robot.placement(joints)[:, :3, 2]
    share = []
    for table in tables:
        for pose in table.poses:
            size = np.linalg.norm(table.force[table.rows(pose)], axis=1)
            share.append(size / (STANDARD_GRAVITY * DEADWEIGHTS[1 : len(size) + 1]))
    softest = _softest(setting, motion_grid())
    return Posture(
        tool_error=float(np.max(np.arccos(np.clip(-out[:, 2], -1.0, 1.0)))),
        force_share=np.array([np.min(share), np.max(share)]),
        softest=np.quantile(softest, [0.0, 0.25, 0.5, 0.75, 1.0]),
        softest_of_figures={
            figure: float(_softest(setting, pose[:3])) for figure, pose in FIGURE_POSES.items()
        },
    )


def _softest(setting: Setting, joints: Array) -> Array:
    J = setting.arm(joints).linear_jacobian
    return principal_stiffness(cartesian_compliance(J, setting.K_theta)).values[..., 0]
