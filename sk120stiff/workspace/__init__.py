"""Stiffness over the workspace: maps, the best posture, deflections compensated, exports."""

from sk120stiff.workspace.arm import ElasticArm, elastic_arm
from sk120stiff.workspace.field import STATUS, JointGrid, MapJob, PositionGrid
from sk120stiff.workspace.finished import LoadSummary, MapCheck, open_map, summarise_map, verify_map
from sk120stiff.workspace.grid import Axis, Grid, parse_axes
from sk120stiff.workspace.inverse import Reached, Task, solve_inverse, starting_poses
from sk120stiff.workspace.mapping import MapReport, write_map
from sk120stiff.workspace.posture import (
    BestPosture,
    PathTask,
    Placement,
    best_posture,
    path_points,
)

__all__ = [
    "STATUS",
    "Axis",
    "BestPosture",
    "ElasticArm",
    "Grid",
    "JointGrid",
    "LoadSummary",
    "MapCheck",
    "MapJob",
    "MapReport",
    "PathTask",
    "Placement",
    "PositionGrid",
    "Reached",
    "Task",
    "best_posture",
    "elastic_arm",
    "open_map",
    "parse_axes",
    "path_points",
    "solve_inverse",
    "starting_poses",
    "summarise_map",
    "verify_map",
    "write_map",
]
