"""Of a robot of several arms, which one the joint columns of files name."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from sk120stiff.errors import ToolkitError, listed
from sk120stiff.measurements.importers.columns.words import unit_of_header
from sk120stiff.measurements.importers.contract import Source
from sk120stiff.measurements.importers.formats.workbook import all_sheets, is_workbook
from sk120stiff.measurements.importers.one_file import opened
from sk120stiff.robot import Robot, load_robot

SEARCHED = 80  # rows of a file in which headers may stand
FEWEST = 3  # motors of an arm


@dataclass(frozen=True)
class Arms:
    """The arms of a robot whose tool frame nobody named.

    Args:
        joints: Tool frame → joints that are no other arm's; that of the default comes first.
    """

    joints: dict[str, tuple[str, ...]]

    def named_in(self, words: set[str]) -> list[str]:
        """Tool frames of the arms whose own joints are all among these."""
        return [tool for tool, own in self.joints.items() if set(own) <= words]

    def choices(self) -> str:
        """What --tool may be, as a sentence."""
        each = [f"--tool {tool} ({own[0]} to {own[-1]})" for tool, own in self.joints.items()]
        return (
            f"This robot ends in {len(each)} places; say which was measured: {listed(each, 'or')}."
        )


def arms_of(robot: Robot, base: str | None) -> Arms | None:
    """The arms of a robot as it was loaded without a tool frame; None where there is one."""
    ends = [tool for tool, motors in robot.choice.others if motors >= FEWEST]
    if robot.tool_frame != robot.choice.tool or not ends:
        return None
    ways = {robot.tool_frame: robot.actuated}
    for tool in ends:
        ways[tool] = load_robot(robot.source, base=base, tool=tool).actuated
    own = {
        tool: tuple(j for j in way if all(j not in w for t, w in ways.items() if t != tool))
        for tool, way in ways.items()
    }
    apart = {tool: joints for tool, joints in own.items() if joints}
    return Arms(apart) if len(apart) > 1 else None


def words_of(paths: Sequence[Path]) -> set[str]:
    """Cells in which headers of these files may stand, without units; none of what is no table."""
    cells: set[str] = set()
    for path in paths:
        source = Source(path, ())
        try:
            book = not path.is_dir() and is_workbook(source.data)
            grids = all_sheets(source) if book else [opened(source).grid]
        except ToolkitError:  # its importer tells
            continue
        rows = [row for grid in grids for row in grid.rows[:SEARCHED]]
        texts = [text for grid in grids for _, text in grid.comments]
        cells |= {unit_of_header(cell)[0] for row in rows for cell in row if cell}
        cells |= {word.strip(" ,;") for text in texts for word in text.split()}
    return cells
