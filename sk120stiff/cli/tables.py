"""Tables and progress bars for people."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from math import isnan, pi
from typing import TYPE_CHECKING

from rich import box
from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    ProgressColumn,
    Task,
    TextColumn,
    TimeRemainingColumn,
)
from rich.table import Table
from rich.text import Text

from sk120stiff.cli.environment import visible

if TYPE_CHECKING:
    from sk120stiff.arrays import Array
    from sk120stiff.measurements import Measurements
    from sk120stiff.show import report


def table(title: str, columns: Sequence[str], rows: Iterable[Sequence[object]]) -> Table:
    """A table whose first column is text and whose other columns are right-aligned numbers."""
    made = Table(title=visible(title), title_justify="left", box=box.SIMPLE_HEAD, show_edge=False)
    for k, name in enumerate(columns):
        made.add_column(visible(name), justify="left" if k == 0 else "right", overflow="fold")
    for row in rows:
        made.add_row(*(cell(value) for value in row))
    return made


def shown(block: report.Table) -> Table:
    """A table of a report."""
    units = block.units or [""] * len(block.header)
    heads = [f"{name}\n{unit}".strip() for name, unit in zip(block.header, units, strict=True)]
    rows = [
        [f"{each:.{block.digits}g}" if isinstance(each, float) else each for each in row]
        for row in block.rows
    ]
    return table(block.caption, heads, rows)


def cell(value: object) -> str:
    """A number with five significant digits, "?" where it is not known, anything else as it is."""
    if isinstance(value, str):
        return visible(value)
    if isinstance(value, bool | int):
        return str(value)
    if isinstance(value, float) or hasattr(value, "__float__"):
        number = float(value) + 0.0  # takes the sign off zero
        return "?" if isnan(number) else f"{number:.5g}"
    return visible(str(value))


def plan_table(title: str, plan: Measurements, digits: int = 1) -> Table:
    """Poses, forces and payloads to be measured: degrees, mm, N, kg."""
    turns = [kind == "angle" for kind in plan.joint_kinds]
    scale = [180.0 / pi if turn else 1e3 for turn in turns]
    joints = zip(plan.joint_names, turns, strict=True)
    columns = ["pose", *(f"{name} [{'deg' if turn else 'mm'}]" for name, turn in joints)]
    rows: list[tuple[object, ...]] = [
        (label, *(f"{x:.{digits}f}" for x in a * scale))
        for label, a in zip(plan.pose, plan.joints, strict=True)
    ]
    if plan.absolute is None or plan.wrench.any():
        columns += ["fx [N]", "fy [N]", "fz [N]"]
        rows = [(*row, *_in_newtons(w[:3])) for row, w in zip(rows, plan.wrench, strict=True)]
    if plan.absolute is not None:
        columns.append("payload [kg]")
        hung = zip(rows, plan.absolute.payload, strict=True)
        rows = [(*row, f"{mass:.4g}") for row, mass in hung]
        if len(set(plan.absolute.markers)) > 1:
            columns.append("marker")
            rows = [(*row, name) for row, name in zip(rows, plan.absolute.markers, strict=True)]
    return table(title, columns, rows)


def _in_newtons(force: Array) -> Iterator[str]:
    """A force (3,) for people: whole newtons, of small ones tenths and hundredths."""
    size = abs(force).max()
    digits = 0 if size >= 30.0 else 1 if size >= 3.0 else 2
    return (f"{x:.{digits}f}" for x in force + 0.0)


class _Rate(ProgressColumn):
    def render(self, task: Task) -> Text:
        return Text(f"{task.speed:,.0f}/s" if task.speed else "")


@contextmanager
def progress_bar(doing: str) -> Iterator[Callable[[int, int], None]]:
    """A bar on stderr with rate and remaining time; yields ``report(done, total)``."""
    with progress_bars(doing) as (report,):
        yield report


@contextmanager
def progress_bars(*doing: str) -> Iterator[tuple[Callable[[int, int], None], ...]]:
    """A bar for each step of a work, shown from its first report on; the first one at once."""
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        _Rate(),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as progress:

        def reporting(step: str, *, visible: bool) -> Callable[[int, int], None]:
            task = progress.add_task(step, total=None, visible=visible)
            return lambda done, total: progress.update(
                task, completed=done, total=total, visible=True
            )

        yield tuple(reporting(step, visible=k == 0) for k, step in enumerate(doing))
