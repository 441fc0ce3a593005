"""Measurements as a pandas table and back, with the headers of the CSV file."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from sk120stiff.errors import MissingPart, require

if TYPE_CHECKING:
    import pandas as pd

    from sk120stiff.measurements.data import Measurements

SHOWN = 10  # rows in a notebook
NOWHERE = Path("frame")  # what messages call a table that is no file
WORDS = ("pose", "branch")  # columns that hold text; those with a unit hold numbers


class Tabular:
    """What `Measurements` can do with tables."""

    def to_frame(self, *, angle: str = "deg", length: str = "mm") -> pd.DataFrame:
        """One row per reading, with the headers and units of the CSV file.

        Examples:
            >>> import sk120stiff as sk
            >>> data = sk.bundled_robots()["motoman_sk120"] / "data" / "table2_measured.csv"
            >>> frame = sk.read(data).to_frame()
            >>> list(frame.columns[:3]), len(frame)
            (['pose', 'joint_1_s[deg]', 'joint_2_l[deg]'], 15)
        """
        require("pandas", needed_for="a data frame")
        import pandas as pd

        from sk120stiff.measurements.files.writing import columns_of
        from sk120stiff.measurements.table.columns import DISPLACEMENTS

        readings = cast("Measurements", self)
        own = {
            name: list(cells) for name, cells in columns_of(readings, angle, length, DISPLACEMENTS)
        }
        frame = pd.DataFrame(own)
        texts = {*WORDS, *readings.extra}
        for name in frame.columns:
            if name not in texts:
                kind = pd.to_numeric(frame[name]).dtype
                # Digit by digit: pandas before 3 rounds a third of all texts to a neighbour.
                exact = [float(cell) if cell else float("nan") for cell in own[name]]
                frame[name] = pd.Series(exact).astype(kind)
        return frame

    @classmethod
    def from_frame(
        cls,
        frame: pd.DataFrame,
        actuated: Sequence[str] | None = None,
        **settings: Any,
    ) -> Measurements:
        """Readings from a table with the headers of the CSV file, units in them.

        Args:
            frame: One row per reading; an empty cell is NaN or None.
            actuated: The robot's actuated joints, in whose order the joint columns are then put.
            settings: The keys of the YAML file, such as ``robot="motoman_sk120"`` and
                ``point={"xyz": [0, 0, 120], "unit": "mm"}``; each has the default that it has
                there.

        Raises:
            InputError: As `read_measurements`; a line is the row of the table plus two, as it would
                be in a file.

        Examples:
            >>> import sk120stiff as sk
            >>> data = sk.bundled_robots()["motoman_sk120"] / "data" / "table2_measured.csv"
            >>> frame = sk.read(data).to_frame()
            >>> sk.Measurements.from_frame(frame[frame["pose"] == "1"], robot="motoman_sk120").poses
            ('1',)
        """
        from sk120stiff.measurements.files import reading
        from sk120stiff.measurements.table.settings import settings_of
        from sk120stiff.measurements.table.table import table_of

        header = [str(name) for name in frame.columns]
        given = frame.astype(object).where(frame.notna(), "")
        rows = [[_text(cell) for cell in row] for row in given.itertuples(index=False, name=None)]
        table = table_of(NOWHERE, header, 1, rows, list(range(2, len(rows) + 2)))
        told = hashlib.sha256(repr((header, rows, sorted(settings.items()))).encode())
        found = reading.assembled(table, settings_of(settings, NOWHERE), told.hexdigest(), actuated)
        return replace(found, path=None)

    def __add__(self, other: Measurements) -> Measurements:
        """These readings and those of a further campaign; zero readings are not shared.

        Raises:
            InputError: They differ in robot, frames, points, noise or columns.

        Examples:
            >>> import sk120stiff as sk
            >>> data = sk.bundled_robots()["motoman_sk120"] / "data"
            >>> first = sk.read(data / "hidden_cause.csv")
            >>> first + sk.read(data / "hidden_cause_holdout.csv").select(range(5))
            <Measurements: 105 readings at 21 poses, ...hidden_cause.csv>
        """
        from sk120stiff.measurements.joining import join_measurements

        return join_measurements([cast("Measurements", self), other])

    def _repr_html_(self) -> str | None:
        """What a notebook shows: the first rows; without pandas the line of `repr`."""
        from html import escape

        try:
            frame = self.to_frame().head(SHOWN)
        except MissingPart:
            return None
        shown = frame.to_html(index=False, float_format="{:.6g}".format)
        more = cast("Measurements", self).n_readings - SHOWN
        rest = f"<p>… {more} more rows</p>" if more > 0 else ""
        return f"<div><p>{escape(repr(self))}</p>{shown}{rest}</div>"


def _text(cell: object) -> str:
    """A cell as it would stand in a file; a number keeps all its digits."""
    if isinstance(cell, bool):
        return str(int(cell))
    return repr(float(cell)) if isinstance(cell, float) else str(cell).strip()
