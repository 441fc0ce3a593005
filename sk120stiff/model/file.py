"""Models as YAML: written by the program, meant for people too.

::

    robot: motoman_sk120            # or a path, relative to this file
    base_frame: base_link           # default, as of tool_frame: the robot's own
    tool_frame: tool0
    gravity: [9.81, 0, 0]           # base axes, m/s²; default: as of an arm that stands on a floor
    effects:
      - name: joint_springs
        where: joint_1_s
        reference: ...              # see reference_file.py; of what goes with warmth or a clock
        parameters:
          stiffness: {value: 1409800.0, unit: N*m/rad, std: null, free: true, origin: "..."}
    provenance: {command: ..., data: sha256:..., date: ...}
    uncertainty: {...}              # see uncertainty_file.py; written where a fit said so
"""

from __future__ import annotations

import math
import os
import re
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from pydantic import Field

from sk120stiff.effects import CATALOGUE, Catalogue, comment_lines
from sk120stiff.errors import InputError, warn
from sk120stiff.files import Strict, Vector, parse_yaml, read_text, validated, write_atomically
from sk120stiff.model.former import translated
from sk120stiff.model.model import Model
from sk120stiff.model.parameter import Parameter
from sk120stiff.model.reference_file import ReferenceSection, reference_document, with_reference
from sk120stiff.model.typical import typical_model
from sk120stiff.model.uncertainty_file import (
    ModelDumper,
    UncertaintySection,
    uncertainty_document,
    uncertainty_of,
)
from sk120stiff.robot import Robot, find_robot, load_robot
from sk120stiff.robot.naming import robot_name
from sk120stiff.units import to_si

_EFFECT = (
    "{name: joint_springs, where: joint_1, parameters: {stiffness: {value: 1e6, unit: N*m/rad}}}"
)
LIKE = dict.fromkeys(("effects", "name", "where", "parameters"), f"effects: [{_EFFECT}]")


class _Value(Strict):
    value: float
    unit: str
    std: float | None = None
    free: bool = True
    origin: str = ""


class _Effect(Strict):
    name: str
    where: str
    reference: ReferenceSection | None = None
    parameters: dict[str, _Value]


class _File(Strict):
    robot: str
    base_frame: str | None = None
    tool_frame: str | None = None
    gravity: Vector | None = None
    effects: list[_Effect] = Field(default_factory=list)
    provenance: dict[str, str] = Field(default_factory=dict)
    uncertainty: UncertaintySection | None = None


def model_text(model: Model, *, folder: Path | None = None) -> str:
    """The model as YAML text; `model_from_text` gives the same model back.

    A robot that is named by a relative path is found from `folder` too, if that is given.
    """
    named = robot_name(model.robot.source)
    document = {
        "robot": str(named if folder is None else named.seen_from(folder)),
        "base_frame": model.robot.base_frame,
        "tool_frame": model.robot.tool_frame,
        **_weight(model.robot),
        "effects": [
            {
                "name": item.name,
                "where": item.where,
                **reference_document(item),
                "parameters": {
                    p.spec.name: _written(p) for p in model.parameters if p.effect == item
                },
            }
            for item in model.effects
        ],
        "provenance": dict(model.provenance),
    }
    known = uncertainty_document(model)
    if known is not None:
        document["uncertainty"] = known
    text = yaml.dump(document, Dumper=ModelDumper, sort_keys=False, allow_unicode=True, width=100)
    return _commented(str(text), model)


def _weight(robot: Robot) -> dict[str, list[float]]:
    """Where weight pulls, of a robot that was told; one that was not stands on a floor."""
    if robot.on_a_floor:
        return {}
    return {"gravity": [float(g) for g in np.round(robot.gravity_in_base, 12)]}


def _commented(text: str, model: Model) -> str:
    """The text with the law, the axes and the meaning of the values above every effect."""
    parts = re.split(r"^(?=- name: )", text, flags=re.MULTILINE)
    if len(parts) != len(model.effects) + 1:
        raise ValueError("the effects of a model file do not begin where they should")
    said: set[tuple[str, ...]] = set()
    out = [parts[0]]
    for item, part in zip(model.effects, parts[1:], strict=True):
        lines = tuple(comment_lines(item))
        if lines not in said:  # six joint springs read alike
            out += [f"# {line}\n" for line in lines]
        said.add(lines)
        out.append(part)
    return "".join(out)


def write_model(model: Model, path: str | os.PathLike[str]) -> Path:
    """Write the model; an interrupted write leaves an old file as it was.

    Examples:
        >>> import sk120stiff as sk
        >>> model = sk.base_model(sk.load_robot("motoman_sk120"))
        >>> import tempfile, pathlib
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     file = sk.write_model(model, pathlib.Path(folder) / "model.yaml")
        ...     sk.read_model(file).names == model.names
        True
    """
    return write_atomically(path, model_text(model, folder=Path(path).parent))


def read_model(
    path: str | os.PathLike[str],
    robot: Robot | None = None,
    *,
    base: str | None = None,
    tool: str | None = None,
    catalogue: Catalogue = CATALOGUE,
) -> Model:
    """Read a model file, and its robot unless one is given.

    Args:
        path: The file.
        robot: The robot to use the model with.
        base, tool: Frames in the place of those that the file names, where no robot is given.
        catalogue: The effects that there are, ``CATALOGUE + Mine`` with your own.

    Raises:
        InputError: Not a model, or an effect, place, parameter or unit that does not exist; file
            and key are named.

    Warns:
        ToolkitWarning: The robot given is not the one that the model is of.

    Examples:
        >>> import sk120stiff as sk
        >>> import tempfile
        >>> from pathlib import Path
        >>> model = sk.base_model(sk.load_robot("motoman_sk120"))
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     again = sk.read_model(sk.write_model(model, Path(folder) / "model.yaml"))
        >>> again.names == model.names
        True
    """
    source = Path(path)
    text, folder = read_text(source), source.parent
    if robot is None and (base or tool):
        content = _parsed(text, str(source))
        robot = load_robot(
            content.robot,
            base=base or content.base_frame,
            tool=tool or content.tool_frame,
            relative_to=folder,
        )
    return model_from_text(text, where=str(source), folder=folder, robot=robot, catalogue=catalogue)


def model_from_text(
    text: str,
    *,
    where: str = "model",
    folder: Path | None = None,
    robot: Robot | None = None,
    catalogue: Catalogue = CATALOGUE,
) -> Model:
    """Read a model from YAML text; a relative robot path is tried from `folder` first."""
    content = _parsed(text, where)
    if robot is None:
        base, tool = content.base_frame, content.tool_frame
        arm = load_robot(content.robot, base=base, tool=tool, relative_to=folder)
    else:
        arm = robot
        _warn_of_another_robot(content.robot, arm, folder, where)
    if content.gravity is not None and arm.on_a_floor:  # what the readings say holds over it
        arm = arm.under(np.array(content.gravity))
    parameters: list[Parameter] = []
    model = Model(arm, provenance=content.provenance, catalogue=catalogue)
    for entry in content.effects:
        place = f"{where}, effect {entry.name}:{entry.where}"
        try:
            kind = catalogue[entry.name]
            given = translated(kind, entry.parameters, place)
            told = kind.options_of({key: item.unit for key, item in given.items()})
            found = catalogue.effect(arm, entry.name, entry.where, told)
            found = with_reference(found, entry.reference)
        except InputError as error:
            raise InputError(error.what, where=place, remedy=error.remedy) from error
        parameters = [_read(found, spec.name, given, place) for spec in found.parameters]
        unknown = given.keys() - {spec.name for spec in found.parameters}
        if unknown:
            raise InputError(
                f"unknown parameter {sorted(unknown)[0]!r}",
                where=place,
                remedy=f"Parameters are: {', '.join(s.name for s in found.parameters)}.",
            )
        model = model + parameters
    _warn_of_untrusted(model, where)
    return uncertainty_of(content.uncertainty, model, where)


def _warn_of_untrusted(model: Model, where: str) -> None:
    """Say once that values are used which no readings stand behind."""
    unseen = [p.name for p in model.untrusted if not p.seen]
    shared = [p.name for p in model.untrusted if p.seen]
    if unseen:
        warn(
            f"{where}: the readings behind this model do not show {', '.join(unseen)}. Its value "
            "stands in the file all the same, and what rests on it is not to be trusted. Measure "
            "poses and loads that show it, or write a value that you know, with its origin.",
            stacklevel=4,
        )
    if shared:
        warn(
            f"{where}: the readings behind this model tell {', '.join(shared)} together only, not "
            "each by itself. At other poses, what rests on them is not to be trusted.",
            stacklevel=4,
        )


def robot_of_model(path: str | os.PathLike[str]) -> str:
    """The robot that a model file names, as it is found from here."""
    source = Path(path)
    named = _parsed(read_text(source), str(source)).robot
    beside = source.parent / named
    return str(beside) if not named.lstrip().startswith("<") and beside.exists() else named


def base_model(robot: Robot) -> Model:
    """The `model.yaml` beside a robot's `robot.yaml`; else springs typical of an arm of its size.

    The latter say so in their `origin`; see `typical_model`.

    Examples:
        >>> import sk120stiff as sk
        >>> sk.base_model(sk.load_robot("motoman_sk120")).names[0]
        'joint_springs:joint_1_s.stiffness'
    """
    known = find_robot(robot.source).model_file
    return typical_model(robot) if known is None else read_model(known, robot)


def _warn_of_another_robot(said: str, robot: Robot, folder: Path | None, where: str) -> None:
    if said in (robot.source, robot.name) or _same_file(said, robot.source, folder):
        return
    warn(
        f"{where}: this model is of the robot {said!r}; here it is used with {robot.source!r}.",
        stacklevel=4,
    )


def _same_file(said: str, source: str, folder: Path | None) -> bool:
    try:
        meant, known = find_robot(said, relative_to=folder), find_robot(source)
        if meant.xacro != known.xacro:
            return False
        if isinstance(meant.urdf, Path) and isinstance(known.urdf, Path):
            return meant.urdf.read_bytes() == known.urdf.read_bytes()
    except (InputError, OSError):
        return False
    return meant.urdf == known.urdf


def _parsed(text: str, where: str) -> _File:
    return validated(_File, parse_yaml(text, where).content, where, LIKE)


def _read(found: Any, name: str, entries: dict[str, _Value], place: str) -> Parameter:
    spec = next(spec for spec in found.parameters if spec.name == name)
    if name not in entries:
        raise InputError(
            f"the parameter {name!r} is missing",
            where=place,
            remedy=f"Write: {name}: {{value: ..., unit: {spec.unit}}}",
        )
    given = entries[name]
    if not _same_unit(given.unit, spec.unit):
        raise InputError(
            f"the parameter {name!r} is given in {given.unit!r}, not in {spec.unit!r}",
            where=place,
            remedy=f"Convert the value to {spec.unit}.",
        )
    if math.isnan(given.value) or (spec.reciprocal and given.value == 0.0):
        raise InputError(f"the parameter {name!r} has no usable value", where=place)
    internal = spec.internal(given.value)
    if not spec.lower <= internal <= spec.upper:
        raise InputError(
            f"the parameter {name!r} has the value {given.value:g} {spec.unit}, which physics "
            "forbids",
            where=place,
            remedy="A compliance or a width is never negative.",
        )
    std = None if given.std is None else _internal_std(spec, internal, given.std)
    return Parameter(found, spec, internal, std, given.free, given.origin)


def _same_unit(given: str, unit: str) -> bool:
    """Whether a unit is this one, as spelled here or another way: ``Nm/rad`` for ``N*m/rad``."""
    try:
        return given == unit or float(to_si(1.0, given, unit)) == 1.0
    except (InputError, ValueError):  # neither is a mass one of the known units
        return False


def _internal_std(spec: Any, internal: float, public_std: float) -> float:
    if not spec.reciprocal:
        return public_std
    return 0.0 if math.isinf(public_std) else public_std * internal**2


def _written(parameter: Parameter) -> dict[str, Any]:
    std = parameter.std
    return {
        "value": parameter.value,
        "unit": parameter.spec.unit,
        "std": None if std is None or math.isinf(std) else std,
        "free": parameter.free,
        "origin": parameter.origin,
    }
