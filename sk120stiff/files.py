"""Writing files so that nobody ever meets half a file, and reading text with clear complaints."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from sk120stiff.errors import InputError


def write_atomically(path: str | os.PathLike[str], content: str | bytes) -> Path:
    """Write `content` under a temporary name in the same folder, then rename it to `path`.

    Parent folders are made. An interrupted write leaves the old file as it was.

    Raises
    ------
    InputError
        `path` is a folder, or its own folder cannot be made or written to.
    """
    target = Path(path)
    if target.is_dir():
        raise InputError(
            "this is a folder, not a file", where=str(target), remedy="Name a file in it."
        )
    data = content.encode("utf-8") if isinstance(content, str) else content
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        handle, temporary = tempfile.mkstemp(dir=target.parent, prefix=f".{target.name}.")
    except OSError as error:
        raise InputError(
            f"cannot write here ({error.strerror})",
            where=str(target),
            remedy="Choose a folder that you may write to.",
        ) from error
    try:
        with os.fdopen(handle, "wb") as stream:
            stream.write(data)
        os.chmod(temporary, 0o666 & ~_umask())
        os.replace(temporary, target)
    except BaseException:
        Path(temporary).unlink(missing_ok=True)
        raise
    return target


def read_text(path: str | os.PathLike[str]) -> str:
    """Text of a UTF-8 file (a leading byte-order mark is dropped).

    Raises
    ------
    InputError
        The file is missing, a folder, unreadable, or not UTF-8 (line and byte are named).
    """
    source = Path(path)
    try:
        data = source.read_bytes()
    except OSError as error:
        raise InputError(
            f"cannot read this file ({error.strerror})",
            where=str(source),
            remedy="Check the path and its permissions.",
        ) from error
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise InputError(
            f"the byte 0x{data[error.start]:02x} is not UTF-8 text",
            where=f"{source}, line {line}",
            remedy="Save the file with the encoding UTF-8.",
        ) from error


def _umask() -> int:
    current = os.umask(0)
    os.umask(current)
    return current
