"""What a fault is, for `scripts/mutations.py`."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Fault:
    """One text that another replaces.

    Attributes
    ----------
    name
        What is wrong then.
    file
        Where, from the root.
    old, new
        The text, found exactly once (the suite holds it to that), and what replaces it.
    tests
        Files or folders of tests that own the file.
    """

    name: str
    file: str
    old: str
    new: str
    tests: tuple[str, ...]


def of(file: str, *tests: str, **faults: tuple[str, str]) -> tuple[Fault, ...]:
    """Faults of one file, by a name in which underscores stand for blanks."""
    return tuple(
        Fault(name.replace("_", " "), f"sk120stiff/{file}", old, new, tests)
        for name, (old, new) in faults.items()
    )


def tests(folder: str, *names: str) -> tuple[str, ...]:
    return tuple(f"tests/{folder}/test_{name}.py" for name in names)
