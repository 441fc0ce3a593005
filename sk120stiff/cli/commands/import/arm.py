"""The arm that was measured, of a robot of several whose tool frame nobody named."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from sk120stiff.cli.frame import note
from sk120stiff.cli.opening import model_file, open_robot
from sk120stiff.errors import InputError
from sk120stiff.measurements.importers.arm_of_columns import Arms, arms_of, words_of
from sk120stiff.robot import Robot, find_robot, load_robot


def open_arm(
    source: str, base: str | None, tool: str | None, files: Sequence[Path]
) -> tuple[Robot, Arms | None]:
    """The robot, with the tool frame of the one arm whose joints the files name; and its arms,
    where there are several and nothing tells which was measured.
    """
    arms = None
    bare = tool is None and model_file(source) is None
    if bare and find_robot(source).description.tool_frame is None:
        arms = arms_of(load_robot(source, base=base), base)
    if arms is None:
        return open_robot(source, base, tool), None
    named = arms.named_in(words_of(files))
    if len(named) != 1:
        return open_robot(source, base, tool), arms
    (chosen,) = named
    own = arms.joints[chosen]
    note(
        f"Tool frame: {chosen}, since the columns name the joints of this arm alone ({own[0]} to "
        f"{own[-1]}). Choose another with --tool FRAME."
    )
    return open_robot(source, base, chosen), None


@contextmanager
def naming(arms: Arms | None) -> Iterator[None]:
    """An error about joints says, too, which arms they may be those of.

    Raises:
        InputError: That error.
    """
    try:
        yield
    except InputError as error:
        if arms is None or "joint" not in f"{error.what} {error.remedy}":
            raise
        remedy = " ".join(filter(None, (error.remedy, arms.choices())))
        raise InputError(error.what, where=error.where, remedy=remedy) from error
