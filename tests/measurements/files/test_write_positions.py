"""Positions, single readings and plans of them: what is written reads back as it was."""

from __future__ import annotations

from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.errors import InputError
from sk120stiff.measurements import Measurements
from tests.positions.arm import NAMES, poses, urdf

COUNT = 6
HEAD = ",".join(f"{name}[deg]" for name in NAMES)
KINDS = {
    "positions": ("x[mm],y[mm],z[mm],sx[um],sy[um],sz[um]", "{v},2,{v},10,11,12"),
    "turned": ("x[m],y[m],z[m],rx[deg],ry[deg],rz[deg]", "{v},2,,0.3,{v},-0.1"),
    "quaternions": ("qw,qx,qy,qz,x[mm],y[mm],z[mm]", "0.8,0.6,0,0,1,2,{v}"),
    "wires": ("l[mm],ax[m],ay[m],az[m]", "{v},1,-2,0.125"),
    "gauges": ("d[um],ux,uy,uz,fx[N],fy[N],fz[N]", "{v},0,0.6,0.8,0,0,-50"),
    "inclinations": ("inc[deg],vx,vy,vz,x[mm],y[mm],z[mm]", "{v},1,0,0,1,2,3"),
}
BESIDE = ",payload[kg],marker,series,temperature[degC],order,use"
PLACES = (
    "points: {A: {xyz: [0, 0, 100], unit: mm, fit: true}, B: {xyz: [50, 0, 0.1], unit: mm}}\n"
    "payload: {point: {xyz: [0, 0.02, 0.12], unit: m}, fit: true}\ngravity: [0, 9.81, 0]\n"
    "noise: {sigma: 15, unit: um, rotation: 20, rotation_unit: urad}\nsource: a test\n"
)


def written(folder: Path, kind: str, settings: str = PLACES, beside: str = BESIDE) -> Measurements:
    """A file of a kind, read."""
    head, row = KINDS[kind]
    lines = [f"pose,{HEAD},{head}{beside}"]
    for k, q in enumerate(np.degrees(poses(COUNT, 1))):
        more = f",{k % 3 * 5},{'AB'[k % 2]},s{k // 3},{20 + k},{k + 1},{int(k != 2)}"
        cells = row.format(v=round(1.234567 * (k + 1), 6))
        lines.append(f"p{k}," + ",".join(f"{v:.6f}" for v in q) + f",{cells}" + more * bool(beside))
    (folder / "six.urdf").write_text(urdf())
    path = folder / "own.csv"
    path.write_text("\n".join(lines) + "\n")
    frames = "robot: six.urdf\nbase_frame: base\ntool_frame: tool\n"
    path.with_suffix(".yaml").write_text(frames + settings)
    return sk.read(path)


def same(one: object, other: object) -> None:
    for own in fields(one):  # type: ignore[arg-type]
        a, b = getattr(one, own.name), getattr(other, own.name)
        if own.name in ("path", "data_hash", "line", "notes", "channels", "absolute", "noise"):
            continue
        if isinstance(a, np.ndarray) and a.dtype.kind == "f":
            np.testing.assert_allclose(a, b, rtol=1e-13, atol=1e-15, err_msg=own.name)
        elif isinstance(a, np.ndarray):
            np.testing.assert_array_equal(a, b, err_msg=own.name)
        elif own.name == "sigma" and isinstance(a, dict):
            assert a.keys() == b.keys()
            np.testing.assert_allclose(list(a.values()), list(b.values()), rtol=1e-11)
        else:
            assert a == b, own.name


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("settings", [PLACES, "position: {frame: unknown}\n"])
def test_what_is_written_reads_back(kind: str, settings: str, tmp_path: Path) -> None:
    data = written(tmp_path, kind, settings)
    again = sk.read(sk.write_measurements(data, tmp_path / "again" / "copy.csv"))
    same(data, again)
    assert data.absolute is not None and again.absolute is not None
    same(data.absolute, again.absolute)
    same(data.absolute.channels, again.absolute.channels)
    assert data.noise == again.noise


@pytest.mark.parametrize("kind", KINDS)
def test_a_plan_of_them_has_blank_cells(kind: str, tmp_path: Path) -> None:
    data = written(tmp_path, kind)
    said = data.absolute
    assert said is not None
    blank = replace(said.channels.without(np.ones(COUNT, dtype=bool)), sigma_of_rows=None)
    plan = replace(data, absolute=replace(said, channels=blank), sigma=None)
    assert plan.is_plan and not data.is_plan and "a plan" in repr(plan)
    again = sk.read(sk.write_measurements(plan, tmp_path / "plan.csv"))
    assert again.is_plan and again.use.all() and again.absolute is not None
    np.testing.assert_allclose(again.joints, data.joints, rtol=1e-13)
    np.testing.assert_array_equal(again.absolute.payload, said.payload)
    robot = sk.load_robot(again.robot, base="base", tool="tool")
    with pytest.raises(InputError, match="poses to go to"):
        sk.fit(sk.Model(robot), again)
    with pytest.raises(InputError, match="poses to go to"):
        sk.explain(sk.Model(robot), again)


def test_a_row_that_lost_its_reading_among_others_is_masked(tmp_path: Path) -> None:
    data = written(tmp_path, "wires", "position: {frame: unknown}\n", beside="")
    path = data.path
    assert path is not None
    path.write_text(path.read_text().replace(",1.234567,", ",,"))
    assert sk.read(path).use.tolist() == [False] + [True] * (COUNT - 1)
