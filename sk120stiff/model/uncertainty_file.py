"""The uncertainty of a model as a part of its YAML file, legible for people.

::

    uncertainty:
      source: 100 readings at 20 poses, σ stated
      noise_um: 10.0                # of one reading per axis
      degrees_of_freedom: null      # of that noise where it was estimated
      parameters:                   # internal values: a compliance where people write a stiffness
        - {name: "joint_springs:joint_1_s.stiffness", value: 7.1e-07, std: 2.0e-09, unit: rad/(N*m)}
      correlation:                  # lower triangle, rows as the parameters
        - [1.0]
      unseen: []                    # plausible changes that the readings do not show, name: change
      kept: {}                      # parameters that were not estimated and count as exact
      remainder: {rms_um: [21.0, 30.1, 18.7], ...}     # base axes; null where nobody knows
"""

from __future__ import annotations

from typing import Any

import numpy as np
import yaml
from pydantic import ConfigDict, Field

from sk120stiff.errors import InputError, warn
from sk120stiff.files import Strict
from sk120stiff.model.model import Model
from sk120stiff.model.uncertainty import Remainder, Uncertainty

DIGITS, FINE = 9, 11  # of sizes, and decimals of correlations
SAME = 1e-6  # relative difference of two values that were written and read


class _Finite(Strict):
    model_config = ConfigDict(allow_inf_nan=False)


class _Parameter(_Finite):
    name: str
    value: float
    std: float | None = Field(default=None, ge=0.0)
    unit: str


class _Remainder(_Finite):
    rms_um: list[float] = Field(min_length=3, max_length=3)
    upper_um: list[float] = Field(min_length=3, max_length=3)
    degrees_of_freedom: list[float] = Field(min_length=3, max_length=3)
    load_N: float  # the unit is spelled so
    length_m: float
    grows: bool
    probability: float
    significant: bool


class UncertaintySection(_Finite):
    """The section as it stands in a file."""

    source: str = ""
    noise_um: float | None
    degrees_of_freedom: float | None = None
    parameters: list[_Parameter]
    correlation: list[list[float]]
    unseen: list[dict[str, float]] = Field(default_factory=list)
    kept: dict[str, float] = Field(default_factory=dict)
    remainder: _Remainder | None = None


class Row(list[Any]):
    """A list that is written on one line."""


class Line(dict[str, Any]):
    """A mapping that is written on one line."""


class ModelDumper(yaml.SafeDumper):  # type: ignore[misc]  # PyYAML has no types
    """Safe YAML in which `Row` and `Line` stay on one line."""


ModelDumper.add_representer(
    Row, lambda dumper, row: dumper.represent_sequence("tag:yaml.org,2002:seq", row, True)
)
ModelDumper.add_representer(
    Line, lambda dumper, line: dumper.represent_mapping("tag:yaml.org,2002:map", line, True)
)


def uncertainty_document(model: Model) -> dict[str, object] | None:
    """The section of a model's file; None where nothing is known."""
    known = model.uncertainty
    if known is None:
        return None
    hidden = {known.names[k] for k in np.flatnonzero(known.unseen.any(axis=0))}
    rows = [
        Line(
            name=name,
            value=_short(value),
            std=None if std == 0.0 and name in hidden else _short(std),
            unit=model.parameter(name).spec.internal_unit,
        )
        for name, value, std in zip(known.names, known.values, known.std, strict=True)
    ]
    correlation = [
        Row(round(float(r), FINE) for r in known.correlation[k, : k + 1]) for k in range(len(rows))
    ]
    unseen = [
        {name: _short(change) for name, change in zip(known.names, row, strict=True) if change}
        for row in known.unseen
    ]
    kept = {p.name: p.internal for p in model.parameters if p.name not in known.names}
    left = known.remainder
    return {
        "source": known.source,
        "noise_um": None if known.noise is None else _short(known.noise * 1e6),
        "degrees_of_freedom": known.freedom,
        "parameters": rows,
        "correlation": correlation,
        "unseen": unseen,
        "kept": {name: _short(value) for name, value in kept.items()},
        "remainder": None
        if left is None
        else {
            "rms_um": Row(_short(x * 1e6) for x in left.rms),
            "upper_um": Row(_short(x * 1e6) for x in left.upper),
            "degrees_of_freedom": Row(round(float(x), 2) for x in left.freedom),
            "load_N": _short(left.load),
            "length_m": _short(left.length),
            "grows": left.grows,
            "probability": _short(left.probability),
            "significant": left.significant,
        },
    }


def uncertainty_of(section: UncertaintySection | None, model: Model, where: str) -> Model:
    """The model with the uncertainty of its file.

    Raises:
        InputError: The matrix is none, or an entry has no possible value.

    Warns:
        ToolkitWarning: The parameters are no longer those that were estimated; the uncertainty is
            dropped.
    """
    if section is None:
        return model
    place = f"{where}, uncertainty"
    changed = _changed(section, model)
    if changed:
        warn(
            f"{place}: dropped, because {changed} Predictions have no ± until the model is "
            "identified again.",
            stacklevel=4,
        )
        return model
    try:
        _check_units(section, model)
        return model.known(_read(section))
    except InputError as error:
        raise InputError(
            error.what,
            where=place,
            remedy="Identify the model again, or take the section 'uncertainty' out.",
        ) from error


def _changed(section: UncertaintySection, model: Model) -> str:
    """What in the model differs from what was estimated, as the end of a sentence."""
    known = {entry.name: entry.value for entry in section.parameters} | section.kept
    for name, value in known.items():
        if name not in model.names:
            return f"the model has no parameter {name!r} any more."
        now = model.parameter(name).internal
        if abs(now - value) > SAME * max(abs(now), abs(value)):
            return f"{name} has another value than in the fit."
    added = [name for name in model.names if name not in known]
    return f"{added[0]} was not in the fit." if added else ""


def _check_units(section: UncertaintySection, model: Model) -> None:
    for entry in section.parameters:
        unit = model.parameter(entry.name).spec.internal_unit
        if entry.unit != unit:
            raise InputError(f"{entry.name} is given in {entry.unit!r}, not in {unit!r}")


def _read(section: UncertaintySection) -> Uncertainty:
    P = len(section.parameters)
    if [len(row) for row in section.correlation] != list(range(1, P + 1)):
        raise InputError(f"the correlation is not the lower triangle of {P} rows")
    correlation = np.zeros((P, P))
    for k, row in enumerate(section.correlation):
        correlation[k, : k + 1] = correlation[: k + 1, k] = row
    if (np.diag(correlation) != 1.0).any() or (np.abs(correlation) > 1.0).any():
        raise InputError("a correlation is not between -1 and 1, or not 1 with itself")
    hidden = {name for row in section.unseen for name in row}
    for entry in section.parameters:
        if entry.std is None and entry.name not in hidden:
            raise InputError(f"{entry.name} has no std, and is not named under 'unseen' either")
    std = np.array([entry.std or 0.0 for entry in section.parameters])
    names = tuple(entry.name for entry in section.parameters)
    stray = hidden - set(names)
    if stray:
        raise InputError(f"'unseen' names {sorted(stray)[0]!r}, which is no estimated parameter")
    left = section.remainder
    return Uncertainty(
        names=names,
        values=np.array([entry.value for entry in section.parameters]),
        covariance=correlation * np.outer(std, std),
        unseen=np.array([[row.get(n, 0.0) for n in names] for row in section.unseen]).reshape(
            -1, P
        ),
        noise=None if section.noise_um is None else section.noise_um * 1e-6,
        freedom=section.degrees_of_freedom,
        remainder=None
        if left is None
        else Remainder(
            rms=np.array(left.rms_um) * 1e-6,
            upper=np.array(left.upper_um) * 1e-6,
            freedom=np.array(left.degrees_of_freedom),
            load=left.load_N,
            length=left.length_m,
            grows=left.grows,
            probability=left.probability,
            significant=left.significant,
        ),
        source=section.source,
    )


def _short(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")
