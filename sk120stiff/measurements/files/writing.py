"""`Measurements` become a CSV file and the YAML file of the same stem."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from numpy.typing import ArrayLike

from sk120stiff import files, units
from sk120stiff.arrays import Integers
from sk120stiff.errors import InputError
from sk120stiff.measurements.data import Measurements
from sk120stiff.measurements.directions import of_columns
from sk120stiff.measurements.files.writing_positions import (
    columns_of_positions,
    settings_of_positions,
)
from sk120stiff.measurements.noise_statement import Instrument
from sk120stiff.measurements.table.columns import (
    DIRECTIONS,
    DISPLACEMENTS,
    FORCES,
    MOMENTS,
    POSITIONS,
    UNCERTAINTIES,
)
from sk120stiff.measurements.zero import of_displacement

_Column = tuple[str, Iterable[str]]


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
    Positions as such (`Measurements.absolute`) are written as they were read, to 15 digits; a plan
    of them has blank cells where readings will stand.

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
        columns = columns_of(measurements, angle, length, measured)
        keys = _settings(measurements, target.parent, length)
    else:
        columns = columns_of_positions(measurements, said, angle, length)
        keys = {
            **_named(measurements, target.parent),
            **settings_of_positions(measurements, said, length),
            **_beside(measurements),
        }
    text = files.csv_text(columns)
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
) -> Iterable[_Column]:
    """Headers with units, and cells, of the CSV file; `measured` names the displacements."""
    yield "pose", m.pose
    for k, name in enumerate(m.joint_names):
        kind = m.joint_kinds[k]
        yield _numbers(name, m.joints[:, k], angle if kind == "angle" else length, kind)
    for k, name in enumerate(FORCES):
        yield _numbers(name, m.wrench[:, k], "N", "force")
    if np.any(m.wrench[:, 3:]):
        for k, name in enumerate(MOMENTS):
            yield _numbers(name, m.wrench[:, 3 + k], "N*m", "moment")
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
        yield _numbers("d", of_columns(m.directions, moved), length, "length")
        for k, name in enumerate(DIRECTIONS):
            yield name, map(_digits, m.directions[:, k])
        moved = None
    for names, values in ((measured, moved), (UNCERTAINTIES, sigma)):
        if values is not None:
            for k, name in enumerate(names):
                yield _numbers(name, values[:, k], length, "length")
    if m.order is not None:
        yield "order", map(_digits, m.order)
    if m.time is not None:
        yield "time[s]", map(_digits, m.time)
    if m.branch is not None:
        yield "branch", m.branch
    if m.repeat is not None:
        yield "repeat", map(str, m.repeat)
    if not m.use.all():
        yield "use", ("1" if used else "0" for used in m.use)
    yield from _zero_columns(m)
    yield from m.extra.items()


def _shortest(si: float, unit: str) -> float:
    """A length without the rounding of its unit: 0.015 mm, not 0.015000000000000001."""
    if unit == "m":
        return si
    whole = float(units.from_si(si, unit, "length"))
    short = float(f"{whole:.15g}")
    back = float(units.to_si(short, unit, "length"))
    return short if abs(back - si) <= 2.0 * np.spacing(si) else whole


def _zero_columns(m: Measurements) -> Iterable[_Column]:
    """What the reader would not guess of the zero readings by itself."""
    plain = np.arange(m.n_readings) if m.zero == "separate" else m.pose_index
    if not _same_grouping(plain, m.zero_group):
        yield "zero_group", map(str, m.zero_group)
    if np.any(m.zero_count != 1):
        yield "zero_count", map(str, m.zero_count)
    if m.zero_order is not None:
        yield "zero_order", map(_digits, m.zero_order)
    if m.zero_time is not None:
        yield "zero_time[s]", map(_digits, m.zero_time)


def _same_grouping(a: Integers, b: Integers) -> bool:
    pairs = len(set(zip(a.tolist(), b.tolist(), strict=True)))
    return pairs == len(np.unique(a)) == len(np.unique(b))


def _numbers(name: str, values: ArrayLike, unit: str, kind: str) -> _Column:
    numbers = np.array(values, dtype=np.float64)
    known = np.isfinite(numbers)  # else it was not read
    numbers[known] = units.from_si(numbers[known], unit, kind)
    return f"{name}[{unit}]", map(_digits, numbers)


def _digits(value: float) -> str:
    """The shortest text that reads back as the same float; NaN is an empty cell."""
    return "" if np.isnan(value) else repr(float(value))


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
    settings["point"] = _point(m.point, length)
    settings["force"] = {"frame": m.force_frame}
    if not np.array_equal(m.force_point, m.point):
        settings["force"]["point"] = _point(m.force_point, length)
    settings["displacement"] = {"frame": m.displacement_frame, "zero": m.zero}
    noise: dict[str, Any] = {}
    if m.noise.sigma is not None:
        noise["sigma"] = _shortest(m.noise.sigma, length)
        noise["unit"] = length
    if m.noise.instrument is not None:
        noise["instrument"] = _instrument(m.noise.instrument, length)
        noise["unit"] = length
    if m.noise.growth is not None:
        noise["growth"] = m.noise.growth
    if m.noise.force is not None:
        noise["force"] = m.noise.force
    if noise:
        settings["noise"] = noise
    return settings | _beside(m)


def _instrument(stated: Instrument, length: str) -> dict[str, Any]:
    sizes = ("along", "across", "along_per_m", "across_per_m")
    return _point(stated.place, length) | {
        name: _shortest(value, length) for name in sizes if (value := getattr(stated, name)) > 0.0
    }


def _point(xyz: ArrayLike, length: str) -> dict[str, Any]:
    return {"xyz": [float(x) for x in units.from_si(xyz, length, "length")], "unit": length}


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
