"""Which rows are of one pose: by labels, by names, or by joint values."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import takewhile

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.measurements.absolute import SAME_POSE
from sk120stiff.measurements.importers.contract import Column, Sheet
from sk120stiff.measurements.table.rows import rows_of_one_pose

_MARKS = " _-./:#"  # between what labels of one pose share and what tells them apart

Labels = tuple[tuple[str, ...], Column | None, list[str]]


def pose_labels(sheet: Sheet, q: Array, W: Array, *, displaced: bool) -> Labels:
    """Pose of every row, the column it is from, and what is to be said of it.

    Args:
        sheet: The readings.
        q: (N, n) joint values [rad or m].
        W: (N, 6) loads [N, N·m].
        displaced: Were displacements read? Poses of one label may then have zeros of their own.
    """
    stated = sheet.get("pose")
    if stated is not None and all(stated.cells):
        one = None if displaced else _of_one_pose(stated.cells, q, W)
        return (stated.cells, stated, []) if one is None else one
    pose, said = rows_of_one_pose(q), "Rows with the same joint values are one pose."
    if len(set(pose)) == len(pose) and np.ptp(W, axis=0).any() and not displaced:
        pose = near_poses(q)
        said = f"Rows whose joint values differ by less than {SAME_POSE:g} are one pose."
    names = sheet.get("name")
    own = names.cells if names else ()
    same = len(set(own)) == len(set(pose)) == len(set(zip(own, pose, strict=False)))
    if same and not any(cell[:1] in ("", "#") for cell in own):
        return own, names, []
    return pose, None, [said]


def near_poses(q: Array) -> tuple[str, ...]:
    """Labels of N rows: those whose joint values differ by no more than `SAME_POSE` have one."""
    firsts: list[int] = []
    labels = []
    for row in range(len(q)):
        near = np.abs(q[firsts] - q[row]).max(axis=1) <= SAME_POSE if firsts else np.zeros(0, bool)
        if not near.any():
            firsts.append(row)
            near = np.append(near, True)
        labels.append(f"P{int(np.argmax(near)) + 1}")
    return tuple(labels)


def _of_one_pose(labels: Sequence[str], q: Array, W: Array) -> Labels | None:
    """Labels that rows with the same joint values share, as P1 of P1_A and P1_B; None where the
    labels told say more than which load was on: one has several loads or joint values, or no two
    loads meet at the same joint values.
    """
    at = rows_of_one_pose(q)
    loads = [(row + 0.0).tobytes() for row in W]
    rows_of = len(set(zip(labels, at, loads, strict=True)))
    if rows_of > len(set(labels)) or len(set(zip(at, loads, strict=True))) == len(set(at)):
        return None
    groups: dict[str, list[str]] = {}
    for label, place in zip(labels, at, strict=True):
        groups.setdefault(place, []).append(label)
    own = {place: list(dict.fromkeys(group)) for place, group in groups.items()}
    names = {place: group[0] for place, group in own.items()}
    for way in (_begin_of, _end_of):
        shared = {p: group[0] if len(group) == 1 else way(group) for p, group in own.items()}
        if all(shared.values()) and len(set(shared.values())) == len(shared):
            names = shared
            break
    several = [place for place, group in own.items() if len(group) > 1]
    first = own[several[0]]
    said = (
        f"Rows with the same joint values are one pose, whatever it is called: {', '.join(first)} "
        f"{'are' if len(first) > 1 else 'is'} {names[several[0]]}"
        + (f", and so on at {len(several)} poses." if len(several) > 1 else ".")
    )
    return tuple(names[place] for place in at), None, [said]


def _begin_of(labels: Sequence[str]) -> str:
    """What labels begin with, up to a mark or to a letter behind a number; else empty."""
    begin = _begin(labels)
    behind = [label[len(begin) : len(begin) + 1] for label in labels]
    marked = begin[-1:] in _MARKS or all(each in _MARKS for each in behind)
    counted = begin[-1:].isdigit() and all(each.isalpha() or not each for each in behind)
    return begin.rstrip(_MARKS) if marked or counted else ""


def _end_of(labels: Sequence[str]) -> str:
    """What labels end with behind a mark, or behind the names of their files; empty without one."""
    end = _begin([label[::-1] for label in labels])[::-1]
    end = end[end.rfind("/") :] if "/" in end else end
    first = next((k for k, letter in enumerate(end) if letter in _MARKS), len(end))
    return end[first:].lstrip(_MARKS)


def _begin(labels: Sequence[str]) -> str:
    same = takewhile(lambda each: len(set(each)) == 1, zip(*labels, strict=False))
    return "".join(each[0] for each in same)
