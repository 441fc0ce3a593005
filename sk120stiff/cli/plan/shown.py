"""How a plan is shown and driven: as JSON, as a page, as a program through the planned poses."""

from __future__ import annotations

import itertools
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from sk120stiff import __version__
from sk120stiff.arrays import Array, Index
from sk120stiff.errors import InputError
from sk120stiff.files import write_atomically
from sk120stiff.measurements import Measurements
from sk120stiff.model import Model
from sk120stiff.plan import Cell, Route, route
from sk120stiff.plan.route import SLIDE_STEP, STEP
from sk120stiff.programs import LANGUAGES, Language
from sk120stiff.programs.building import controller_axes, convention
from sk120stiff.programs.program import Program
from sk120stiff.robot import Robot

COARSER = 2.0  # than the steps in which a way is asked: enough for a picture


def as_keys(plan: Measurements) -> list[dict[str, object]]:
    """The rows in JSON."""
    return [
        {
            "pose": label,
            "joints": dict(zip(plan.joint_names, a.tolist(), strict=True)),
            "wrench": wrench.tolist(),
        }
        for label, a, wrench in zip(plan.pose, plan.joints, plan.wrench, strict=True)
    ]


def write_page(
    file: Path, model: Model, plan: Measurements, cell: Cell, driven: Route | None = None
) -> None:
    """The arm at every pose of a plan, in its order, with the loads there and what stands around.

    The point's way between the poses is that of joints that go straight, by the via points of
    `driven` where there are any.
    """
    from sk120stiff.show import scene_of_model, static_scene
    from sk120stiff.show.scene.scene import ScenePath
    from sk120stiff.show.scene.surroundings import surroundings_of

    said = f"{len(plan.poses)} poses in their order, {plan.n_readings} loads"
    if cell.source:
        said += f"; around it what {Path(cell.source).name} states"
    scene = scene_of_model(model, plan, title=f"{model.robot.name}: plan", subtitle=said)
    stands = np.array([pose.a for pose in scene.poses]) if driven is None else driven.a
    a, reached = _between(model.robot, stands)
    planned = np.ones(len(stands), dtype=bool) if driven is None else driven.pose >= 0
    at = model.robot.screws(a, point=plan.point).position
    path = ScenePath(
        at, at, 0, said=f"first: {plan.poses[0]}", freedom="", mark="the first pose's point",
        stops=tuple(int(k) for k in reached[planned]),
    )  # fmt: skip
    around = surroundings_of(cell, model.robot, scene.tree)
    static_scene(file, replace(scene, path=path, surroundings=around))


def _between(robot: Robot, stops: Array) -> tuple[Array, Index]:
    """(M, n) poses along joints that go straight from stop to stop, and which of them are stops."""
    rows, reached = [stops[:1]], [0]
    for start, end in itertools.pairwise(stops):
        steps = np.abs(end - start) / np.where(robot.prismatic, SLIDE_STEP, STEP)
        count = max(int(np.ceil(steps.max() / COARSER)), 1)
        rows.append(start + np.linspace(0.0, 1.0, count + 1)[1:, None] * (end - start))
        reached.append(reached[-1] + count)
    return np.concatenate(rows), np.array(reached, dtype=np.intp)


SPEED = 0.05  # m/s that the header names for the tool; joints go at the language's own share


def language_for(out: Path) -> Language:
    """The language of a program's file name.

    Raises:
        InputError: It is none that moves by joint values.
    """
    by_joints = {each.ending: each for each in LANGUAGES.values() if each.joint_moves}
    language = by_joints.get(out.suffix.lower())
    if language is None:
        known = ", ".join(f"{ending} ({each.title})" for ending, each in by_joints.items())
        raise InputError(
            f"poses are driven to by joint values, and the ending {out.suffix!r} names no language "
            "that knows them",
            where=f"--program {out}",
            remedy=f"Endings are: {known}.",
        )
    return language


def in_order(plan: Measurements, robot: Robot, cell: Cell, seed: int) -> tuple[Measurements, Route]:
    """The plan with its poses in the order of least driving, and the way."""
    first = [plan.pose.index(label) for label in plan.poses]
    found = route(robot, cell, plan.joints[first], point=plan.point, seed=seed)
    rows = [
        k for pose in found.order for k, label in enumerate(plan.pose) if label == plan.poses[pose]
    ]
    return plan.select(np.array(rows, dtype=np.intp)), found


def write_route(
    language: Language, out: Path, robot: Robot, found: Route, poses: tuple[str, ...]
) -> None:
    """Write the program; each stop at a planned pose is a target of its own.

    Args:
        poses: What the poses are called, in the order in which they are driven.
    """
    labels = dict(zip(found.order, poses, strict=True))
    given = {}
    if "pulses" in language.settings and robot.controller.pulses_per_degree:
        given = {"pulses": ",".join(f"{x:.12g}" for x in robot.controller.pulses_per_degree)}
    settings = language.with_defaults(given)
    axes, slides, values = controller_axes(robot, found.a)
    place = robot.placement(found.a)
    stops = ", ".join(
        f"{labels[pose]} at target {k}" for k, pose in enumerate(found.pose, 1) if pose >= 0
    )
    count, via = len(found.a), bool((found.pose < 0).any())
    program = Program(
        name=out.stem,
        header=(
            f"Written by sk120stiff {__version__}: the way through the poses of a plan.",
            f"Robot: {robot.name}. Poses: {stops}"
            + ("; the others are via points." if via else "."),
            "It waits at each pose: hang on the loads, read, take them off, go on. Between targets "
            "the joints go straight; the way was held against the cell, loads and cables were not.",
            f"Joints: {convention(robot)}.",
            *language.remarks(settings),
        ),
        axes=axes,
        slides=slides,
        joints=values,
        position=place[:, :3, 3],
        rotation=place[:, :3, :3],
        speed=np.full(count, SPEED),
        rapid=np.ones(count, dtype=bool),
        lines=np.arange(1, count + 1, dtype=np.intp),
        by_joints=True,
        settings=settings,
        date=datetime.now(UTC).strftime("%Y/%m/%d %H:%M"),
        halts=found.pose >= 0,
    )
    write_atomically(out, language.text(program))
