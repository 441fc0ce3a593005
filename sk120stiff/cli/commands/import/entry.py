"""`sk120stiff import FILE... --robot ROBOT --out FILE.csv`."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from sk120stiff.arrays import Array
from sk120stiff.cli.frame import Answer, ahead
from sk120stiff.cli.opening import declare_readings, wrench_of
from sk120stiff.cli.options import BaseOption, ToolOption
from sk120stiff.cli.tables import progress_bar
from sk120stiff.errors import InputError, warn
from sk120stiff.measurements.importers import Told, import_readings
from sk120stiff.measurements.importers.loads.masses_in_words import mass_told
from sk120stiff.units import parse_values

from .arm import naming, open_arm
from .preview import document_of, doubts_of, preview_of


class Length(StrEnum):
    """Unit of positions."""

    m = "m"
    mm = "mm"
    um = "um"
    inch = "in"


class Angle(StrEnum):
    """Unit of joint values."""

    rad = "rad"
    deg = "deg"


class Load(StrEnum):
    """Unit of forces, or of a payload."""

    N = "N"
    kN = "kN"
    kg = "kg"


class Axes(StrEnum):
    """Axes of forces."""

    base = "base"
    tool = "tool"
    instrument = "instrument"


class TakenAs(StrEnum):
    """What positions of a pose under several loads become."""

    positions = "positions"
    displacements = "displacements"


class Dates(StrEnum):
    """What comes first in dates like 10/09/2026."""

    dmy = "dmy"
    mdy = "mdy"


def command(
    sources: list[Path],
    robot: Annotated[str, typer.Option("--robot")],
    out: Path | None = None,
    preview: Annotated[bool, typer.Option("--preview", "--dry-run")] = False,
    joints_file: Path | None = None,
    loads_file: Path | None = None,
    before: Path | None = None,
    length: Length | None = None,
    angle: Angle | None = None,
    load: Load | None = None,
    forces: Axes | None = None,
    forces_rpy: str | None = None,
    wrench: str | None = None,
    payload: list[str] | None = None,
    payload_point: str | None = None,
    coverage: Annotated[float | None, typer.Option(min=0.1)] = None,
    dates: Dates | None = None,
    point: list[str] | None = None,
    joints: str | None = None,
    columns: str | None = None,
    taken_as: Annotated[TakenAs | None, typer.Option("--as")] = None,
    register: Annotated[bool | None, typer.Option("--register/--no-register")] = None,
    format_name: Annotated[str | None, typer.Option("--format")] = None,
    marker: str | None = None,
    sheet: list[str] | None = None,
    topic: str | None = None,
    base: BaseOption = None,
    tool: ToolOption = None,
) -> Answer:
    """Readings of trackers and calibration programs as measurements.

    Knows SpatialAnalyzer, Leica, PolyWorks, RoboDK, DELMIA, FIGAROH, plain lists, Excel, MATLAB,
    numpy and ROS 2 bags by their content, and shows what it understood: columns, units, axes, what
    is left out, how well the positions fit the robot, and what can be identified.

    Example: sk120stiff import points.txt --joints-file joints.csv --robot ur5.urdf --length mm
    --angle deg --out own.csv

    Args:
        sources (FILE): Positions of a marker, with or without joints: text of any separator, .xlsx,
            .mat, .npz, or the folder of a ROS bag. What it is, its content tells. Several files of
            the same columns are one campaign; the tracker may have moved in between.
        robot (ROBOT): A .urdf, a .xacro, a DH table (.csv), a folder with robot.yaml, or a bundled
            name (motoman_sk120).
        out (FILE): The CSV file to write; a YAML file goes beside it.
        preview: Show what was understood; write nothing.
        joints_file (FILE): Joint values, where they stand in a file of their own, or the robot's
            program with its joint targets; matched by name, else by order.
        loads_file (FILE): Forces or payloads, in the same way.
        before (FILE): Positions of the same poses without load, in the same way; those of FILE are
            then under the load.
        length: Unit of positions, where the file does not say it.
        angle: Unit of joint angles, where the file does not say it.
        load: Unit of fx,fy,fz or payload (kg: payload alone).
        forces: Axes of fx,fy,fz and mx,my,mz; instrument: those in which the positions stand.
            [default: base]
        forces_rpy (VALUES): Roll, pitch, yaw of the sensor's axes in those that --forces names:
            '0,0,45 deg'. [default: not turned]
        wrench (VALUES): What the column load counts, on the robot in base axes: '0,0,-490 N'.
        payload (MASS): What hung on the tool in all rows, where no column says it: '5 kg', '500 g'
            or '10 lb', one mass ('0,5 kg' is 0.5 kg); of several files each by its name, 'a.csv=5
            kg', or '*_b.csv=5 kg'. [default: where names of files or lines above the tables say
            one mass, that]
        payload_point (VALUES): Where the centre of the payload is in the tool frame: '0,0,120 mm'.
            [default: of positions found by 'identify' and 'explain' where masses differ, else the
            tool frame's origin]
        coverage (K): Stated uncertainties are K times standard ones. [default: 2 for U95, else 1]
        dates: Day (dmy) or month (mdy) first in dates like 10/09/2026, where the file leaves it
            open.
        point (VALUES): Where the marker sits in the tool frame: '0,0,150 mm'; of several each by
            its name, 'A=0,0,150 mm'. [default: found by the fit]
        joints (NAMES): Columns of the actuated joints, in the joints' order: 'a,b,c'; or sums of
            them, as controllers have it: 'q1,q2,-(q2+q3)'. Names may hold blanks: 'J 1,J 2,J 2+J
            3'. [default: named as the joints, or q1,q2,...]
        columns (NAMES): Names for the columns of FILE, in their order, where it has no headers:
            'name,x,y,z'; a dash for one that is not needed.
        taken_as: What positions of a pose under several loads become: positions show geometry and
            springs; displacements are their differences, and show springs. [default: positions
            under payloads from ten poses on, unless loads rise and fall; displacements else]
        register: Write positions in base axes, by the best fit of the robot to them. [default: only
            where displacements are made of positions in other axes]
        format_name (NAME): sa, leica, polyworks, robodk, delmia, figaroh, rosbag or points.
            [default: told by the content]
        marker (NAME): One marker alone, where there are several (of a column marker, or 2 of x1,
            x2). [default: all, as positions]
        sheet (NAME): Which sheet of a workbook; for files beside FILE, which may be the same
            workbook, with what it is for: 'before=NAME', 'joints=NAME', 'loads=NAME'.
        topic (NAME): Which topic of a recording, or of headers like /vicon/tool/pose/position/x,
            has positions.
    """
    if out is None and not preview:
        raise InputError(
            "nobody said where to write",
            where="--out",
            remedy="Give --out own.csv, or --preview to see what was understood.",
        )
    if not preview:
        declare_readings(out)
    beside = [file for file in (joints_file, loads_file) if file is not None]
    arm, arms = open_arm(robot, base, tool, [*sources, *beside])
    one, several = _places(point or [])
    told = Told(
        length=length,
        angle=angle,
        load=load,
        wrench=None if wrench is None else wrench_of(wrench),
        point=one,
        points=several,
        payload_point=None
        if payload_point is None
        else parse_values(payload_point, "length", where="--payload-point", like="0,0,120 mm"),
        payloads=_masses(payload or []),
        joints=_names(joints),
        coverage=coverage,
        forces=None if forces is None else forces.value,
        forces_rpy=None
        if forces_rpy is None
        else parse_values(forces_rpy, "angle", where="--forces-rpy", like="0,0,45 deg"),
        dates=None if dates is None else dates.value,
    )
    with naming(arms), progress_bar("Reading the file and placing the arm"):
        found = import_readings(
            sources,
            arm,
            told,
            joints_file=joints_file,
            loads_file=loads_file,
            before=before,
            format_name=format_name,
            columns=_names(columns),
            sheet=sheet,
            topic=topic,
            marker=marker,
            into_base=register,
            taken_as=None if taken_as is None else taken_as.value,
        )
    doubts = doubts_of(found, arm)
    for sentence in doubts:
        warn(sentence)
    parts = preview_of(found, arm)
    if preview or out is None:
        parts.append("Nothing was written (--preview).")
    else:
        ahead(parts)
        found.write(out)
        parts = [f"Written to {out} and {out.with_suffix('.yaml')}."]
    document = {**document_of(found, out, written=not preview), "doubts": doubts}
    return Answer(document, parts)


def _names(text: str | None) -> tuple[str, ...] | None:
    return None if text is None else tuple(name.strip() for name in text.split(","))


def _masses(texts: list[str]) -> dict[str, float]:
    """What hung on the tool [kg] by the names of files, of all files by an empty one.

    Raises:
        InputError: No mass, or two of one file.
    """
    found: dict[str, float] = {}
    for text in texts:
        name, _, mass = text.rpartition("=")
        if name.strip() in found:
            raise InputError(
                f"two masses are told of {name.strip() or 'all files'}",
                where="--payload",
                remedy="Name the file before each mass: --payload 'a.csv=0 kg' --payload "
                "'b.csv=5 kg'.",
            )
        found[name.strip()] = mass_told(mass, "--payload")
    return found


def _places(texts: list[str]) -> tuple[Array | None, dict[str, Array]]:
    """The place of the only marker, or those of several by their names [m].

    Raises:
        InputError: Some of several places have no name, or one name has two.
    """
    named = {}
    for text in texts:
        name, _, place = text.rpartition("=")
        if (not name.strip() and len(texts) > 1) or name.strip() in named:
            raise InputError(
                f"{len(texts)} places, and it is not told whose each is",
                where="--point",
                remedy="Name the marker before each place: --point 'A=0,0,150 mm' --point "
                "'B=50,0,150 mm'.",
            )
        named[name.strip()] = parse_values(place, "length", where="--point", like="0,0,150 mm")
    return named.pop("", None), named
