"""Figures: functions of plain arrays (SI) that return a matplotlib `Figure` in the house style."""

from sk120stiff.show.figures.curves import LoadCurve, force_deflection
from sk120stiff.show.figures.definite import definiteness_map
from sk120stiff.show.figures.ellipses import PlaneEllipse, plane_ellipses
from sk120stiff.show.figures.gaps import gap_per_pose, gap_waterfall
from sk120stiff.show.figures.parameters import Estimate, parameter_forest
from sk120stiff.show.figures.parts import relief_parts, surface_parts
from sk120stiff.show.figures.postures import posture_choice
from sk120stiff.show.figures.slices import stiffness_slice

__all__ = [
    "Estimate",
    "LoadCurve",
    "PlaneEllipse",
    "definiteness_map",
    "force_deflection",
    "gap_per_pose",
    "gap_waterfall",
    "parameter_forest",
    "plane_ellipses",
    "posture_choice",
    "relief_parts",
    "stiffness_slice",
    "surface_parts",
]
