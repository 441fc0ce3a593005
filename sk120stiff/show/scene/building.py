"""From a model and measurements to a scene: the usual way to one."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from sk120stiff.arrays import Array, Mask
from sk120stiff.errors import InputError
from sk120stiff.show.scene.elastic import Elastic
from sk120stiff.show.scene.scene import Reading, Scene, ScenePose
from sk120stiff.show.wording import number

if TYPE_CHECKING:
    from sk120stiff.effects import Effect, LoadCases
    from sk120stiff.measurements import Measurements
    from sk120stiff.model import Model
    from sk120stiff.robot import Robot
    from sk120stiff.show.scene.links import LinkTree


def scene_of_model(
    model: Model,
    data: Measurements | None = None,
    *,
    models: Mapping[str, Model] | None = None,
    title: str = "",
    subtitle: str = "",
    label: str = "",
    a: ArrayLike | None = None,
    wrench: ArrayLike | None = None,
    model_file: str | os.PathLike[str] = "",
    named: Sequence[Effect] = (),
) -> Scene:
    """The scene of a modelled robot, with the poses of its data.

    Args:
        model: What yields in the scene.
        data: Readings to list, with arrows for what was measured and what was predicted; masked
            rows are left out.
        models: Name → model whose predictions are shown beside the measured displacements, before
            and after an explanation for example; ``{"model": model}`` by default.
        title, subtitle, label: Headings, and where the springs come from.
        a, wrench: (n,) pose and (6,) load shown at first; by default those of the first reading,
            or of the reading that the first model misses most where something is named.
        model_file: The model's file, for "copy as command".
        named: Effects whose places are marked on the arm.

    Raises:
        InputError: The data belong to another robot, or nothing in the model yields.
    """
    robot = model.robot
    shown = {"model": model} if models is None else dict(models)
    poses = poses_of(robot, data, shown) if data is not None else ()
    point = None if data is None else _first_point(poses, data)
    if a is None and wrench is None and named:
        a, wrench, point = _widest_gap(poses) or (a, wrench, point)
    scene = Scene(
        robot=robot,
        elastic=Elastic.of_model(model, label=label),
        poses=poses,
        title=title,
        subtitle=subtitle,
        point=np.zeros(3) if point is None else np.asarray(point, dtype=float),
        a=None if a is None else np.asarray(a, dtype=float),
        wrench=None if wrench is None else np.asarray(wrench, dtype=float),
        robot_argument=robot.source,
        model_argument=os.fspath(model_file),
        positions=data is not None and _of_positions(data),
    )
    return replace(scene, marks=_marks(scene.tree, named))


def _of_positions(data: Measurements) -> bool:
    """Is what was read where a point stands, and not how far a load moved it?"""
    return data.absolute is not None and data.absolute.channels.displacement is None


def _first_point(poses: Sequence[ScenePose], data: Measurements) -> Array:
    """(3,) the point of the first reading, in the tool frame [m]."""
    points = [r.point for pose in poses for r in pose.readings if r.point is not None]
    return points[0] if points else np.asarray(data.point)


def _widest_gap(poses: Sequence[ScenePose]) -> tuple[Array, Array, Array | None] | None:
    """Pose, load and point of the reading that the first model misses most; None of none."""
    gaps = [
        (float(np.linalg.norm(r.measured - next(iter(r.predicted.values())))), (pose.a, r))
        for pose in poses
        for r in pose.readings
        if r.measured is not None and r.predicted
    ]
    if not gaps:
        return None
    _, (a, reading) = max(gaps, key=lambda gap: gap[0])
    return a, reading.wrench, reading.point


def _marks(tree: LinkTree, effects: Sequence[Effect]) -> dict[str, str]:
    """Link → the effects that act there: at a link itself, or at the joint that carries it.

    What an instrument misreads has no place on the arm and is not marked.
    """
    carried = dict(zip(tree.joints, tree.names, strict=True))
    marks: dict[str, list[str]] = {}
    for effect in effects:
        for where in effect.where.split(","):
            link = carried.get(where, where)
            if link in tree.names:
                marks.setdefault(link, []).append(f"{effect.name} at {where}")
    return {link: ", ".join(dict.fromkeys(texts)) for link, texts in marks.items()}


def poses_of(
    robot: Robot, data: Measurements, models: Mapping[str, Model] | None = None
) -> tuple[ScenePose, ...]:
    """The poses of measurements with their readings in base axes, and what models predict.

    A reading that lacks an axis has no measured arrow. Of positions the arrows are told from where
    the last of the models has the marker: what was measured is the gap that it leaves.

    Raises:
        InputError: The data belong to another robot.
    """
    from sk120stiff.effects import load_cases_of

    used = data.masked()
    load_cases = load_cases_of(robot, used)
    models = models or {}
    went = used.displacement if used.absolute is None else used.absolute.channels.displacement
    if used.absolute is None or went is not None:
        measured = None if went is None else _in_base(load_cases, went)
        predicted = {
            name: _in_base(load_cases, m.predict(load_cases)) for name, m in models.items()
        }
    else:
        measured, predicted = _off_the_last(used, load_cases, models)
    read: Mask = np.zeros(used.n_readings, dtype=np.bool_)
    if measured is not None:
        read |= np.isfinite(measured).all(axis=1)
    wrench, said = _at_point(load_cases), _said(used)
    points = np.broadcast_to(load_cases.point, (load_cases.count, 3))
    poses = []
    for k, pose in enumerate(load_cases.poses):
        rows = np.flatnonzero(load_cases.pose == k)
        readings = tuple(
            Reading(
                wrench=wrench[row],
                measured=measured[row] if measured is not None and read[row] else None,
                predicted={name: values[row] for name, values in predicted.items()},
                label=f"reading {count}",
                point=points[row],
                said=said[row],
            )
            for count, row in enumerate(rows, start=1)
        )
        poses.append(ScenePose(f"pose {pose}", load_cases.a[rows[0]], readings))
    return tuple(poses)


def _said(used: Measurements) -> list[str | None]:
    """What hung at each of N rows, which force pulled and which marker was read, in words.

    Only what differs from nothing: an empty word where no row has a load and there is one marker;
    None of displacements under forces, whose size says enough.
    """
    told = used.absolute
    if told is None:
        return [None] * used.n_readings
    force = np.linalg.norm(used.wrench[:, :3], axis=1)
    columns = []
    if told.payload.any():
        columns.append([f"{number(mass)} kg" for mass in told.payload.tolist()])
    if force.any():
        columns.append([f"{number(size, 3)} N" for size in force.tolist()])
    if len(set(told.markers)) > 1:
        columns.append([f"marker {name}" for name in told.markers])
    return [", ".join(column[row] for column in columns) for row in range(used.n_readings)]


def _off_the_last(
    used: Measurements, load_cases: LoadCases, models: Mapping[str, Model]
) -> tuple[Array | None, dict[str, Array]]:
    """Positions (N, 3) as read, and as models have them, from those of the last, base axes [m].

    Every model places the instrument itself, so each is told by the gap that it leaves. Nothing
    where a model does not know where the instrument stands; of what was not read the last is where
    the others are told from.
    """
    from sk120stiff.effects import load_cases_of
    from sk120stiff.identify.positions.checks.reregistration import placed_anew
    from sk120stiff.model import instrument_frames, predict

    position = None if used.absolute is None else used.absolute.channels.position
    if position is None or not models:
        return None, {}
    seen: dict[str, tuple[Array, Array]] = {}
    parts = placed_anew([*models.values()][-1], used)
    if parts is not None and parts.parts:  # rows without a station have that of the best model
        used = parts.readings
        load_cases = load_cases_of(parts.model.robot, used)
    for name, model in models.items():
        moved = placed_anew(model, used)
        model = model if moved is None else moved.model
        try:
            said = np.asarray(predict(model, used).position)
        except InputError:
            return None, {}
        seen[name] = instrument_frames(model, load_cases)[0], said
    nearest = np.where(np.isfinite(position), position, seen[next(reversed(seen))][1])
    gaps = {name: np.einsum("nji,nj->ni", R, nearest - said) for name, (R, said) in seen.items()}
    last = gaps[next(reversed(gaps))]
    told = {name: last - own for name, own in gaps.items()}
    return np.where(np.isfinite(position), last, np.nan), told


def _in_base(load_cases: LoadCases, values: Array) -> Array:
    """(N, 3) displacements in base axes."""
    return np.asarray(np.einsum("nij,nj->ni", load_cases.reading_axes, values))


def _at_point(load_cases: LoadCases) -> Array:
    """(N, 6) loads moved to the measured point: the same wrench, seen from there."""
    arm = np.einsum("nij,nj->ni", load_cases.rotation, np.broadcast_to(
        load_cases.force_point - load_cases.point, (load_cases.count, 3)))  # fmt: skip
    wrench = load_cases.wrench.copy()
    wrench[:, 3:] += np.cross(arm, wrench[:, :3])
    return wrench
