"""Readings of kinds that no measurement file holds: what they are, and what to give instead.

Whoever has them would else read that a column is missing, and look for it.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from sk120stiff.errors import InputError, listed
from sk120stiff.measurements.importers.columns.orientations import orientation_columns
from sk120stiff.measurements.importers.columns.words import unit_of_header
from sk120stiff.measurements.importers.contract import Sheet

IMAGES = (".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".pgm", ".gif", ".raw")
_CONTACT = re.compile(
    r"(?<![^\W_])(?:contacts?|kontakte?|contatto|contacto|contato|touch(?:ed)?|ber[üu]hr\w*|antast\w*|"
    r"plates?|platten?|planes?|ebenen?|surfaces?|fl[äa]chen?|piano|plano|superficie|constraint)"
    r"(?![^\W_])",
    re.IGNORECASE,
)
_CAMERA = re.compile(
    r"(?<![^\W_])(?:images?|img|bild(?:er)?|photos?|foto|imagen|imagem|immagine|cameras?|kamera|"
    r"pixels?|px|(?:chess|checker)board|charuco|aruco|apriltag|corners?)(?![^\W_])",
    re.IGNORECASE,
)
_OWN = re.compile(r"(?:.*[\W_])?(?:tcp|flange|flansch|[ck]artesi\w+)[\W_].*[xyz]", re.IGNORECASE)
_POSITIONS = (
    "Give what an instrument read of a point on the tool: positions x, y, z (a tracker, an arm, a "
    "camera system), displacements dx, dy, dz, what a gauge read (d with its direction ux, uy, "
    "uz), or distances l to fixed points (docs/FILES.md)."
)
_BOARD = (
    "Give where the camera was: its position x, y, z in axes of the board at each pose, which "
    "programs for hand-eye calibration find of the images (of the board's R and t in axes of the "
    "camera it is -R^T t), or what another instrument read of a point on the tool."
)
_NAMED = " If positions or displacements stand there, too, name all columns with --columns."


def refuse_contacts_and_images(headers: Sequence[str], row: Sequence[str], where: str) -> None:
    """Refuse a table without readings whose columns, or cells, speak of contacts or of images.

    Args:
        headers: Of the columns of unknown meaning.
        row: Their cells in one row.
        where: The file.

    Raises:
        InputError: They do.
    """
    pairs = list(zip(headers, row, strict=True))
    images = [h for h, cell in pairs if _CAMERA.search(h) or cell.lower().endswith(IMAGES)]
    if images:
        raise InputError(
            f"images of a camera ({listed(images)}) and the joints they were taken at are no "
            "readings that are taken: what they show has to be found first",
            where=where,
            remedy=_BOARD + _NAMED,
        )
    contacts = [h for h, cell in pairs if _CONTACT.search(h) or _CONTACT.search(cell)]
    if contacts:
        raise InputError(
            f"contacts with a plate or plane ({listed(contacts)}) are no readings that are taken: "
            "that a point lay on a surface does not say where",
            where=where,
            remedy=_POSITIONS + _NAMED,
        )


def refuse_image_files(path: Path) -> None:
    """Refuse an image, or a folder that holds images for the most part.

    Raises:
        InputError: It is one.
    """
    folder = path.is_dir()
    inside = [each.suffix.lower() in IMAGES for each in path.iterdir()] if folder else []
    if path.suffix.lower() in IMAGES or 2 * sum(inside) > len(inside):
        raise InputError(
            f"{'a folder of images' if folder else 'an image'} is no table of readings",
            where=str(path),
            remedy=_BOARD,
        )


def robot_poses(sheet: Sheet) -> list[str]:
    """Headers of columns that may be poses of the robot in space, where no joints are: a position
    with an orientation, that of the tool centre, or a position beside displacements."""
    turns = orientation_columns(sheet)
    centre = sheet.those("tcp x", "tcp y", "tcp z")
    places = sheet.those("x", "y", "z")
    moved = sheet.those("dx", "dy", "dz")
    if centre:
        return [c.header for c in (*centre, *turns)]
    return [c.header for c in (*places, *turns)] if places and (turns or moved) else []


def own_places(sheet: Sheet) -> list[str]:
    """Headers among those that are not known which name a coordinate of the tool's centre."""
    return [c.header for c in sheet.spare if _OWN.fullmatch(unit_of_header(c.header)[0])]


NO_JOINTS = (
    "Poses of the robot in space do not tell its joints: an arm reaches most of them in several "
    "ways, and how it bends its joints decide. Export the joint angles of the same poses (the "
    "controller shows them as joint coordinates or axis positions), or the robot's program with "
    "its joint targets"
)
