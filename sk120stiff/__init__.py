"""Stiffness of robot arms under load: predict it, identify it, find what the model is missing."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sk120stiff.errors import InputError, Refusal, ToolkitError, ToolkitWarning
    from sk120stiff.robot import Robot, load_robot

# Public name → the module that holds it. Nothing is imported before a name is asked for.
_HOME = {
    "InputError": "sk120stiff.errors",
    "Refusal": "sk120stiff.errors",
    "Robot": "sk120stiff.robot",
    "ToolkitError": "sk120stiff.errors",
    "ToolkitWarning": "sk120stiff.errors",
    "load_robot": "sk120stiff.robot",
}

__all__ = [
    "InputError",
    "Refusal",
    "Robot",
    "ToolkitError",
    "ToolkitWarning",
    "load_robot",
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
