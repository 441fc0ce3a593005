"""What `compensate` writes: a robot program, or the CSV file of the path; and the sheet.

The sheet has the path before and after, predicted and as it came back.
"""

from __future__ import annotations

import shlex
import sys
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

from sk120stiff import __version__
from sk120stiff.arrays import Array
from sk120stiff.cli.opening import model_file
from sk120stiff.cli.shares import budget_tables_of
from sk120stiff.errors import InputError, warn
from sk120stiff.explain.answer.document import share_entries
from sk120stiff.files import sha256_of, write_atomically
from sk120stiff.model import Model, typical_parameters
from sk120stiff.programs import Language
from sk120stiff.programs.bad_targets import refuse_bad_targets
from sk120stiff.programs.building import build
from sk120stiff.programs.controller import checked_text
from sk120stiff.programs.orientation import fixed_xyz
from sk120stiff.robot import Robot, find_robot
from sk120stiff.workspace import Compensation, Judged, LoadedPath

DISTANCE = float(np.sqrt(3.0))  # from rms per axis to rms distance
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
        "" if file is None else f", {file.name} with SHA-256 {sha256_of(file)}"
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
        f"Path: {path.name}, SHA-256 {sha256_of(path)}.",
        f"Robot: {model.robot.name}.",
    ]


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
    in_part = part if language.in_part_frame(program.settings) else None
    write_atomically(out, checked_text(language, program, robot, found.a, frame, in_part))
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


def check_sheet(sheet: Path | None) -> None:
    """Complain of a sheet that cannot be written, before the work.

    Raises:
        InputError: See `will_show`.
        MissingPart: What draws is not installed.
    """
    from sk120stiff.cli.outputs import will_draw, will_show

    will_show(sheet, "--sheet")
    will_draw(sheet)


def measured_keys(judged: Judged) -> dict[str, dict[str, Any]]:
    """The key `measured`."""
    return {
        each.run: {
            "points": int(each.seen.sum()),
            "rms_um": 1e6 * each.rms,
            "max_um": 1e6 * float(np.nanmax(np.linalg.norm(each.away, axis=1))),
            "constant_um": 1e6 * each.constant,
            "about_constant_um": 1e6 * each.about_constant,
            "off_prediction_um": 1e6 * judged.off_prediction(each),
        }
        for each in judged.returned
    }


def budget_keys(judged: Judged) -> dict[str, object]:
    """The key `budget`: rms distances along the path."""
    names = ("effects", "joints")
    return {
        name: [entry.model_dump() for entry in share_entries(shares, DISTANCE)]
        for name, shares in zip(names, judged.budgets, strict=True)
    }


def budget_parts(judged: Judged) -> list[object]:
    """The same for people."""
    return budget_tables_of("Uncorrected, along the path", "µm rms", *judged.budgets, DISTANCE)


def write_sheet(
    judged: Judged,
    sheet: Path,
    named: str,
    source: Path,
    facts: Sequence[str],
    uncertainty: Sequence[str],
) -> None:
    """Write the page."""
    from sk120stiff.show import reproducibility
    from sk120stiff.show.stories import PathSheet

    file = model_file(named)
    command = " ".join(["sk120stiff", *(shlex.quote(word) for word in sys.argv[1:])])
    inputs = [each for each in (file, source, judged.measured) if each is not None]
    PathSheet(
        path=source.name,
        robot=judged.model.robot.name,
        lines=judged.path.table.lines,
        position=judged.meant,
        before=judged.in_path(judged.before.away),
        after=judged.in_path(judged.after.away),
        std=None if judged.uncertainty is None else judged.uncertainty.std,
        uncertainty=uncertainty,
        shares=judged.budgets[0],
        measured=judged.returned,
        facts=facts,
        reproducibility=reproducibility(command, inputs),
    ).report().write(sheet)


def measured_words(found: Mapping[str, Mapping[str, Any]]) -> list[str]:
    """What came back, in sentences."""
    said = []
    for run, keys in found.items():
        said.append(
            f"Measured {run} correction: {keys['rms_um']:.3g} µm rms, {keys['max_um']:.3g} at most,"
            f" over {keys['points']} points; {keys['off_prediction_um']:.3g} µm off the prediction."
        )
    return said
