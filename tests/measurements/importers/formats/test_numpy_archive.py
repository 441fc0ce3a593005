"""Arrays of numpy, with names and without."""

import io
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.io import savemat
from scipy.spatial.transform import Rotation

from sk120stiff.errors import InputError
from tests.measurements.importers.reading import draft_of, sheet_of, written

RNG = np.random.default_rng(5)
P, Q = RNG.uniform(-2.0, 2.0, (9, 3)), RNG.uniform(-3.0, 3.0, (9, 6))
M = np.linspace(0.0, 8.0, 9)
T = np.tile(np.eye(4), (9, 1, 1))
T[:, :3, :3], T[:, :3, 3] = Rotation.from_rotvec(P).as_matrix(), P


def npz(**arrays: Any) -> bytes:
    stream = io.BytesIO()
    np.savez(stream, **arrays)
    return stream.getvalue()


@pytest.mark.parametrize(
    "arrays",
    [
        {"q_deg": Q, "p_mm": P, "payload_kg": M},
        {
            "joints": Q.T,
            "tracker": P.T,
            "m_payload": M[:, None],
            "note": np.array("units: mm, deg"),
        },
        {"q_deg": Q, "pos_mm": P, "payload_kg": M, "names": np.array([f"P{k}" for k in range(9)])},
    ],
)
def test_arrays_of_an_archive(tmp_path: Path, arrays: dict[str, Any]) -> None:
    told = {} if "payload_kg" in arrays else {"load": "kg"}
    draft = draft_of(tmp_path, npz(**arrays), **told)
    np.testing.assert_array_equal(np.array(written(draft)["y[mm]"], float), P[:, 1])
    np.testing.assert_allclose(draft.joints.values, np.radians(Q))
    np.testing.assert_array_equal(draft.loads.payload, M)


def test_fields_of_one_array(tmp_path: Path) -> None:
    names = [*(f"q{k}_deg" for k in range(1, 7)), "x_mm", "y_mm", "z_mm"]
    table = np.rec.fromarrays(np.hstack([Q, P]).T, names=names)
    stream = io.BytesIO()
    np.save(stream, table)
    draft = draft_of(tmp_path, stream.getvalue())
    np.testing.assert_array_equal(np.array(written(draft)["z[mm]"], float), P[:, 2])


def test_one_array_without_names_needs_them(tmp_path: Path) -> None:
    stream = io.BytesIO()
    np.save(stream, np.hstack([Q, P]))
    with pytest.raises(InputError, match="--columns"):
        sheet_of(tmp_path, stream.getvalue())
    names = (*(f"q{k}" for k in range(1, 7)), "x", "y", "z")
    sheet = sheet_of(tmp_path, stream.getvalue(), columns=names)
    assert sheet.total == 9 and float(sheet.get("x").cells[4]) == P[4, 0]  # type: ignore[union-attr]


@pytest.mark.parametrize("matlab", [False, True])
def test_poses_as_matrices(tmp_path: Path, matlab: bool) -> None:
    stream = io.BytesIO()
    if matlab:
        savemat(stream, {"q": Q, "T": np.moveaxis(T, 0, -1)})
    else:
        np.savez(stream, q=Q, T=T)
    sheet = sheet_of(tmp_path, stream.getvalue())
    assert [float(cell) for cell in sheet.get("y").cells] == P[:, 1].tolist()  # type: ignore[union-attr]
    assert sheet.has("orientation r11", "orientation r33")


def test_objects_are_not_opened(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="the array data holds Python objects"):
        sheet_of(tmp_path, npz(q=Q, data=np.array({"p": P}, dtype=object)))
    stream = io.BytesIO()
    np.save(stream, np.array([{"p": 1}], dtype=object), allow_pickle=True)
    with pytest.raises(InputError, match="holds Python objects"):
        sheet_of(tmp_path, stream.getvalue())


def test_what_is_broken_or_empty_is_told(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be read"):
        sheet_of(tmp_path, b"\x93NUMPY" + bytes(40))
    with pytest.raises(InputError, match="holds no readings"):
        sheet_of(tmp_path, npz(a=np.float64(3.0)))
