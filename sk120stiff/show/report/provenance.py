"""What someone needs to make the same report again."""

from __future__ import annotations

import hashlib
import os
import platform
import sys
from collections.abc import Iterable
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from sk120stiff.errors import InputError
from sk120stiff.files import read_bytes

_LIBRARIES = ("sk120stiff", "numpy", "scipy", "pin", "matplotlib", "meshcat")


def reproducibility(
    command: str, files: Iterable[str | os.PathLike[str]] = (), *, seed: int | None = None
) -> dict[str, str]:
    """Command, versions and SHA-256 of the input files, in the order to show them.

    Args:
        command: The command line, or the Python call, that made the result.
        files: Input files; a missing one is named as missing.
        seed: Seed of random numbers, if any were drawn.
    """
    facts = {"Command": command}
    if seed is not None:
        facts["Seed"] = str(seed)
    for file in files:
        facts[f"SHA-256 of {Path(file).name}"] = _digest(Path(file))
    found = [f"{name} {_version(name)}" for name in _LIBRARIES]
    facts["Versions"] = ", ".join([*found, f"Python {platform.python_version()}"])
    facts["System"] = f"{platform.system()} {platform.machine()} ({sys.implementation.name})"
    return facts


def _digest(path: Path) -> str:
    try:
        return hashlib.sha256(read_bytes(path)).hexdigest()
    except InputError:
        return "missing"


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "(not installed)"
