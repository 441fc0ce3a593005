"""The process in which xacro runs: reads a job from stdin, writes plain URDF and a report to files.

It is started as a file, not as a module of the package: nothing but xacro is imported, so that the
bound on its memory is xacro's own.
"""

from __future__ import annotations

import importlib.util
import json
import os
import re
import sys
from pathlib import Path
from typing import Any

_LARGEST_FILE = 256 * 1024**2  # bytes that it may write to one file
_DECLARED = re.compile(r"""<xacro:arg\b[^>]{0,500}?\bname\s*=\s*["']([^"']{1,200})["']""")
_USED = re.compile(r"""\$\(arg\s+([\w.-]{1,200})\s*\)|\barg\(\s*["']([^"']{1,200})["']""")


class ArgException(Exception):
    """An argument has no value; of the same name as xacro's own."""


def main() -> int:
    """Expand one file; what went wrong goes into the report."""
    job: dict[str, Any] = json.loads(sys.stdin.buffer.read())
    _bound(job["memory"])
    report: dict[str, Any] = {"error": None, "missing": None, "guessed": [], "arguments": []}
    try:
        _expand(job, report)
    except MemoryError:
        report["error"] = f"it needs more than {job['memory'] / 1024**3:g} GB of memory"
    except BaseException as error:  # noqa: BLE001 - whatever xacro raises becomes one line
        report["error"] = f"{type(error).__name__}: {error}"
        report["missing"] = _missing(error)
        if _is_memory(error):
            report["error"] = f"it needs more than {job['memory'] / 1024**3:g} GB of memory"
    Path(job["report"]).write_text(json.dumps(report), encoding="utf-8")
    return 0


def _bound(memory: int) -> None:
    try:
        import resource  # absent on Windows
    except ImportError:
        return
    for kind, most in ((resource.RLIMIT_AS, memory), (resource.RLIMIT_FSIZE, _LARGEST_FILE)):
        _, hard = resource.getrlimit(kind)
        resource.setrlimit(kind, (most if hard < 0 else min(most, hard), hard))


def _expand(job: dict[str, Any], report: dict[str, Any]) -> None:
    import xacro
    from xacro import substitution_args

    find_package = _neighbour("packages").find_package
    path = Path(job["path"])
    folders = [Path(folder) for folder in job["folders"]]

    def look_up(name: str) -> str:
        found = find_package(name, folders)
        if not found:
            found = _guess(path)
            report["guessed"].append(name)
        if not found:
            raise FileNotFoundError(
                f"package {name!r} was not found beside the file, in folders above it, or in "
                "ROS_PACKAGE_PATH and AMENT_PREFIX_PATH"
            )
        return str(found[0])

    substitution_args._eval_find = look_up
    substitution_args._eval_dict["find"] = look_up
    # xacro knows the file that it reads, but does not hand it on to $(dirname)
    substitution_args._eval_dirname = lambda _: str(Path(xacro.filestack[-1]).absolute().parent)
    xacro.check_attrs = _with_arguments_without_default(xacro.check_attrs, job["arguments"])
    report["opened"] = _files_opened_from_now()
    os.chdir(path.parent)
    try:
        document = xacro.process_file(str(path), mappings=dict(job["arguments"]))
    finally:
        report["arguments"] = _arguments([path, *map(Path, xacro.all_includes)])
    text = document.toprettyxml(indent="  ")
    if len(text) > job["max_bytes"]:
        raise MemoryError(f"the expanded text has {len(text) / 1e6:.0f} MB")
    Path(job["result"]).write_text(text, encoding="utf-8")


def _with_arguments_without_default(check: Any, given: dict[str, str]) -> Any:
    """xacro's check of attributes, but `<xacro:arg>` without default only asks for a value."""

    def checked(tag: Any, required: list[str], optional: list[str]) -> Any:
        name = tag.getAttribute("name")
        if tag.tagName != "xacro:arg" or tag.hasAttribute("default") or not name:
            return check(tag, required, optional)
        if name not in given:
            raise ArgException(name)
        return [name, ""]

    return checked


def _neighbour(name: str) -> Any:
    """The module of that name beside this file, without the package around it."""
    spec = importlib.util.spec_from_file_location(name, Path(__file__).with_name(f"{name}.py"))
    if spec is None or spec.loader is None:
        raise ImportError(f"{name}.py does not lie beside this file")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def _files_opened_from_now() -> list[str]:
    """Grows with every file that is read: what xacro includes and loads is an input too."""
    opened: list[str] = []

    def notice(event: str, details: tuple[Any, ...]) -> None:
        if event == "open" and isinstance(details[0], str) and details[1] in ("r", "rb"):
            opened.append(os.path.abspath(details[0]))

    sys.addaudithook(notice)
    return opened


def _guess(path: Path) -> list[Path]:
    """Root of a package that lost its name: one level up, if the file lies in `urdf`."""
    above = path.parent.parent
    nameless = not (above / "package.xml").is_file()
    return [above] if nameless and path.parent.name in ("urdf", "robots", "robot", "xacro") else []


def _arguments(files: list[Path]) -> list[str]:
    """Names of all arguments that the files declare or use."""
    names: dict[str, None] = {}
    for file in files:
        text = file.read_text(encoding="utf-8", errors="replace") if file.is_file() else ""
        for pattern in (_DECLARED, _USED):
            for match in pattern.finditer(text):
                names[next(filter(None, match.groups()))] = None
    return list(names)


def _missing(error: BaseException | None) -> str | None:
    """Name of the argument that has no value, if that is what stopped xacro."""
    while error is not None:
        if type(error).__name__ == "ArgException":
            return str(error.args[0])
        error = getattr(error, "exc", None) or error.__cause__
    return None


def _is_memory(error: BaseException | None) -> bool:
    while error is not None:
        if isinstance(error, MemoryError):
            return True
        error = getattr(error, "exc", None) or error.__cause__
    return False


if __name__ == "__main__":
    sys.exit(main())
