"""Which poses are visited and which loads are hung on, and in what order."""

from __future__ import annotations

import numpy as np

from .arm import Arm
from .mechanism import Mechanism
from .rotations import Array
from .rows import Rows

SCHEDULES = ("ascending", "scattered", "up_down", "repeated", "one_direction", "single",
             "three_axes", "ladder", "reloads")  # fmt: skip


def random_poses(
    arm: Arm, count: int, rng: np.random.Generator, clusters: int = 0
) -> dict[str, Array]:
    """Joint coordinates (count,) within limits, tool clear of the column, linkage not folded.

    `clusters`: a technician goes to that many places and measures around each of them, all joints
    within a twelfth of their range.
    """
    if clusters:
        return _clustered(arm, count, rng, clusters)
    kept: dict[str, list[float]] = {name: [] for name in arm.actuated}
    mechanism = Mechanism(arm)
    while len(kept[arm.actuated[0]]) < count:
        trial = {name: rng.uniform(*arm.limits[name], size=4 * count) for name in arm.actuated}
        good = np.ones(4 * count, bool)
        if arm.loop is not None:
            pivot = arm.joints[arm.loop.pivot].name
            good &= np.abs(np.cos(trial[pivot] + trial[arm.loop.driver])) > 0.4
        crank = None if arm.loop is None else trial[arm.loop.driver]
        rest = np.zeros((len(mechanism.labels), 4 * count))
        tool = mechanism.stand(mechanism.commanded(trial), rest, crank).tool_position
        reach = np.linalg.norm(tool[:, :2], axis=1)
        good &= reach > 0.3 * np.median(reach)
        for i in np.nonzero(good)[0]:
            if len(kept[arm.actuated[0]]) < count:
                for name in arm.actuated:
                    kept[name].append(float(trial[name][i]))
    return {name: np.array(values) for name, values in kept.items()}


def _clustered(arm: Arm, count: int, rng: np.random.Generator, clusters: int) -> dict[str, Array]:
    centres = random_poses(arm, clusters, rng)
    owner = np.arange(count) * clusters // count  # one place after the other
    out = {}
    for name in arm.actuated:
        low, high = arm.limits[name]
        near = centres[name][owner] + (high - low) / 12.0 * rng.uniform(-1.0, 1.0, count)
        out[name] = np.clip(near, low, high)
    return out


def _direction(rng: np.random.Generator) -> Array:
    vector = rng.normal(size=3)
    return vector / np.linalg.norm(vector)


def plan(
    arm: Arm,
    rng: np.random.Generator,
    *,
    poses: int = 20,
    loads: int = 5,
    schedule: str = "ascending",
    shared_zero: bool = True,
    first_pose: int = 1,
    moments: bool = False,
    point: Array | None = None,
    force_point: Array | None = None,
    clusters: int = 0,
) -> Rows:
    """Random poses, and for each of them a series of loads after its zero reading.

    `ascending`: one direction per pose, rising; `scattered`: a direction per row; `up_down`:
    rising and falling; `repeated`: rising, every reading twice; `one_direction`: the same
    direction at all poses; `single`: one load at every pose; `three_axes`: the full load along each
    axis of the base, either way; `ladder`: up, down, and the same as a pull; `reloads`: the whole
    series rising, taken off, and rising again.
    """
    chosen = random_poses(arm, poses, rng, clusters)
    full = arm.typical.force
    everywhere = _direction(rng)
    index, force, branch, repeat, order, zero_order = [], [], [], [], [], []
    clock = zero = 0
    for pose in range(poses):
        direction = everywhere if schedule == "one_direction" else _direction(rng)
        # equal loads everywhere keep a drift and a slide along the load exact aliases
        spread = 1.0 if schedule == "one_direction" else rng.uniform(0.95, 1.05)
        levels = list(full * np.arange(1, loads + 1) / loads * spread)
        steps = [(level, 1, 1) for level in levels]
        if schedule == "up_down":
            steps += [(level, -1, 1) for level in levels[-2::-1]]
        if schedule == "repeated":
            steps = [(level, 1, number) for level in levels for number in (1, 2)]
        if schedule == "single":
            steps = [(full * rng.uniform(0.6, 1.0), 1, 1)]
        if schedule == "three_axes":
            steps = [(full * way, 1, 1) for way in rng.choice([-1.0, 1.0], 3)]
        if schedule == "ladder":
            steps += [(level, -1, 1) for level in levels[-2::-1]]
            steps += [(-level, way, again) for level, way, again in steps]
        if schedule == "reloads":
            steps += [(level, 1, 2) for level in levels]
        for number, (level, way, again) in enumerate(steps):
            if number == 0 or not shared_zero:
                zero = clock
                clock += 1
            if schedule == "scattered":
                direction = _direction(rng)
                level = full * rng.uniform(0.4, 1.0)
            if schedule == "three_axes":
                direction = np.eye(3)[number]
            index.append(pose)
            force.append(level * direction)
            branch.append(way)
            repeat.append(again)
            zero_order.append(zero)
            order.append(clock)
            clock += 1
    forces = np.array(force)
    torque = np.zeros_like(forces)
    if moments:
        torque = 0.08 * full * rng.normal(size=forces.shape)
        for row in np.flatnonzero(np.array(repeat) > 1):  # a repeat has the same load
            first = (np.array(index) == index[row]) & (forces == forces[row]).all(axis=1)
            torque[row] = torque[np.argmax(first & (np.array(branch) == branch[row]))]
    index = np.array(index)
    point = np.zeros(3) if point is None else np.asarray(point, float)
    return Rows(
        pose=index + first_pose,
        coordinates={name: values[index] for name, values in chosen.items()},
        force=forces,
        moment=torque,
        order=np.array(order, float),
        zero_order=np.array(zero_order, float),
        branch=np.array(branch, float),
        repeat=np.array(repeat),
        point=point,
        force_point=point if force_point is None else np.asarray(force_point, float),
    )
