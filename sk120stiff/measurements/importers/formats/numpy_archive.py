"""Arrays of numpy (.npz, .npy) as a table."""

from __future__ import annotations

import io
import zipfile
from typing import Any

import numpy as np

from sk120stiff.errors import InputError
from sk120stiff.measurements.importers.contract import Source
from sk120stiff.measurements.importers.formats.variables import variables_grid
from sk120stiff.measurements.importers.grid import Grid

_ARRAY, _ZIP = b"\x93NUMPY", b"PK\x03\x04"


def is_numpy(data: bytes) -> bool:
    """Is this an array of numpy, or an archive that holds nothing else?"""
    if data.startswith(_ARRAY):
        return True
    if not data.startswith(_ZIP):
        return False
    try:
        names = zipfile.ZipFile(io.BytesIO(data)).namelist()
    except zipfile.BadZipFile:
        return False
    return bool(names) and all(name.endswith(".npy") for name in names)


def numpy_grid(source: Source) -> Grid:
    """Arrays of equal length side by side, those of structured arrays by the names of their fields.

    Nothing of the file is executed: what is stored as Python objects is refused.

    Raises:
        InputError: Objects, a broken file, or nothing that could be readings.
    """
    where = str(source.path)
    try:
        loaded = np.load(io.BytesIO(source.data), allow_pickle=False)
        whole = {"array": loaded} if isinstance(loaded, np.ndarray) else _arrays(loaded, where)
    except InputError:
        raise
    except ValueError as error:
        if "pickle" not in str(error):
            raise _broken(error, where) from error
        raise _objects("it", where) from error
    except Exception as error:  # whatever a broken file makes of it
        raise _broken(error, where) from error
    content: dict[str, Any] = {}
    for name, array in whole.items():
        fields = array.dtype.names or ()
        content |= {field: array[field] for field in fields} or {name: _plain(array)}
    return variables_grid(source, content, "arrays of numpy")


def _arrays(archive: Any, where: str) -> dict[str, Any]:
    out = {}
    for name in archive.files:
        try:
            out[name] = archive[name]
        except ValueError as error:
            if "pickle" not in str(error):
                raise
            raise _objects(f"the array {name}", where) from error
    return out


def _plain(array: Any) -> Any:
    """A text of no axes as text."""
    return str(array) if array.ndim == 0 and array.dtype.kind == "U" else array


def _objects(what: str, where: str) -> InputError:
    return InputError(
        f"{what} holds Python objects, which are programs as much as data and are not opened",
        where=where,
        remedy="Store numbers alone: np.savez('file.npz', q=np.asarray(q, float), ...), and of a "
        "dict each entry by its name: np.savez('file.npz', **data).",
    )


def _broken(error: Exception, where: str) -> InputError:
    return InputError(
        f"this file of numpy cannot be read ({error})", where=where, remedy="Save it once more."
    )
