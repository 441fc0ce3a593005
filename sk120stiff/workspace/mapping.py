"""Writing a map: here on all cores, or on a Dask cluster; by one writer at a time.

The lock of a writer opens with its death.
"""

from __future__ import annotations

import fcntl
import os
import socket
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sk120stiff.errors import InputError, Refusal, ToolkitError, require, warn
from sk120stiff.workspace.field import MapJob
from sk120stiff.workspace.store import MapStore, Progress

FAST_POINTS, SLOW_POINTS = 1 << 17, 1 << 12  # of a chunk: for one load, for slow work
CONNECT_SECONDS = 5  # after which a scheduler counts as unreachable
STARVED_SECONDS = 120  # after which a cluster without workers counts as gone
IN_FLIGHT = 3  # chunks per worker that are handed out ahead
ATTEMPTS = 10  # times that a chunk is handed out before its loss counts as its own fault


@dataclass(frozen=True)
class MapReport:
    """What `write_map` did.

    Attributes:
        path: The map.
        points: Points of the grid.
        computed: Those that this run computed; the rest was there already.
        seconds: How long this run took.
        chunks: Number of chunks of the map.
        mended: Files that were not as an earlier run had written them, and were made again.
    """

    path: Path
    points: int
    computed: int
    seconds: float
    chunks: int
    mended: tuple[str, ...] = ()


def write_map(
    job: MapJob,
    path: str | os.PathLike[str],
    *,
    scheduler: str | None = None,
    chunk_points: int | None = None,
    overwrite: bool = False,
    progress: Progress | None = None,
    checking: Progress | None = None,
) -> MapReport:
    """Write a map, or what is missing of it.

    Only a few chunks are in memory at a time. A run that was killed is taken up by calling this
    again with the same job and path; so is a finished map, of which whatever is not as it was
    written is made again.

    Args:
        job: What to compute.
        path: Folder of the map, by custom ``….zarr``.
        scheduler: Address of a Dask scheduler (``tcp://host:8786``) whose workers see the same
            folder; without it the map is computed here.
        chunk_points: Points that are computed, held in memory and written together; by default as
            many as make about a second's work.
        overwrite: Replace another map of that name.
        progress: Called with (points done, points in all) after every chunk.
        checking: Called with (chunks looked at, chunks in all) while what an earlier run left is
            compared with its checksums.

    Raises:
        InputError: The place is taken, another run writes there, the disk has not enough room, or
            there is no such scheduler.
        Refusal: The disk is full, or the cluster is gone; what is done is kept.
    """
    begin = time.perf_counter()
    store = MapStore(Path(path).resolve(), job, chunk_points or _chunk_points(job))
    size, number = job.points.grid.size, store.chunks.number
    with only_writer(store.path):
        client = None if scheduler is None else _connect(scheduler)
        try:
            found = store.prepare(overwrite=overwrite, progress=checking)
            missing = [chunk for chunk in range(number) if chunk not in found.done]
            counted = size - sum(_points(store, chunk) for chunk in missing)
            computed = 0
            if progress:
                progress(counted, size)
            written = (
                (store.write_chunk(chunk) for chunk in missing)
                if client is None
                else _on_cluster(client, store, missing)
            )
            for points in written:
                computed += points
                if progress:
                    progress(counted + computed, size)
            if missing or found.damaged or not store.complete:
                store.finish()
        finally:
            if client is not None:
                client.close()
    seconds = time.perf_counter() - begin
    return MapReport(store.path, size, computed, seconds, number, found.damaged)


def _chunk_points(job: MapJob) -> int:
    if job.points.cartesian or not job.arm.compiled:
        return SLOW_POINTS
    return max(SLOW_POINTS, FAST_POINTS // len(job.loads))


def _points(store: MapStore, chunk: int) -> int:
    begin, end = store.chunks.stretch(chunk)
    return end - begin


def _connect(address: str) -> Any:
    require("distributed", needed_for="a cluster")
    from distributed import Client

    try:
        connect: Any = Client
        # the default client of a process would compute whatever else Dask does there
        return connect(address, timeout=CONNECT_SECONDS, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as error:
        raise InputError(
            f"no Dask scheduler answers at {address!r}",
            where="--scheduler",
            remedy="Start one with 'dask scheduler' and give the address it prints, such as "
            "tcp://192.168.0.10:8786.",
        ) from error


def _on_cluster(client: Any, store: MapStore, missing: list[int]) -> Iterator[int]:
    """Hand chunks out a few at a time, and again those that a lost worker had."""
    import distributed

    wait: Any = distributed.wait
    waiting = list(reversed(missing))
    tries = dict.fromkeys(missing, 0)
    running: dict[Any, int] = {}
    while waiting or running:
        room = IN_FLIGHT * max(1, _workers(client)) - len(running)
        for _ in range(min(room, len(waiting))):
            chunk = waiting.pop()
            tries[chunk] += 1
            future = client.submit(_write, store, chunk, pure=False)
            running[future] = chunk
        try:
            with client.as_current():
                found = wait(list(running), timeout=STARVED_SECONDS, return_when="FIRST_COMPLETED")
        except TimeoutError:
            if _workers(client):
                continue
            raise Refusal(
                f"the cluster has had no worker for {STARVED_SECONDS} s",
                where="--scheduler",
                remedy="What is finished is kept: run the same command again.",
            ) from None
        for future in found.done:
            chunk = running.pop(future)
            if future.status == "finished":
                yield future.result()
                continue
            error = None if future.cancelled() else future.exception()
            if isinstance(error, ToolkitError) or tries[chunk] >= ATTEMPTS:
                raise error or Refusal(
                    f"chunk {chunk} was lost {ATTEMPTS} times with the worker that had it",
                    where="--scheduler",
                    remedy="Look at the workers' logs; the same command goes on where it stopped.",
                )
            if error is not None and not _is_loss(error):
                raise error
            waiting.append(chunk)


def _is_loss(error: BaseException) -> bool:
    """Did the worker or its connection go, rather than the work?"""
    from distributed import KilledWorker

    return isinstance(error, KilledWorker | OSError)


def _write(store: MapStore, chunk: int) -> int:
    """Body of a worker's task; a worker computes with one thread."""
    if not store.path.is_dir():
        raise Refusal(
            "a worker of the cluster does not see the folder of the map",
            where=str(store.path),
            remedy="Choose a folder that all workers share.",
        )
    return store.write_chunk(chunk, threads=1)


def _workers(client: Any) -> int:
    return len(client.scheduler_info(n_workers=-1)["workers"])


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
