"""Readings of kinds that are not taken are told as what they are."""

from pathlib import Path

import pytest

from sk120stiff.errors import InputError
from sk120stiff.measurements.importers.columns.not_taken import refuse_image_files
from tests.measurements.importers.reading import draft_of, sheet_of

JOINTS = "Pose," + ",".join(f"J{k} [deg]" for k in range(1, 7))


def read(folder: Path, more: str, cells: str) -> None:
    sheet_of(folder, f"{JOINTS},{more}\nP1,1,2,3,4,5,6,{cells}\nP2,2,3,4,5,6,7,{cells}\n")


@pytest.mark.parametrize(
    ("more", "cells"),
    [("Contact", "1"), ("touched", "1"), ("Plane nx,ny,nz,d [mm]", "0,0,1,100"), ("Ebene", "1"),
     ("Constraint", "plate A"), ("Antastung", "3")],
)  # fmt: skip
def test_contacts(tmp_path: Path, more: str, cells: str) -> None:
    with pytest.raises(InputError, match=r"contacts with a plate or plane.*positions x, y, z"):
        read(tmp_path, more, cells)


@pytest.mark.parametrize(
    ("more", "cells"),
    [("Image", "1"), ("file", "img_001.PNG"), ("u [px],v [px]", "320.5,200.1"), ("Bild", "7"),
     ("corner_u,corner_v", "320.5,200.1")],
)  # fmt: skip
def test_images(tmp_path: Path, more: str, cells: str) -> None:
    with pytest.raises(InputError, match=r"images of a camera.*position x, y, z in axes of the bo"):
        read(tmp_path, more, cells)


def test_images_instead_of_a_table(tmp_path: Path) -> None:
    for name in ("a.png", "b.JPG", "poses.csv"):
        (tmp_path / name).write_bytes(b"")
    for path, what in ((tmp_path, "a folder of images"), (tmp_path / "a.png", "an image")):
        with pytest.raises(InputError, match=what):
            refuse_image_files(path)
    refuse_image_files(tmp_path / "poses.csv")
    (tmp_path / "b.JPG").unlink()
    refuse_image_files(tmp_path)


def test_other_columns_are_unknown_as_before(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="columns of unknown meaning are Template"):
        read(tmp_path, "Template", "7")


@pytest.mark.parametrize(
    "headers",
    [
        "X [mm],Y [mm],Z [mm],A [deg],B [deg],C [deg],dX [mm],dY [mm],dZ [mm]",
        "TCP x [mm],TCP y [mm],TCP z [mm],Rx [deg],Ry [deg],Rz [deg],X [mm],Y [mm],Z [mm]",
        "X [mm],Y [mm],Z [mm],dX [mm],dY [mm],dZ [mm]",
        "Flange pos x [mm],Flange pos y [mm],Flange pos z [mm],dX [mm],dY [mm],dZ [mm]",
    ],
)
def test_poses_in_space_are_no_joints(tmp_path: Path, headers: str) -> None:
    rows = "".join(
        ",".join([f"P{k}", *(str(k + n) for n in range(headers.count(",") + 1))]) + "\n"
        for k in range(3)
    )
    with pytest.raises(InputError, match=r"poses of the robot in space.*joint angles of the same"):
        draft_of(tmp_path, f"Pose,{headers}\n{rows}")


def test_positions_alone_lack_joints(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="this file holds no joint values"):
        draft_of(tmp_path, "Pose,X [mm],Y [mm],Z [mm],Flange temp [°C]\nP1,1,2,3,20\nP2,4,5,6,21\n")
