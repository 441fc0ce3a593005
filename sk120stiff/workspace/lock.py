"""One writer at a time: a lock that its writer's death opens."""

from __future__ import annotations

import fcntl
import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from sk120stiff.errors import InputError, warn


@contextmanager
def only_writer(path: Path) -> Iterator[None]:
    """Hold the lock of `path` (a file ``.NAME.lock`` beside it, with the writer's pid inside).

    The lock is the kernel's: it falls when its process ends in whatever way, so that the file a
    killed run leaves behind stops nobody.

    Raises:
        InputError: Another process writes there; its pid and machine are named.

    Warns:
        ToolkitWarning: The file system knows no locks.
    """
    beside = path.with_name(f".{path.name}.lock")
    handle = _taken(beside, path)
    try:
        yield
    finally:
        with suppress(OSError):
            beside.unlink()  # while it is held: whoever opened it before looks again
        os.close(handle)


def _taken(beside: Path, path: Path) -> int:
    try:
        beside.parent.mkdir(parents=True, exist_ok=True)
        while True:
            handle = os.open(beside, os.O_RDWR | os.O_CREAT, 0o666)
            try:
                if _locked(handle, beside, path):
                    return handle
            except BaseException:
                os.close(handle)
                raise
            os.close(handle)
    except OSError as error:
        raise InputError(
            f"cannot write here ({error.strerror})",
            where=str(path),
            remedy="Choose a folder that you may write to.",
        ) from error


def _locked(handle: int, beside: Path, path: Path) -> bool:
    """Take the lock; False where the file was removed meanwhile and another has to be opened."""
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError as error:
        raise InputError(
            f"another run ({_written(handle)}) is writing here",
            where=str(path),
            remedy="Wait for it or stop it, then give the command again; or choose another name.",
        ) from error
    except OSError as error:
        warn(
            f"{path}: this file system knows no locks ({error.strerror}); see to it that no other "
            "run writes here",
            stacklevel=4,
        )
    try:
        same = os.path.samestat(os.fstat(handle), os.stat(beside))
    except FileNotFoundError:
        return False
    if same:
        os.truncate(handle, 0)
        os.pwrite(handle, f"process {os.getpid()} on {socket.gethostname()}\n".encode(), 0)
    return same


def _written(handle: int) -> str:
    text = os.pread(handle, 200, 0).decode(errors="replace").strip()
    return text or "which has not said its process yet"
