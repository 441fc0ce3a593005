"""The way through the poses of a plan as a robot program that moves by joint values."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path

import numpy as np

from sk120stiff.errors import InputError
from sk120stiff.plan import Route
from sk120stiff.programs.building import controller_axes, convention, places_in, with_pulses
from sk120stiff.programs.catalogue import LANGUAGES
from sk120stiff.programs.controller import frame_words, places
from sk120stiff.programs.language import Language
from sk120stiff.programs.program import Program
from sk120stiff.robot import Robot

SPEED = 0.05  # m/s that the header names for the tool; joints go at the language's own share


def language_by_joints(out: Path) -> Language:
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


def route_program(
    language: Language, name: str, robot: Robot, found: Route, poses: Sequence[str]
) -> Program:
    """The program of a way; each stop at a planned pose is a target of its own.

    Args:
        poses: What the poses are called, in the order in which they are driven.
    """
    labels = dict(zip(found.order, poses, strict=True))
    settings = language.with_defaults(with_pulses(language, robot, {}))
    axes, slides, values = controller_axes(robot, found.a)
    place = places(robot, found.a, None)
    stops = ", ".join(
        f"{labels[pose]} at target {k}" for k, pose in enumerate(found.pose, 1) if pose >= 0
    )
    count, via = len(found.a), bool((found.pose < 0).any())
    return Program(
        name=name,
        header=(
            f"Written by sk120stiff {version('sk120stiff')}: the way through the poses of a plan.",
            f"Robot: {robot.name}. Poses: {stops}"
            + ("; the others are via points." if via else "."),
            "It waits at each pose: hang on the loads, read, take them off, go on. Between targets "
            "the joints go straight; the way was held against the cell, loads and cables were not.",
            f"Places: frame {robot.tool_frame} in {places_in(robot)}.",
            *frame_words(robot),
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
