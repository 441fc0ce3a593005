"""A map on disk: a Zarr group that is written chunk by chunk and knows when it is whole.

While a map is being written, a folder of small files beside the arrays says which chunks are done,
with the SHA-256 of every file they consist of; such a file is written after the data, so a killed
run loses only what it was working on. When all chunks are there, the digests of these and of all
other files go into ``manifest.json``: a map that has one is finished. Whatever is not as it was
written is made again when the same map is asked for, and nothing else is.
"""

from __future__ import annotations

import errno
import json
import shutil
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sk120stiff.errors import InputError, Refusal
from sk120stiff.files import write_atomically
from sk120stiff.workspace.field import MapJob, Variable
from sk120stiff.workspace.grid import Chunks
from sk120stiff.workspace.skeleton import (
    MANIFEST,
    VERSION,
    Digests,
    Manifest,
    as_written,
    identity_of,
    read_manifest,
    sha256_of,
    stored_identities,
    write_manifest,
    write_skeleton,
    zarr_or_explain,
)

PROGRESS = ".progress"
Progress = Callable[[int, int], None]


@dataclass(frozen=True)
class Found:
    """What `MapStore.prepare` found in the place.

    Attributes:
        done: Chunks that are there as they were written.
        damaged: Files of an earlier run that are not; they are made again.
    """

    done: frozenset[int]
    damaged: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class MapStore:
    """A map's folder.

    Attributes:
        path: The folder, by custom ``….zarr``.
        job: What the map holds.
        chunk_points: Points that a chunk has at most.
    """

    path: Path
    job: MapJob
    chunk_points: int

    @property
    def chunks(self) -> Chunks:
        """How the grid is cut."""
        return Chunks(self.job.points.grid.shape, self.chunk_points)

    def prepare(self, *, overwrite: bool = False, progress: Progress | None = None) -> Found:
        """Make the folder or take up what an earlier run left.

        Damaged files that hold no results are made again here; damaged chunks are removed, so
        that they count as missing. `progress` is called with (chunks looked at, chunks in all).

        Raises:
            InputError: Something else is in that place, or the disk has not enough room.
        """
        self._remove_leftovers()
        if overwrite and self._is_there():
            self._remove()
        if not self._is_there():
            self._check_room(self.job.points.grid.size)
            with full_disk_explained(self.path):
                self._create()
            return Found(frozenset())
        self._check_identity()
        finished = (self.path / MANIFEST).is_file()
        manifest = read_manifest(self.path)
        if finished and manifest is None:
            (self.path / MANIFEST).unlink()
        files = (manifest.results if manifest else {}) | self._records()
        done: set[int] = set()
        damaged: list[str] = [MANIFEST] if finished and manifest is None else []
        for chunk in range(self.chunks.number):
            if progress:
                progress(chunk, self.chunks.number)
            bad = [
                f for f in self._chunk_files(chunk) if not as_written(self.path, f, files.get(f))
            ]
            damaged += [file for file in bad if file in files]
            if not bad:
                done.add(chunk)
            for file in bad:
                (self.path / file).unlink(missing_ok=True)
        damaged += self._mended_skeleton(manifest)
        rest = self.chunks.number - len(done)
        self._check_room(rest * self.job.points.grid.size // self.chunks.number)
        return Found(frozenset(done), tuple(damaged))

    def write_chunk(self, chunk: int, *, threads: int | None = None) -> int:
        """Compute a chunk, write it, and record that it is done; the number of its points."""
        begin, end = self.chunks.stretch(chunk)
        values = self.job.compute(begin, end, threads=threads)
        region = self.chunks.region(chunk)
        shape = tuple(part.stop - part.start for part in region)
        digests: Digests = {}
        # a chunk of nothing but NaN, all out of reach, is a file too: the manifest counts on it
        written = zarr_or_explain().config.set({"array.write_empty_chunks": True})
        with full_disk_explained(self.path), written:
            group = self._open()
            for variable in self.job.variables:
                array = group[variable.name]
                leading = (len(self.job.loads),) if variable.per_load else ()
                trailing = (len(variable.extra[1]),) if variable.extra else ()
                block = values[variable.name].reshape(*leading, *shape, *trailing)
                where = (*(slice(None) for _ in leading), *region, *(slice(None) for _ in trailing))
                array[where] = block
                file = self._file(variable, chunk)
                digests[file] = sha256_of(self.path / file)
            record = {"points": end - begin, "files": digests}
            write_atomically(self.path / PROGRESS / f"{chunk}.json", json.dumps(record))
        return end - begin

    def finish(self) -> None:
        """Turn the records of all chunks into the manifest: from then on the map is finished."""
        manifest = read_manifest(self.path)
        files = (manifest.results if manifest else {}) | self._records()
        wanted = {f: c for c in range(self.chunks.number) for f in self._chunk_files(c)}
        missing = sorted({c for f, c in wanted.items() if f not in files})
        if missing:
            raise Refusal(
                f"{len(missing)} of {self.chunks.number} chunks are not there, the first is "
                f"chunk {missing[0]}",
                where=str(self.path),
                remedy="If a cluster wrote them: its workers must see the same folder as you. "
                "Run the same command again.",
            )
        with full_disk_explained(self.path):
            with self._new_skeleton() as (_, names):
                describing = {file: sha256_of(self.path / file) for file in names}
            results = {file: files[file] for file in wanted}
            write_manifest(self.path, VERSION, Manifest(describing, results))
        shutil.rmtree(self.path / PROGRESS, ignore_errors=True)

    @property
    def complete(self) -> bool:
        """Was the map finished?"""
        return read_manifest(self.path) is not None and not (self.path / PROGRESS).exists()

    def _chunk_files(self, chunk: int) -> list[str]:
        return [self._file(variable, chunk) for variable in self.job.variables]

    def _file(self, variable: Variable, chunk: int) -> str:
        """The file of one variable that holds a chunk, relative to the store."""
        where = np.unravel_index(chunk, self.chunks.counts)
        index = [str(int(i)) for i in where]
        leading = ["0"] if variable.per_load else []
        trailing = ["0"] if variable.extra else []
        return "/".join([variable.name, "c", *leading, *index, *trailing])

    def _records(self) -> Digests:
        """Digests of the chunks that a run finished; half-written records are void."""
        found: Digests = {}
        for path in (self.path / PROGRESS).glob("*.json"):
            try:
                files = json.loads(path.read_text(encoding="utf-8"))["files"]
                known = set(files) == set(self._chunk_files(int(path.stem)))
                if known and all((self.path / file).is_file() for file in files):
                    found |= files
            except (ValueError, KeyError, TypeError):
                continue
        return found

    def _create(self) -> None:
        with self._new_skeleton() as (folder, _):
            (folder / PROGRESS).mkdir()
            folder.chmod((folder / PROGRESS).stat().st_mode)  # mkdtemp made it for us alone
            folder.rename(self.path)

    def _mended_skeleton(self, manifest: Manifest | None) -> list[str]:
        """Put back what holds no results and is not as it was written; names of these files."""
        with self._new_skeleton() as (folder, names):
            fresh = {file: sha256_of(folder / file) for file in names}
            told = manifest.describing if manifest else fresh
            bad = [file for file in names if not as_written(self.path, file, told.get(file))]
            for file in bad:
                target = self.path / file
                if target.is_dir():
                    shutil.rmtree(target)
                target.parent.mkdir(parents=True, exist_ok=True)
                (folder / file).replace(target)
        return bad

    @contextmanager
    def _new_skeleton(self) -> Iterator[tuple[Path, tuple[str, ...]]]:
        """A map without results in a folder of its own beside the map, and its files."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        folder = Path(tempfile.mkdtemp(dir=self.path.parent, prefix=self._leftover))
        try:
            yield folder, write_skeleton(folder, self.job, self.chunks)
        finally:
            shutil.rmtree(folder, ignore_errors=True)

    @property
    def _leftover(self) -> str:
        return f".{self.path.name}.new-"

    def _remove_leftovers(self) -> None:
        """What a killed run left half-made; nobody else writes while the lock is held."""
        for folder in self.path.parent.glob("*"):
            if folder.name.startswith(self._leftover):
                shutil.rmtree(folder, ignore_errors=True)
        if stored_identities(self.path):
            for path in self.path.rglob("*.partial"):
                path.unlink(missing_ok=True)

    def _is_there(self) -> bool:
        """Is something in the place? An empty folder is nothing."""
        return self.path.exists() and not (self.path.is_dir() and not any(self.path.iterdir()))

    def _check_identity(self) -> None:
        there = stored_identities(self.path)
        if not there:
            raise InputError(
                "there is something here that is no map",
                where=str(self.path),
                remedy="Choose another name.",
            )
        if identity_of(self.job, self.chunks) not in there:
            raise InputError(
                "another map is here: another robot, model, grid or load",
                where=str(self.path),
                remedy="Choose another name, or --overwrite it.",
            )

    def _check_room(self, points: int) -> None:
        needed = points * self.job.bytes_per_point
        folder = self.path.absolute().parent
        while not folder.exists():
            folder = folder.parent
        free = shutil.disk_usage(folder).free
        if needed > free:
            raise InputError(
                f"a grid of {self.job.points.grid.size:,} points under {len(self.job.loads)} "
                f"load(s) may need {needed / 1e9:.3g} GB, and {free / 1e9:.3g} GB are free",
                where=str(self.path),
                remedy="Take larger steps, fewer loads, or another disk.",
            )

    def _open(self) -> Any:
        return zarr_or_explain().open_group(self.path, mode="r+", use_consolidated=False)

    def _remove(self) -> None:
        if not stored_identities(self.path):
            raise InputError(
                "this is no map of this program, and is not overwritten",
                where=str(self.path),
                remedy="Choose another name.",
            )
        shutil.rmtree(self.path)


@contextmanager
def full_disk_explained(path: Path) -> Iterator[None]:
    """A full disk becomes a message that says how to go on."""
    try:
        yield
    except OSError as error:
        if error.errno not in (errno.ENOSPC, errno.EDQUOT):
            raise
        raise Refusal(
            "the disk is full",
            where=str(path),
            remedy="What is finished is kept: make room and run the same command again.",
        ) from error
