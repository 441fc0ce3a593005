"""The YAML file beside the readings: every key, its default, and where a slip in it stands."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, Literal

import yaml
from pydantic import Field

from sk120stiff import files, units
from sk120stiff.errors import InputError
from sk120stiff.files import Finite, Strict, Vector, validated

_Frame = Literal["base", "tool"]


class PointEntry(Strict):
    """A point in the tool frame; `fit`: its place is only roughly known."""

    xyz: Vector
    unit: str
    fit: bool = False

    def in_metres(self, where: str) -> tuple[float, float, float]:
        """The coordinates in m."""
        x, y, z = units.to_si(self.xyz, self.unit, "length", where=where)
        return float(x), float(y), float(z)


class ForceEntry(Strict):
    """Axes of the reported wrench, and its point of attack if that is not the measured point.

    Whoever writes about the force says its frame; only without the section it is the base. With
    `rpy` the axes are turned in that frame by roll, pitch and yaw, as a sensor is screwed on.
    """

    frame: _Frame
    rpy: Vector | None = None
    rpy_unit: str | None = None
    point: PointEntry | None = None


class DisplacementEntry(Strict):
    """Axes of the readings, and how the zero reading is shared."""

    frame: _Frame = "base"
    zero: Literal["shared", "separate", "unknown"] = "unknown"


class PositionEntry(Strict):
    """Axes of positions: of the base, or the tracker's own, which the fit then finds."""

    frame: Literal["base", "unknown"] = "base"


class RotationEntry(Strict):
    """Axes whose rotation is read: the tool's, or a target's, turned on the tool as the fit finds.

    Without the section they are the tool's where the point is known, and a target's where it is
    not: `fit: true` says that nobody knows how the target sits.
    """

    axes: Literal["tool", "target"]


class RegisteredEntry(Strict):
    """A record of how positions came into base axes: where the tracker had the base.

    A position of the tracker was rotation · (position here) + xyz; the rotation is a vector, its
    standard errors are about the tracker's axes. Of several stations each has its own.
    """

    station: str | None = None
    xyz: Vector
    unit: str
    rotation: Vector
    rotation_unit: str
    std_xyz: Vector
    std_rotation: Vector
    rms: Finite
    poses: int


class PayloadEntry(Strict):
    """Where the mass of the column ``payload[kg]`` hangs; `fit`: mass and centre are in doubt."""

    point: PointEntry | None = None
    fit: bool = False


class InstrumentEntry(Strict):
    """Where the instrument stands in the base frame, and its uncertainty along and across its ray.

    Of positions in its own axes it stands at their origin. Uncertainties are in `noise.unit`; those
    per metre of distance are added in squares.
    """

    xyz: Vector | None = None
    unit: str | None = None
    along: Annotated[float, Field(gt=0, allow_inf_nan=False)]
    across: Annotated[float, Field(gt=0, allow_inf_nan=False)]
    along_per_m: Annotated[float, Field(ge=0, allow_inf_nan=False)] = 0.0
    across_per_m: Annotated[float, Field(ge=0, allow_inf_nan=False)] = 0.0


class NoiseEntry(Strict):
    """Standard uncertainty of one reading per axis, and the part that grows with displacement.

    `force` is that of every component of a force, as a share of the force; `rotation` that of an
    orientation about each axis; `instrument` is given in the place of `sigma` where one is sharper
    along its ray than across it.
    """

    sigma: Annotated[float, Field(gt=0, allow_inf_nan=False)] | None = None
    unit: str | None = None
    rotation: Annotated[float, Field(gt=0, allow_inf_nan=False)] | None = None
    rotation_unit: str | None = None
    growth: Annotated[float, Field(ge=0, lt=1, allow_inf_nan=False)] | None = None
    force: Annotated[float, Field(ge=0, lt=1, allow_inf_nan=False)] | None = None
    instrument: InstrumentEntry | None = None


class Settings(Strict):
    """All keys of the file. An absent file and an absent key mean the defaults below.

    The robot and its frames default to what the command or the robot says, the point to the
    origin of the tool frame, both frames to the base, the zero to unknown (positions: shared),
    the noise to "estimate it".
    """

    robot: str | None = None
    base_frame: str | None = None
    tool_frame: str | None = None
    point: PointEntry | None = None
    force: ForceEntry = ForceEntry(frame="base")
    displacement: DisplacementEntry = DisplacementEntry()
    position: PositionEntry | None = None
    rotation: RotationEntry | None = None
    registered: RegisteredEntry | list[RegisteredEntry] | None = None
    points: dict[str, PointEntry] = Field(default_factory=dict)
    payload: PayloadEntry | None = None
    joints: dict[str, str | float] = Field(default_factory=dict)
    gravity: Vector | Literal[0] | None = None
    noise: NoiseEntry = NoiseEntry()
    source: str = ""


_REGISTERED = (
    "registered: {xyz: [0, 0, 0], unit: mm, rotation: [0, 0, 0], rotation_unit: rad, "
    "std_xyz: [0, 0, 0], std_rotation: [0, 0, 0], rms: 0, poses: 3}"
)
_PAYLOAD = "payload: {point: {xyz: [0, 0, 120], unit: mm}}"
_EXAMPLES = {
    "point": "point: {xyz: [-60.0, 40.0, 150.0], unit: mm}",
    "force": "force: {frame: base, point: {xyz: [0.0, 0.0, 100.0], unit: mm}}",
    "displacement": "displacement: {frame: base, zero: shared}",
    "position": "position: {frame: unknown}",
    "rotation": "rotation: {axes: target}",
    "registered": _REGISTERED,
    "registered.rotation": _REGISTERED,
    "points": "points: {A: {xyz: [0, 0, 100], unit: mm}, B: {xyz: [50, 0, 100], unit: mm}}",
    "payload": _PAYLOAD,
    "payload.point": _PAYLOAD,
    "joints": "joints: {joint_3: -(J2 + J3), joint_4: J4/101}",
    "gravity": "gravity: [0, 0, -9.81]",
    "noise": "noise: {sigma: 10, unit: um}",
    "noise.rotation": "noise: {sigma: 10, unit: um, rotation: 20, rotation_unit: urad}",
    "noise.force": "noise: {sigma: 10, unit: um, force: 0.015}",
}


@dataclass(frozen=True)
class SettingsFile:
    """Settings, the file they come from (None: all defaults), and the line of each key."""

    settings: Settings
    path: Path | None
    lines: dict[str, int]

    def place(self, key: str) -> str:
        """File, line and key for a message; a key that is not there has its section's line."""
        section = key
        while section and section not in self.lines:
            section = section.rpartition(".")[0]
        line = f", line {self.lines[section]}" if section else ""
        return f"{self.path}{line}, key {key}"


def find_settings(readings: Path) -> Path | None:
    """The YAML file of the same stem as the CSV file, if there is one.

    Raises:
        InputError: Both ``.yaml`` and ``.yml`` exist.
    """
    found = [p for p in (readings.with_suffix(s) for s in (".yaml", ".yml")) if p.exists()]
    if len(found) > 1:
        raise InputError(
            f"{found[0].name} and {found[1].name} stand side by side",
            where=str(readings.parent),
            remedy="Keep one of them.",
        )
    return found[0] if found else None


def read_settings(path: Path | None) -> SettingsFile:
    """Read and check the file; None gives the defaults.

    Raises:
        InputError: Text that is not YAML, an unknown, repeated or missing key, or a value that does
            not fit.
    """
    if path is None:
        return SettingsFile(Settings(), None, {})
    text = files.read_yaml(path)
    content = text.content
    lines = dict(_keys(text.node, str(path)))
    if content is None:
        content = {}
    if not isinstance(content, dict):
        raise InputError(
            "the file holds no keys",
            where=str(path),
            remedy="Write one 'key: value' per line. The keys are "
            f"{', '.join(Settings.model_fields)}.",
        )
    return settings_of(content, path, lines)


def settings_of(
    content: Mapping[str, Any], path: Path, lines: Mapping[str, int] | None = None
) -> SettingsFile:
    """Settings from their keys; `lines` tells where each stands in the file.

    Raises:
        InputError: An unknown or missing key, or a value that does not fit.
    """
    known = dict(lines or {})
    draft = SettingsFile(Settings(), path, known)
    settings = validated(Settings, _without_empty(content), draft.place, _EXAMPLES)
    return replace(draft, settings=settings)


def _keys(node: yaml.Node | None, path: str, above: str = "") -> Iterator[tuple[str, int]]:
    """Dotted keys and their lines, two levels below the top at most."""
    if not isinstance(node, yaml.MappingNode) or above.count(".") > 1:
        return
    seen: set[str] = set()
    for name, value in node.value:
        key = f"{above}.{name.value}" if above else f"{name.value}"
        line = name.start_mark.line + 1
        if key in seen:
            raise InputError(
                f"the key {key!r} stands there twice",
                where=f"{path}, line {line}",
                remedy="Keep one of them.",
            )
        seen.add(key)
        yield key, line
        yield from _keys(value, path, key)


def _without_empty(content: Mapping[Any, Any]) -> dict[str, object]:
    """A key without a value means its default."""
    return {
        str(key): _without_empty(value) if isinstance(value, dict) else value
        for key, value in content.items()
        if value is not None
    }
