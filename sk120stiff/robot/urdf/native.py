"""What C++ libraries print on file descriptor 2, caught instead of lost on the terminal."""

from __future__ import annotations

import os
import sys
import tempfile
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass

_ONE_AT_A_TIME = threading.RLock()
_LONGEST = 20_000  # bytes kept; a parser that complains once per element can fill a disk


@dataclass
class CapturedText:
    """`text` is filled when the context ends, and already inside an `except` within it."""

    _stream: object = None
    _kept: str = ""

    @property
    def text(self) -> str:
        """What was printed so far, undecodable bytes replaced."""
        if self._stream is None:
            return self._kept
        return _read(self._stream.fileno())  # type: ignore[attr-defined]


def _read(descriptor: int) -> str:
    return os.pread(descriptor, _LONGEST, 0).decode("utf-8", "replace")


@contextmanager
def captured_stderr() -> Iterator[CapturedText]:
    """Redirect file descriptor 2 of the whole process into a buffer while the block runs.

    Parsers written in C++ report there and leave Python with one empty `ValueError`. Only one
    block at a time redirects; others wait. A process without descriptor 2 is left alone.

    Yields:
        CapturedText: Its `text` may be read inside the block and after it.
    """
    captured = CapturedText()
    with _ONE_AT_A_TIME, tempfile.TemporaryFile() as stream:
        with suppress(OSError, ValueError, AttributeError):
            sys.stderr.flush()
        try:
            saved = os.dup(2)
        except OSError:  # no terminal and no descriptor: nothing to protect
            yield captured
            return
        captured._stream = stream
        try:
            os.dup2(stream.fileno(), 2)
            yield captured
        finally:
            with suppress(OSError, ValueError, AttributeError):
                sys.stderr.flush()
            os.dup2(saved, 2)
            os.close(saved)
            captured._kept = _read(stream.fileno())
            captured._stream = None
