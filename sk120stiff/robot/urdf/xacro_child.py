"""The process in which xacro runs: reads a job from stdin, writes plain URDF to a file."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path
from typing import Any

_MEMORY = 4 * 1024**3  # bytes of address space


def main() -> int:
    """Expand one file; the reason of a failure goes to stderr in one line."""
    job: dict[str, Any] = json.loads(sys.stdin.buffer.read())
    _bound_memory()
    try:
        _expand(job)
    except BaseException as error:  # noqa: BLE001 - whatever xacro raises becomes one line
        print(f"{type(error).__name__}: {error}", file=sys.stderr)  # noqa: T201
        return 1
    return 0


def _bound_memory() -> None:
    try:
        import resource  # absent on Windows
    except ImportError:
        return
    _, hard = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (_MEMORY, hard))


def _expand(job: dict[str, Any]) -> None:
    from xacrodoc import XacroDoc, packages  # heavy, and only here

    from sk120stiff.robot.urdf.packages import find_package

    folders = [Path(folder) for folder in job["folders"]]

    def look_up(name: str) -> str:
        found = find_package(name, folders) or _guess(name, job["path"])
        if not found:
            raise FileNotFoundError(
                f"package {name!r} was not found in the parent folders or ROS_PACKAGE_PATH"
            )
        return str(found[0])

    packages.get_path = look_up
    opened = _files_opened_from_now()
    options = {"subargs": job["arguments"], "resolve_packages": False}
    if job["path"] is not None:
        os.chdir(Path(job["path"]).parent)  # includes are relative to the file
        document = XacroDoc.from_file(job["path"], **options)
    else:
        document = XacroDoc.from_string(job["text"], **options)
    text = document.to_urdf_string()
    Path(job["opened"]).write_text(json.dumps(sorted(set(opened))), encoding="utf-8")
    if len(text) > job["max_bytes"]:
        raise MemoryError(f"the expanded text has {len(text) / 1e6:.0f} MB")
    Path(job["result"]).write_text(text, encoding="utf-8")


def _files_opened_from_now() -> list[str]:
    """Grows with every file that is read: what xacro includes are inputs too."""
    opened: list[str] = []

    def notice(event: str, details: tuple[Any, ...]) -> None:
        if event == "open" and isinstance(details[0], str) and details[1] in ("r", "rb"):
            opened.append(os.path.abspath(details[0]))

    sys.addaudithook(notice)
    return opened


def _guess(name: str, path: str | None) -> list[Path]:
    """Root of a package whose folder was renamed: two levels up, if the file lies in `urdf`."""
    folder = Path(path).parent if path is not None else Path()
    if folder.name not in ("urdf", "robots", "robot", "xacro"):
        return []
    print(f"package {name!r} was not found; {folder.parent} was taken instead", file=sys.stderr)  # noqa: T201
    return [folder.parent]


if __name__ == "__main__":
    sys.exit(main())
