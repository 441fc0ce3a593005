"""Measurements: what was pressed, what moved, and how well that is known."""

from sk120stiff.measurements.absolute import Absolute
from sk120stiff.measurements.channels import Channels
from sk120stiff.measurements.data import Measurements, NoiseStatement
from sk120stiff.measurements.joining import join_measurements
from sk120stiff.measurements.model_form import EXACT, FormWhitener, ModelForm
from sk120stiff.measurements.noise import NoiseModel, candidates, decided
from sk120stiff.measurements.reading import read_measurements
from sk120stiff.measurements.whitening import Whitener
from sk120stiff.measurements.writing import write_measurements

__all__ = [
    "EXACT",
    "Absolute",
    "Channels",
    "FormWhitener",
    "Measurements",
    "ModelForm",
    "NoiseModel",
    "NoiseStatement",
    "Whitener",
    "candidates",
    "decided",
    "join_measurements",
    "read_measurements",
    "write_measurements",
]
