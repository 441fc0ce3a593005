"""The error budget of a task: what moves the loaded tool on a path that somebody has to drive."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from sk120stiff.arrays import Array
from sk120stiff.cli.cell import at_work
from sk120stiff.cli.path_words import floor_of
from sk120stiff.explain import Explanation
from sk120stiff.explain.findings import TaskBudget
from sk120stiff.explain.judge.budget import within_joints
from sk120stiff.identify import known_model
from sk120stiff.model import joint_spring_model, with_own_errors
from sk120stiff.plan import Cell, feasible
from sk120stiff.robot import Robot
from sk120stiff.workspace import (
    elastic_arm,
    joints_along,
    read_path,
    standing_budgets,
    stays_above,
)


def opened_task(file: Path, robot: Robot, cell: Cell) -> tuple[Array, Array]:
    """(N, n) joints and (N, 6) loads of a task, as `compensate` finds them.

    Raises:
        InputError: The file cannot be read.
        Refusal: The arm does not reach a point.
    """
    path = read_path(file, robot)
    ground, around = floor_of(robot, None, path), at_work(cell)
    a = joints_along(
        path,
        elastic_arm(joint_spring_model(robot)),
        stays_above=lambda a: stays_above(robot, a, ground),
        stands=lambda a: feasible(robot, around, a).ok,
    )
    return a, path.wrench


def with_task(answer: Explanation, file: Path, a: Array, wrench: Array) -> Explanation:
    """The answer with the budget of a task (N, n), (N, 6) by its final model."""
    left = answer.remainder
    model = known_model(answer.final, left.left)
    within = known_model(within_joints(answer.final), left.left)
    (effects, joints), (_, inner) = (standing_budgets(m, a, wrench) for m in (model, within))
    task = TaskBudget(file.name, len(a), effects, with_own_errors(joints, inner))
    return replace(answer, task=task)
