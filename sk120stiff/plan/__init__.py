"""Which poses and loads to measure next, and what such a measurement would read."""

from sk120stiff.plan.cell import Cell, read_cell
from sk120stiff.plan.design import d_optimal, random_choice, well_spread
from sk120stiff.plan.discriminate import readings_for_all, rivalry, signature_columns
from sk120stiff.plan.feasible import Verdict, feasible
from sk120stiff.plan.of_positions import PlanOfPositions, plan_positions
from sk120stiff.plan.places import Places
from sk120stiff.plan.planned import Plan, plan, promised
from sk120stiff.plan.pool import Pool, feasible_pool, random_pool, random_poses
from sk120stiff.plan.rig import Rig
from sk120stiff.plan.route import NoWay, Route, jumps, route, straight_on
from sk120stiff.plan.schedule import Schedule, scheduled
from sk120stiff.plan.simulation import as_positions, simulate
from sk120stiff.plan.surroundings import (
    as_measured,
    assumed_around,
    assumptions,
    cell_from_data,
    lowest_points,
)

__all__ = [
    "Cell",
    "NoWay",
    "Places",
    "Plan",
    "PlanOfPositions",
    "Pool",
    "Rig",
    "Route",
    "Schedule",
    "Verdict",
    "as_measured",
    "as_positions",
    "assumed_around",
    "assumptions",
    "cell_from_data",
    "d_optimal",
    "feasible",
    "feasible_pool",
    "jumps",
    "lowest_points",
    "plan",
    "plan_positions",
    "promised",
    "random_choice",
    "random_pool",
    "random_poses",
    "read_cell",
    "readings_for_all",
    "rivalry",
    "route",
    "scheduled",
    "signature_columns",
    "simulate",
    "straight_on",
    "well_spread",
]
