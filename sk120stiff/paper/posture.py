"""The printed configurations: tool direction, size of the loads, stiffness, pulls of Figs. 4 to 6.

The paper's points of Figs. 4 to 6 are drawn, not printed, and so are their forces. The curves here
are the models', for deadweights of 0 to 50 kg hung along each base axis.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.paper.printed import DEADWEIGHTS, FIGURE_POSES, LOADINGS, PrintedLoads
from sk120stiff.paper.setting import Setting, motion_grid
from sk120stiff.robot import STANDARD_GRAVITY


@dataclass(frozen=True, eq=False)
class Posture:
    """Findings about the printed configurations and loads.

    Attributes:
        tool_error: Largest deviation of the tool from straight down over all printed configurations
            [rad].
        force_share: (2,) smallest and largest printed force over the weight of its deadweight, k ·
            10 kg for the k-th load of a pose.
        softest: (5,) smallest principal stiffness over the motion range: quantiles 0, 0.25, 0.5,
            0.75, 1 [N/m].
        softest_of_figures: Figure → smallest principal stiffness at its configuration [N/m].
    """

    tool_error: float
    force_share: Array
    softest: Array
    softest_of_figures: dict[str, float]


def posture(setting: Setting, tables: tuple[PrintedLoads, ...]) -> Posture:
    """Look at every printed configuration and load."""
    figures = np.array([*FIGURE_POSES.values()])
    joints = np.concatenate([*(table.joints for table in tables), figures])
    down = -setting.robot.placement(joints)[:, 2, 2]
    size = np.concatenate([np.linalg.norm(table.force, axis=1) for table in tables])
    share = size.reshape(-1, LOADINGS) / (STANDARD_GRAVITY * DEADWEIGHTS[1:])
    softest = dict(zip(FIGURE_POSES, _softest(setting, figures[:, :3]).tolist(), strict=True))
    return Posture(
        tool_error=float(np.max(np.arccos(np.clip(down, -1.0, 1.0)))),
        force_share=np.array([np.min(share), np.max(share)]),
        softest=np.quantile(_softest(setting, motion_grid()), [0.0, 0.25, 0.5, 0.75, 1.0]),
        softest_of_figures=softest,
    )


def _softest(setting: Setting, joints: Array) -> Array:
    return setting.under_load(joints, np.zeros(3), "values").of("values")[..., 0]


@dataclass(frozen=True, eq=False)
class Pull:
    """A force that grows along one base axis at the configuration of Fig. 4, 5 or 6.

    `force` is (k,) its size [N], `displacement` model name → (k, 3) of the flange, exact [m].
    """

    figure: str
    axis: str
    force: Array
    displacement: dict[str, Array]


def pulls(setting: Setting, springs: dict[str, Array]) -> tuple[Pull, ...]:
    """Curves of each printed configuration and axis, for each model's (3,) springs [N·m/rad]."""
    force = STANDARD_GRAVITY * DEADWEIGHTS

    def moved(joints: Array, along: Array) -> dict[str, Array]:
        loads = np.outer(force, along)
        return {
            name: setting.deflection(joints[:3], loads, springs=values)
            for name, values in springs.items()
        }

    return tuple(
        Pull(figure, axis, force, moved(joints, along))
        for figure, joints in FIGURE_POSES.items()
        for axis, along in zip("xyz", np.eye(3), strict=True)
    )
