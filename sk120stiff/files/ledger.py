"""What one run reads and writes, so that no output ever replaces an input.

A run is one call of a command. Everything that it reads is noted here, outputs are declared before
the work begins, and both are compared whichever comes first: by path, with links followed, and by
the file itself (device and inode), which finds hard links and names that differ in case alone.
Outside a run, in a library call, nothing is compared: a program may well rewrite what it has read.
"""

from __future__ import annotations

import logging
import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from sk120stiff.errors import InputError

logger = logging.getLogger(__name__)

Path_ = str | os.PathLike[str]
_Key = tuple[object, ...]
_STREAMS = ("/dev/std", "/dev/fd/", "/proc/")  # names for whatever is open already


@dataclass
class Ledger:
    """Keys of the files of one run.

    Attributes:
        read: Key → the path as it was read.
        promised: Key → the output as it was declared, and the option that did it.
        filled: Folders that are going to be the run's own.
        written: Keys of what the run has written itself and may read again.
        told: Links that were spoken of.
    """

    read: dict[_Key, Path] = field(default_factory=dict)
    promised: dict[_Key, tuple[Path, str]] = field(default_factory=dict)
    filled: list[Path] = field(default_factory=list)
    written: set[_Key] = field(default_factory=set)
    told: set[Path] = field(default_factory=set)


_current: list[Ledger] = []


@contextmanager
def running() -> Iterator[None]:
    """Begin a run; what an enclosing one has read does not count in it."""
    _current.append(Ledger())
    try:
        yield
    finally:
        _current.pop()


def note_read(path: Path_) -> None:
    """Say that this file is an input.

    Raises:
        InputError: It was declared as an output of this run.
    """
    if not _current:
        return
    ledger, source = _current[-1], Path(path)
    keys = _keys(source)
    if keys & ledger.written:
        return
    for key in keys & ledger.promised.keys():
        out, option = ledger.promised[key]
        raise _clash(source, out, option)
    for folder in ledger.filled:
        if _lies_in(source, folder):
            raise _clash(source, folder, "--out")
    ledger.read.update(dict.fromkeys(keys, source))


def will_write(path: Path_ | None, option: str = "--out") -> None:
    """Declare an output before the work that leads to it.

    Args:
        path: The file; None, an option that was not given, declares nothing.
        option: What the user named it by, for the message.

    Raises:
        InputError: The file is an input, two options name it, or it cannot be written.
    """
    if path is None:
        return
    out = Path(path)
    target = destination(out)
    refuse_input(out, option)
    there = next(folder for folder in target.absolute().parents if folder.exists())
    if not there.is_dir() or not os.access(there, os.W_OK | os.X_OK):
        raise InputError(
            f"cannot write into {there}",
            where=f"{option} {out}",
            remedy="Choose a folder that you may write to.",
        )
    if not _current:
        return
    promised = _current[-1].promised
    keys = _keys(out)
    for key in keys & promised.keys():
        other, named = promised[key]
        raise InputError(
            f"{named} {other} names the same file",
            where=f"{option} {out}",
            remedy="Give each output a name of its own.",
        )
    promised.update(dict.fromkeys(keys, (out, option)))


def will_fill(folder: Path_) -> None:
    """Declare the folder of --out, which is going to hold this run's output and nothing else.

    Raises:
        InputError: An input lies in it, or is it.
    """
    if not _current:
        return
    ledger, out = _current[-1], Path(folder)
    for source in ledger.read.values():
        if _lies_in(source, out):
            raise _clash(source, out, "--out")
    ledger.filled.append(out)


def refuse_input(path: Path, option: str | None = None) -> None:
    """Refuse to write what this run has read.

    Raises:
        InputError: It has.
    """
    if not _current:
        return
    for key in _keys(path) & _current[-1].read.keys():
        raise _clash(_current[-1].read[key], path, option)


def note_written(path: Path) -> None:
    """Say that this run made the file: reading it back is no clash."""
    if _current:
        _current[-1].written.update(_keys(path))


def destination(path: Path) -> Path:
    """The file that writing to `path` makes or replaces: a link is followed, and that is said.

    Raises:
        InputError: A folder, a link that leads nowhere, a write-protected file, or no file at all,
            such as a device or a pipe.
    """
    if str(path).startswith(_STREAMS):
        raise _no_file(path)
    try:
        target = path.resolve()
        mode = target.stat().st_mode if target.exists() else None
    except (OSError, RuntimeError, ValueError) as error:
        raise InputError(
            f"this name cannot be used ({getattr(error, 'strerror', None) or error})",
            where=str(path),
            remedy="Choose another name.",
        ) from error
    if mode is not None and stat.S_ISDIR(mode):
        raise InputError(
            "this is a folder, not a file", where=str(path), remedy="Name a file in it."
        )
    if mode is not None and not stat.S_ISREG(mode):
        raise _no_file(path)
    if mode is not None and not os.access(target, os.W_OK):
        raise InputError(
            "this file is write-protected",
            where=str(path),
            remedy="Choose another name, or allow writing to it.",
        )
    if path.is_symlink():
        if mode is None:
            raise InputError(
                f"this is a link to {target}, which does not exist",
                where=str(path),
                remedy="Remove the link, or choose another name.",
            )
        told = _current[-1].told if _current else set()
        if path not in told:
            told.add(path)
            logger.info("%s is a link; %s is written.", path, target)
    return target


def _no_file(path: Path) -> InputError:
    return InputError(
        "this is a device or a pipe, not a file",
        where=str(path),
        remedy="Name a file; the option --json prints the answer instead.",
    )


def _clash(source: Path, out: Path, option: str | None) -> InputError:
    return InputError(
        f"this would overwrite {source.name}, which is an input",
        where=f"{option} {out}" if option else str(out),
        remedy="Choose another name.",
    )


def _keys(path: Path) -> set[_Key]:
    """The path with links followed and, where there is such a file, the file itself."""
    try:
        keys: set[_Key] = {(os.path.normcase(path.resolve()),)}
        status = path.stat()
    except (OSError, RuntimeError, ValueError):
        return {(os.path.normcase(os.path.abspath(path)),)}
    return keys | {(status.st_dev, status.st_ino)}


def _lies_in(path: Path, folder: Path) -> bool:
    try:
        return path.resolve().is_relative_to(folder.resolve())
    except (OSError, RuntimeError, ValueError):
        return False
