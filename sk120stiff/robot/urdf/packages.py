"""Where the files lie that a URDF refers to: by package, by `file://`, by relative path."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Sequence
from pathlib import Path
from urllib.parse import unquote

_PACKAGE_NAME = re.compile(rb"<name>\s*([\w.-]{1,200})\s*</name>")
_LEVELS_UP = 12


def package_folders(
    path: Path | None, extra: Iterable[str | os.PathLike[str]] = ()
) -> tuple[Path, ...]:
    """Folders that may be a package or hold packages, first match wins.

    `extra`, then the parents of the description, then ROS_PACKAGE_PATH, AMENT_PREFIX_PATH/share
    and CMAKE_PREFIX_PATH/share.
    """
    folders = [Path(folder).expanduser() for folder in extra]
    if path is not None:
        folders.extend(list(path.absolute().parents)[:_LEVELS_UP])
    for variable, below in (
        ("ROS_PACKAGE_PATH", ""),
        ("AMENT_PREFIX_PATH", "share"),
        ("CMAKE_PREFIX_PATH", "share"),
    ):
        entries = os.environ.get(variable, "").split(os.pathsep)
        folders.extend(Path(entry) / below for entry in entries if entry)
    return tuple(dict.fromkeys(folders))


def find_package(name: str, folders: Sequence[Path]) -> list[Path]:
    """Candidate roots of a package: folders of its name, or whose package.xml says so."""
    found = []
    for folder in folders:
        if folder.name == name or _package_name(folder) == name:
            found.append(folder)
        if (folder / name).is_dir():
            found.append(folder / name)
    return list(dict.fromkeys(found))


def resolve(address: str, path: Path | None, folders: Sequence[Path]) -> tuple[Path | None, str]:
    """The file behind an address, or None and the reason.

    A ``package://`` address that climbs out of its package is not followed.
    """
    try:
        return _resolve(address, path, folders)
    except (OSError, ValueError) as error:  # names too long, zero bytes, no permission
        return None, f"cannot be looked up ({getattr(error, 'strerror', None) or error})"


def _resolve(address: str, path: Path | None, folders: Sequence[Path]) -> tuple[Path | None, str]:
    scheme, separator, rest = address.partition("://")
    scheme = scheme.lower()
    if separator and scheme in ("package", "model"):
        return _in_package(rest, folders)
    if separator and scheme == "file":
        rest = unquote(rest)
        return _existing(Path(rest if rest.startswith(("/", "~")) else f"/{rest}"), path)
    if separator:
        return None, f"addresses of kind {scheme[:20]}:// are not fetched"
    if address.startswith(("package:/", "file:/")):
        return _resolve(address.replace(":/", "://", 1), path, folders)
    return _existing(Path(address.replace("\\", "/")), path)


def _in_package(rest: str, folders: Sequence[Path]) -> tuple[Path | None, str]:
    name, _, inside = unquote(rest).replace("\\", "/").lstrip("/").partition("/")
    inside = os.path.normpath(inside) if inside else ""
    if name in ("", ".", "..") or inside.startswith(("..", "/")):
        return None, "the address leaves its package and is not followed"
    packages = find_package(name, folders)
    # A checkout often has another name than its package: then the parents of the file are tried.
    for folder in (*packages, *folders):
        candidate = folder / inside
        if candidate.is_file():
            return candidate, ""
    if packages:
        return None, f"there is no such file in {packages[0]}"
    missing = f"the package {name[:60]!r} was not found"
    return None, f"{missing} in the parent folders or ROS_PACKAGE_PATH"


def _existing(target: Path, path: Path | None) -> tuple[Path | None, str]:
    if not target.is_absolute():
        if path is None:
            return None, "a relative path in URDF text leads nowhere"
        target = path.absolute().parent / target
    if target.is_file():
        return target, ""
    return None, "there is no such file"


def _package_name(folder: Path) -> str | None:
    manifest = folder / "package.xml"
    try:
        with manifest.open("rb") as stream:
            match = _PACKAGE_NAME.search(stream.read(20_000))
    except OSError:
        return None
    return match.group(1).decode("ascii", "replace") if match else None
