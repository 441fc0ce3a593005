"""Arrays with names, as MATLAB and numpy store them, side by side as a table."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError
from sk120stiff.measurements.importers.contract import Source
from sk120stiff.measurements.importers.grid import Grid
from sk120stiff.measurements.table.columns import (
    DISPLACEMENTS,
    FORCES,
    MOMENTS,
    POSITIONS,
    UNCERTAINTIES,
)

# What matrices of three or six columns are called, and what their columns then are.
_KNOWN = {
    r"p|pos(?:itions?)?|xyz|pts|points?|meas\w*|tracker|markers?|targets?": POSITIONS,
    r"d|dx|disp\w*|defl\w*|deltas?": DISPLACEMENTS,
    r"s|sigmas?|std|unc\w*": UNCERTAINTIES,
    r"f|forces?": FORCES,
    r"w|wrench(?:es)?": (*FORCES, *MOMENTS),
}
_JOINTS = re.compile(r"q|j|th(?:eta)?s?|joints?|joint_?(?:angles?|pos\w*|values?)|angles?", re.I)
_UNIT = re.compile(r"(.+)_(mm|um|m|deg|rad|N|kN|kg|s)")


def variables_grid(source: Source, content: Mapping[str, Any], what: str) -> Grid:
    """Variables of equal length side by side; matrices by their names, else by their widths.

    Args:
        source: The file they are from.
        content: Name → number, text, array of one to three axes, or the same within a structure.
        what: What the file is, in words.

    Raises:
        InputError: Nothing that could be readings.
    """
    arrays: dict[str, Any] = {}
    matrices: dict[str, tuple[str, ...]] = {}
    words: list[tuple[int, str]] = []
    left: list[str] = []
    for name, value in _flat(content):
        array = np.squeeze(np.asarray(value))
        poses = _of_matrices(name, array) if array.dtype.kind in "fiu" else None
        if isinstance(value, str):
            words.append((0, f"{name}: {value}"))
        elif poses is not None:
            arrays[name], matrices[name] = poses
        elif array.dtype.kind in "fiub" and array.ndim in (1, 2) and array.size > 1:
            arrays[name] = array.astype(float)
        elif (
            array.dtype.kind in "UO" and array.ndim == 1 and all(isinstance(v, str) for v in array)
        ):
            arrays[name] = array
        else:
            left.append(f"variable {name}")
    sizes = Counter(
        size
        for name, a in arrays.items()
        for size in (a.shape[:1] if name in matrices else a.shape)
        if size > 1
    )
    if not sizes:
        raise InputError(
            "this file holds no readings",
            where=str(source.path),
            remedy="Store joint values and positions as arrays with a row for each reading.",
        )
    most = max(sizes.values())
    count = max(size for size, times in sizes.items() if times == most)
    headers, columns = _table(arrays, matrices, count, len(source.actuated), left, source.role)
    rows = (headers, *zip(*columns, strict=True))
    said = f"{what}, {count} rows; line 1 stands for their names"
    return Grid(
        source.path, tuple(map(tuple, rows)), tuple(range(1, count + 2)), tuple(words), said,
        left=tuple(left),
    )  # fmt: skip


def _flat(content: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, Any]]:
    """Variables and fields of structures."""
    for name, value in content.items():
        if not name.startswith("__"):
            if isinstance(value, dict):
                yield from _flat(value, f"{above}{name}.")
            else:
                yield f"{above}{name}", value


def _of_matrices(name: str, array: Array) -> tuple[Array, tuple[str, ...]] | None:
    """(N, 9), (N, 12) or (N, 16) numbers of N matrices 3 x 3, 3 x 4 or 4 x 4, and their headers.

    N is the first axis, as in numpy, or the last one, as in MATLAB. None of any other array.
    """
    if array.ndim != 3:
        return None
    for stacked in (array, np.moveaxis(array, -1, 0)):
        _, high, wide = stacked.shape
        if (high, wide) in ((3, 3), (3, 4), (4, 4)):
            of = "r" if wide == len(POSITIONS) else _split(name)[0]
            places = [(i, j) for i in range(1, high + 1) for j in range(1, wide + 1)]
            flat = stacked.reshape(len(stacked), high * wide).astype(float)
            return flat, tuple(f"{of}{i}{j}" for i, j in places)
    return None


def _table(
    arrays: dict[str, Any],
    of_matrices: Mapping[str, tuple[str, ...]],
    count: int,
    n: int,
    left: list[str],
    role: str,
) -> tuple[tuple[str, ...], list[list[str]]]:
    headers: list[str] = []
    columns: list[list[str]] = []
    matrices: dict[str, Any] = {}
    named: dict[str, tuple[str, ...]] = dict(of_matrices)
    for path, array in arrays.items():
        if (
            path not in named
            and array.ndim == 2
            and array.shape[0] != count
            and array.shape[1] == count
        ):
            array = array.T
        if array.shape[0] != count:
            left.append(f"variable {path} of {' x '.join(map(str, array.shape))}")
            continue
        if array.ndim == 1:
            headers.append(_bracketed(path.rpartition(".")[2]))
            columns.append([_text(v) for v in array])
            continue
        matrices[path] = array
        if path in of_matrices:
            continue
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
    wanted = [(n, tuple(f"q{k + 1}" for k in range(n))), (3, POSITIONS if role != "loads" else ())]
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
