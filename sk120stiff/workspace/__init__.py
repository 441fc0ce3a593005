"""Stiffness over the workspace: maps, the best posture, deflections compensated."""

from sk120stiff.workspace.arm import ElasticArm, elastic_arm
from sk120stiff.workspace.branch import Branch, branch_of, lowest_floor, stays_above
from sk120stiff.workspace.compensate import Compensation, Standing, compensate, standing
from sk120stiff.workspace.field import STATUS, JointGrid, MapJob, PositionGrid
from sk120stiff.workspace.finished import (
    LoadSummary,
    damaged_map,
    open_map,
    summarise_map,
    verify_map,
)
from sk120stiff.workspace.grid import Axis, Grid, parse_axes
from sk120stiff.workspace.inverse import Task, solve_inverse, starting_poses
from sk120stiff.workspace.judge import PathTask, Placement
from sk120stiff.workspace.judged import Judged
from sk120stiff.workspace.landscape import Landscape, posture_landscape
from sk120stiff.workspace.map_postures import MapPostures, map_postures
from sk120stiff.workspace.mapping import MapReport, write_map
from sk120stiff.workspace.path import (
    LoadedPath,
    joints_along,
    read_path,
    write_joints,
)
from sk120stiff.workspace.places import places_of
from sk120stiff.workspace.posture import BestPosture, best_posture
from sk120stiff.workspace.returned import Returned
from sk120stiff.workspace.standing_uncertainty import (
    StandingUncertainty,
    standing_budgets,
    standing_uncertainty,
)

__all__ = [
    "STATUS",
    "Axis",
    "BestPosture",
    "Branch",
    "Compensation",
    "ElasticArm",
    "Grid",
    "JointGrid",
    "Judged",
    "Landscape",
    "LoadSummary",
    "LoadedPath",
    "MapJob",
    "MapPostures",
    "MapReport",
    "PathTask",
    "Placement",
    "PositionGrid",
    "Returned",
    "Standing",
    "StandingUncertainty",
    "Task",
    "best_posture",
    "branch_of",
    "compensate",
    "damaged_map",
    "elastic_arm",
    "joints_along",
    "lowest_floor",
    "map_postures",
    "open_map",
    "parse_axes",
    "places_of",
    "posture_landscape",
    "read_path",
    "solve_inverse",
    "standing",
    "standing_budgets",
    "standing_uncertainty",
    "starting_poses",
    "stays_above",
    "summarise_map",
    "verify_map",
    "write_joints",
    "write_map",
]
