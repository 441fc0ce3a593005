"""Mutated input files: cells, keys, lines and bytes of CSV, YAML and URDF that go wrong.

Every mutation is made by a seed, so that what failed can be made again.
"""

from __future__ import annotations

import random
import re
from collections.abc import Callable

NUMBERS = (
    "1e308", "-1e308", "1e-308", "5e-324", "1e400", "-0", "nan", "inf", "-Infinity", "0", "1e15",
    "-1e9", "1e-30", "9" * 400, "0x10", "1_0", "1,5", "1.2.3", "--3", "+", "1e", "٣", "½", "1 mm",
)  # fmt: skip
TEXTS = (
    "", " ", "=1+1", "@SUM(A1)", "-2+3", "\x1b[31mred", "\x07", "\u202eevil", "a" * 5000, '"', "'",
    "#", ";", "\t", "😀", "<script>", "../../etc/passwd", "None", "null", "True", "%s%n", "\x00",
)  # fmt: skip
YAML_VALUES = (
    "!!float x", "!!int x", "!!bool x", "!!timestamp x", "!!binary x", "!!set {a}", "!!omap [a: 1]",
    "!!python/object/apply:os.getcwd []", "!!python/name:os.system", "2001-99-99", "2020-13-45",
    "2001-02-30 25:61:61", "0000-00-00", "&a [*a]", "&a {b: *a}", "*nowhere", "[[[[[[1]]]]]]", "{}",
    "[]", "null", "~", "true", "-1", "0", "1e308", "-1e308", "1e-308", ".nan", ".inf", "-.inf",
    "1e400", "'1'", "'\\x1b[31m'", "{a: {b: {c: {d: 1}}}}", "0o9", "0b2", "190:20:30", "|", ">",
    "? x", "!!str 3", "[1, 2]", "[1, 2, 3, 4]", "[1e308, 1e308, 1e308]", "[nan, nan, nan]", "a: b",
    "@x", "`x`", "%x", "!<tag:yaml.org,2002:float> abc", "9" * 400, "1" * 5000, "../..",
    "/dev/zero", "/", ".", "''", "!!merge x",
    "<<", "=", "[{}]", "{1: 2}", "{[1]: 2}", "{? {a: 1} : 2}",
)  # fmt: skip
NESTED = "[" * 3000 + "]" * 3000
LAUGHS = "a: &a [x, x, x, x, x, x, x, x, x]\n" + "".join(
    f"{b}: &{b} [{', '.join([f'*{a}'] * 9)}]\n" for a, b in zip("abcdefgh", "bcdefghi", strict=True)
)

Mutation = Callable[[str, random.Random], str]


def mutated_csv(text: str, seed: int) -> bytes:
    """A table with one to three things wrong."""
    draw = random.Random(seed)
    for _ in range(draw.choice((1, 1, 1, 2, 3))):
        text = draw.choice(_TABLE)(text, draw)
    return _bytes(text, draw)


def mutated_yaml(text: str, seed: int) -> bytes:
    """A YAML file with one or two things wrong."""
    draw = random.Random(seed)
    for _ in range(draw.choice((1, 1, 2))):
        text = draw.choice(_TREE)(text, draw)
    return _bytes(text, draw)


def mutated_xml(text: str, seed: int) -> bytes:
    """A URDF with one to three things wrong."""
    draw = random.Random(seed)
    for _ in range(draw.choice((1, 1, 2, 3))):
        text = draw.choice(_MARKUP)(text, draw)
    return _bytes(text, draw)


def _bytes(text: str, draw: random.Random) -> bytes:
    data = text.encode("utf-8", "surrogateescape")
    kind = draw.random()
    if kind < 0.04:
        place = draw.randrange(len(data) + 1)
        data = data[:place] + bytes([draw.randrange(256)]) + data[place + 1 :]
    elif kind < 0.06:
        data = data[: draw.randrange(len(data) + 1)]
    elif kind < 0.07:
        data = b"\xff\xfe" + text.encode("utf-16-le", "surrogatepass")
    elif kind < 0.08:
        data = text.replace("\n", "\r").encode("utf-8", "surrogateescape")
    return data


def _found(pattern: str, text: str) -> list[re.Match[str]]:
    """Where a pattern occurs; the beginning of the text where it does not."""
    return list(re.finditer(pattern, text)) or list(re.finditer(r"\A", text))


def _cell(text: str, draw: random.Random) -> str:
    lines = text.split("\n")
    row = draw.randrange(len(lines))
    cells = lines[row].split(",")
    cells[draw.randrange(len(cells))] = draw.choice(NUMBERS + NUMBERS + TEXTS)
    lines[row] = ",".join(cells)
    return "\n".join(lines)


def _column(text: str, draw: random.Random) -> str:
    rows = [line.split(",") for line in text.split("\n")]
    k, value = draw.randrange(len(rows[0])), draw.choice(NUMBERS)
    for row in rows[1:]:
        if k < len(row):
            row[k] = value
    return "\n".join(",".join(row) for row in rows)


def _scaled(text: str, draw: random.Random) -> str:
    """A number off by a power of ten, as a slip of the decimal point makes it."""
    numbers = list(re.finditer(r"-?\d+\.\d+", text))
    if not numbers:
        return text
    found = draw.choice(numbers)
    wrong = float(found.group()) * 10.0 ** draw.choice((-6, -3, 1, 2, 3, 6, 9, 100))
    return text[: found.start()] + repr(wrong) + text[found.end() :]


def _header(text: str, draw: random.Random) -> str:
    head, _, rest = text.partition("\n")
    cells = head.split(",")
    k = draw.randrange(len(cells))
    unit = draw.choice(("rad", "mm", "um", "kN", "lbf", "", "furlong", "m/s", "N*m", "1", "deg^2"))
    cells[k] = draw.choice(
        (re.sub(r"\[.*?\]", f"[{unit}]", cells[k]), cells[k] * 2, "", "pose", draw.choice(TEXTS),
         draw.choice(cells), "use", "order", "branch", "repeat", "time[s]", "sx[um]", "x[mm]")
    )  # fmt: skip
    return ",".join(cells) + "\n" + rest


def _line(text: str, draw: random.Random) -> str:
    lines = text.split("\n")
    k = draw.randrange(len(lines))
    what = draw.randrange(5)
    if what == 0:
        del lines[k]
    elif what == 1:
        lines.insert(k, lines[draw.randrange(len(lines))])
    elif what == 2:
        draw.shuffle(lines)
    elif what == 3:
        lines = lines[: draw.randrange(1, 4)]
    else:
        lines.insert(k, draw.choice(TEXTS))
    return "\n".join(lines)


def _value(text: str, draw: random.Random) -> str:
    found = draw.choice(_found(r"(?<=: )[^\n{}\[\],]+", text))
    return text[: found.start()] + draw.choice(YAML_VALUES) + text[found.end() :]


def _branch(text: str, draw: random.Random) -> str:
    """A whole line's value, so that a list or a section becomes something else."""
    found = draw.choice(_found(r"(?m)(?<=:)[ \t]+\S.*$", text))
    return text[: found.start()] + " " + draw.choice(YAML_VALUES) + text[found.end() :]


def _key(text: str, draw: random.Random) -> str:
    found = draw.choice(_found(r"(?m)[\w.]+(?=:)", text))
    name = draw.choice(
        ("x", "''", "1", "null", "[1]", "{a: 1}", "<<", "&a", "*a", "? ", "!!float x", "robot")
    )
    return text[: found.start()] + name + text[found.end() :]


def _whole(text: str, draw: random.Random) -> str:
    return draw.choice(
        ("", "- 1\n- 2\n", "3", "null", NESTED, LAUGHS + text, f"{text}\ndeep: {NESTED}\n",
         text * 2, f"{text}\n---\n{text}", "&a [*a]", f"{text}\nme: &b {{you: *b}}\n", "\t" + text,
         "!!set {}", f"{text}\nwhen: 2001-99-99\n", "? [a]\n: b\n", f"%YAML 9.9\n---\n{text}",
         "2001-99-99")
    )  # fmt: skip


def _number(text: str, draw: random.Random) -> str:
    found = draw.choice(_found(r"-?\d+\.?\d*(?:e[+-]?\d+)?", text))
    return text[: found.start()] + draw.choice(NUMBERS) + text[found.end() :]


def _tag(text: str, draw: random.Random) -> str:
    found = draw.choice(_found(r"<[^<>]*>", text))
    new = draw.choice(("", found.group() * 2, "<", "<![CDATA[", "<!--", "</robot>", "<a/>", "&x;"))
    return text[: found.start()] + new + text[found.end() :]


def _attribute(text: str, draw: random.Random) -> str:
    found = draw.choice(_found(r'(?<=")[^"<>]*(?=")', text))
    return text[: found.start()] + draw.choice(NUMBERS + TEXTS) + text[found.end() :]


_TABLE: tuple[Mutation, ...] = (_cell, _cell, _cell, _scaled, _scaled, _column, _header, _line)
_TREE: tuple[Mutation, ...] = (
    _value,
    _value,
    _branch,
    _branch,
    _key,
    _number,
    _scaled,
    _whole,
    _line,
)
_MARKUP: tuple[Mutation, ...] = (_tag, _attribute, _attribute, _number, _line)
