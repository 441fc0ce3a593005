"""Loads that ask more of the motors than they give: a unit of force, or of the URDF, is wrong."""

from __future__ import annotations

import numpy as np

from sk120stiff.effects import load_cases_of
from sk120stiff.measurements import Measurements
from sk120stiff.robot import Robot

MOST = 2.0  # times its effort: for a moment a gear bears about twice what it is rated for


def efforts_doubt(robot: Robot, measurements: Measurements) -> str | None:
    """A sentence where loads exceed by far what the URDF says that the motors hold; or None.

    An effort that is the same for all joints, or that cannot hold the arm's own weight, is no
    effort of this arm: it says nothing of the loads.
    """
    used = measurements.masked()
    efforts = robot.efforts
    if used.displacement is None or used.absolute is not None or np.all(efforts == efforts[0]):
        return None
    load_cases = load_cases_of(robot, used)
    if np.any(np.abs(load_cases.gravity_torque) > efforts):
        return None
    torques = robot.screws(load_cases.a, point=load_cases.force_point).torques(load_cases.wrench)
    shares = np.abs(torques) / efforts
    row, joint = np.unravel_index(int(np.argmax(shares)), shares.shape)
    if not shares[row, joint] > MOST:
        return None
    asked = f"{abs(torques[row, joint]):.3g} of {efforts[joint]:.3g}"
    unit = "N" if robot.prismatic[joint] else "N*m"
    return (
        f"the loads ask {shares[row, joint]:.2g} times of {robot.actuated[joint]} what its motor "
        f"gives by the URDF ({asked} {unit}, at pose {used.pose[row]}): check the unit of the "
        "force (lbf, kgf and N differ by 4.4 and 9.8) and where it acts, or the efforts in the "
        "URDF. Springs come out stiffer by as much as the force is too large."
    )
