"""Points of a path as they were measured: where the loaded tool did stand.

::

    point,run,x[mm],y[mm],z[mm]              positions, in the axes of the path
    point,run,dx[mm],dy[mm],dz[mm]           or displacements from where the tool was meant to stand

``run`` is ``before`` (sent without correction) or ``after``, which also holds where the column is
missing. ``point`` is the label of the path's CSV file, else the number of the point, from 1;
without the column there is one row per point, in order.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sk120stiff.arrays import Array, Mask
from sk120stiff.errors import InputError
from sk120stiff.measurements.table.table import read_table
from sk120stiff.workspace.path import LoadedPath

RUNS = ("before", "after")
FAR = 0.1  # m: no arm yields as much at work; another unit or other axes do


@dataclass(frozen=True, eq=False)
class Returned:
    """Measured points of one run.

    Attributes:
        run: ``before`` or ``after``.
        away: (N, 3) from where the tool was meant to stand, axes of the path [m]; NaN where no
            point was measured.
    """

    run: str
    away: Array

    @property
    def seen(self) -> Mask:
        """(N,) was the point measured?"""
        return np.asarray(np.isfinite(self.away).all(axis=1))

    @property
    def rms(self) -> float:
        """Root mean square distance from the target [m]."""
        return _rms(self.away[self.seen])

    @property
    def constant(self) -> Array:
        """(3,) mean displacement: what a shifted frame of part or tracker would make [m]."""
        return np.asarray(self.away[self.seen].mean(axis=0))

    @property
    def about_constant(self) -> float:
        """Root mean square distance without the constant part [m]."""
        return _rms(self.away[self.seen] - self.constant)

    def apart(self, predicted: Array) -> float:
        """Root mean square distance from displacements (N, 3) that were predicted [m]."""
        both = self.seen & np.isfinite(predicted).all(axis=1)
        return _rms((self.away - predicted)[both])


def _rms(away: Array) -> float:
    return float(np.sqrt(np.mean((away**2).sum(axis=1)))) if len(away) else float("nan")


def read_returned(
    file: str | os.PathLike[str], path: LoadedPath, meant: Array
) -> tuple[Returned, ...]:
    """Read what came back of a path whose tool was meant to stand at (N, 3) [m, its own axes].

    Raises:
        InputError: The file cannot be read, names points or runs that do not exist, or names one
            twice; or a point is nowhere near its target.
    """
    table = read_table(Path(file))
    has = set(table.headers)
    names = ("dx", "dy", "dz") if "dx" in has else ("x", "y", "z")
    values = table.quantities(names, "length")
    runs = table.cells.get("run", ("after",) * len(values))
    labels = path.table.cells.get("point") or tuple(str(k + 1) for k in range(path.count))
    where = {label: k for k, label in enumerate(labels)}
    found = {run: np.full((path.count, 3), np.nan) for run in RUNS}
    given = dict.fromkeys(RUNS, 0)
    for row, (run, value) in enumerate(zip(runs, values, strict=True)):
        if run not in RUNS:
            raise InputError(
                f"{run!r} is no run", where=table.place("run", row), remedy="Write before or after."
            )
        k = given[run]
        given[run] += 1
        if "point" in has:
            label = table.cells["point"][row]
            if label not in where:
                raise InputError(
                    f"the path has no point {label!r}",
                    where=table.place("point", row),
                    remedy=f"Points are {labels[0]} to {labels[-1]}.",
                )
            k = where[label]
        elif k >= path.count:
            break
        if np.isfinite(found[run][k]).all():
            raise InputError(
                f"point {table.cells['point'][row]!r} stands twice in the run {run!r}",
                where=table.place("point", row),
            )
        found[run][k] = value if names[0] == "dx" else value - meant[k]
    for run, count in given.items():
        if "point" not in has and count not in (0, path.count):
            raise InputError(
                f"{count} rows of the run {run!r} for {path.count} points",
                where=str(table.path),
                remedy="Add a column point with the label, or number, of each point.",
            )
    for run, away in found.items():
        distance = np.nan_to_num(np.linalg.norm(away, axis=1))
        worst = int(distance.argmax())
        if distance[worst] > FAR:
            raise InputError(
                f"in the run {run!r} the tool would stand {distance[worst]:.3g} m from its target",
                where=f"{table.path}, point {labels[worst]}",
                remedy="Check the unit; positions are in the axes of the path (--frame).",
            )
    return tuple(Returned(run, away) for run, away in found.items() if given[run])
