"""Stiffness of robot arms under load: predict it, identify it, find what the model is missing."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sk120stiff.errors import InputError, Refusal, ToolkitError, ToolkitWarning
    from sk120stiff.identify.estimate import fit
    from sk120stiff.identify.fit import Fit
    from sk120stiff.measurements import Measurements, read_measurements, write_measurements
    from sk120stiff.model import (
        Model,
        base_model,
        joint_spring_model,
        loaded_stiffness,
        read_model,
        write_model,
    )
    from sk120stiff.robot import Robot, load_robot

# Public name → the module that holds it. Nothing is imported before a name is asked for.
# A name that is also a folder's (explain, plan) cannot stand here: importing the folder would
# overwrite it.
_HOME = {
    "Fit": "sk120stiff.identify.fit",
    "InputError": "sk120stiff.errors",
    "Measurements": "sk120stiff.measurements",
    "Model": "sk120stiff.model",
    "Refusal": "sk120stiff.errors",
    "Robot": "sk120stiff.robot",
    "ToolkitError": "sk120stiff.errors",
    "ToolkitWarning": "sk120stiff.errors",
    "base_model": "sk120stiff.model",
    "fit": "sk120stiff.identify.estimate",
    "joint_spring_model": "sk120stiff.model",
    "load_robot": "sk120stiff.robot",
    "loaded_stiffness": "sk120stiff.model",
    "read_measurements": "sk120stiff.measurements",
    "read_model": "sk120stiff.model",
    "write_measurements": "sk120stiff.measurements",
    "write_model": "sk120stiff.model",
}

__all__ = [
    "Fit",
    "InputError",
    "Measurements",
    "Model",
    "Refusal",
    "Robot",
    "ToolkitError",
    "ToolkitWarning",
    "base_model",
    "fit",
    "joint_spring_model",
    "load_robot",
    "loaded_stiffness",
    "read_measurements",
    "read_model",
    "write_measurements",
    "write_model",
]


def __getattr__(name: str) -> object:
    if name == "__version__":
        from importlib.metadata import version

        return version("sk120stiff")
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(_HOME[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__, "__version__"})
