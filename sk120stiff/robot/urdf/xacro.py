"""Expanding xacro, in a process of its own so that no file can hang, fill or crash the caller."""

from __future__ import annotations

import json
import os
import re
import shlex
import signal
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from sk120stiff.errors import require
from sk120stiff.files import note_read
from sk120stiff.robot.urdf.findings import Notebook, did_you_mean, listed, shown
from sk120stiff.robot.urdf.source import MAX_BYTES, RawSource
from sk120stiff.robot.urdf.xml_tree import without_comments

TIME_LIMIT = 20.0  # s
MEMORY_LIMIT = 2 * 1024**3  # bytes of address space

_ELEMENT = re.compile(r"<xacro:\w")
_SUBSTITUTION = re.compile(r"\$\((?:optenv|env|arg|find|eval|dirname) |\$\{[^}]{1,200}\}")
_OUTERMOST = re.compile(r"<(?![?!])([\w:.-]{1,100})")
_ENVIRONMENT = re.compile(r"\$\((optenv|env) +(\w{1,100}) *([^)]{0,1000})\)")
_ARGUMENT = re.compile(r"<xacro:arg\b[^>]{0,500}>")
_ATTRIBUTE = re.compile(r"""\b(name|default)\s*=\s*(?:"([^"]*)"|'([^']*)')""")
_MACRO = re.compile(r"""<xacro:macro\b[^>]{0,500}?\bname\s*=\s*["']([\w.:-]{1,200})["']""")
_MOST_NEIGHBOURS = 300
_LARGEST_NEIGHBOUR = 1_000_000  # bytes


def is_xacro(raw: RawSource, text: str) -> bool:
    """Is this a xacro by its content? Only then, and only from a file, does xacro ever run.

    Its outermost element is `<robot>`, and there are xacro elements, or, in a file that calls
    itself xacro, expressions.
    """
    if raw.path is None:
        return False
    plain = without_comments(text)
    outermost = _OUTERMOST.search(plain)
    if outermost is None or outermost.group(1) != "robot":
        return False
    named = raw.path.suffix.lower() == ".xacro"
    return bool(_ELEMENT.search(plain) or (named and _SUBSTITUTION.search(plain)))


def refuse_text(text: str, notes: Notebook) -> None:
    """Refuse xacro that was given as text: only a file is expanded, and knows its neighbours.

    Raises:
        InputError: There are xacro elements.
    """
    if _ELEMENT.search(without_comments(text)):
        notes.refuse(
            "xacro is expanded from a file only, and this is text",
            remedy="Save it as a .xacro file and give its path.",
        )


def with_environment(text: str) -> str:
    """The text with `$(optenv NAME default)` and set `$(env NAME)` replaced by their values."""

    def value(match: re.Match[str]) -> str:
        kind, name, default = match.groups()
        return os.environ.get(name, default if kind == "optenv" else match.group())

    return _ENVIRONMENT.sub(value, text)


def expand(
    raw: RawSource,
    text: str,
    folders: Sequence[Path],
    arguments: Mapping[str, str],
    notes: Notebook,
) -> str:
    """Plain URDF text of a xacro file.

    Raises:
        MissingPart: xacro is not installed.
        InputError: An argument has no value or does not exist, the expansion fails, takes longer
            than `TIME_LIMIT`, or grows beyond `MEMORY_LIMIT` or `MAX_BYTES`; the message carries
            what xacro said.
    """
    require("xacro", needed_for=f"reading the xacro in {raw.label}")
    if "<!ENTITY" in text:
        notes.refuse(
            "the file defines entities; they are never expanded",
            where=f"line {text.count(chr(10), 0, text.index('<!ENTITY')) + 1}",
            remedy="Write the values where they are used.",
        )
    with tempfile.TemporaryDirectory() as scratch:
        files = {key: str(Path(scratch) / key) for key in ("result", "report", "said")}
        job: dict[str, Any] = {
            "path": str(Path(raw.path or "").absolute()),
            "folders": [str(folder) for folder in folders],
            "arguments": dict(arguments),
            "max_bytes": MAX_BYTES,
            "memory": MEMORY_LIMIT,
            **files,
        }
        _run(job, notes)
        result, report = Path(files["result"]), Path(files["report"])
        told = json.loads(report.read_text(encoding="utf-8")) if report.is_file() else {}
        for file in dict.fromkeys(told.get("opened", ())):
            note_read(file)
        if told.get("missing"):
            _refuse_missing(raw, text, told["missing"], arguments, notes)
        if told.get("error") or not result.is_file():
            said = told.get("error") or _last_lines(Path(files["said"])) or "it gave no reason"
            if told.get("guessed"):
                said = f"package {told['guessed'][0]!r} was not found, and {said}"
            notes.refuse(
                f"xacro cannot expand this file: {said[:800]}",
                remedy="Mend the place that xacro names; give folders of missing packages "
                f"through ROS_PACKAGE_PATH.{_takes(declared_arguments(text))}",
            )
        expanded = result.read_text(encoding="utf-8", errors="replace")
    _refuse_unknown(told["arguments"], arguments, notes)
    for name in dict.fromkeys(told["guessed"]):
        folder = Path(job["path"]).parent.parent
        notes.warn("package_guessed", "", f"package {name!r} was not found; {folder} was taken")
    notes.warn("xacro_expanded", "", "lines below are those of the expanded text")
    return expanded


def _run(job: Mapping[str, Any], notes: Notebook) -> None:
    """Run the child, and leave nothing of it behind, however this ends."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    command = [sys.executable, "-P", str(Path(__file__).with_name("xacro_child.py"))]
    with Path(job["said"]).open("wb") as said:
        child = subprocess.Popen(
            command,
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=said,
            env=environment,
            start_new_session=True,  # Ctrl-C reaches us alone, and we end its whole group
        )
        try:
            child.communicate(json.dumps(job).encode(), timeout=TIME_LIMIT)
        except subprocess.TimeoutExpired:
            notes.refuse(
                f"xacro did not finish within {TIME_LIMIT:g} s",
                remedy="Look for a macro that calls itself.",
            )
        finally:
            if child.poll() is None:
                with suppress(ProcessLookupError):
                    if hasattr(os, "killpg"):
                        os.killpg(child.pid, signal.SIGKILL)
                    else:
                        child.kill()
                child.wait()


def _last_lines(file: Path) -> str:
    lines = file.read_text(encoding="utf-8", errors="replace").strip().splitlines()
    return "; ".join(dict.fromkeys(line.strip() for line in lines[-8:]))


def declared_arguments(text: str) -> dict[str, str | None]:
    """Arguments that a xacro file itself declares, and their defaults; None where there is none."""
    found: dict[str, str | None] = {}
    for element in _ARGUMENT.findall(without_comments(text)):
        said = {key: double or single for key, double, single in _ATTRIBUTE.findall(element)}
        if said.get("name"):
            found.setdefault(said["name"], said.get("default"))
    return found


def _refuse_missing(
    raw: RawSource, text: str, missing: str, given: Mapping[str, str], notes: Notebook
) -> None:
    declared = declared_arguments(text)
    absent = [name for name, default in declared.items() if default is None and name not in given]
    needed = list(dict.fromkeys([missing, *absent]))
    values = {name: declared.get(name) or "VALUE" for name in needed}
    words = ["sk120stiff", "check", str(raw.path)]
    for name, value in values.items():
        words += ["--xacro-arg", f"{name}:={value}"]
    keys = ", ".join(f"{name}: {value}" for name, value in values.items())
    notes.refuse(
        f"this xacro has no value for its argument {', '.join(map(shown, needed))}",
        remedy=f"Write: {shlex.join(words)} (or xacro: {{{keys}}} in "
        f"robot.yaml).{_takes(declared, needed)}",
    )


def _takes(declared: Mapping[str, str | None], without: Sequence[str] = ()) -> str:
    """A sentence on the arguments that a xacro takes, or nothing."""
    others = [
        f"{name} ({default})" if default else name
        for name, default in declared.items()
        if name not in without
    ]
    return f" Arguments it takes, with defaults: {', '.join(others[:12])}." if others else ""


def _refuse_unknown(known: Sequence[str], given: Mapping[str, str], notes: Notebook) -> None:
    for name in given:
        if name not in known:
            hint = did_you_mean(name, known)
            takes = f"It takes: {', '.join(known)}." if known else "It takes none."
            notes.refuse(f"this xacro has no argument {shown(name)}", remedy=hint + takes)


def refuse_empty(raw: RawSource, text: str, notes: Notebook) -> None:
    """Refuse a xacro without links, and name the files beside it that make a robot of it.

    Raises:
        InputError: Always.
    """
    path = raw.path or Path()
    macros = _MACRO.findall(without_comments(text))
    holds = f"only defines the macro {listed(macros, 4)}" if macros else "holds no link"
    callers = ", ".join(str(file) for file in _callers(path.absolute(), macros)[:4])
    notes.source = raw.label
    notes.refuse(
        f"this file {holds} and describes no robot itself",
        remedy=f"Give a file that uses it: {callers}."
        if callers
        else "Give the file that includes it, or write one that includes it and calls the macro.",
    )


def _callers(path: Path, macros: Sequence[str]) -> list[Path]:
    """Files in this folder and the ones beside it that include this one or call its macros.

    Those that define no macros of their own come first: they are robots.
    """
    names = "|".join(map(re.escape, macros))
    calls = re.compile(
        rf"<xacro:include\b[^>]{{0,500}}[/\"']{re.escape(path.name)}[\"']"
        + (rf"|<xacro:(?:{names})[\s/>]" if macros else "")
    )
    above = path.parent.parent
    folders = [path.parent, above]
    with suppress(OSError):
        folders += sorted(folder for folder in above.iterdir() if folder.is_dir())
    found: dict[Path, bool] = {}
    looked = 0
    for folder in dict.fromkeys(folders):
        with suppress(OSError):
            for file in sorted(folder.iterdir()):
                if file.suffix.lower() not in (".xacro", ".urdf") or file == path:
                    continue
                looked += 1
                if looked > _MOST_NEIGHBOURS or file.stat().st_size > _LARGEST_NEIGHBOUR:
                    continue
                said = without_comments(file.read_text(encoding="utf-8", errors="replace"))
                if calls.search(said):
                    found[file] = bool(_MACRO.search(said))
    return sorted(found, key=lambda file: found[file])
