"""Which poses and loads to measure next, and what such a measurement would read."""

from sk120stiff.plan.discriminate import Choice, discriminating_readings, signature_columns
from sk120stiff.plan.pool import Pool, random_pool, random_poses
from sk120stiff.plan.schedule import Schedule, scheduled
from sk120stiff.plan.simulation import Simulated, as_positions, simulate

__all__ = [
    "Choice",
    "Pool",
    "Schedule",
    "Simulated",
    "as_positions",
    "discriminating_readings",
    "random_pool",
    "random_poses",
    "scheduled",
    "signature_columns",
    "simulate",
]
