"""Writing files so that nobody ever meets half a file, and no input is lost."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from sk120stiff.errors import InputError
from sk120stiff.files.file_set import open_set
from sk120stiff.files.ledger import destination, note_written, refuse_input


def write_atomically(path: str | os.PathLike[str], content: str | bytes) -> Path:
    """Write `content` under a temporary name in the same folder, then rename it to `path`.

    Parent folders are made. An interrupted write leaves the old file as it was. Within `together`
    the renaming waits for the other files. A link is followed.

    Raises:
        InputError: `path` is an input of this run, no file, or its folder cannot be made or written
            to.
    """
    named = Path(path)
    target = destination(named)
    refuse_input(named)
    data = content.encode("utf-8", "surrogateescape") if isinstance(content, str) else content
    waiting = open_set()
    try:
        if waiting is not None:
            waiting.will_make(target.parent)
        target.parent.mkdir(parents=True, exist_ok=True)
        handle, temporary = tempfile.mkstemp(dir=target.parent, prefix=f".{target.name[:80]}.")
    except (OSError, ValueError) as error:
        raise InputError(
            f"cannot write here ({getattr(error, 'strerror', None) or error})",
            where=str(named),
            remedy="Choose a folder that you may write to.",
        ) from error
    try:
        with os.fdopen(handle, "wb") as stream:
            stream.write(data)
        os.chmod(temporary, _mode(target))
        if waiting is not None:
            waiting.add(Path(temporary), target)
        else:
            os.replace(temporary, target)
    except BaseException:
        Path(temporary).unlink(missing_ok=True)
        raise
    note_written(named)
    return named


def _mode(target: Path) -> int:
    """Permissions of the file that is replaced, else those that a new one has."""
    if target.exists():
        return target.stat().st_mode & 0o777
    current = os.umask(0)
    os.umask(current)
    return 0o666 & ~current
