"""A URDF becomes a `Robot`: reading, checks, coupling of joints, kinematics of one pose or many."""

from sk120stiff.robot.kinematics.chain import Chain, VirtualJoint
from sk120stiff.robot.kinematics.coupling import Coupling, JointMotion, LinearCoupling
from sk120stiff.robot.kinematics.screws import Mechanism, Screws
from sk120stiff.robot.loading import find_robot, load_robot
from sk120stiff.robot.robot import STANDARD_GRAVITY, Robot
from sk120stiff.robot.urdf import is_dh_table
from sk120stiff.robot.yourdfpy_holder import as_yourdfpy

__all__ = [
    "STANDARD_GRAVITY",
    "Chain",
    "Coupling",
    "JointMotion",
    "LinearCoupling",
    "Mechanism",
    "Robot",
    "Screws",
    "VirtualJoint",
    "as_yourdfpy",
    "find_robot",
    "is_dh_table",
    "load_robot",
]
