"""Report tables as PolyWorks exports them: a row for each coordinate of each point."""

from __future__ import annotations

from dataclasses import dataclass, replace

from sk120stiff.errors import InputError
from sk120stiff.measurements.importers.columns.words import file_units, meaning_of, unit_of_header
from sk120stiff.measurements.importers.contract import NO, Guess, Sheet, Source
from sk120stiff.measurements.importers.grid import Grid
from sk120stiff.measurements.importers.layout.layout import SEARCHED, layout_of, sheet_of


@dataclass(frozen=True)
class PolyWorks:
    """``Name, Control, Nominal, Measured ...``, where the control is X, Y or Z."""

    name: str = "polyworks"
    title: str = "a PolyWorks report table"

    def sniff(self, source: Source) -> Guess:
        """The columns Name, Control and Measured."""
        found = _header(source.grid) if source.role == "points" else None
        return Guess(0.9, "a row for each control of a point") if found else NO

    def read(self, source: Source) -> Sheet:
        """One reading for each name that has X, Y and Z.

        Raises:
            InputError: No such table, or a control of a point that stands there twice.
        """
        grid = source.grid
        found = _header(grid)
        if found is None:
            raise InputError("no columns Name, Control and Measured", where=str(source.path))
        at, name, control, measured = found
        points: dict[str, dict[str, str]] = {}
        lines: dict[str, int] = {}
        left: dict[str, None] = {}
        last = ""
        for k in range(at + 1, len(grid.rows)):
            row = (*grid.rows[k], *[""] * (len(grid.rows[at]) - len(grid.rows[k])))
            last = row[name] or last  # the name may stand in the first row of a point alone
            axis = row[control].lower()
            if axis not in ("x", "y", "z"):
                left[f"control {row[control]}"] = None
                continue
            if axis in points.setdefault(last, {}):
                raise InputError(
                    f"{last} has its {axis.upper()} twice",
                    where=grid.place(k),
                    remedy="Give every measurement a name of its own.",
                )
            points[last][axis] = row[measured]
            lines.setdefault(last, grid.lines[k])
        unit = unit_of_header(grid.rows[at][measured])[1]
        said = file_units([t for _, t in grid.comments] + ["  ".join(r) for r in grid.rows[:at]])
        suffix = f" [{unit or said['length']}]" if unit or "length" in said else ""
        head = ("name", *(f"{axis}{suffix}" for axis in "xyz"))
        rows = (head, *((n, *(p.get(a, "") for a in "xyz")) for n, p in points.items()))
        others = [h for k, h in enumerate(grid.rows[at]) if k not in (name, control, measured)]
        made = replace(
            source,
            given=Grid(
                grid.path, rows, (grid.lines[at], *lines.values()), grid.comments, grid.how,
                grid.part, (*(f"column {h}" for h in others), *left),
            ),
        )  # fmt: skip
        layout = layout_of(made)
        if layout is None:
            raise InputError("no point has X, Y and Z", where=str(source.path))
        return sheet_of(made, layout, self.title, "a row for each control of a point")


def _header(grid: Grid) -> tuple[int, int, int, int] | None:
    """Row of the headers, and the columns of name, control and measured value."""
    for k, row in enumerate(grid.rows[:SEARCHED]):
        known = [meaning_of(unit_of_header(cell)[0]) if cell else None for cell in row]
        words = [found[0] if found else "" for found in known]
        if {"name", "control", "measured"} <= set(words):
            return k, words.index("name"), words.index("control"), words.index("measured")
    return None
