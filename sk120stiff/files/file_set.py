"""Several files that are one result: all of them appear at once, or none."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from types import FrameType


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
