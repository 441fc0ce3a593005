"""Poses that put the measured point where people want it: by inverse kinematics, all branches."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError, Refusal
from sk120stiff.measurements import Measurements
from sk120stiff.measurements.table import read_table
from sk120stiff.model import Model, joint_spring_model
from sk120stiff.plan import Cell, Pool, feasible
from sk120stiff.plan.design import determinant_worth, information
from sk120stiff.workspace import (
    Task,
    different,
    elastic_arm,
    read_path,
    solve_inverse,
    starting_poses,
)

STARTS = 64  # poses from which each place is sought


@dataclass(frozen=True, eq=False)
class Places:
    """Poses that can be, and at which of the places each stands.

    Attributes:
        a: (K, n) poses [rad or m].
        names: (K,) label of each one's place.
        remarks: Which places no pose reaches, and why, in sentences.
    """

    a: Array
    names: tuple[str, ...]
    remarks: tuple[str, ...]

    def one_each(self, model: Model, pool: Pool) -> Pool:
        """Of a pool's readings those of one pose for each place: by whose loads most is learnt."""
        span = np.array([model.parameters[k].spec.plausible for k in model.free])
        gains = information(model, pool, span)
        gains /= np.trace(gains, axis1=1, axis2=2).mean() or 1.0
        worth, total = determinant_worth(np.arange(len(span))), 1e-6 * np.eye(len(span))
        standing: dict[str, dict[int, list[int]]] = {}
        for row, (pose, a) in enumerate(zip(pool.pose, pool.load_cases.a, strict=True)):
            standing.setdefault(self._place(a), {}).setdefault(int(pose), []).append(row)
        kept: list[int] = []
        for poses in standing.values():
            rows = list(poses.values())
            sums = np.array([gains[each].sum(axis=0) for each in rows])
            best = int(np.argmax(worth(total + sums)))
            total = total + sums[best]
            kept += rows[best]
        return Pool(pool.load_cases.rows(np.array(sorted(kept), dtype=np.intp)), pool.remarks)

    def lost(self, pool: Pool) -> tuple[str, ...]:
        """Places of which a pool has no pose any more."""
        left = {self._place(a) for a in pool.load_cases.a}
        return tuple(name for name in dict.fromkeys(self.names) if name not in left)

    def _place(self, a: Array) -> str:
        return self.names[int(np.argmin(np.abs(self.a - a).max(axis=1)))]

    def named(self, plan: Measurements) -> Measurements:
        """The plan with its poses called by their places; a second one there gets a number."""
        labels: dict[str, str] = {}
        taken: dict[str, int] = {}
        for pose, joints in zip(plan.pose, plan.joints, strict=True):
            if pose in labels:
                continue
            name = self._place(joints)
            taken[name] = taken.get(name, 0) + 1
            labels[pose] = name if taken[name] == 1 else f"{name}/{taken[name]}"
        return replace(plan, pose=tuple(labels[pose] for pose in plan.pose))


def places_of(file: Path, model: Model, cell: Cell, point: Array, axis: Array | None) -> Places:
    """Every pose found that puts the point at one of a file's places, and that can be.

    Args:
        file: x, y, z of the point, base axes; roll, pitch and yaw of the tool where these count.
        model, cell: The arm, and what it must keep to.
        point: (3,) in the tool frame [m].
        axis: (3,) where the tool's z axis shall point, rotation about it free; None: any way, or
            that of the file.

    Raises:
        InputError: The file cannot be read, has no positions, or calls two places the same.
        Refusal: No place can be reached.
    """
    robot = model.robot
    holds_loads = {"fx", "fy", "fz"} & set(read_table(file).headers)
    path = read_path(file, robot, wrench=None if holds_loads else np.zeros(6))
    if path.position is None:
        raise InputError(
            "places are positions, and the file has joints alone", where=str(file),
            remedy="Give x[mm], y[mm], z[mm] of the point; --data and --check take joints.",
        )  # fmt: skip
    called = path.table.cells.get("point") or [""] * path.count
    labels = [label or f"p{k + 1}" for k, label in enumerate(called)]
    for k, label in enumerate(labels):
        if label in labels[:k]:
            raise InputError(
                f"two places are called {label!r}",
                where=f"{file}, line {path.table.lines[k]}",
                remedy="Give each place a name of its own, or leave the column point out.",
            )
    arm = elastic_arm(joint_spring_model(robot), point=point)
    starts = starting_poses(arm, STARTS, np.clip(np.zeros(robot.n), arm.lower, arm.upper))
    found: list[Array] = []
    names: list[str] = []
    remarks: list[str] = []
    for k, label in enumerate(labels):
        many = Task(
            np.tile(path.position[k], (STARTS, 1)),
            axis=axis,
            rotation=None if path.rotation is None or axis is not None else path.rotation[k],
        )
        reached = solve_inverse(arm, many, starts)
        branches = different(reached.a[reached.found])
        if not len(branches):
            remarks.append(f"{label}: no pose reaches it.")
            continue
        verdict = feasible(robot, cell, branches, point=point)
        found.append(branches[verdict.ok])
        names += [label] * int(verdict.ok.sum())
        if not verdict.ok.any():
            remarks.append(
                f"{label}: of {len(branches)} poses none can be; {verdict.faults[0][0]}."
            )
    if not names:
        raise Refusal(
            f"no pose at any of the {path.count} places can be",
            where=str(file),
            remedy=" ".join(remarks[:3]),
        )
    return Places(np.concatenate(found), tuple(names), tuple(remarks))
