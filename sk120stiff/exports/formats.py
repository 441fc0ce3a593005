"""The formats, by name: a new one is one file with a `FORMAT`, and one line here."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from sk120stiff.arrays import Array, rms
from sk120stiff.errors import InputError
from sk120stiff.exports import dh_table, kinematics_params, mjcf, sdf, urdf
from sk120stiff.exports.contract import Exported, Format, Request
from sk120stiff.exports.geometry import departure
from sk120stiff.files import together, write_atomically
from sk120stiff.model import Model

_NOTHING = 1e-9  # m

FORMATS: dict[str, Format] = {
    one.name: one
    for one in (
        urdf.FORMAT,
        kinematics_params.FORMAT,
        dh_table.FORMAT,
        mjcf.FORMAT,
        sdf.FORMAT,
    )
}


def format_of(out: Path | None, to: str | None = None) -> Format:
    """The format that is asked for by name, or else by the ending of a file.

    Raises:
        InputError: There is no such format, or the ending names none.
    """
    if to is not None:
        if to not in FORMATS:
            raise InputError(
                f"there is no format {to!r}", remedy=f"Formats are: {', '.join(FORMATS)}."
            )
        return FORMATS[to]
    ending = "" if out is None else out.suffix.lower()
    for one in FORMATS.values():
        if ending in one.endings:
            return one
    known = ", ".join(
        f"{ending} ({one.name})" for one in FORMATS.values() for ending in one.endings
    )
    raise InputError(
        f"the ending {ending!r} names no format" if out is not None else "no format is named",
        where=None if out is None else str(out),
        remedy=f"Endings are {known}; or give --to.",
    )


def exported(model: Model, request: Request, to: Format) -> Exported:
    """An export, with how far its unloaded tool stands off the model for what was left out."""
    made, away = to.make(model, request), departure(model)
    found = {"departure_rms_m": rms(away), "departure_max_m": away.max()}
    if found["departure_rms_m"] < _NOTHING:
        return replace(made, details={**made.details, **found})
    note = (
        f"What goes with the pose and was left out moves the unloaded tool by "
        f"{1e3 * found['departure_rms_m']:.2g} mm rms, at most {1e3 * away.max():.2g} mm, at "
        f"{len(away)} random poses. A geometry that is to stand alone is fitted without waves: "
        "identify --no-waves."
    )
    return replace(made, notes=(note, *made.notes), details={**made.details, **found})


def write_exported(made: Exported, out: Path) -> None:
    """Write an export and the files beside it, all or none."""
    with together():
        for name, data in made.files.items():
            write_atomically(out.parent / name, data)
        write_atomically(out, made.text)


def export(
    model: Model,
    out: str | Path,
    to: str | None = None,
    *,
    pose: Array | None = None,
    frame: str | None = None,
) -> Exported:
    """Write a model in another program's words.

    Args:
        model: Robot and effects.
        out: The file; meshes of a moving model lie in a folder beside it, named after it.
        to: Name of the format; by the ending of `out` where it is not given.
        pose, frame: Where a model that moves begins, and where loads act; see `Request`.

    Raises:
        InputError: No such format, or the model is one that the format has no word for.

    Examples:
        >>> import sk120stiff as sk
        >>> model = sk.base_model(sk.load_robot("motoman_sk120"))
        >>> import tempfile, pathlib
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     made = sk.export(model, pathlib.Path(folder) / "sk120.xml")
        >>> "<mujoco" in made.text
        True
    """
    path = Path(out)
    made = exported(model, Request(path, pose, frame), format_of(path, to))
    write_exported(made, path)
    return made
