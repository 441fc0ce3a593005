"""A URDF becomes a `Robot`: reading, checks, coupling of joints, kinematics of one pose or many."""

from sk120stiff.robot.kinematics.chain import Chain, VirtualJoint
from sk120stiff.robot.kinematics.coupling import Coupling, Follower, JointMotion, LinearCoupling
from sk120stiff.robot.kinematics.screws import Mechanism, Screws
from sk120stiff.robot.loading import RobotSource, find_robot, load_robot
from sk120stiff.robot.robot import STANDARD_GRAVITY, Linkage, Robot
from sk120stiff.robot.urdf import is_dh_table
from sk120stiff.robot.yourdfpy_holder import as_yourdfpy

__all__ = [
    "STANDARD_GRAVITY",
    "Chain",
    "Coupling",
    "Follower",
    "JointMotion",
    "LinearCoupling",
    "Linkage",
    "Mechanism",
    "Robot",
    "RobotSource",
    "Screws",
    "VirtualJoint",
    "as_yourdfpy",
    "find_robot",
    "is_dh_table",
    "load_robot",
]
