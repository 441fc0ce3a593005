"""Expanding xacro, in a process of its own so that no file can hang or crash the caller."""

from __future__ import annotations

import importlib.util
import json
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

from sk120stiff.errors import MissingPart
from sk120stiff.files import note_read
from sk120stiff.robot.urdf.findings import Notebook
from sk120stiff.robot.urdf.source import MAX_BYTES, RawSource
from sk120stiff.robot.urdf.xml_text import without_comments

TIME_LIMIT = 60.0  # s
_ELEMENT = re.compile(r"<xacro:\w")
_SUBSTITUTION = re.compile(r"\$\((?:optenv|env|arg|find|eval|dirname) |\$\{[^}]{1,200}\}")


def uses_xacro(text: str) -> bool:
    """Are there xacro elements, outside comments?"""
    return bool(_ELEMENT.search(text)) and bool(_ELEMENT.search(without_comments(text)))


def has_substitutions(text: str) -> bool:
    """Does an attribute hold an expression that only xacro can evaluate?"""
    return bool(_SUBSTITUTION.search(without_comments(text)))


def expand(
    raw: RawSource,
    text: str,
    folders: Sequence[Path],
    arguments: Mapping[str, str],
    notes: Notebook,
) -> str:
    """Plain URDF text of a xacro source.

    Raises
    ------
    MissingPart
        xacrodoc is not installed.
    InputError
        The expansion fails, takes longer than `TIME_LIMIT` or grows beyond `MAX_BYTES`; the message
        carries what xacro said.
    """
    if importlib.util.find_spec("xacrodoc") is None:
        raise MissingPart("xacrodoc", "xacro", needed_for=f"reading the xacro in {raw.label}")
    if "<!ENTITY" in text:
        notes.refuse(
            "the file defines entities; they are never expanded",
            where=f"line {text.count(chr(10), 0, text.index('<!ENTITY')) + 1}",
            remedy="Write the values where they are used.",
        )
    with tempfile.TemporaryDirectory() as scratch:
        result, opened = Path(scratch) / "robot.urdf", Path(scratch) / "opened.json"
        job = {
            "path": str(raw.path.absolute()) if raw.path is not None else None,
            "text": None if raw.path is not None else text,
            "folders": [str(folder) for folder in folders],
            "arguments": dict(arguments),
            "result": str(result),
            "opened": str(opened),
            "max_bytes": MAX_BYTES,
        }
        said = _run(job, notes)
        if not result.is_file():
            notes.refuse(
                f"xacro cannot expand this file: {said or 'it gave no reason'}",
                remedy="Mend the place that xacro names; give folders of missing packages "
                "through ROS_PACKAGE_PATH.",
            )
        expanded = result.read_text(encoding="utf-8", errors="replace")
        for file in json.loads(opened.read_text(encoding="utf-8")):
            note_read(file)
    for line in said.split("; "):
        if line.startswith("package "):
            notes.warn("package_guessed", "", line)
    notes.warn("xacro_expanded", "", "lines below are those of the expanded text")
    return expanded


def _run(job: Mapping[str, object], notes: Notebook) -> str:
    """Run the child; what it complained about, in one line."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    try:
        done = subprocess.run(
            [sys.executable, "-P", "-m", "sk120stiff.robot.urdf.xacro_child"],
            input=json.dumps(job).encode(),
            capture_output=True,
            timeout=TIME_LIMIT,
            env=environment,
            check=False,
        )
    except subprocess.TimeoutExpired:
        notes.refuse(
            f"xacro did not finish within {TIME_LIMIT:g} s",
            remedy="Look for a macro that calls itself.",
        )
    lines = done.stderr.decode("utf-8", "replace").strip().splitlines()
    return "; ".join(dict.fromkeys(line.strip() for line in lines[-8:]))[:800]
