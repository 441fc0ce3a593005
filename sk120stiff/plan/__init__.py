"""Which poses and loads to measure next, and what such a measurement would read."""

from sk120stiff.plan.design import Design, d_optimal
from sk120stiff.plan.discriminate import (
    Choice,
    Rivalry,
    discriminating_readings,
    rivalry,
    signature_columns,
)
from sk120stiff.plan.feasible import Column, base_column, lowest_points
from sk120stiff.plan.planned import plan, to_be_taken
from sk120stiff.plan.pool import Pool, Region, feasible_pool, random_pool, random_poses
from sk120stiff.plan.schedule import Schedule, scheduled
from sk120stiff.plan.simulation import Simulated, as_positions, simulate
from sk120stiff.plan.spread import random_choice, well_spread

__all__ = [
    "Choice",
    "Column",
    "Design",
    "Pool",
    "Region",
    "Rivalry",
    "Schedule",
    "Simulated",
    "as_positions",
    "base_column",
    "d_optimal",
    "discriminating_readings",
    "feasible_pool",
    "lowest_points",
    "plan",
    "random_choice",
    "random_pool",
    "random_poses",
    "rivalry",
    "scheduled",
    "signature_columns",
    "simulate",
    "to_be_taken",
    "well_spread",
]
