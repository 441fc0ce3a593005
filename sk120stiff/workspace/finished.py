"""Reading finished maps, and checking that they are as they were written."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from sk120stiff.errors import InputError
from sk120stiff.workspace.store import MANIFEST, sha256_of, zarr_or_explain

if TYPE_CHECKING:
    import xarray


@dataclass(frozen=True)
class MapCheck:
    """What `verify_map` found.

    Attributes
    ----------
    files
        Number of files that the manifest names.
    missing, damaged
        Those that are not there, and those whose content is another.
    """

    files: int
    missing: tuple[str, ...]
    damaged: tuple[str, ...]

    @property
    def intact(self) -> bool:
        """Is every file there as it was written?"""
        return not self.missing and not self.damaged


def verify_map(path: str | os.PathLike[str]) -> MapCheck:
    """Compare every file of a finished map with the SHA-256 of when it was written.

    Raises
    ------
    InputError
        There is no finished map.
    """
    folder = Path(path)
    try:
        digests: dict[str, str] = json.loads((folder / MANIFEST).read_text())["sha256"]
    except (OSError, ValueError, KeyError) as error:
        raise InputError(
            "there is no finished map here",
            where=str(folder),
            remedy="Run the command that makes it again: it takes up where it stopped.",
        ) from error
    missing = tuple(file for file in digests if not (folder / file).is_file())
    damaged = tuple(
        file
        for file, digest in digests.items()
        if file not in missing and sha256_of(folder / file) != digest
    )
    return MapCheck(len(digests), missing, damaged)


def open_map(path: str | os.PathLike[str]) -> xarray.Dataset:
    """A finished map as a labelled dataset; values are read from disk when they are asked for.

    Raises
    ------
    InputError
        There is no finished map.
    """
    import xarray

    zarr_or_explain()
    folder = Path(path)
    if not (folder / MANIFEST).is_file():
        verify_map(folder)  # says so
    dataset: xarray.Dataset = xarray.open_zarr(folder, consolidated=True)
    return dataset
