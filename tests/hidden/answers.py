"""What the program answered, read from its public files alone."""

from __future__ import annotations

import csv
import json
import re
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import yaml
from numpy.typing import NDArray

# one of a kind: whatever stands as their place is right
PLACELESS = {
    "base_rocking", "base_sliding", "tool_compliance", "closure_rod", "force_scale", "force_bias",
    "force_rotation", "force_crosstalk", "reading_rotation", "reading_scale", "reading_drift",
    "zero_offset", "tool_offset",
}  # fmt: skip
LENGTHS = {"m": 1.0, "mm": 1e-3, "um": 1e-6, "µm": 1e-6}


def identity(name: str, where: str) -> str:
    """One spelling for one cause at one place."""
    name = name.strip()
    if name in PLACELESS:
        return name
    places = sorted(part for part in re.split(r"[,+/&\s]+", where) if part)
    return f"{name}:{'+'.join(places)}"


def identity_of(text: str) -> str:
    """`identity` of `name:where`."""
    name, _, where = text.partition(":")
    return identity(name, where)


@dataclass(frozen=True)
class Parameter:
    value: float
    std: float | None
    unit: str


@dataclass(frozen=True)
class Remainder:
    """What the answer says is left beyond the noise: rms per axis [um] with its 95 % interval."""

    rms: float
    low: float
    high: float
    significant: bool


@dataclass(frozen=True)
class Answer:
    """One verdict. Every named effect is the set of names between which it does not decide."""

    verdict: str
    effects: list[frozenset[str]] = field(default_factory=list)
    parameters: dict[str, Parameter] = field(default_factory=dict)  # identity.short name -> value
    next_poses: bool = False
    remainder: Remainder | None = None  # None: the answer says nothing of it
    # (names of which one is at work, stated probability)
    named: list[tuple[frozenset[str], float]] = field(default_factory=list)
    listed: list[tuple[frozenset[str], float]] = field(default_factory=list)
    seconds: float = 0.0

    @property
    def names(self) -> bool:
        return bool(self.effects)


def read_answer(folder: Path) -> Answer:
    """The answer in one folder; verdict `error` if the command did not give one."""
    run = _json(folder / "run.json") or {}
    seconds = float(run.get("seconds") or 0.0)
    if run.get("pages") is False:  # the answer is there, but a user was shown none of it
        return Answer("error", seconds=seconds)
    document = _json(folder / "verdict.json")
    if not isinstance(document, dict) or "verdict" not in document:
        # an explained refusal is an answer, though an empty one; a crash or a timeout is none
        told = folder / "stderr.txt"
        crashed = told.exists() and "Internal error" in told.read_text(errors="replace")
        refused = run.get("exit") == 1 and not crashed
        return Answer("refused" if refused else "error", seconds=seconds)
    effects: list[frozenset[str]] = []
    parameters: dict[str, Parameter] = {}
    named: list[tuple[frozenset[str], float]] = []
    for entry in document.get("effects", []):
        effects += _members(entry)
        named += [(group, p) for group in _members(entry) for p in _probability(entry)]
        _collect(parameters, entry["name"], entry.get("where", ""), entry.get("parameters", []))
    _collect_model(parameters, folder / "model.yaml")
    return Answer(
        verdict=document["verdict"],
        effects=effects,
        parameters=parameters,
        next_poses=bool(document.get("next_poses")) and (folder / "next_poses.csv").exists(),
        remainder=_remainder(document.get("remainder")),
        named=named,
        listed=_listed(document),
        seconds=seconds,
    )


def _remainder(entry: object) -> Remainder | None:
    """The remainder, if all of it is told."""
    if not isinstance(entry, dict):
        return None
    try:
        low, high = (float(end) for end in entry["interval_95"])
        return Remainder(float(entry["rms_um"]), low, high, bool(entry["significant"]))
    except (KeyError, TypeError, ValueError):
        return None


def _probability(entry: dict) -> list[float]:  # type: ignore[type-arg]
    """The stated probability, or nothing."""
    value = entry.get("probability")
    return [float(value)] if isinstance(value, (int, float)) else []


# entries that speak of no single cause
NO_CAUSE = {"none", "other", "outside", "something_else", "something else"}


def _listed(document: dict) -> list[tuple[frozenset[str], float]]:  # type: ignore[type-arg]
    """Every candidate of `probabilities` with what is said of it; `name:where`, or both keys."""
    out = []
    for entry in document.get("probabilities") or []:
        text = str(entry["name"])
        if text in NO_CAUSE:
            continue
        own = identity(text, str(entry["where"])) if entry.get("where") else identity_of(text)
        out += [(frozenset({own}), p) for p in _probability(entry)]
    return out


def _json(path: Path) -> dict | None:  # type: ignore[type-arg]
    try:
        return json.loads(path.read_text(encoding="utf-8"))  # type: ignore[no-any-return]
    except (OSError, ValueError):
        return None


def _members(entry: dict) -> list[frozenset[str]]:  # type: ignore[type-arg]
    name, where = str(entry["name"]), str(entry.get("where", ""))
    others = {identity_of(str(text)) for text in entry.get("alternatives", [])}
    joints = [part for part in re.split(r"[,+/&\s]+", where) if part]
    if name == "joint_springs" and len(joints) > 1:
        return [frozenset({identity(name, joint), *others}) for joint in joints]
    return [frozenset({identity(name, where), *others})]


def _collect(into: dict[str, Parameter], name: str, where: str, entries: list) -> None:  # type: ignore[type-arg]
    for entry in entries:
        own, place = name, where
        short = str(entry["name"])
        if ":" in short:  # effect:where.parameter
            own, _, rest = short.partition(":")
            place, _, short = rest.rpartition(".")
        value = entry.get("value")
        if isinstance(value, (int, float)):
            std = entry.get("std")
            into[f"{identity(own, place)}.{short}"] = Parameter(
                float(value),
                float(std) if isinstance(std, (int, float)) else None,
                str(entry.get("unit", "")),
            )


def _collect_model(into: dict[str, Parameter], path: Path) -> None:
    """Base springs and the rest from the model file."""
    try:
        document = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, yaml.YAMLError):
        return
    for effect in (document or {}).get("effects", []) or []:
        entries = effect.get("parameters") or []
        if isinstance(entries, dict):
            entries = [{"name": key, **value} for key, value in entries.items()]
        found: dict[str, Parameter] = {}
        _collect(found, str(effect.get("name")), str(effect.get("where", "")), entries)
        for key, value in found.items():
            into.setdefault(key, value)


def read_predictions(path: Path) -> NDArray[np.float64] | None:
    """Predicted displacements (N, 3) [m] from the CSV that `predict --out` writes."""
    found = _of_axes(path, r"(?:pred\w*d?{axis}|d{axis}_pred\w*)")
    return None if found is None or np.isnan(found).any() else found


def read_prediction_errors(path: Path) -> NDArray[np.float64] | None:
    """Their standard uncertainties (N, 3) [m], without the noise of a reading; NaN: not known."""
    parts = [_of_axes(path, rf"std_{part}_{{axis}}") for part in ("parameters", "remainder")]
    own, left = parts
    return None if own is None else np.hypot(own, 0.0 if left is None else np.nan_to_num(left))


def _of_axes(path: Path, pattern: str) -> NDArray[np.float64] | None:
    """(N, 3) numbers [m] of the three columns whose names fit; empty cells are NaN."""
    try:
        with path.open(newline="", encoding="utf-8") as stream:
            table = list(csv.reader(stream))
    except OSError:
        return None
    columns = []
    for axis in "xyz":
        name = re.compile(rf"\s*{pattern.format(axis=axis)}\[(\w+)\]\s*")
        hits = [(k, m[1]) for k, title in enumerate(table[0]) if (m := name.fullmatch(title))]
        if len(hits) != 1:
            return None
        columns.append(hits[0])
    rows = [row for row in table[1:] if row]
    try:
        return np.array(
            [[float(row[k] or "nan") * LENGTHS[unit] for k, unit in columns] for row in rows]
        )
    except (ValueError, KeyError, IndexError):
        return None
