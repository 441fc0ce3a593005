"""Variables of a MATLAB file (.mat, up to version 7) as a table."""

from __future__ import annotations

import io
import re
from collections import Counter
from collections.abc import Iterator
from typing import Any

import numpy as np

from sk120stiff.errors import InputError
from sk120stiff.measurements.importers.contract import Source
from sk120stiff.measurements.importers.grid import Grid

_HDF5 = b"\x89HDF\r\n\x1a\n"
_XYZ = ("x", "y", "z")
# What matrices of three or six columns are called, and what their columns then are.
_KNOWN = {
    r"p|pos(?:itions?)?|xyz|pts|points?|meas\w*|tracker|markers?|targets?": _XYZ,
    r"d|dx|disp\w*|defl\w*|deltas?": ("dx", "dy", "dz"),
    r"s|sigmas?|std|unc\w*": ("sx", "sy", "sz"),
    r"f|forces?": ("fx", "fy", "fz"),
    r"w|wrench(?:es)?": ("fx", "fy", "fz", "mx", "my", "mz"),
}
_JOINTS = re.compile(r"q|j|th(?:eta)?s?|joints?|joint_?(?:angles?|pos\w*|values?)|angles?", re.I)
_UNIT = re.compile(r"(.+)_(mm|um|m|deg|rad|N|kN|kg|s)")


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
    arrays: dict[str, Any] = {}
    words: list[tuple[int, str]] = []
    left: list[str] = []
    for name, value in _flat(content):
        array = np.asarray(value)
        if isinstance(value, str):
            words.append((0, f"{name}: {value}"))
        elif array.dtype.kind in "fiub" and array.ndim in (1, 2) and array.size > 1:
            arrays[name] = array.astype(float)
        elif (
            array.dtype.kind in "UO" and array.ndim == 1 and all(isinstance(v, str) for v in array)
        ):
            arrays[name] = array
        else:
            left.append(f"variable {name}")
    sizes = Counter(size for a in arrays.values() for size in a.shape if size > 1)
    if not sizes:
        raise InputError("this MATLAB file holds no readings", where=where, remedy="Check it.")
    most = max(sizes.values())
    count = max(size for size, times in sizes.items() if times == most)
    headers, columns = _table(arrays, count, len(source.actuated), left, source.role)
    rows = (headers, *zip(*columns, strict=True))
    said = f"variables of a MATLAB file, {count} rows; line 1 stands for their names"
    return Grid(
        source.path, tuple(map(tuple, rows)), tuple(range(1, count + 2)), tuple(words), said,
        left=tuple(left),
    )  # fmt: skip


def _flat(content: dict[str, Any], above: str = "") -> Iterator[tuple[str, Any]]:
    """Variables and fields of structures."""
    for name, value in content.items():
        if not name.startswith("__"):
            if isinstance(value, dict):
                yield from _flat(value, f"{above}{name}.")
            else:
                yield f"{above}{name}", value


def _table(
    arrays: dict[str, Any], count: int, n: int, left: list[str], role: str
) -> tuple[tuple[str, ...], list[list[str]]]:
    headers: list[str] = []
    columns: list[list[str]] = []
    matrices: dict[str, Any] = {}
    named: dict[str, tuple[str, ...]] = {}
    for path, array in arrays.items():
        if array.ndim == 2 and array.shape[0] != count and array.shape[1] == count:
            array = array.T
        if array.shape[0] != count:
            left.append(f"variable {path} of {' x '.join(map(str, array.shape))}")
            continue
        if array.ndim == 1:
            headers.append(_bracketed(path.rpartition(".")[2]))
            columns.append([_text(v) for v in array])
            continue
        matrices[path] = array
        plain = _split(path)[0]
        names = next(
            (c for p, c in _KNOWN.items()
             if re.fullmatch(p, plain, re.I) and len(c) == array.shape[1]), None,
        )  # fmt: skip
        if array.shape[1] == n and _JOINTS.fullmatch(plain):
            names = tuple(f"q{k + 1}" for k in range(n))
        if names:
            named[path] = names
    said = set().union(*named.values()) if named else set()
    wanted = [(n, tuple(f"q{k + 1}" for k in range(n))), (3, _XYZ if role != "loads" else ())]
    for width, names in wanted:
        rest = [p for p, a in matrices.items() if p not in named and a.shape[1] == width]
        if names and not said & set(names) and len(rest) == 1 and (width != 3 or n != 3):
            named[rest[0]] = names
    for path, matrix in matrices.items():
        unit = _split(path)[1]
        names = named.get(path) or tuple(f"{path}({k + 1})" for k in range(matrix.shape[1]))
        headers += [f"{name} [{unit}]" if unit else name for name in names]
        columns += [[_text(v) for v in column] for column in matrix.T]
    return tuple(headers), columns


def _split(path: str) -> tuple[str, str | None]:
    """Name and unit of ``data.p_mm``."""
    name = path.rpartition(".")[2]
    match = _UNIT.fullmatch(name)
    return (match[1], match[2]) if match else (name, None)


def _bracketed(name: str) -> str:
    plain, unit = _split(name)
    return f"{plain} [{unit}]" if unit else name


def _text(value: Any) -> str:
    return value if isinstance(value, str) else repr(float(value))
