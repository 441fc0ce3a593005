"""Variables of a MATLAB file (.mat, up to version 7) as a table."""

from __future__ import annotations

import io

from sk120stiff.errors import InputError
from sk120stiff.measurements.importers.contract import Source
from sk120stiff.measurements.importers.formats.variables import variables_grid
from sk120stiff.measurements.importers.grid import Grid

_HDF5 = b"\x89HDF\r\n\x1a\n"


def is_matlab(data: bytes) -> bool:
    """Does the file begin as MATLAB's do?"""
    return data.startswith((b"MATLAB ", _HDF5))


def matlab_grid(source: Source) -> Grid:
    """Variables of equal length side by side; matrices by their names, else by their widths.

    Raises:
        InputError: Version 7.3, a broken file, or nothing that could be positions.
    """
    where = str(source.path)
    if source.data.startswith((_HDF5, b"MATLAB 7.3")):
        raise InputError(
            "this MATLAB file is of version 7.3",
            where=where,
            remedy="Save it in MATLAB with: save('file.mat', '-v7').",
        )
    from scipy.io import loadmat

    try:
        content = loadmat(io.BytesIO(source.data), simplify_cells=True)
    except Exception as error:  # whatever a broken file makes of it
        raise InputError(
            f"this MATLAB file cannot be read ({error})", where=where, remedy="Save it once more."
        ) from error
    return variables_grid(source, content, "variables of a MATLAB file")
