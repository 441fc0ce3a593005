"""`Measurements` become a CSV file and the YAML file of the same stem."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from sk120stiff import files
from sk120stiff.arrays import Integers
from sk120stiff.errors import InputError
from sk120stiff.measurements.data import Measurements
from sk120stiff.measurements.directions import of_columns
from sk120stiff.measurements.files.entries import (
    Column,
    bare,
    column,
    columns,
    digits,
    instrument_entry,
    length_entry,
    point_entry,
)
from sk120stiff.measurements.files.writing_positions import (
    columns_of_positions,
    settings_of_positions,
)
from sk120stiff.measurements.table.columns import (
    DIRECTIONS,
    DISPLACEMENTS,
    FORCES,
    MOMENTS,
    POSITIONS,
    UNCERTAINTIES,
)
from sk120stiff.measurements.zero import of_displacement


def write_measurements(
    measurements: Measurements,
    path: str | os.PathLike[str],
    *,
    angle: str = "deg",
    length: str = "mm",
    as_positions: bool = False,
) -> Path:
    """Write both files so that `read_measurements` gives the same readings back.

    Numbers carry all digits of a float. With ``angle="rad"`` and ``length="m"`` they come back
    bit for bit; with other units within one rounding of the conversion. Readings that came as
    positions are written as displacements, with what they subtracted in the columns
    ``zero_group``, ``zero_count``, ``zero_order`` and ``zero_time[s]`` where that is not plain.
    Positions as such (`Measurements.absolute`) are written as they were read; a plan of them
    has blank cells where readings will stand.

    Args:
        measurements: What to write; masked rows too, with ``use`` 0.
        path: The CSV file. The YAML file stands beside it.
        angle, length: Units of the columns.
        as_positions: `displacement` holds positions, rows without load among them: write the
            columns x, y, z.

    Returns:
        Path: The CSV file.

    Raises:
        InputError: The folder cannot be written to, the path does not end in ``.csv``, or a
            ``.yml`` file of the same stem is in the way.

    Examples:
        >>> import sk120stiff as sk
        >>> data = sk.bundled_robots()["motoman_sk120"] / "data"
        >>> readings = sk.read(data / "table2_measured.csv")
        >>> import tempfile, pathlib
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     file = sk.write_measurements(readings, pathlib.Path(folder) / "copy.csv")
        ...     sk.read(file).n_readings
        15
    """
    target = Path(path)
    check_name(target)
    measured = POSITIONS if as_positions else DISPLACEMENTS
    said = measurements.absolute if measurements.displacement is None else None
    if said is None:
        cells = columns_of(measurements, angle, length, measured)
        keys = _settings(measurements, target.parent, length)
    else:
        cells = columns_of_positions(measurements, said, angle, length)
        keys = {
            **_named(measurements, target.parent),
            **settings_of_positions(measurements, said, length),
            **_beside(measurements),
        }
    text = files.csv_text(cells)
    settings = yaml.safe_dump(keys, sort_keys=False, allow_unicode=True)
    with files.together():
        files.write_atomically(target.with_suffix(".yaml"), settings)
        return files.write_atomically(target, text)


def check_name(target: Path) -> None:
    """Refuse a name that readings cannot be written to.

    Raises:
        InputError: It does not end in ``.csv``, or a ``.yml`` file of the same stem is in the way.
    """
    if target.suffix.lower() != ".csv":
        raise InputError(
            "readings are written to a CSV file",
            where=str(target),
            remedy="Let the name end in .csv.",
        )
    rival = target.with_suffix(".yml")
    if rival.exists():
        raise InputError(
            "this file would stand beside the settings that are written",
            where=str(rival),
            remedy="Move it, or choose another name.",
        )


def columns_of(
    m: Measurements, angle: str, length: str, measured: tuple[str, ...]
) -> Iterable[Column]:
    """Headers with units, and cells, of the CSV file; `measured` names the displacements."""
    yield "pose", m.pose
    for k, name in enumerate(m.joint_names):
        kind = m.joint_kinds[k]
        yield column(name, m.joints[:, k], angle if kind == "angle" else length, kind)
    yield from columns(FORCES, m.wrench[:, :3], "N", "force")
    if np.any(m.wrench[:, 3:]):
        yield from columns(MOMENTS, m.wrench[:, 3:], "N*m", "moment")
    sigma = m.sigma
    if sigma is not None and m.displacement is not None and measured == DISPLACEMENTS:
        sigma = of_displacement(sigma, m.zero_count)
    moved = m.displacement
    if m.directions is not None and moved is not None:
        if (m.read.sum(axis=1) > 1).any():
            raise InputError(
                "gauges along directions of their own stand beside whole displacements, and one "
                "file holds either",
                remedy="Write them to two files.",
            )
        yield column("d", of_columns(m.directions, moved), length, "length")
        yield from bare(DIRECTIONS, m.directions)
        moved = None
    for names, values in ((measured, moved), (UNCERTAINTIES, sigma)):
        if values is not None:
            yield from columns(names, values, length, "length")
    if m.order is not None:
        yield "order", map(digits, m.order)
    if m.time is not None:
        yield "time[s]", map(digits, m.time)
    if m.branch is not None:
        yield "branch", m.branch
    if m.repeat is not None:
        yield "repeat", map(str, m.repeat)
    if not m.use.all():
        yield "use", ("1" if used else "0" for used in m.use)
    yield from _zero_columns(m)
    yield from m.extra.items()


def _zero_columns(m: Measurements) -> Iterable[Column]:
    """What the reader would not guess of the zero readings by itself."""
    plain = np.arange(m.n_readings) if m.zero == "separate" else m.pose_index
    if not _same_grouping(plain, m.zero_group):
        yield "zero_group", map(str, m.zero_group)
    if np.any(m.zero_count != 1):
        yield "zero_count", map(str, m.zero_count)
    if m.zero_order is not None:
        yield "zero_order", map(digits, m.zero_order)
    if m.zero_time is not None:
        yield "zero_time[s]", map(digits, m.zero_time)


def _same_grouping(a: Integers, b: Integers) -> bool:
    pairs = len(set(zip(a.tolist(), b.tolist(), strict=True)))
    return pairs == len(np.unique(a)) == len(np.unique(b))


def _named(m: Measurements, folder: Path) -> dict[str, Any]:
    """The robot and its frames."""
    names = {
        "robot": robot_seen_from(m.robot, folder),
        "base_frame": m.base_frame,
        "tool_frame": m.tool_frame,
    }
    return {key: name for key, name in names.items() if name is not None}


def _beside(m: Measurements) -> dict[str, Any]:
    """Gravity and source."""
    gravity = {} if m.gravity is None else {"gravity": m.gravity.tolist()}
    return gravity | ({"source": m.source} if m.source else {})


def _settings(m: Measurements, folder: Path, length: str) -> dict[str, Any]:
    settings = _named(m, folder)
    settings["point"] = point_entry(m.point, length)
    settings["force"] = {"frame": m.force_frame}
    if not np.array_equal(m.force_point, m.point):
        settings["force"]["point"] = point_entry(m.force_point, length)
    settings["displacement"] = {"frame": m.displacement_frame, "zero": m.zero}
    noise: dict[str, Any] = {}
    if m.noise.sigma is not None:
        noise["sigma"] = length_entry(m.noise.sigma, length)
        noise["unit"] = length
    if m.noise.instrument is not None:
        stated = m.noise.instrument
        noise["instrument"] = point_entry(stated.place, length) | instrument_entry(stated, length)
        noise["unit"] = length
    if m.noise.growth is not None:
        noise["growth"] = m.noise.growth
    if m.noise.force is not None:
        noise["force"] = m.noise.force
    if noise:
        settings["noise"] = noise
    return settings | _beside(m)


def robot_seen_from(robot: str | None, folder: Path) -> str | None:
    """A path is written relative to the file, so that both can move together."""
    if robot is None:
        return None
    from sk120stiff.robot.naming import RobotName, robot_name  # Pinocchio comes with it

    name = robot_name(robot)
    if not Path(name.place).is_absolute():
        return str(name.seen_from(folder))
    seen = Path(os.path.relpath(name.place, folder.resolve())).as_posix()
    return str(RobotName(seen, name.arguments))
