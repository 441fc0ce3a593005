"""Ctrl-C that is not lost: what something swallowed still stops before a file is written.

Python raises `KeyboardInterrupt` wherever the program stands. Within a library that catches
everything, or in a callback from compiled code, it is gone, and a run that was to end goes on.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

_asked: list[int] = []


@contextmanager
def remembered() -> Iterator[None]:
    """Remember within this block that Ctrl-C was pressed, beside raising `KeyboardInterrupt`.

    Other threads than the main one get no signals; where Ctrl-C is ignored, as of `nohup`, or has
    another's handler, it stays so.
    """
    usual = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    if threading.current_thread() is not threading.main_thread() or not usual:
        yield
        return

    def stop(number: int, _frame: FrameType | None) -> None:
        _asked.append(number)
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGINT, stop)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
        _asked.clear()


def stop_if_asked() -> None:
    """Raise `KeyboardInterrupt` where one was swallowed."""
    if _asked:
        raise KeyboardInterrupt
