"""What `compensate` writes: a robot program, or the CSV file of the path."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from sk120stiff import __version__
from sk120stiff.arrays import Array
from sk120stiff.cli.opening import model_file
from sk120stiff.errors import InputError, warn
from sk120stiff.files import read_bytes, write_atomically
from sk120stiff.model import Model, typical_parameters
from sk120stiff.programs import Language
from sk120stiff.programs.bad_targets import refuse_bad_targets
from sk120stiff.programs.building import build
from sk120stiff.programs.orientation import fixed_xyz
from sk120stiff.robot import Robot, find_robot
from sk120stiff.workspace import Compensation, LoadedPath

PLACE = 6  # numbers of a place: more joints than these are not determined by it


def settings_of(texts: Sequence[str]) -> dict[str, str]:
    """``KEY=VALUE`` words of --set.

    Raises:
        InputError: One is none.
    """
    found: dict[str, str] = {}
    for text in texts:
        key, equals, value = text.partition("=")
        if not equals or not key.strip():
            raise InputError(
                f"{text!r} is no KEY=VALUE", where="--set", remedy="Write it like --set tool=1."
            )
        found[key.strip()] = value.strip()
    return found


def origin(named: str, model: Model, path: Path) -> list[str]:
    """From which program, model, data and path a result comes: the first lines of a header."""
    file = model_file(named) or find_robot(named).model_file
    of_model = f"Model: {named}" + (
        "" if file is None else f", {file.name} with SHA-256 {_digest(file)}"
    )
    data = [
        f"{key} {model.provenance[key]}"
        for key in ("data", "data_hash", "date")
        if key in model.provenance
    ]
    assumed = typical_parameters(model)
    typical = "Its springs are typical of an arm of this size, not measured. " if assumed else ""
    return [
        f"Written by sk120stiff {__version__}, compensated for the deflection under load.",
        f"{of_model}. {typical}"
        + (f"Fitted to {', '.join(data)}." if data else "It names no data."),
        f"Path: {path.name}, SHA-256 {_digest(path)}.",
        f"Robot: {model.robot.name}.",
    ]


def _digest(path: Path) -> str:
    return hashlib.sha256(read_bytes(path)).hexdigest()


def write_program(
    language: Language,
    out: Path,
    path: LoadedPath,
    robot: Robot,
    found: Compensation,
    *,
    frame: str | None,
    part: Array,
    feed: float,
    rapid: float,
    by_joints: bool,
    settings: Mapping[str, str],
    facts: Sequence[str],
) -> Mapping[str, str]:
    """Write the program; returns the settings that it was written with.

    Raises:
        Refusal: A target is beyond a limit, singular, or could not be corrected.
        InputError: The language cannot say it.
    """
    refuse_bad_targets(robot, path, found, frame, straight=not by_joints)
    if robot.n > PLACE and not by_joints:
        free = (
            f"Straight moves state the tool's place alone, which this arm of {robot.n} joints can "
            "hold in many postures: the correction is that of the joint values beside each target"
        ) + ("; --by-joints moves by those." if language.joint_moves else ".")
        warn(free)
        facts = [*facts, free]
    program = build(
        language, out, path, robot, found.a, frame=frame, part=part, feed=feed, rapid=rapid,
        by_joints=by_joints, given=settings, facts=facts,
        date=datetime.now(UTC).strftime("%Y/%m/%d %H:%M"),
    )  # fmt: skip
    write_atomically(out, language.text(program))
    return program.settings


def placement_columns(
    robot: Robot, path: LoadedPath, a: Array, frame: str | None
) -> dict[str, list[str]]:
    """Columns for a CSV file: where the commands put the unloaded tool, and the load."""
    place = robot.placement(a, frame)
    columns = {
        f"command_{name}[mm]": 1e3 * values
        for name, values in zip("xyz", place[:, :3, 3].T, strict=True)
    }
    angles = fixed_xyz(place[:, :3, :3]).T
    for name, values in zip(("roll", "pitch", "yaw"), angles, strict=True):
        columns[f"command_{name}[deg]"] = values
    if "fx" not in path.table.headers:
        heads = ("fx[N]", "fy[N]", "fz[N]", "mx[N*m]", "my[N*m]", "mz[N*m]")
        columns |= dict(zip(heads, path.wrench.T, strict=True))
    return {name: [f"{x:.9g}" for x in np.asarray(values)] for name, values in columns.items()}
