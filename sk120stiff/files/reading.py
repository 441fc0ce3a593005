"""Reading files: each is noted, so that no output replaces it, and complaints are clear."""

from __future__ import annotations

import hashlib
import os
from pathlib import Path

from sk120stiff.errors import InputError
from sk120stiff.files.ledger import note_read

LARGEST = 250_000_000  # bytes of one file; a device has no end at all
WORKBOOK = b"PK\x03\x04"  # how packed files begin, workbooks of spreadsheets among them


def read_bytes(path: str | os.PathLike[str]) -> bytes:
    """Content of a file.

    Raises:
        InputError: The file is missing, a folder, unreadable or too large, or this run is going to
            write it.
    """
    source = Path(path)
    note_read(source)
    try:
        with source.open("rb") as stream:
            data = stream.read(LARGEST + 1)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(
            f"cannot read this file ({reason})",
            where=str(source),
            remedy="Check the path and its permissions.",
        ) from error
    if len(data) > LARGEST:
        raise InputError(
            f"this file is larger than {LARGEST / 1e6:.0f} MB",
            where=str(source),
            remedy="Check that it is the right one, or split it.",
        )
    return data


def sha256_of(*paths: str | os.PathLike[str]) -> str:
    """SHA-256 of what files hold, one after the other, in hexadecimal; errors of `read_bytes`."""
    digest = hashlib.sha256()
    for path in paths:
        digest.update(read_bytes(path))
    return digest.hexdigest()


def read_text(path: str | os.PathLike[str]) -> str:
    """Text of a UTF-8 file (a leading byte-order mark is dropped).

    Raises:
        InputError: As `read_bytes`, or the file is not UTF-8 (line and byte are named).
    """
    data = read_bytes(path)
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        if data.startswith(WORKBOOK):
            raise InputError(
                "this is a workbook (or another packed file), no text",
                where=str(path),
                remedy=f"Make a table of it: sk120stiff import {Path(path).name} --robot ROBOT "
                "--out readings.csv",
            ) from error
        line = data.count(b"\n", 0, error.start) + 1
        raise InputError(
            f"the byte 0x{data[error.start]:02x} is not UTF-8 text",
            where=f"{path}, line {line}",
            remedy="Save the file with the encoding UTF-8.",
        ) from error
