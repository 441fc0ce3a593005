"""A map as figures: slices over two of its axes, through one of its points."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations
from textwrap import fill
from typing import TYPE_CHECKING

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError
from sk120stiff.show.figures import definiteness_map, stiffness_slice
from sk120stiff.show.wording import load_in_words

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure

_UNITS = {"rad": "deg", "m": "mm"}  # of a map → of a figure


@dataclass(frozen=True, eq=False)
class MapFigure:
    """One figure, and the name of its file without an ending."""

    name: str
    figure: Figure


def axes_of_slices(dataset: xarray.Dataset) -> tuple[str, ...]:
    """Axes of a map that have more than one point."""
    dims = dataset["minimum_stiffness"].dims
    return tuple(str(dim) for dim in dims if dim != "load" and dataset.sizes[dim] > 1)


def figures_of_map(
    dataset: xarray.Dataset, *, load: int = 0, at: Mapping[str, float] | None = None
) -> list[MapFigure]:
    """Least stiffness, definiteness, and deflection ± over every pair of axes.

    Args:
        dataset: A map, see `sk120stiff.workspace.open_map`.
        load: Number of the load.
        at: Point through which the slices go, by axis [rad or m]; the softest of the map by
            default.

    Raises:
        InputError: There is no such load, the map has fewer than two axes, or no point has a value.
    """
    if not 0 <= load < dataset.sizes["load"]:
        raise InputError(f"the map has no load {load}", remedy=f"It has {dataset.sizes['load']}.")
    axes = axes_of_slices(dataset)
    if len(axes) < 2:
        raise InputError(
            "a slice needs two axes with more than one point each", remedy="Map a finer grid."
        )
    part = dataset.isel(load=load)
    place = _softest(part) if at is None else dict(at)
    near = part.sel({axis: place[axis] for axis in axes}, method="nearest")
    place = {axis: float(near[axis]) for axis in axes}
    wrench = load_in_words(part["wrench"].values.tolist())
    figures = []
    for first, second in combinations(axes, 2):
        held = {axis: place[axis] for axis in axes if axis not in (first, second)}
        plane = part.sel(held).transpose(second, first, ...).squeeze()
        where = ", ".join(
            [wrench, *(f"{axis} = {_shown(dataset, axis, value)}" for axis, value in held.items())]
        )
        name = f"load{load + 1}_{first}_{second}"
        figures += _slices(plane, first, second, where, place, name)
        figures += _bent(plane, first, second, where, name)
    return figures


def _bent(plane: xarray.Dataset, first: str, second: str, where: str, name: str) -> list[MapFigure]:
    """The length of the deflection and its ±, where the map has them."""
    if "deflection_length" not in plane:
        return []
    x, y = (np.asarray(plane[axis].values, dtype=float) for axis in (first, second))
    units = (_unit(plane, first), _unit(plane, second))
    std = deflection_std(plane)
    quantities = [("deflection", "Deflection", np.asarray(plane["deflection_length"], float))]
    if std is not None:
        known = np.where(np.isfinite(std), std, np.nan)
        quantities.append(
            ("deflection_uncertainty", "Standard uncertainty of the deflection", known)
        )
    return [
        MapFigure(
            f"{name}_{ending}",
            stiffness_slice(
                x, y, values, x_label=first, y_label=second, units=units,
                value_label=f"{ending.removeprefix('deflection_')} [µm]", scale=1e6,
                low_is_soft=False,
                title=f"{title}\n{fill(where + _white(values), 52)}",
            ),
        )
        for ending, title, values in quantities
    ]  # fmt: skip


def _white(values: Array) -> str:
    return "; white: unstable, unknown or not reached" if np.isnan(values).any() else ""


def deflection_std(dataset: xarray.Dataset) -> Array | None:
    """Standard uncertainty of a map's deflections, parameters and remainder together [m].

    None where the map has none.
    """
    if "deflection_std_parameters" not in dataset:
        return None
    std = np.asarray(dataset["deflection_std_parameters"].values, dtype=float)
    if "deflection_std_remainder" in dataset:
        std = np.hypot(std, np.asarray(dataset["deflection_std_remainder"].values, dtype=float))
    return std


def _slices(
    plane: xarray.Dataset,
    first: str,
    second: str,
    where: str,
    place: Mapping[str, float],
    name: str,
) -> list[MapFigure]:
    x, y = (np.asarray(plane[axis].values, dtype=float) for axis in (first, second))
    units = (_unit(plane, first), _unit(plane, second))
    least = np.asarray(plane["minimum_stiffness"].values, dtype=float)
    K, K_C = (np.asarray(plane[key].values, dtype=int) for key in ("stability", "K_C_definiteness"))
    # A negative stiffness has no place on a scale of stiffness: the other figure tells it.
    stable = np.where(K == 0, least, np.nan)
    white = "; white: unstable or not reached" if np.isnan(stable).any() else ""
    softest = np.isclose(x, place[first])[None, :] & np.isclose(y, place[second])[:, None]
    marked = bool(np.isfinite(stable[softest]).all())
    return [
        MapFigure(
            f"{name}_stiffness",
            stiffness_slice(
                x, y, stable, x_label=first, y_label=second, units=units,
                marks={"softest": (place[first], place[second])} if marked else None,
                title=f"Least principal stiffness\n{fill(where + white, 52)}",
            ),
        ),
        MapFigure(
            f"{name}_definiteness",
            definiteness_map(
                x, y, np.stack([K, K_C]), x_label=first, y_label=second, units=units,
                titles=[f"K_θ − K_C\n{fill(where, 42)}", "K_C alone"],
            ),
        ),
    ]  # fmt: skip


def _softest(part: xarray.Dataset) -> dict[str, float]:
    least = part["minimum_stiffness"].load()
    if not np.isfinite(least.values).any():
        raise InputError("no point of this map has a value", where="minimum_stiffness")
    index = least.argmin(...)
    return {str(axis): float(least[axis][index[axis]]) for axis in least.dims}


def _unit(dataset: xarray.Dataset, axis: str) -> str:
    return _UNITS[dataset[axis].attrs["units"]]


def _shown(dataset: xarray.Dataset, axis: str, value: float) -> str:
    unit = _unit(dataset, axis)
    return f"{np.degrees(value):.1f}°" if unit == "deg" else f"{value * 1e3:.0f} mm"
