"""`sk120stiff check ROBOT`."""

from __future__ import annotations

from sk120stiff.cli.frame import Answer
from sk120stiff.cli.opening import model_file
from sk120stiff.cli.options import BaseOption, RobotOrModelArgument, ToolOption
from sk120stiff.cli.tables import table
from sk120stiff.model import robot_of_model
from sk120stiff.robot.checks import CheckReport, check_robot


def command(
    robot: RobotOrModelArgument, base: BaseOption = None, tool: ToolOption = None
) -> Answer:
    """Does a robot load, what moves, what is suspicious.

    Example: sk120stiff check motoman_sk120
    """
    file = model_file(robot)
    report = check_robot(robot if file is None else robot_of_model(file), base=base, tool=tool)
    document = {
        "name": report.name,
        "base_frame": report.base_frame,
        "tool_frame": report.tool_frame,
        "actuated": report.actuated,
        "coupled": report.coupled,
        "loops": report.loops,
        "moving": report.moving,
        "frames": report.frames,
        "other_ends": [
            {"frame": frame, "joints": joints} for frame, joints in report.choice.others
        ],
        "fingers": report.choice.fingers,
        "total_mass_kg": report.total_mass_kg,
        "warnings": report.warnings,
    }
    return Answer(document, parts=_parts(report))


def _parts(report: CheckReport) -> list[object]:
    mass = f"{report.total_mass_kg:g} kg" if report.total_mass_kg else "none stated"
    facts = [
        ("actuated", report.actuated),
        ("coupled", report.coupled),
        ("loops", report.loops),
        ("frames", report.frames),
        ("total mass", [mass]),
    ]
    lines = [f"{report.name}: it loads."]
    lines += [f"  {reason}" for reason in report.chosen_because]
    lines += [f"{label}: {', '.join(names) or 'none'}" for label, names in facts]
    if not report.warnings:
        return [*lines, "Nothing suspicious."]
    suspicions = table(
        f"Suspicious ({len(report.warnings)})",
        ["code", "where", "what"],
        [(finding.code, finding.where, finding.message) for finding in report.warnings],
    )
    for column in suspicions.columns:
        column.justify = "left"
    return [*lines, suspicions]
