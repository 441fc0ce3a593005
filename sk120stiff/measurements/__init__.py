"""Measurements: what was pressed, what moved, and how well that is known."""

from sk120stiff.measurements.absolute import Absolute
from sk120stiff.measurements.channels import Channels
from sk120stiff.measurements.data import Measurements
from sk120stiff.measurements.files.gauges_alone import as_displacements
from sk120stiff.measurements.files.reading import read_measurements
from sk120stiff.measurements.files.writing import write_measurements
from sk120stiff.measurements.moved import MovedBetween, taken_as_moved
from sk120stiff.measurements.noise.law import NoiseModel, candidates, decided
from sk120stiff.measurements.noise.line_of_sight import may_have_rays, seen_from
from sk120stiff.measurements.noise.model_form import EXACT, FormWhitener, ModelForm
from sk120stiff.measurements.noise.whitening import Whitener, Whitens
from sk120stiff.measurements.noise_statement import Instrument, NoiseStatement

__all__ = [
    "EXACT",
    "Absolute",
    "Channels",
    "FormWhitener",
    "Instrument",
    "Measurements",
    "ModelForm",
    "MovedBetween",
    "NoiseModel",
    "NoiseStatement",
    "Whitener",
    "Whitens",
    "as_displacements",
    "candidates",
    "decided",
    "may_have_rays",
    "read_measurements",
    "seen_from",
    "taken_as_moved",
    "write_measurements",
]
