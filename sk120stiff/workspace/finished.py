"""Reading finished maps, and checking that they are as they were written."""

from __future__ import annotations

import itertools
import math
import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sk120stiff.errors import InputError, Refusal, require
from sk120stiff.workspace.field import STATUS, UNKNOWN_CLASS
from sk120stiff.workspace.skeleton import MANIFEST, as_written, read_manifest, zarr_or_explain
from sk120stiff.workspace.store import Progress

if TYPE_CHECKING:
    import xarray


@dataclass(frozen=True)
class MapCheck:
    """What `verify_map` found.

    Attributes:
        files: Number of files that were looked at: those of the manifest, and it itself.
        missing, damaged: Those that are not there, and those whose content is another.
    """

    files: int
    missing: tuple[str, ...]
    damaged: tuple[str, ...]

    @property
    def intact(self) -> bool:
        """Is every file there as it was written?"""
        return not self.missing and not self.damaged


def verify_map(
    path: str | os.PathLike[str], *, results: bool = True, progress: Progress | None = None
) -> MapCheck:
    """Compare every file of a finished map with the SHA-256 of when it was written.

    Args:
        path: The map.
        results: Read the results too, which are nearly all of it; else only what describes them.
        progress: Called with (files looked at, files in all).

    Raises:
        InputError: There is no finished map.
    """
    folder = Path(path)
    if not (folder / MANIFEST).is_file():
        raise InputError(
            "there is no finished map here",
            where=str(folder),
            remedy="Run the command that makes it again: it takes up where it stopped.",
        )
    manifest = read_manifest(folder)
    if manifest is None:
        return MapCheck(1, (), (MANIFEST,))
    digests = manifest.describing | (manifest.results if results else {})
    missing = tuple(file for file in digests if not (folder / file).is_file())
    damaged = []
    for number, (file, digest) in enumerate(digests.items()):
        if progress:
            progress(number, len(digests))
        if file not in missing and not as_written(folder, file, digest):
            damaged.append(file)
    return MapCheck(len(digests) + 1, missing, tuple(damaged))


def damaged_map(path: Path, check: MapCheck) -> Refusal:
    """What is said about a map that is not as it was written."""
    damaged = [*check.missing, *check.damaged]
    return Refusal(
        f"{len(damaged)} of {check.files} files of this map are not as they were written, the "
        f"first is {damaged[0]}",
        where=str(path),
        remedy="Give the command that made the map again: it makes what is damaged anew, and "
        "nothing else.",
    )


def open_map(path: str | os.PathLike[str]) -> xarray.Dataset:
    """A finished map as a labelled dataset; values are read from disk when they are asked for.

    Raises:
        InputError: There is no finished map.
        Refusal: Its loads, coordinates or descriptions are not as they were written. The results
            are not looked at here, see `verify_map`.
    """
    require("xarray", needed_for="a map")
    import xarray

    zarr_or_explain()
    folder = Path(path)
    check = verify_map(folder, results=False)
    if not check.intact:
        raise damaged_map(folder, check)
    dataset: xarray.Dataset = xarray.open_zarr(folder, consolidated=True)
    return dataset


@dataclass(frozen=True)
class LoadSummary:
    """One load of a map in a few numbers.

    Attributes:
        softest, stiffest: Smallest and largest minimum stiffness of all points [N/m].
        softest_at, stiffest_at: Coordinates of those points by axis [rad or m].
        critical: Smallest critical load factor.
        unstable: Number of points at which K_θ − K_C is not positive definite.
        deflection, deflection_at: Largest length of a deflection [m] and where; None where there is
            no load.
        deflection_std_parameters, deflection_std_remainder: Its ± there [m], infinite where
            unknown; None where the map has none.
    """

    softest: float
    softest_at: dict[str, float]
    stiffest: float
    stiffest_at: dict[str, float]
    critical: float
    unstable: int
    deflection: float | None = None
    deflection_at: dict[str, float] | None = None
    deflection_std_parameters: float | None = None
    deflection_std_remainder: float | None = None


def summarise_map(
    path: str | os.PathLike[str], *, progress: Progress | None = None
) -> tuple[tuple[LoadSummary, ...], dict[str, int]]:
    """Every load's summary, and how many points have which status; read chunk by chunk."""
    dataset = open_map(path)
    stiffness = dataset["minimum_stiffness"]
    axes = stiffness.dims[1:]
    # From the store: the array itself has chunks only where dask is installed.
    size = dict(zip(stiffness.dims, stiffness.encoding["chunks"], strict=True))
    starts = {axis: range(0, stiffness.sizes[axis], size[axis]) for axis in axes}
    counts = dict.fromkeys(STATUS, 0)
    best: list[_Extremes] = [_Extremes() for _ in range(stiffness.sizes["load"])]
    corners = list(itertools.product(*(starts[axis] for axis in axes)))
    for done, corner in enumerate(corners):
        if progress:
            progress(done, len(corners))
        where = {axis: slice(k, k + size[axis]) for axis, k in zip(axes, corner, strict=True)}
        chunk = dataset.isel(where).load()
        if "status" in chunk:
            for number, count in enumerate(np.bincount(chunk["status"].values.ravel())):
                counts[STATUS[number]] += int(count)
        else:
            counts[STATUS[0]] += int(chunk["conditioning"].size)
        for load, extremes in enumerate(best):
            extremes.take(chunk.isel(load=load), [str(axis) for axis in axes])
    return tuple(extremes.summary() for extremes in best), counts


class _Extremes:
    """Extremes of one load, gathered chunk by chunk."""

    def __init__(self) -> None:
        self.low: tuple[float, dict[str, float]] = (math.inf, {})
        self.high: tuple[float, dict[str, float]] = (-math.inf, {})
        self.critical = math.inf
        self.unstable = 0
        self.bent: dict[str, Any] = {}

    def take(self, chunk: xarray.Dataset, axes: list[str]) -> None:
        values = chunk["minimum_stiffness"].values
        if not np.isfinite(values).any():
            return
        for pick, better in ((np.nanargmin, True), (np.nanargmax, False)):
            where = np.unravel_index(int(pick(values)), values.shape)
            value = float(values[where])
            if (value < self.low[0]) if better else (value > self.high[0]):
                at = {
                    axis: float(chunk[axis].values[k]) for axis, k in zip(axes, where, strict=True)
                }
                if better:
                    self.low = (value, at)
                else:
                    self.high = (value, at)
        self._bend(chunk, axes)
        self.critical = min(self.critical, float(np.nanmin(chunk["critical_load_factor"].values)))
        stability = chunk["stability"].values
        self.unstable += int(((stability != 0) & (stability != UNKNOWN_CLASS)).sum())

    def _bend(self, chunk: xarray.Dataset, axes: list[str]) -> None:
        if "deflection_length" not in chunk:
            return
        lengths = chunk["deflection_length"].values
        if not np.isfinite(lengths).any():
            return
        where = np.unravel_index(int(np.nanargmax(lengths)), lengths.shape)
        if float(lengths[where]) <= self.bent.get("deflection", 0.0):
            return
        at = {axis: float(chunk[axis].values[k]) for axis, k in zip(axes, where, strict=True)}
        self.bent = {"deflection": float(lengths[where]), "deflection_at": at}
        for name in ("deflection_std_parameters", "deflection_std_remainder"):
            if name in chunk:
                self.bent[name] = float(chunk[name].values[where])

    def summary(self) -> LoadSummary:
        extremes = (*self.low, *self.high)
        return LoadSummary(*extremes, self.critical, self.unstable, **self.bent)
