"""From arrays to the compiled kernel and back, on all cores."""

from __future__ import annotations

import logging
import os
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from functools import cache
from importlib.util import find_spec
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError, MissingPart
from sk120stiff.stiffness.kernel.folding import Fold, Given
from sk120stiff.stiffness.quantities import BY_LOAD, COMPILED, shape_of

logger = logging.getLogger(__name__)

LARGEST_ANGLE = 1e5  # rad; beyond it sine and cosine lose digits
PIECE = 16384  # poses that a thread takes at a time
PATIENCE = 0.5  # seconds after which the loading is announced
_READY: list[Any] = []  # the compiled function, its outputs and its memory, once they are loaded


def run(
    folded: Fold,
    poses: Array,
    wrench: Array,
    want: frozenset[str],
    threads: int | None,
    more: Given | None = None,
) -> dict[str, NDArray[Any]]:
    """Wanted quantities of `COMPILED` at poses (N, n_a) under (6,), (N, 6) or (Q, 1 or N, 6).

    Where `folded` has the motion given, `more` gives it, and poses are joint values (N, m).

    Raises:
        InputError: An angle is too large for sine and cosine to be accurate.
    """
    _check_angles(folded, poses)
    loads = np.ascontiguousarray(wrench.reshape(-1, 1, 6) if wrench.ndim < 2 else wrench)
    if loads.ndim < 3 or wrench.ndim < 2:
        loads = loads.reshape(1, -1, 6)
    count, n, s = len(poses), folded.n, len(folded.soft)
    arrays = {}
    for name in COMPILED:
        batch = (len(loads), count) if name in BY_LOAD else (count,)
        own = shape_of(name, n, s)
        arrays[name] = np.zeros(
            (*batch, *own) if name in want else (0,) * (len(batch) + len(own)),
            dtype=np.uint8 if name.endswith("_class") else float,
        )
    more = more or Given(*(np.zeros((0, 0)) for _ in Given._fields))
    work, out, scratch = _kernel(folded, poses, more, loads, arrays)

    def stretch(begin: int, end: int) -> None:
        work(folded, poses, more, loads, begin, end, out, scratch(folded))

    cores = threads or available_cores()
    if cores == 1 or count <= PIECE:
        stretch(0, count)
    else:
        ends = [*range(PIECE, count, PIECE), count]
        with ThreadPoolExecutor(cores) as pool:
            list(pool.map(stretch, range(0, count, PIECE), ends))
    single = wrench.ndim < 3
    return {name: arrays[name][0] if single and name in BY_LOAD else arrays[name] for name in want}


@cache
def compiles() -> bool:
    """Is numba there? Without it NumPy gives the same numbers, and says once that it is slow."""
    if find_spec("numba") is not None:
        return True
    missing = MissingPart("numba", needed_for="the fast way through many poses")
    logger.info("Many poses go through NumPy, some fifty times slower: %s", missing)
    return False


def available_cores() -> int:
    """Cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _check_angles(folded: Fold, poses: Array) -> None:
    """One pass without copies settles nearly every call; only a doubt looks at each joint."""
    if not poses.size:
        return
    factors = np.abs(folded.pose_map[:, : poses.shape[1]])[folded.slides == 0.0]
    reach = max(float(poses.max()), -float(poses.min()))
    if reach * factors.sum(axis=1).max(initial=0.0) <= LARGEST_ANGLE:
        return
    turning = factors @ np.abs(poses).max(axis=0)
    if turning.max(initial=0.0) > LARGEST_ANGLE:
        raise InputError(
            f"a joint angle of {turning.max():.3g} rad is beyond {LARGEST_ANGLE:.0e}",
            remedy="Give joint angles in radians.",
        )


def _kernel(
    folded: Fold, poses: Array, more: Given, loads: Array, arrays: dict[str, Any]
) -> tuple[Callable[..., None], Any, Callable[[Fold], Any]]:
    """The compiled function, its outputs and its memory; a first call loads or compiles it."""
    if _READY:
        work, outputs, scratch = _READY
        return work, outputs(**arrays), scratch
    with announced():
        from sk120stiff.stiffness.kernel.block import Outputs, work
        from sk120stiff.stiffness.kernel.compiled import told_of_compiling
        from sk120stiff.stiffness.kernel.layout import scratch

        out = Outputs(**arrays)
        # nothing to do but to be compiled or loaded
        with told_of_compiling(_compiling):
            work(folded, poses, more, loads, 0, 0, out, scratch(folded))
        _READY[:] = [work, Outputs, scratch]
    return work, out, scratch


@contextmanager
def announced() -> Iterator[None]:
    """Say so when what happens inside takes long: numba comes in, or the machine is busy."""
    clock = threading.Timer(PATIENCE, logger.info, args=("Loading the batch kernel …",))
    clock.daemon = True
    clock.start()
    try:
        yield
    finally:
        clock.cancel()


def _compiling() -> None:
    logger.info("Preparing the batch kernel (some ten seconds at its first use on a machine) …")
