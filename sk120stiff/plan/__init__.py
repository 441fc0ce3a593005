"""Which poses and loads to measure next."""

from sk120stiff.plan.discriminate import Choice, discriminating_readings, signature_columns
from sk120stiff.plan.pool import Pool, random_pool, random_poses

__all__ = [
    "Choice",
    "Pool",
    "discriminating_readings",
    "random_pool",
    "random_poses",
    "signature_columns",
]
