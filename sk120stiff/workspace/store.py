"""A map on disk: a Zarr group that is written chunk by chunk and knows when it is whole.

While a map is being written, a folder of small files beside the arrays says which chunks are done,
with the SHA-256 of every file they consist of; such a file is written after the data, so a killed
run loses only what it was working on. When all chunks are there, the digests go into
``manifest.json`` and the group gets the attribute ``complete``.
"""

from __future__ import annotations

import errno
import hashlib
import json
import shutil
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sk120stiff.errors import InputError, MissingPart, Refusal
from sk120stiff.files import write_atomically
from sk120stiff.workspace.field import UNKNOWN_CLASS, MapJob, Numbers, Variable
from sk120stiff.workspace.grid import Chunks

PROGRESS, MANIFEST = ".progress", "manifest.json"
VERSION = 1  # of the layout and of what the numbers mean


@dataclass(frozen=True, eq=False)
class MapStore:
    """A map's folder.

    Attributes
    ----------
    path
        The folder, by custom ``….zarr``.
    job
        What the map holds.
    chunk_points
        Points that a chunk has at most.
    """

    path: Path
    job: MapJob
    chunk_points: int

    @property
    def chunks(self) -> Chunks:
        """How the grid is cut."""
        return Chunks(self.job.points.grid.shape, self.chunk_points)

    def prepare(self, *, overwrite: bool = False) -> frozenset[int]:
        """Make the folder or take up what an earlier run left; the chunks that are done.

        Raises
        ------
        InputError
            Something else is in that place, or the disk has not enough room.
        """
        if overwrite and self.path.exists():
            self._remove()
        if not self.path.exists():
            self._check_room(self.job.points.grid.size)
            with full_disk_explained(self.path):
                self._create()
            return frozenset()
        self._check_identity()
        if self.complete:
            return frozenset(range(self.chunks.number))
        self._remove_partial_files()
        done = frozenset(self._records())
        rest = self.chunks.number - len(done)
        self._check_room(rest * self.job.points.grid.size // self.chunks.number)
        return done

    def write_chunk(self, chunk: int, *, threads: int | None = None) -> int:
        """Compute a chunk, write it, and record that it is done; the number of its points."""
        begin, end = self.chunks.stretch(chunk)
        values = self.job.compute(begin, end, threads=threads)
        region = self.chunks.region(chunk)
        shape = tuple(part.stop - part.start for part in region)
        digests: dict[str, str] = {}
        with full_disk_explained(self.path):
            group = self._open()
            for variable in self.job.variables:
                array = group[variable.name]
                leading = (len(self.job.loads),) if variable.per_load else ()
                trailing = (len(variable.extra[1]),) if variable.extra else ()
                block = values[variable.name].reshape(*leading, *shape, *trailing)
                where = (*(slice(None) for _ in leading), *region, *(slice(None) for _ in trailing))
                array[where] = block
                for file in self._files(variable, chunk):
                    digests[file] = sha256_of(self.path / file)
            record = {"points": end - begin, "files": digests}
            write_atomically(self.path / PROGRESS / f"{chunk}.json", json.dumps(record))
        return end - begin

    def finish(self) -> None:
        """Turn the records of all chunks into the manifest, and mark the group complete."""
        records = self._records()
        missing = sorted(set(range(self.chunks.number)) - set(records))
        if missing:
            raise Refusal(
                f"{len(missing)} of {self.chunks.number} chunks are not there, the first is "
                f"chunk {missing[0]}",
                where=str(self.path),
                remedy="If a cluster wrote them: its workers must see the same folder as you. "
                "Run the same command again.",
            )
        files = {file: digest for record in records.values() for file, digest in record.items()}
        with full_disk_explained(self.path):
            text = json.dumps({"version": VERSION, "sha256": files}, indent=0, sort_keys=True)
            write_atomically(self.path / MANIFEST, text)
            self._open().attrs["complete"] = True
            self._consolidate()
        shutil.rmtree(self.path / PROGRESS, ignore_errors=True)

    @property
    def complete(self) -> bool:
        """Was the map finished?"""
        return bool(self._open().attrs.get("complete")) and (self.path / MANIFEST).is_file()

    def _files(self, variable: Variable, chunk: int) -> list[str]:
        """Files of one variable that hold a chunk, relative to the store."""
        where = np.unravel_index(chunk, self.chunks.counts)
        index = [str(int(i)) for i in where]
        leading = ["0"] if variable.per_load else []
        trailing = ["0"] if variable.extra else []
        return ["/".join([variable.name, "c", *leading, *index, *trailing])]

    def _records(self) -> dict[int, dict[str, str]]:
        """The files of every chunk that an earlier run finished; half-written records are void."""
        found: dict[int, dict[str, str]] = {}
        for path in (self.path / PROGRESS).glob("*.json"):
            try:
                files = json.loads(path.read_text())["files"]
                number = int(path.stem)
            except (ValueError, KeyError):
                continue
            if all((self.path / file).is_file() for file in files):
                found[number] = files
        return found

    def _create(self) -> None:
        zarr = zarr_or_explain()
        from zarr.codecs import BloscCodec

        job = self.job
        temporary = self.path.with_name(f".{self.path.name}.new")
        shutil.rmtree(temporary, ignore_errors=True)
        temporary.mkdir(parents=True)
        group = zarr.create_group(temporary, attributes=self._attributes())
        grid = job.points.grid
        names = tuple(axis.name for axis in grid.axes)
        for variable in job.variables:
            leading = (len(job.loads),) if variable.per_load else ()
            trailing = (len(variable.extra[1]),) if variable.extra else ()
            group.create_array(
                variable.name,
                shape=(*leading, *grid.shape, *trailing),
                chunks=(*leading, *self.chunks.chunk_shape, *trailing),
                dtype=variable.kind,
                compressors=BloscCodec(cname="lz4", clevel=3, shuffle="shuffle"),
                fill_value=UNKNOWN_CLASS if variable.kind == "u1" else np.nan,
                dimension_names=(
                    *(["load"] if variable.per_load else []),
                    *names,
                    *([variable.extra[0]] if variable.extra else []),
                ),
                attributes=_attributes_of(variable),
                config={"write_empty_chunks": True},
            )
        self._create_coordinates(group)
        (temporary / PROGRESS).mkdir()
        temporary.rename(self.path)

    def _create_coordinates(self, group: Any) -> None:
        job = self.job
        slides = dict(zip(job.arm.joints, job.arm.slides, strict=True))
        for axis in job.points.grid.axes:
            unit = "m" if slides.get(axis.name, True) else "rad"
            _coordinate(group, axis.name, (axis.name,), axis.values, {"units": unit})
        _coordinate(group, "load", ("load",), np.arange(len(job.loads)), {"units": "1"})
        about = {"units": "N, N*m", "long_name": "force and moment on the arm, base axes"}
        _coordinate(group, "wrench", ("load", "component"), job.loads, about)
        components = np.array(["fx", "fy", "fz", "mx", "my", "mz"])
        _coordinate(group, "component", ("component",), components, {})
        for name, labels in {v.extra for v in job.variables if v.extra}:
            _coordinate(group, name, (name,), np.array(labels), {})

    def _attributes(self) -> dict[str, Any]:
        arm = self.job.arm
        return {
            "title": f"Stiffness of {arm.name} over its workspace",
            "robot": arm.name,
            "joints": list(arm.joints),
            "frame": arm.frame,
            "point": arm.point.tolist(),
            "rest": self.job.points.rest.tolist(),
            "convention": "stiffness of the unloaded pose under a small displacement, "
            "J (K_theta - K_C)^-1 J^T inverted, base axes, SI units",
            "coordinates": "wrench",
            "layout": VERSION,
            "identity": self._identity(),
            "complete": False,
        }

    def _identity(self) -> str:
        """A digest of everything that decides the numbers."""
        import pickle

        arm, points = self.job.arm, self.job.points
        chain = arm.mechanism.chain
        motion = arm.mechanism.coupling.motion(points.rest)
        parts: list[object] = [
            VERSION, arm.joints, arm.lower, arm.upper, arm.springs, arm.shift, arm.point,
            chain.placements, chain.axes, chain.revolute, chain.coordinates,
            motion.q, motion.first,
            [(axis.name, axis.values) for axis in points.grid.axes], points.rest,
            *(getattr(points, name, None) for name in ("axis", "rotation", "movable", "starts")),
            self.job.loads, [variable.name for variable in self.job.variables],
            self.chunks.chunk_shape,
            arm.slow.values if arm.slow else None,
            (arm.weight.gravity, arm.weight.compliance, chain.masses, chain.centres)
            if arm.weight
            else None,
        ]  # fmt: skip
        digest = hashlib.sha256()
        for part in parts:
            digest.update(pickle.dumps(part, protocol=4))
        return digest.hexdigest()

    def _check_identity(self) -> None:
        try:
            attributes = dict(self._open().attrs)
        except (FileNotFoundError, FileExistsError, ValueError, KeyError) as error:
            raise InputError(
                "there is something here that is no map",
                where=str(self.path),
                remedy="Choose another name, or --overwrite it.",
            ) from error
        if attributes.get("identity") != self._identity():
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

    def _consolidate(self) -> None:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # zarr: not everything here is an array, and it is new
            zarr_or_explain().consolidate_metadata(self.path)

    def _remove(self) -> None:
        if not (self.path / "zarr.json").is_file():
            raise InputError(
                "this is no map, and is not overwritten",
                where=str(self.path),
                remedy="Choose another name.",
            )
        shutil.rmtree(self.path)

    def _remove_partial_files(self) -> None:
        for path in self.path.rglob("*.partial"):
            path.unlink(missing_ok=True)


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


def _coordinate(
    group: Any, name: str, dims: tuple[str, ...], values: Numbers, about: dict[str, str]
) -> None:
    if values.dtype.kind == "U":
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # zarr: fixed-length strings are not in the standard
            array = group.create_array(
                name, shape=values.shape, dtype=str, dimension_names=dims, attributes=about
            )
            array[:] = values.astype(object)
        return
    array = group.create_array(
        name, shape=values.shape, dtype=values.dtype, dimension_names=dims, attributes=about
    )
    array[:] = values


def _attributes_of(variable: Variable) -> dict[str, Any]:
    about: dict[str, Any] = {"long_name": variable.meaning}
    if variable.unit:
        about["units"] = variable.unit
    if variable.labels:
        about["flag_values"] = list(range(len(variable.labels)))
        about["flag_meanings"] = " ".join(label.replace(" ", "_") for label in variable.labels)
    return about


def sha256_of(path: Path) -> str:
    """SHA-256 of a file, in hexadecimal."""
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def zarr_or_explain() -> Any:
    """The library zarr, or a message that says how to install it."""
    try:
        import zarr
    except ImportError as error:
        raise MissingPart("zarr", None, needed_for="a map") from error
    return zarr
