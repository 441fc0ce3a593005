"""Measurements + model become a `Fit`: least squares, uncertainty, what cannot be known."""

from sk120stiff.identify.checks.comparison import Compared, compare
from sk120stiff.identify.checks.held_out import (
    HeldOut,
    Learn,
    drawn_parts,
    held_out,
    pose_parts,
    refitted,
)
from sk120stiff.identify.checks.lack_of_fit import DOUBTFUL, LackOfFit, lack_of_fit
from sk120stiff.identify.checks.null_space import known_together, weak_directions
from sk120stiff.identify.checks.tool_axes import axes_of_joint_angles
from sk120stiff.identify.checks.unseen import unseen_reasons, unseen_sentences, why_unseen
from sk120stiff.identify.checks.yardstick import Yardstick, contradiction, yardstick
from sk120stiff.identify.estimate import as_seen, likelier, refuse_unusable
from sk120stiff.identify.fit import Fit
from sk120stiff.identify.positions.calibrate import Calibration
from sk120stiff.identify.report import fit_report
from sk120stiff.identify.robust import far_off
from sk120stiff.identify.run import (
    as_moved,
    fit,
    gauges_as_displacements,
    known_model,
    refuse_for_positions,
    refuse_plan,
)
from sk120stiff.identify.solve.problem import Problem
from sk120stiff.identify.solving import solve, solve_near
from sk120stiff.identify.uncertainty.profile import profile_intervals

__all__ = [
    "DOUBTFUL",
    "Calibration",
    "Compared",
    "Fit",
    "HeldOut",
    "LackOfFit",
    "Learn",
    "Problem",
    "Yardstick",
    "as_moved",
    "as_seen",
    "axes_of_joint_angles",
    "compare",
    "contradiction",
    "drawn_parts",
    "far_off",
    "fit",
    "fit_report",
    "gauges_as_displacements",
    "held_out",
    "known_model",
    "known_together",
    "lack_of_fit",
    "likelier",
    "pose_parts",
    "profile_intervals",
    "refitted",
    "refuse_for_positions",
    "refuse_plan",
    "refuse_unusable",
    "solve",
    "solve_near",
    "unseen_reasons",
    "unseen_sentences",
    "weak_directions",
    "why_unseen",
    "yardstick",
]
