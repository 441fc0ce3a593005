"""Workbooks and MATLAB files, made by the libraries that write them."""

import datetime as dt
import io
from pathlib import Path
from typing import Any

import numpy as np
import openpyxl
import pytest
from scipy.io import savemat

from sk120stiff.errors import InputError
from tests.measurements.importers.reading import draft_of, sheet_of, written

RNG = np.random.default_rng(3)
# Workbooks keep fifteen digits.
P, Q = RNG.uniform(-2.0, 2.0, (9, 3)).round(12), RNG.uniform(-3.0, 3.0, (9, 6)).round(12)
HEAD = ["point", *(f"{a} [mm]" for a in "xyz"), *(f"J{k + 1} [deg]" for k in range(6))]


def workbook(sheets: dict[str, list[list[Any]]]) -> bytes:
    book = openpyxl.Workbook()
    for name, rows in sheets.items():
        sheet = book.create_sheet(name)
        for row in rows:
            sheet.append(row)
    del book["Sheet"]
    stream = io.BytesIO()
    book.save(stream)
    return stream.getvalue()


def mat(**variables: Any) -> bytes:
    stream = io.BytesIO()
    savemat(stream, variables)
    return stream.getvalue()


ROWS = [[f"P{k}", *map(float, P[k]), *map(float, Q[k])] for k in range(9)]


def test_a_workbook_is_read_to_the_last_digit(tmp_path: Path) -> None:
    data = workbook({"Read me": [["made by", "us"], ["on", dt.datetime(2026, 11, 22)]],
                     "Points": [["Robot", "UR5"], [], HEAD, *ROWS]})  # fmt: skip
    draft = draft_of(tmp_path, data)
    columns = written(draft)
    assert [float(c) for c in columns["y[mm]"]] == P[:, 1].tolist()
    assert [float(c) for c in columns["joint_4[deg]"]] == Q[:, 3].tolist()
    assert draft.pose[0] == "P0" and draft.sheet.lines[0] == 4
    assert "sheet Read me" in draft.unused
    assert any("Robot  UR5" in item for item in draft.unused)


def test_a_workbook_asks_what_it_cannot_know(tmp_path: Path) -> None:
    two = {"A": [HEAD, *ROWS], "B": [HEAD, *ROWS]}
    with pytest.raises(InputError, match=r"sheets A, B.*--sheet 'A'"):
        sheet_of(tmp_path, workbook(two))
    assert sheet_of(tmp_path, workbook(two), sheet="B").total == 9
    with pytest.raises(InputError, match="no sheet with rows is called 'C'"):
        sheet_of(tmp_path, workbook(two), sheet="C")
    formula = [HEAD, ["P0", "=1+1", *ROWS[0][2:]]]
    with pytest.raises(InputError, match=r"sheet A, line 2: the formula '=1\+1' has no stored"):
        sheet_of(tmp_path, workbook({"A": formula}))
    with pytest.raises(InputError, match=r"\.xls"):
        sheet_of(tmp_path, b"\xd0\xcf\x11\xe0" + bytes(100))
    with pytest.raises(InputError, match="cannot be read"):
        sheet_of(tmp_path, workbook(two)[:3000] + b"xl/")


@pytest.mark.parametrize(
    "variables",
    [
        {"p_mm": P, "q_deg": Q},
        {"data": {"xyz": P, "theta": Q}, "units": "mm, deg"},
        {"tracker": P.T, "joints": Q.T, "units": "units: mm and deg"},
        {**{a: P[:, k] for k, a in enumerate("xyz")}, **{f"q{k + 1}": Q[:, k] for k in range(6)}},
        {"first": P, "second": Q},
    ],
)
def test_variables_of_matlab(tmp_path: Path, variables: dict[str, Any]) -> None:
    stated = "p_mm" in variables
    told = {} if stated else {"length": "mm", "angle": "deg"}
    if "units" in variables:
        told = {}
    columns = written(draft_of(tmp_path, mat(**variables), **told))
    assert [float(c) for c in columns["z[mm]"]] == P[:, 2].tolist()
    assert [float(c) for c in columns["joint_6[deg]"]] == Q[:, 5].tolist()


def test_what_matlab_holds_besides_is_listed(tmp_path: Path) -> None:
    names = np.array([f"P{k}" for k in range(9)], dtype=object)
    draft = draft_of(
        tmp_path,
        mat(p=P, q=Q, name=names, dt=0.01, extra=np.ones((9, 4)), short=np.ones(4)),
        length="m",
        angle="rad",
    )
    assert draft.pose[:2] == ("P0", "P1")
    listed = " ".join(draft.unused)
    for word in ("variable dt", "extra(1)", "extra(4)", "variable short of 4"):
        assert word in listed


def test_matlab_files_that_are_none(tmp_path: Path) -> None:
    for data in (b"\x89HDF\r\n\x1a\n" + bytes(100), b"MATLAB 7.3 MAT-file, Platform" + bytes(500)):
        with pytest.raises(InputError, match=r"version 7\.3.*'-v7'"):
            sheet_of(tmp_path, data)
    with pytest.raises(InputError, match="cannot be read"):
        sheet_of(tmp_path, mat(p=P)[:150])
    with pytest.raises(InputError, match="holds no readings"):
        sheet_of(tmp_path, mat(note="hello"))
