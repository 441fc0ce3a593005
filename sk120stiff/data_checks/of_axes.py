"""Slips in loads and displacements: signs, exchanged axes, frames, one axis in another unit."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import permutations

import numpy as np

from sk120stiff.data_checks.correction import Correction
from sk120stiff.data_checks.sheet import Sheet
from sk120stiff.measurements.data import Frame

AXES = "xyz"
#: factors by which one axis may have been written in another unit of length
UNITS = (
    (1e3, "mm labelled um, or m labelled mm"),
    (1e-3, "um labelled mm, or mm labelled m"),
    (25.4, "inch labelled mm"),
    (1.0 / 25.4, "mm labelled inch"),
)
OTHER: dict[Frame, Frame] = {"base": "tool", "tool": "base"}


def of_axes(sheet: Sheet) -> Iterator[Correction]:
    """Corrections of the columns of load and displacement."""
    against = int((np.einsum("ni,ni->n", _base(sheet, "force"), _base(sheet, "d")) < 0).sum())
    yield Correction(
        f"displacement and force point against each other in {against} of {len(sheet.measured)} "
        "rows: check the sign convention",
        "A displacement is loaded minus unloaded, a force is the one on the arm.",
        lambda s: replace(s, displacement=-s.displacement),
    )
    for axis, name in enumerate(AXES):
        signs = np.ones(3)
        signs[axis] = -1.0
        yield _displacement(
            signs, f"d{name} seems to have the wrong sign", f"Negate the column d{name}."
        )
        yield _wrench(signs, f"f{name} seems to have the wrong sign", f"Negate the column f{name}.")
    for order in list(permutations(range(3)))[1:]:
        names = ", ".join(AXES[k] for k in order)
        yield Correction(
            f"the axes of the displacement seem to be swapped: dx, dy, dz look like {names}",
            "Rename the headers of the displacement.",
            lambda s, o=list(order): replace(s, displacement=s.displacement[:, o]),  # type: ignore[misc]
        )
        both = [*order, *(3 + k for k in order)]
        yield Correction(
            f"the axes of the force seem to be swapped: fx, fy, fz look like {names}",
            "Rename the headers of the force.",
            lambda s, o=both: replace(s, wrench=s.wrench[:, o]),  # type: ignore[misc]
        )
    yield from _frames(sheet)
    yield from _units()


def _frames(sheet: Sheet) -> Iterator[Correction]:
    force, read = OTHER[sheet.force_frame], OTHER[sheet.displacement_frame]
    yield Correction(
        f"the force looks as if it were given in {force} axes, not in {sheet.force_frame} axes",
        f"Write force: {{frame: {force}}} into the YAML file beside the readings.",
        lambda s: replace(s, force_frame=force),
    )
    yield Correction(
        f"the displacement looks as if it were given in {read} axes, "
        f"not in {sheet.displacement_frame} axes",
        f"Write displacement: {{frame: {read}}} into the YAML file beside the readings.",
        lambda s: replace(s, displacement_frame=read),
    )
    if force == read:
        yield Correction(
            f"force and displacement look as if both were given in {read} axes",
            f"Write force: {{frame: {force}}} and displacement: {{frame: {read}}} into the YAML "
            "file beside the readings.",
            lambda s: replace(s, force_frame=force, displacement_frame=read),
        )


def _units() -> Iterator[Correction]:
    for axis, name in enumerate(AXES):
        for factor, words in UNITS:
            by = np.ones(3)
            by[axis] = factor
            yield _displacement(
                by,
                f"d{name} looks as if it were in another unit than the other axes ({words})",
                f"Edit the unit in the header of d{name}.",
            )


def _displacement(by: np.ndarray, said: str, remedy: str) -> Correction:
    stretch = float(np.log(np.abs(by)).sum())
    return Correction(
        said,
        remedy,
        lambda s: replace(s, displacement=s.displacement * by, stretch=s.stretch + stretch),
    )


def _wrench(signs: np.ndarray, said: str, remedy: str) -> Correction:
    def mend(s: Sheet) -> Sheet:
        moments = signs if s.wrench[:, 3:].any() else np.ones(3)
        return replace(s, wrench=s.wrench * np.concatenate([signs, moments]))

    return Correction(said, remedy, mend)


def _base(sheet: Sheet, what: str) -> np.ndarray:
    """Forces or displacements of the rows in use, in base axes (M, 3)."""
    values = sheet.wrench[sheet.kept, :3] if what == "force" else sheet.measured
    frame = sheet.force_frame if what == "force" else sheet.displacement_frame
    if frame == "base":
        return values
    return np.asarray(np.einsum("nij,nj->ni", sheet.at().rotation, values))
