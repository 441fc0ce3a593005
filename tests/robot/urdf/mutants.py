"""Mutated URDFs, and the process that feeds them to the product.

Run as ``python -m tests.robot.urdf.mutants FIRST COUNT``; prints one JSON line with what happened.
A crash of the interpreter ends the process; the seed at work stands on stderr before it is tried.
"""

import faulthandler
import json
import re
import sys
import warnings
from collections import Counter
from pathlib import Path

import numpy as np

from sk120stiff.errors import InputError, ToolkitWarning
from sk120stiff.robot import load_robot
from sk120stiff.robot.checks import check_robot
from sk120stiff.robot.urdf import read_urdf
from sk120stiff.robot.visuals import visuals
from tests.robot.urdf.trees import random_tree

HANG = 30  # s for one mutant

_BAD = Path(__file__).resolve().parent.parent / "bad" / "repaired"
_NUMBERS = [
    "nan", "inf", "-inf", "1e400", "-1e400", "1e-320", "1e308", "-0", "0", "1,5", "1.2.3", "0x1A",
    "1e", "1_0", "١", "−1", "+", ".", "1e-5000", "abc", "${x}", "9e99", "", " ", "1 2", "1 2 3 4",
]  # fmt: skip
_NAMES = ["", " ", "universe", "root_joint", "world", "a b", "é", "&lt;", "&amp;", "l0", "j0", "j1"]
_NAMES += ["x" * 5000, "../..", "%s%n", "-", "0", "\u202e", "l1 ", "NaN", "tool0", "gripper"]
_TYPES = ["revolute", "continuous", "prismatic", "fixed", "floating", "planar", "spherical", "?"]
_PIECES = [
    "<", ">", "/", '"', "&", "]]>", "<!--", "-->", "\0", "\x0c", "\ud7ff", "<?xml?>", "</robot>",
    "<robot>", "<link/>", "<joint/>", "<link name='l0'/>", '<mimic joint="j0"/>', "<origin/>",
    '<axis xyz="0 0 0"/>', "<limit/>", "<inertial/>", "<visual/>", "<!DOCTYPE robot>", "<![CDATA[",
    '<!DOCTYPE r [<!ENTITY a "b">]>',
    '<visual><geometry><mesh filename="/dev/zero"/></geometry></visual>',
    '<visual><geometry><mesh filename="package://../../x.stl"/></geometry></visual>',
    '<visual><geometry><box size="1 1 1"/></geometry></visual>',
]  # fmt: skip
_ATTRIBUTE = re.compile(r'(\w+)="([^"]*)"')
_ELEMENT = re.compile(r"<(link|joint|mimic|inertial|origin|axis|limit|mass|parent|child)\b[^>]*>")


def mutant(seed: int) -> str:
    """A valid URDF with a few things changed."""
    rng = np.random.default_rng(seed)
    if rng.random() < 0.3:
        files = sorted(_BAD.glob("[a-m]*.urdf"))
        text = files[rng.integers(len(files))].read_bytes().decode("utf-8", "replace")
    else:
        text = random_tree(int(rng.integers(2**31)))
    for _ in range(int(rng.geometric(0.6))):
        text = _OPERATORS[rng.integers(len(_OPERATORS))](text, rng)
    return text


def _attribute(text: str, rng: np.random.Generator) -> str:
    """Give one attribute another value."""
    found = list(_ATTRIBUTE.finditer(text))
    if not found:
        return text
    match = found[rng.integers(len(found))]
    key, value = match.groups()
    if key in ("xyz", "rpy", "size", "rgba"):
        words = value.split() or [""]
        words[rng.integers(len(words))] = str(rng.choice(_NUMBERS))
        value = " ".join(words)
    elif key == "type":
        value = str(rng.choice(_TYPES))
    elif key in ("name", "link", "joint"):
        others = [m.group(2) for m in found if m.group(1) in ("name", "link", "joint")]
        value = str(rng.choice(others if rng.random() < 0.7 else _NAMES))
    else:
        value = str(rng.choice(_NUMBERS))
    return text[: match.start()] + f'{key}="{value}"' + text[match.end() :]


def _drop(text: str, rng: np.random.Generator) -> str:
    """Remove one tag."""
    found = list(_ELEMENT.finditer(text))
    if not found:
        return text
    match = found[rng.integers(len(found))]
    return text[: match.start()] + text[match.end() :]


def _line_twice(text: str, rng: np.random.Generator) -> str:
    lines = text.split("\n")
    lines.insert(int(rng.integers(len(lines))), lines[rng.integers(len(lines))])
    return "\n".join(lines)


def _line_gone(text: str, rng: np.random.Generator) -> str:
    lines = text.split("\n")
    del lines[rng.integers(len(lines))]
    return "\n".join(lines)


def _insert(text: str, rng: np.random.Generator) -> str:
    at = int(rng.integers(len(text) + 1))
    if rng.random() < 0.6:  # where an element may stand
        places = [m.end() for m in re.finditer(">", text)] or [0]
        at = places[rng.integers(len(places))]
    return text[:at] + _PIECES[rng.integers(len(_PIECES))] + text[at:]


def _cut(text: str, rng: np.random.Generator) -> str:
    at = int(rng.integers(len(text) + 1))
    return text[:at] + text[at + int(rng.integers(1, 40)) :]


def _truncate(text: str, rng: np.random.Generator) -> str:
    return text[: int(rng.integers(len(text) + 1))] if rng.random() < 0.2 else text


def _noise(text: str, rng: np.random.Generator) -> str:
    if not text:
        return text
    at = int(rng.integers(len(text)))
    return text[:at] + chr(int(rng.integers(1, 0xD7FF))) + text[at + 1 :]


_OPERATORS = [
    *[_attribute] * 8, _drop, _drop, _line_twice, _line_gone, _insert, _cut, _truncate, _noise,
]  # fmt: skip


def outcome(text: str) -> str:
    """What the product makes of a text: accepted, refused, or words about a defect."""
    try:
        report = check_robot(text)
        document = read_urdf(text)
        visuals(document)
        if report.actuated:
            robot = load_robot(text)
            with np.errstate(all="ignore"):
                robot.jacobian(np.full(robot.n, 0.3))
                robot.gravity_torque(np.full(robot.n, 0.3))
    except InputError as error:
        if not error.where or not error.remedy or "Traceback" in str(error):
            return f"no place or remedy: {error}"
        return "refused"
    return "accepted"


def main(first: int, count: int) -> None:
    warnings.simplefilter("ignore", ToolkitWarning)
    counts: Counter[str] = Counter()
    defects: dict[int, str] = {}
    for seed in range(first, first + count):
        sys.stderr.write(f"\r{seed}")
        sys.stderr.flush()
        faulthandler.dump_traceback_later(HANG, exit=True)
        try:
            result = outcome(mutant(seed))
        except Exception as error:  # noqa: BLE001 - any other exception is the defect looked for
            result = f"{type(error).__name__}: {error}"
        faulthandler.cancel_dump_traceback_later()
        counts[result if result in ("accepted", "refused") else "defect"] += 1
        if result not in ("accepted", "refused"):
            defects[seed] = result
    print(json.dumps({"counts": counts, "defects": defects}))


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]))
