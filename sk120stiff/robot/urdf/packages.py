"""Where the files lie that a URDF refers to: by package, by `file://`, by relative path."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from contextlib import suppress
from functools import lru_cache
from pathlib import Path
from urllib.parse import unquote

_PACKAGE_NAME = re.compile(rb"<name>\s*([\w.-]{1,200})\s*</name>")
_LEVELS_UP = 12
_CRAWLED_UP = 6  # of the folders around a description, so many are crawled for packages
_DEPTH_AROUND, _DEPTH_OF_WORKSPACE = 2, 6
_MOST_FOLDERS = 5_000  # looked into for one package
_NO_PACKAGES = frozenset({"COLCON_IGNORE", "CATKIN_IGNORE", "AMENT_IGNORE"})


def package_folders(path: Path | None) -> tuple[Path, ...]:
    """Folders that may be a package or hold packages, first match wins.

    The parents of the description, then the `workspaces`.
    """
    around = [] if path is None else list(path.absolute().parents)[:_LEVELS_UP]
    return tuple(dict.fromkeys((*around, *workspaces())))


def workspaces() -> tuple[Path, ...]:
    """ROS_PACKAGE_PATH, and `share` below AMENT_PREFIX_PATH and CMAKE_PREFIX_PATH."""
    folders: list[Path] = []
    for variable, below in (
        ("ROS_PACKAGE_PATH", ""),
        ("AMENT_PREFIX_PATH", "share"),
        ("CMAKE_PREFIX_PATH", "share"),
    ):
        entries = os.environ.get(variable, "").split(os.pathsep)
        for entry in filter(None, entries):
            with suppress(OSError, RuntimeError):  # a name too long, no home: no such folder
                inside = Path(entry).expanduser() / below
                folders.append(inside if inside.is_dir() else Path(entry).expanduser())
    return tuple(dict.fromkeys(folders))


def find_package(name: str, folders: Sequence[Path]) -> list[Path]:
    """Candidate roots of a package: folders of its name, or whose package.xml says so.

    Only if none of `folders` is or directly holds it, the packages are sought that lie in or near
    them under another folder's name: beside the description and beside the folders above it, and
    anywhere in a workspace.
    """
    found = []
    for folder in folders:
        if folder.name == name or _package_name(folder) == name:
            found.append(folder)
        if (folder / name).is_dir():
            found.append(folder / name)
    if not found:
        deep = {folder: _DEPTH_AROUND for folder in folders[:_CRAWLED_UP] if _is_near(folder)}
        deep |= {folder: _DEPTH_OF_WORKSPACE for folder in workspaces() if folder in folders}
        for folder, depth in deep.items():
            known = _packages_below(folder, depth, _changed(folder))
            found += [place for place, said in known if said == name]
    return list(dict.fromkeys(found))


def _is_near(folder: Path) -> bool:
    """A folder that may hold somebody's packages; not the root, /home, /tmp or one's own home."""
    return len(folder.parts) > 2 and folder != Path.home()


def _changed(folder: Path) -> int:
    try:
        return folder.stat().st_mtime_ns
    except OSError:
        return 0


def _is_folder(entry: os.DirEntry[str]) -> bool:
    try:
        return entry.is_dir()
    except OSError:  # a link that leads round in a circle
        return False


@lru_cache(maxsize=64)
def _packages_below(folder: Path, depth: int, _changed: int) -> tuple[tuple[Path, str], ...]:
    """Packages in a folder and down to `depth` below it, nearest first; none within another."""
    found: list[tuple[Path, str]] = []
    level, looked = [folder], 0
    for _ in range(depth + 1):
        below: list[Path] = []
        for place in level:
            looked += 1
            if looked > _MOST_FOLDERS:
                return tuple(found)
            name = _package_name(place)
            if name is not None and place != folder:
                found.append((place, name))
                continue
            try:
                with os.scandir(place) as entries:
                    inside = sorted(entries, key=lambda entry: entry.name)
            except OSError:
                continue
            if not _NO_PACKAGES & {entry.name for entry in inside}:
                below += [Path(e.path) for e in inside if e.name[:1] != "." and _is_folder(e)]
        level = below
    return tuple(found)


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
