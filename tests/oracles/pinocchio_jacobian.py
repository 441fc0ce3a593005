"""Pinocchio's own Jacobian, the second road to that of the chain."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from sk120stiff.robot.kinematics.tree import Tree
from sk120stiff.robot.rotations import crossed


def pinocchios(tree: Tree, q: np.ndarray, frame: str, point: np.ndarray) -> np.ndarray:
    """(6, m) Jacobian of a point (3,) of a frame, root axes."""
    joint, T_body_frame = tree.body(frame)
    if joint < 0:
        return np.zeros((6, tree.m))
    data = tree.model.createData()
    pin.computeJointJacobians(tree.model, data, tree.configuration(q))
    columns = np.array(pin.getJointJacobian(tree.model, data, joint + 1, pin.LOCAL_WORLD_ALIGNED))
    columns = columns.reshape(6, tree.m)
    arm = T_body_frame[:3, :3] @ point + T_body_frame[:3, 3]
    columns[:3] -= crossed(data.oMi[joint + 1].rotation @ arm) @ columns[3:]
    return columns
