"""Where the public robots of the package example-robot-data lie."""

from importlib import metadata
from pathlib import Path


def example_urdfs() -> list[Path]:
    """All URDFs of example-robot-data; its absence is an error, not a reason to skip."""
    files = metadata.distribution("example-robot-data").files or []
    return sorted(Path(str(file.locate())).resolve() for file in files if file.suffix == ".urdf")


def example(name: str) -> Path:
    (path,) = [path for path in example_urdfs() if path.name == name]
    return path
