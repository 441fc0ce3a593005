"""Forces and moments in axes of a sensor that is screwed on turned."""

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import sk120stiff as sk
from sk120stiff.measurements.files.writing import write_measurements
from sk120stiff.measurements.sensor_axes import axes_line

HEAD = "pose,q1[deg],fx[N],fy[N],fz[N],mx[N*m],my[N*m],mz[N*m],dx[mm],dy[mm],dz[mm]\n"
ROWS = "1,10,100,-50,30,1,2,3,0.1,0.2,0.3\n2,40,-20,70,300,-4,5,6,0.2,0.1,0.4\n"
AS_READ = np.array([[100.0, -50, 30, 1, 2, 3], [-20, 70, 300, -4, 5, 6]])


def read(folder: Path, force: str) -> sk.Measurements:
    (folder / "own.csv").write_text(HEAD + ROWS)
    (folder / "own.yaml").write_text(f"force: {force}\ndisplacement: {{zero: shared}}\n")
    return sk.read(folder / "own.csv")


def test_they_are_turned_as_a_joint_of_a_urdf_is(tmp_path: Path) -> None:
    """roll about x first, then pitch about y, then yaw about z, axes that stay."""
    found = read(tmp_path, "{frame: tool, rpy: [10, -20, 30], rpy_unit: deg}")
    turn = np.eye(3)
    for axis, degrees in (("x", 10.0), ("y", -20.0), ("z", 30.0)):
        turn = Rotation.from_euler(axis, degrees, degrees=True).as_matrix() @ turn
    assert found.force_frame == "tool"
    assert np.allclose(found.wrench[:, :3], AS_READ[:, :3] @ turn.T, atol=1e-9)
    assert np.allclose(found.wrench[:, 3:], AS_READ[:, 3:] @ turn.T, atol=1e-9)


def test_what_is_written_is_in_axes_of_the_frame(tmp_path: Path) -> None:
    found = read(tmp_path, "{frame: tool, rpy: [0, 0, 90], rpy_unit: deg}")
    assert np.allclose(found.wrench[0, :3], [50.0, 100.0, 30.0])
    write_measurements(found, tmp_path / "again.csv")
    again = sk.read(tmp_path / "again.csv")
    assert again.force_frame == "tool"
    assert np.allclose(again.wrench, found.wrench, atol=1e-9)


@pytest.mark.parametrize(
    ("force", "said"),
    [
        ("{frame: tool, rpy: [0, 0, 30]}", "key force.rpy.*triple with its unit.*rpy_unit: deg"),
        ("{frame: tool, rpy_unit: deg}", "key force.rpy_unit.*triple with its unit"),
        ("{frame: tool, rpy: [0, 0, 30], rpy_unit: mm}", "key force.rpy_unit.*mm"),
        ("{frame: tool, rpy: [0, 30], rpy_unit: deg}", "force.rpy"),
        ("{frame: tool, rpy: [0, 0, .nan], rpy_unit: deg}", "force.rpy"),
    ],
)
def test_half_a_turn_is_refused(tmp_path: Path, force: str, said: str) -> None:
    with pytest.raises(sk.InputError, match=f"(?s){said}"):
        read(tmp_path, force)


@pytest.mark.parametrize("stated", [None, (np.pi, 0.0, 0.0), (0.2, -0.4, 0.5)])
def test_a_further_turn_goes_on_top_of_the_one_that_is_stated(stated, tmp_path: Path) -> None:
    """The line that a message says, once written, brings both."""
    further = Rotation.from_euler("z", 30.0, degrees=True)
    line = axes_line("tool", further, stated)
    found = read(tmp_path, line.removeprefix("force: "))
    whole = further * Rotation.from_euler("xyz", stated or (0.0, 0.0, 0.0))
    assert np.allclose(found.wrench[:, :3], whole.apply(AS_READ[:, :3]), atol=0.5)  # to 0.1 deg
    assert found.sensor_rpy is not None
