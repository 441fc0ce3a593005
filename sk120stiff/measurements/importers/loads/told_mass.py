"""A column that may be the mass on the tool becomes it where the user said its unit, kg."""

from __future__ import annotations

from dataclasses import replace

from sk120stiff.errors import InputError, listed
from sk120stiff.measurements.importers.columns.compound_headers import may_be_mass
from sk120stiff.measurements.importers.contract import Sheet
from sk120stiff.measurements.importers.grid import is_number
from sk120stiff.measurements.importers.loads.pairs import LOADS
from sk120stiff.measurements.importers.told import Told


def with_told_mass(sheet: Sheet, told: Told) -> Sheet:
    """The sheet with ``mass``, ``m``, ``Last`` as payload, if `Told.load` is kg and it is alone.

    Where no column is a load and `Told.load` is not stated, a note says which column may be one.

    Raises:
        InputError: Several columns may be it.
    """
    if sheet.those(*LOADS, "direction", "force direction"):
        return sheet
    heavy = [
        c for c in sheet.spare
        if c.unit is None and may_be_mass(c.header) and all(map(is_number, c.cells))
    ]  # fmt: skip
    if not heavy:
        left = [c.header for c in sheet.spare] if told.load else []
        said = f"--load {told.load} is of no column; not understood are {listed(left)}."
        return sheet.noting(said) if left else sheet
    names = listed([c.header for c in heavy])
    if told.load != "kg":
        return sheet.noting(f"{names} may be the mass on the tool: if so, --load kg says it.")
    if len(heavy) > 1:
        raise InputError(
            f"{names} may each be the mass on the tool",
            where=str(sheet.path),
            remedy="Call the one that is payload[kg].",
        )
    (own,) = heavy
    return sheet.exchanged([own], replace(own, meaning="payload"))
