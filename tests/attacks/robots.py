"""Robots and labels from strangers: mutated URDFs, entity bombs, scripts and formulas in names."""

from __future__ import annotations

import re
import time
import warnings
from collections.abc import Iterator
from pathlib import Path

from sk120stiff.errors import ToolkitWarning
from tests.attacks.inputs import desk
from tests.attacks.judge import Verdict, heard
from tests.robot.urdf.mutants import mutant, outcome

SCRIPT = "</script><script>alert(1)</script><img src=x onerror=alert(1)>"
LABELS = (SCRIPT, "\x1b[2J\x07red", "\u202eevil", "=1+1", "@SUM(A1)", "+1", "-2+3", "\t=1",
          "a\u2028b", "{{7*7}}", "{% raw %}", "${x}", "javascript:alert(1)", "%s%n", "]]>",
          "&lt;b&gt;")  # fmt: skip
ENTITIES = (
    '<!DOCTYPE r [<!ENTITY a "{}">'
    + "".join(
        f'<!ENTITY {b} "{f"&{a};" * 10}">' for a, b in zip("abcdefgh", "bcdefghi", strict=True)
    )
    + "]>"
)
OUTER = (
    '<!DOCTYPE r [<!ENTITY a SYSTEM "file:///etc/passwd">]>',
    '<!DOCTYPE r SYSTEM "http://127.0.0.1:9/x.dtd">',
    '<!DOCTYPE r [<!ENTITY % p SYSTEM "file:///etc/passwd"> %p;]>',
    ENTITIES.format("laugh" * 10),
)
ROBOT = """<robot name="r"><link name="a">{visual}</link><link name="b"/><joint name="{joint}"
type="continuous"><parent link="a"/><child link="b"/><origin xyz="1 0 0"/><axis xyz="0 0 1"/>
</joint>{more}</robot>"""
MESHES = ("/dev/zero", "/etc/passwd", "package://../../x.stl", "http://127.0.0.1:9/x.stl",
          "file:///dev/zero",
          "bomb.dae", ".", "", "x" * 5000)  # fmt: skip
CONTROL = {chr(k) for k in [*range(9), *range(11, 32), 127, 0x202E, 0x2028]} - {"\r"}


def mutated_robots(folder: Path, count: int = 1000, first: int = 0) -> Iterator[Verdict]:
    """URDFs with a few things wrong: loaded or refused with place and remedy."""
    del folder
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ToolkitWarning)
        for seed in range(first, first + count):
            begin, loss = time.process_time(), ""
            try:
                found = outcome(mutant(seed))
                loss = "" if found in ("accepted", "refused") else found
            except Exception as error:  # noqa: BLE001 - any other exception is the defect sought
                loss = f"{type(error).__name__}: {error}"
            yield Verdict(f"robot {seed}", loss, time.process_time() - begin)


def hostile_robots(folder: Path) -> Iterator[Verdict]:
    """Entities, meshes from elsewhere; labels that a terminal, a page or a spreadsheet obeys."""
    desk(folder)
    arm = folder / "arm.urdf"
    (folder / "bomb.dae").write_text(ENTITIES.format("laugh" * 10) + "<COLLADA>&i;</COLLADA>")
    for head in OUTER:
        arm.write_text(head + ROBOT.format(visual="", joint="j", more="&a;"), encoding="utf-8")
        found = heard(f"robot {head[:60]!r}", "check", str(arm))
        loss = found.loss or ("" if found.code == 2 and "root:" not in found.said else "read")
        yield Verdict(found.attack, loss, found.seconds)
    for mesh in MESHES:
        shape = f'<visual><geometry><mesh filename="{mesh}"/></geometry></visual>'
        arm.write_text(ROBOT.format(visual=shape, joint="j", more=""), encoding="utf-8")
        page = folder / "v.html"
        found = heard(f"mesh {mesh[:60]!r}", "view", str(arm), "--static", str(page))
        yield Verdict(found.attack, found.loss, found.seconds)
    rows = (folder / "m.csv").read_text(encoding="utf-8").splitlines()
    for label in LABELS:
        quoted = '"' + label.replace('"', '""') + '"'
        lines = [rows[0], *(quoted + row[row.index(",") :] for row in rows[1:6])]
        (folder / "l.csv").write_text("\n".join([*lines, *rows[6:]]) + "\n", encoding="utf-8")
        (folder / "l.yaml").write_bytes((folder / "m.yaml").read_bytes())
        yield from _labelled(folder, label)


def _labelled(folder: Path, label: str) -> Iterator[Verdict]:
    """What is printed, written as a table and drawn as a page from readings with such a label."""
    model, data = str(folder / "mod.yaml"), str(folder / "l.csv")
    out, page = folder / "p.csv", folder / "s.html"
    found = heard(f"label {label!r} in a table", "predict", model, data, "--out", str(out))
    loss = found.loss or ("obeyed by the terminal" if CONTROL & set(found.said) else "")
    if not loss and out.exists():
        cells = [line.lstrip('"') for line in out.read_text(encoding="utf-8").splitlines()]
        loss = "a formula" if any(_formula(cell.split(",")[0]) for cell in cells) else ""
    yield Verdict(found.attack, loss, found.seconds)
    found = heard(f"label {label!r} in a page", "view", str(folder / "rob"), "--data", data,
                  "--static", str(page))  # fmt: skip
    drawn = page.read_text(encoding="utf-8") if page.exists() else ""
    loss = found.loss or ("a script of its own" if SCRIPT in drawn else "")
    yield Verdict(found.attack, loss, found.seconds)
    for file in (out, page):
        file.unlink(missing_ok=True)


def _formula(cell: str) -> bool:
    """Would a spreadsheet compute it? A plain number it only shows."""
    plain = re.fullmatch(r"[+-]?[\d.]+", cell)
    return cell.startswith(("=", "+", "-", "@", "\t")) and not plain
