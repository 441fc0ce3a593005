"""A robot under load: pure functions on arrays, for one pose or for many."""

from sk120stiff.stiffness.batch import StiffnessBatch, stiffness_batch
from sk120stiff.stiffness.cartesian import (
    cartesian_compliance,
    cartesian_stiffness,
    spring_matrix,
)
from sk120stiff.stiffness.complementary import (
    complementary_stiffness,
    gravity_stiffness,
    gravity_torques,
    symmetric_part,
)
from sk120stiff.stiffness.critical import critical_load
from sk120stiff.stiffness.deflection import Deflection, deflection
from sk120stiff.stiffness.energy import PaperWork, loading_balance, paper_work, quadratic
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
    definiteness_of,
    principal_stiffness,
)

__all__ = [
    "CLASSES",
    "Definiteness",
    "Deflection",
    "ElasticLaw",
    "Equilibrium",
    "PaperWork",
    "Principal",
    "StiffnessBatch",
    "Weight",
    "cartesian_compliance",
    "cartesian_stiffness",
    "complementary_stiffness",
    "critical_load",
    "definiteness",
    "definiteness_of",
    "deflection",
    "equilibrium",
    "gravity_stiffness",
    "gravity_torques",
    "linear_springs",
    "loading_balance",
    "paper_work",
    "principal_stiffness",
    "quadratic",
    "spring_matrix",
    "stiffness_batch",
    "symmetric_part",
]
