"""Writing files so that nobody ever meets half a file, or half a set, and no input is lost."""

from __future__ import annotations

import os
import signal
import tempfile
import threading
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from types import FrameType

from sk120stiff.errors import InputError
from sk120stiff.files.interrupts import stop_if_asked
from sk120stiff.files.ledger import destination, note_written, refuse_input


def write_atomically(path: str | os.PathLike[str], content: str | bytes) -> Path:
    """Write `content` under a temporary name in the same folder, then rename it to `path`.

    Parent folders are made. An interrupted write leaves the old file as it was. Within `together`
    the renaming waits for the other files. A link is followed.

    Raises:
        InputError: `path` is an input of this run, no file, or its folder cannot be made or written
            to.
    """
    stop_if_asked()
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


@dataclass
class FileSet:
    """Files that wait under temporary names for the moment in which they take their places."""

    waiting: dict[Path, Path] = field(default_factory=dict)  # target → temporary
    folders: list[Path] = field(default_factory=list)

    def will_make(self, folder: Path) -> None:
        """Remember which folders did not exist."""
        self.folders += [f for f in (folder, *folder.parents) if not f.exists()]

    def add(self, temporary: Path, target: Path) -> None:
        """Take in a file that is written."""
        replaced = self.waiting.pop(target, None)
        self.waiting[target] = temporary
        if replaced is not None:
            replaced.unlink(missing_ok=True)

    def swap(self, stale: Iterable[Path], last: Path | None) -> None:
        """Put every file into its place: the old `last` goes first, the new one comes last."""
        if last is not None:
            last.unlink(missing_ok=True)
        for path in stale:
            if path.resolve() not in self.waiting:
                path.unlink(missing_ok=True)
        final = None if last is None else last.resolve()
        for target in sorted(self.waiting, key=lambda each: each == final):
            os.replace(self.waiting[target], target)
        self.waiting.clear()

    def drop(self) -> None:
        """Leave everything as it was."""
        for temporary in self.waiting.values():
            temporary.unlink(missing_ok=True)
        for folder in sorted(set(self.folders), key=lambda each: -len(each.parts)):
            with suppress(OSError):  # not made, or somebody put something there
                folder.rmdir()


_open: list[FileSet] = []


def open_set() -> FileSet | None:
    """The set that is being written, if there is one."""
    return _open[-1] if _open else None


@contextmanager
def together(*, stale: Iterable[Path] = (), last: Path | None = None) -> Iterator[None]:
    """Let files that are written inside take their places at the end, all in one moment.

    Whatever ends the block early leaves the files of an earlier run as they were. Ctrl-C within
    that moment waits for its end. Within another such block the files wait for the outer one.

    Args:
        stale: Files of an earlier run that must not stand beside the new ones; they are removed.
        last: The file that says that all others are there.
    """
    if _open:
        yield
        return
    files = FileSet()
    _open.append(files)
    try:
        yield
        stop_if_asked()
        with _interrupts_wait():
            files.swap(stale, last)
    finally:
        _open.clear()
        files.drop()


@contextmanager
def _interrupts_wait() -> Iterator[None]:
    """Hold Ctrl-C back; other threads than the main one cannot, and need not."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    asked: list[int] = []

    def remember(number: int, _frame: FrameType | None) -> None:
        asked.append(number)

    before = signal.signal(signal.SIGINT, remember)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
        if asked and callable(before):
            before(asked[0], None)
