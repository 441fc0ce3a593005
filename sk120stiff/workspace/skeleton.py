"""The files of a map that hold no results: groups, arrays, coordinates, loads, and its identity.

They follow from the job alone, so that damaged ones are made again without computing anything. The
manifest says what a map consists of, file by file, with the SHA-256 of each.
"""

from __future__ import annotations

import hashlib
import json
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sk120stiff.errors import InputError, require
from sk120stiff.files import write_atomically
from sk120stiff.model import ModelCompliance
from sk120stiff.workspace.field import UNKNOWN_CLASS, MapJob, Numbers, Variable
from sk120stiff.workspace.grid import Chunks

IDENTITY = "identity.json"
OURS = "sk120stiff map"
VERSION = 3  # of the layout and of what the numbers mean


def write_skeleton(folder: Path, job: MapJob, chunks: Chunks) -> tuple[str, ...]:
    """Write a map without results into an empty folder; names of the files."""
    zarr = zarr_or_explain()
    from zarr.codecs import BloscCodec

    _check_names(job)
    identity = identity_of(job, chunks)
    group = zarr.create_group(folder, attributes={**_attributes(job), "identity": identity})
    grid = job.points.grid
    names = tuple(axis.name for axis in grid.axes)
    for variable in job.variables:
        leading = (len(job.loads),) if variable.per_load else ()
        trailing = (len(variable.extra[1]),) if variable.extra else ()
        group.create_array(
            variable.name,
            shape=(*leading, *grid.shape, *trailing),
            chunks=(*leading, *chunks.chunk_shape, *trailing),
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
    _write_coordinates(group, job)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # zarr: consolidated metadata is new
        zarr.consolidate_metadata(folder)
    card = {"what": OURS, "layout": VERSION, "identity": identity}
    (folder / IDENTITY).write_text(json.dumps(card, indent=0), encoding="utf-8")
    return tuple(
        sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file())
    )


def identity_of(job: MapJob, chunks: Chunks) -> str:
    """A digest of everything that decides the numbers."""
    import pickle

    arm, points, elastic = job.arm, job.points, job.arm.elastic
    chain = elastic.mechanism.chain
    motion = elastic.mechanism.coupling.motion(points.rest)
    rest = points.rest[None]
    weight = elastic.weight_at(rest)
    parts: list[object] = [
        VERSION, arm.joints, arm.lower, arm.upper, elastic.compliance_at(rest),
        elastic.start(rest), elastic.point,
        chain.placements, chain.axes, chain.revolute, chain.coordinates,
        motion.q, motion.first,
        [(axis.name, axis.values) for axis in points.grid.axes], points.rest,
        # None: joints that were held still, which maps of an earlier program could state.
        *(getattr(points, name, None) for name in ("axis", "rotation")), None,
        *(getattr(points, name, None) for name in ("starts", "start")),
        job.loads, [variable.name for variable in job.variables],
        chunks.chunk_shape,
        elastic.model.values if isinstance(elastic, ModelCompliance) else None,
        arm.uncertainty.identity if arm.uncertainty else None,
        None if weight is None else (weight.gravity, chain.masses, chain.centres),
    ]  # fmt: skip
    digest = hashlib.sha256()
    for part in parts:
        digest.update(pickle.dumps(part, protocol=4))
    return digest.hexdigest()


def stored_identities(folder: Path) -> frozenset[str]:
    """The identity that a folder carries, as a map of ours; empty where it is none.

    It stands in two files, so that damage to one of them does not make a map a stranger: there are
    two identities then, one of them falsified.
    """
    found = set()
    for name, keys in ((IDENTITY, ("identity",)), ("zarr.json", ("attributes", "identity"))):
        try:
            told = json.loads((folder / name).read_text(encoding="utf-8"))
            for key in keys:
                told = told[key]
        except (OSError, ValueError, KeyError, TypeError):
            continue
        if isinstance(told, str) and len(told) == hashlib.sha256().digest_size * 2:
            found.add(told)
    return frozenset(found)


def zarr_or_explain() -> Any:
    """The library zarr, or a message that says how to install it."""
    require("zarr", needed_for="a map")
    import zarr

    return zarr


def _check_names(job: MapJob) -> None:
    taken = {variable.name for variable in job.variables} | {"load", "wrench", "component"}
    taken |= {variable.extra[0] for variable in job.variables if variable.extra}
    for axis in job.points.grid.axes:
        if axis.name in taken or "/" in axis.name:
            raise InputError(
                f"the joint {axis.name!r} is named as something else that a map holds",
                where="--grid",
                remedy="Give the joint another name in the URDF.",
            )


def _write_coordinates(group: Any, job: MapJob) -> None:
    slides = dict(zip(job.arm.joints, job.arm.slides, strict=True))
    for axis in job.points.grid.axes:
        unit = "m" if slides.get(axis.name, True) else "rad"
        _coordinate(group, axis.name, (axis.name,), axis.values, {"units": unit})
    _coordinate(group, "load", ("load",), np.arange(len(job.loads)), {"units": "1"})
    about = {"units": "N, N*m", "long_name": "force and moment on the arm, base axes"}
    _coordinate(group, "wrench", ("load", "component"), job.loads, about)
    components = np.array(["fx", "fy", "fz", "mx", "my", "mz"])
    _coordinate(group, "component", ("component",), components, {})
    for name, labels in sorted({v.extra for v in job.variables if v.extra}):
        _coordinate(group, name, (name,), np.array(labels), {})


def _attributes(job: MapJob) -> dict[str, Any]:
    arm = job.arm
    return {
        "title": f"Stiffness of {arm.name} over its workspace",
        "robot": arm.name,
        "joints": list(arm.joints),
        "frame": arm.frame,
        "point": arm.elastic.point.tolist(),
        "rest": job.points.rest.tolist(),
        "convention": "stiffness of the unloaded pose under a small displacement, "
        "J (K_theta - K_C)^-1 J^T inverted, base axes, SI units",
        "coordinates": "wrench",
        "layout": VERSION,
        "finished": "when manifest.json is there",
    }


def _attributes_of(variable: Variable) -> dict[str, Any]:
    about: dict[str, Any] = {"long_name": variable.meaning}
    if variable.unit:
        about["units"] = variable.unit
    if variable.labels:
        about["flag_values"] = list(range(len(variable.labels)))
        about["flag_meanings"] = " ".join(label.replace(" ", "_") for label in variable.labels)
    return about


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


MANIFEST = "manifest.json"

Digests = dict[str, str]


def sha256_of(path: Path) -> str:
    """SHA-256 of a file, in hexadecimal."""
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def as_written(folder: Path, file: str, digest: str | None) -> bool:
    """Is a file there, with the content of that digest?"""
    path = folder / file
    return digest is not None and path.is_file() and sha256_of(path) == digest


@dataclass(frozen=True)
class Manifest:
    """Digests of all files of a finished map, relative names.

    Attributes:
        describing: Files that hold no results: groups, arrays, coordinates, loads, identity.
        results: Files of the chunks.
    """

    describing: Digests
    results: Digests


def write_manifest(folder: Path, version: int, manifest: Manifest) -> None:
    """Write the digests of all files of a folder, and one of themselves."""
    told: dict[str, object] = {
        "version": version,
        "describing": dict(sorted(manifest.describing.items())),
        "results": dict(sorted(manifest.results.items())),
    }
    write_atomically(folder / MANIFEST, _text(told))


def read_manifest(folder: Path) -> Manifest | None:
    """The digests of a folder's files; None where the manifest is missing or not as written."""
    try:
        text = (folder / MANIFEST).read_text(encoding="utf-8")
        told = json.loads(text)
        del told["own_sha256"]
        manifest = Manifest(told["describing"], told["results"])
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return None
    return manifest if text == _text(told) else None


def _text(told: Mapping[str, object]) -> str:
    own = hashlib.sha256(json.dumps(told, sort_keys=True).encode()).hexdigest()
    return json.dumps({**told, "own_sha256": own}, indent=0)
