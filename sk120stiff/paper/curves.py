"""Figs. 4 to 6: force against deflection at the three printed configurations.

The paper's points are drawn, not printed, and so are their forces. The curves here are the models',
for deadweights of 0 to 50 kg hung along each base axis.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.paper.printed import DEADWEIGHTS, FIGURE_POSES
from sk120stiff.paper.setting import Setting, wrench_of
from sk120stiff.robot import STANDARD_GRAVITY
from sk120stiff.stiffness import deflection


@dataclass(frozen=True, eq=False)
class Pull:
    """Deflections for a force that grows along one axis.

    Attributes
    ----------
    figure
        ``"4"``, ``"5"`` or ``"6"``.
    axis
        Base axis of the force.
    force
        (k,) size of the force [N].
    displacement
        Model name → (k, 3) exact displacement of the flange [m].
    """

    figure: str
    axis: str
    force: Array
    displacement: dict[str, Array]


def pulls(setting: Setting, springs: dict[str, Array]) -> tuple[Pull, ...]:
    """Curves of each printed configuration, axis and set of springs.

    Parameters
    ----------
    setting
        Robot.
    springs
        Model name → (3,) springs [N·m/rad].
    """
    force = STANDARD_GRAVITY * DEADWEIGHTS
    wrist = np.full(3, np.inf)
    found = []
    for figure, joints in FIGURE_POSES.items():
        straight = np.concatenate([joints[:3], np.zeros(3)])
        for axis in range(3):
            wrench = wrench_of(force[:, None] * np.eye(3)[axis])
            moved = {
                name: deflection(
                    setting.mechanism,
                    straight,
                    wrench,
                    np.concatenate([values, wrist]),
                ).equilibrium
                for name, values in springs.items()
            }
            found.append(Pull(figure, "xyz"[axis], force, moved))
    return tuple(found)
