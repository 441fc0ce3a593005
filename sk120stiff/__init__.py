"""Stiffness of robot arms under load: predict it, identify it, find what the model is missing.

>>> import sk120stiff as sk
>>> robot = sk.load_robot("motoman_sk120")
>>> model = sk.base_model(robot)
>>> model.deflect([0, 0.2, -0.3, 0, -1, 0], [0, 0, -490, 0, 0, 0]).shape  # (N, 3) [m]
(1, 3)

`load_robot`, `read`, `read_model` open files; `stiffness`, `predict`, `simulate` compute what a
model says; `fit`, `explain` hold it against measurements; `plan`, `compensate`, `export` use it.

`explain`, `plan` and `stiffness` are folders of the package too. As names of the package they are
always the functions, whatever was imported before; what is in the folders is had by
``from sk120stiff.explain import localise``.
"""

from __future__ import annotations

import sys
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sk120stiff import show as show
    from sk120stiff.effects import CATALOGUE, Catalogue, Effect, effect
    from sk120stiff.errors import InputError, Refusal, ToolkitError, ToolkitWarning
    from sk120stiff.explain.answer.explanation import Explanation
    from sk120stiff.explain.answer.verdict import Verdict, read_verdict
    from sk120stiff.explain.options import Options
    from sk120stiff.explain.run import explain
    from sk120stiff.exports import export
    from sk120stiff.identify.fit import Fit
    from sk120stiff.identify.run import fit
    from sk120stiff.measurements import (
        Instrument,
        Measurements,
        NoiseModel,
        read_measurements,
        write_measurements,
    )
    from sk120stiff.measurements import read_measurements as read
    from sk120stiff.model import (
        Model,
        base_model,
        joint_spring_model,
        loaded_stiffness,
        predict,
        read_model,
        write_model,
    )
    from sk120stiff.model import loaded_stiffness as stiffness
    from sk120stiff.plan.of_positions import plan_positions
    from sk120stiff.plan.planned import plan
    from sk120stiff.plan.schedule import Schedule
    from sk120stiff.plan.simulation import simulate
    from sk120stiff.robot import Robot, load_robot
    from sk120stiff.robot.bundled import bundled_robots
    from sk120stiff.workspace.compensate import compensate

# Public name → the module that holds it. Nothing is imported before a name is asked for.
_HOME = {
    name: home
    for home, names in {
        "sk120stiff.effects": "CATALOGUE Catalogue Effect effect",
        "sk120stiff.errors": "InputError Refusal ToolkitError ToolkitWarning",
        "sk120stiff.explain.answer.explanation": "Explanation",
        "sk120stiff.explain.answer.verdict": "Verdict read_verdict",
        "sk120stiff.explain.options": "Options",
        "sk120stiff.explain.run": "explain",
        "sk120stiff.exports": "export",
        "sk120stiff.identify.fit": "Fit",
        "sk120stiff.identify.run": "fit",
        "sk120stiff.measurements": "Measurements Instrument NoiseModel read read_measurements "
        "write_measurements",
        "sk120stiff.model": "Model base_model joint_spring_model loaded_stiffness predict "
        "read_model stiffness write_model",
        "sk120stiff.plan.of_positions": "plan_positions",
        "sk120stiff.plan.planned": "plan",
        "sk120stiff.plan.schedule": "Schedule",
        "sk120stiff.plan.simulation": "simulate",
        "sk120stiff.robot": "Robot load_robot",
        "sk120stiff.robot.bundled": "bundled_robots",
        "sk120stiff.workspace.compensate": "compensate",
    }.items()
    for name in names.split()
}
_CALLED_THERE = {"read": "read_measurements", "stiffness": "loaded_stiffness"}

__all__ = [
    "CATALOGUE",
    "Catalogue",
    "Effect",
    "Explanation",
    "Fit",
    "InputError",
    "Instrument",
    "Measurements",
    "Model",
    "NoiseModel",
    "Options",
    "Refusal",
    "Robot",
    "Schedule",
    "ToolkitError",
    "ToolkitWarning",
    "Verdict",
    "base_model",
    "bundled_robots",
    "compensate",
    "effect",
    "explain",
    "export",
    "fit",
    "joint_spring_model",
    "load_robot",
    "loaded_stiffness",
    "plan",
    "plan_positions",
    "predict",
    "read",
    "read_measurements",
    "read_model",
    "read_verdict",
    "simulate",
    "stiffness",
    "write_measurements",
    "write_model",
]


def _found(name: str) -> object:
    return getattr(import_module(_HOME[name]), _CALLED_THERE.get(name, name))


def __getattr__(name: str) -> object:
    if name == "__version__":
        from importlib.metadata import version

        return version("sk120stiff")
    if name == "show":  # the one folder that is spoken of as such: sk.show.in_meshcat(...)
        return import_module("sk120stiff.show")
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = _found(name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__, "__version__"})


class _Verb:
    """A name that stays the function when Python hangs the folder of that name into the package."""

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name

    def __get__(self, module: object, owner: type | None = None) -> object:
        return _found(self._name)

    def __set__(self, module: object, folder: object) -> None:
        """Nothing: the folder is found by ``from sk120stiff.explain import ...`` all the same."""


class _FrontDoor(ModuleType):
    """This package, with the verbs that are folders too."""

    explain = _Verb()
    plan = _Verb()
    stiffness = _Verb()


sys.modules[__name__].__class__ = _FrontDoor
