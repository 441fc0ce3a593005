"""The forms a robot description comes in: a file, a folder, text; each becomes bytes and a path."""

from __future__ import annotations

import os
import stat
from dataclasses import dataclass
from pathlib import Path

from sk120stiff.errors import InputError
from sk120stiff.files import note_read
from sk120stiff.robot.urdf.findings import shown

MAX_BYTES = 100 * 1024 * 1024
_MESHES = frozenset({".stl", ".dae", ".obj", ".ply", ".glb", ".gltf", ".step", ".stp", ".iges"})
_REMEDY = "Give a .urdf or .xacro file, a DH table (.csv), a folder that holds one, or URDF text."


@dataclass(frozen=True)
class RawSource:
    """Bytes of a description, where they come from, and how to name that in messages."""

    data: bytes
    path: Path | None
    label: str

    @property
    def is_xacro(self) -> bool:
        """Does the file call itself xacro?"""
        return self.path is not None and self.path.suffix.lower() == ".xacro"


def read_source(source: str | os.PathLike[str] | bytes) -> RawSource:
    """Bytes of a URDF or xacro.

    Args:
        source: Path of a file or of a folder that holds exactly one description, or XML as text or
            bytes.

    Raises:
        InputError: Nothing there, several candidates in a folder, not a regular file, not readable,
            a mesh, or more than `MAX_BYTES`.
    """
    if isinstance(source, bytes):
        return _text(source)
    if isinstance(source, str):
        start = source.lstrip("\ufeff \t\r\n")[:1]
        if start == "<" or "\n" in source or not source.strip():
            return _text(source.encode("utf-8", "replace"))
    try:
        named = os.fspath(source)
        path = Path(named.decode() if isinstance(named, bytes) else named).expanduser()
        if path.is_dir():
            path = _only_description(path)
        return RawSource(_bytes(path), path, str(path))
    except (TypeError, ValueError, OSError, RuntimeError) as error:
        if isinstance(error, InputError):
            raise
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(
            f"cannot read this file ({reason})", where=shown(str(source), 200), remedy=_REMEDY
        ) from error


def _text(data: bytes) -> RawSource:
    label = "URDF text"
    if len(data) > MAX_BYTES:
        raise InputError(
            f"this text has {len(data) / 1e6:.0f} MB; at most {MAX_BYTES / 1e6:.0f} MB are read",
            where=label,
            remedy="Give a smaller description; meshes belong into files of their own.",
        )
    return RawSource(data, None, label)


def _bytes(path: Path) -> bytes:
    if not path.exists():
        raise InputError("there is no such file", where=str(path), remedy=_REMEDY)
    status = path.stat()
    if not stat.S_ISREG(status.st_mode):
        raise InputError("this is not a regular file", where=str(path), remedy=_REMEDY)
    if path.suffix.lower() in _MESHES:
        raise InputError(
            "this is a mesh, not a robot description",
            where=str(path),
            remedy="Give the URDF that refers to it.",
        )
    note_read(path)
    with path.open("rb") as stream:
        data = stream.read(MAX_BYTES + 1)
    if len(data) > MAX_BYTES:
        raise InputError(
            f"the file has more than {MAX_BYTES / 1e6:.0f} MB",
            where=str(path),
            remedy="Give a smaller description; meshes belong into files of their own.",
        )
    if b"\0" in data[:4096] and not data.startswith((b"\xff\xfe", b"\xfe\xff")):
        raise InputError(
            "this is a binary file, not a robot description", where=str(path), remedy=_REMEDY
        )
    return data


def _only_description(folder: Path) -> Path:
    """The one description of a folder: in it, or in its folders `urdf`, `robots`, `robot`."""
    for place in (folder, *(folder / name for name in ("urdf", "robots", "robot"))):
        for pattern in (".urdf", ".urdf.xacro", ".xacro"):
            found = sorted(
                path
                for path in (place.iterdir() if place.is_dir() else ())
                if path.name.lower().endswith(pattern) and path.is_file()
            )
            if len(found) == 1:
                return found[0]
            if found:
                names = ", ".join(path.name for path in found[:12])
                raise InputError(
                    f"this folder holds {len(found)} robot descriptions: {names}",
                    where=str(place),
                    remedy="Name one of the files, or write a robot.yaml whose key urdf names it.",
                )
    raise InputError(
        "this folder holds no robot.yaml and no robot description",
        where=str(folder),
        remedy="Give a .urdf or .xacro file, or a folder that holds one.",
    )
