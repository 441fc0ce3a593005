"""A robot under load: pure functions on arrays, for one pose or for many."""

from sk120stiff.stiffness.cartesian import (
    cartesian_compliance,
    cartesian_stiffness,
    complementary_stiffness,
    follower_stiffness,
    gravity_stiffness,
    spring_matrix,
    symmetric_part,
)
from sk120stiff.stiffness.elastic import ConstantCompliance
from sk120stiff.stiffness.energy import PaperWork, loading_balance, paper_work
from sk120stiff.stiffness.equilibrium import (
    ElasticLaw,
    Equilibrium,
    Weight,
    equilibrium,
    linear_springs,
)
from sk120stiff.stiffness.principal import (
    CLASSES,
    Definiteness,
    Principal,
    definiteness,
    principal_stiffness,
)
from sk120stiff.stiffness.quantities import BY_LOAD, BY_POSE, COMPILED
from sk120stiff.stiffness.under_load import POSITIONS, ROTATIONS, UnderLoad, under_load

__all__ = [
    "BY_LOAD",
    "BY_POSE",
    "CLASSES",
    "COMPILED",
    "POSITIONS",
    "ROTATIONS",
    "ConstantCompliance",
    "Definiteness",
    "ElasticLaw",
    "Equilibrium",
    "PaperWork",
    "Principal",
    "UnderLoad",
    "Weight",
    "cartesian_compliance",
    "cartesian_stiffness",
    "complementary_stiffness",
    "definiteness",
    "equilibrium",
    "follower_stiffness",
    "gravity_stiffness",
    "linear_springs",
    "loading_balance",
    "paper_work",
    "principal_stiffness",
    "spring_matrix",
    "symmetric_part",
    "under_load",
]
