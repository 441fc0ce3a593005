"""The door to numba: how functions of this folder become machine code. No other file imports it."""

from __future__ import annotations

import hashlib
import logging
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numba
from numba.core import event

logger = logging.getLogger(__name__)

# Divisions follow IEEE 754 instead of raising, and a product may be fused with the sum it goes
# into; sums are never reordered.
_OPTIONS: dict[str, Any] = {
    "nogil": True,
    "error_model": "numpy",
    "fastmath": {"contract", "nsz"},
}
_INNER: dict[str, Any] = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}


def part(function: Callable[..., Any]) -> Callable[..., Any]:
    """Compile a function that is called by compiled functions only."""
    return numba.njit(**_OPTIONS, **_INNER)(function)  # type: ignore[no-any-return]


def entry(function: Callable[..., Any]) -> Callable[..., Any]:
    """Compile a function that Python calls, and keep the result on disk.

    numba keeps it beside the source file or, where that cannot be written to, in the user's cache
    folder or in NUMBA_CACHE_DIR. Its own check for staleness looks at one source file alone, so the
    name under which it is kept carries a digest of all files the code is made of.
    """
    function.__qualname__ = f"{function.__qualname__}_{_digest()}"
    try:
        return numba.njit(cache=True, **_OPTIONS)(function)  # type: ignore[no-any-return]
    except RuntimeError:
        logger.info(
            "Compiled code cannot be kept and is made anew by every process, because no folder for "
            "it can be written to. Set NUMBA_CACHE_DIR to one that can."
        )
        return part(function)


@contextmanager
def told_of_compiling(say: Callable[[], None]) -> Iterator[None]:
    """Call `say` once where something is compiled inside, not where it is loaded from disk."""
    with event.install_listener("numba:compile", _Told(say)):
        yield


class _Told(event.Listener):
    def __init__(self, say: Callable[[], None]) -> None:
        self._say: Callable[[], None] | None = say

    def on_start(self, _: object) -> None:
        say, self._say = self._say, None  # the parts of a function are compiled inside it
        if say is not None:
            say()

    def on_end(self, _: object) -> None:
        pass


def _digest() -> str:
    files = sorted(Path(__file__).parent.glob("*.py"))
    text = b"".join(path.read_bytes() for path in files)
    return hashlib.sha256(text).hexdigest()[:12]
