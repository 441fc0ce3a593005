"""Measurements: what was pressed, what moved, and how well that is known."""

from sk120stiff.measurements.absolute import Absolute
from sk120stiff.measurements.channels import Channels
from sk120stiff.measurements.data import Measurements
from sk120stiff.measurements.line_of_sight import may_have_rays, seen_from
from sk120stiff.measurements.model_form import EXACT, FormWhitener, ModelForm
from sk120stiff.measurements.noise import NoiseModel, candidates, decided
from sk120stiff.measurements.noise_statement import Instrument, NoiseStatement
from sk120stiff.measurements.reading import read_measurements
from sk120stiff.measurements.whitening import Whitener
from sk120stiff.measurements.writing import write_measurements

__all__ = [
    "EXACT",
    "Absolute",
    "Channels",
    "FormWhitener",
    "Instrument",
    "Measurements",
    "ModelForm",
    "NoiseModel",
    "NoiseStatement",
    "Whitener",
    "candidates",
    "decided",
    "may_have_rays",
    "read_measurements",
    "seen_from",
    "write_measurements",
]
