"""What a map consists of, file by file, with the SHA-256 of each."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from sk120stiff.files import write_atomically

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
