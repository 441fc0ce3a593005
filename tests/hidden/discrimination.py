"""Would the proposed poses settle an 'A or B'? Answered with the generator's own physics."""

from __future__ import annotations

import csv
import re
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .answers import identity, identity_of
from .generator.build import rebuild
from .generator.case import Case
from .generator.draw import unit_causes
from .generator.rows import Rows
from .generator.signature import blocks, rivals, signature, view
from .judge import TOLD_APART

UNITS = {"deg": np.pi / 180.0, "rad": 1.0, "m": 1.0, "mm": 1e-3, "N": 1.0, "kN": 1e3}


def tells_apart(truth: dict[str, Any], answer: Path) -> bool:
    """Whether the proposed readings tell the pair apart, repeated until they are as many as the
    readings so far."""
    case = rebuild(truth["level"], truth["seed"])
    extra = proposed(answer / "next_poses.csv", case)
    if extra is None:
        return False
    before = _separations(truth, case, case.train)
    after = _separations(truth, case, joined(case.train, extra))
    repeats = case.train.count / extra.count
    # what independent readings add to lambda adds up
    return all(
        first**2 + repeats * (second**2 - first**2) > TOLD_APART**2
        for first, second in zip(before, after, strict=True)
    )


def _separations(truth: dict[str, Any], case: Case, rows: Rows) -> list[float]:
    seen = view(case.world.with_causes(), rows, case.noise)
    partner = {identity_of(text) for text in truth["pair"]}
    others = [c for c in unit_causes(case.arm) if identity(c.name, c.where) in partner]
    found = rivals(signature(seen, case.hidden[0].cause), ("", ""), blocks(seen, others))
    return [rival.separation for rival in found]


def proposed(path: Path, case: Case) -> Rows | None:
    """The proposed readings; forces in the axes that the data use."""
    with path.open(newline="", encoding="utf-8") as stream:
        lines = list(csv.DictReader(stream))
    if not lines:
        return None
    columns: dict[str, NDArray[np.float64]] = {}
    for title in lines[0]:
        match = re.fullmatch(r"\s*(\w+)\s*(?:\[([^\]]+)\])?\s*", title or "")
        if match is None:
            continue
        try:
            values = np.array([float(entry[title]) for entry in lines])
        except (TypeError, ValueError):
            continue
        columns[match[1]] = values * UNITS.get(match[2] or "", 1.0)
    if any(name not in columns for name in (*case.arm.actuated, "fx", "fy", "fz")):
        return None
    count = len(lines)
    force = np.stack([columns[key] for key in ("fx", "fy", "fz")], 1)
    order = case.train.order.max() + 2.0 + 2.0 * np.arange(count)
    rows = Rows(
        pose=9001 + np.arange(count),
        coordinates={name: columns[name] for name in case.arm.actuated},
        force=force,
        moment=np.zeros_like(force),
        order=order,
        zero_order=order - 1.0,
        branch=np.ones(count),
        repeat=np.ones(count, int),
        point=case.train.point,
        force_point=case.train.force_point,
    )
    if case.force_frame == "tool":
        from .generator.writing import nominal_tool_rotation

        turned = np.einsum("nij,nj->ni", nominal_tool_rotation(case, rows), force)
        rows = Rows(**{**rows.__dict__, "force": turned})
    return rows


def joined(first: Rows, second: Rows) -> Rows:
    """Both series, one after the other."""

    def both(name: str) -> NDArray[np.float64]:
        return np.concatenate([getattr(first, name), getattr(second, name)])

    return Rows(
        pose=both("pose"),
        coordinates={
            name: np.concatenate([values, second.coordinates[name]])
            for name, values in first.coordinates.items()
        },
        force=both("force"),
        moment=both("moment"),
        order=both("order"),
        zero_order=both("zero_order"),
        branch=both("branch"),
        repeat=both("repeat"),
        point=first.point,
        force_point=first.force_point,
    )
