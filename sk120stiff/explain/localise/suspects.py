"""What a gap may go with: places of the arm, torques, angles, axes, instruments, the series.

A suspect is no cause. It is a handful of columns that say how the readings would change if the arm
yielded at some place, if a joint's law were bent, if an instrument misread. The catalogue decides
what a cause is called; suspects tell where a gap lives, also where the catalogue has no name.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects import LoadCases
from sk120stiff.errors import two_digits
from sk120stiff.explain.localise.changes import changes
from sk120stiff.explain.localise.drives import angles, drives, laws, waves
from sk120stiff.explain.localise.suspect import Suspect
from sk120stiff.explain.localise.yielding import yielding
from sk120stiff.model import Model
from sk120stiff.robot.anatomy import ArmJoint, arm_joints, last_link

CLOCKS = ("the order of the readings", "the time since the zero reading")
TO_AND_FRO = ", coming and going in "
WAVE = 4  # readings, at least, in half a wave of a drift
MOST_HALF_WAVES = 40  # of a drift in one series
TIPS, TURNS = "the moment that tips the base", "the moment that the tool carries"
ENDS = (TIPS, "the force that pushes the base", TURNS, "the force that the tool carries")
SHARE_OF_LONGEST = 0.3  # a link shorter than this share of the longest does not count as an arm


def comes_and_goes(name: str) -> bool:
    """Is a suspect of that name a drift to and fro?"""
    return TO_AND_FRO in name


@dataclass(frozen=True, eq=False)
class Axes:
    """Three directions that go with the pose.

    Attributes:
        name: ``world``, ``arm plane``, ``forearm`` or ``tool``.
        words: What each of the three directions is called.
        directions: (N, 3, 3) unit directions as columns, base axes.
    """

    name: str
    words: tuple[str, str, str]
    directions: Array


def axes_of(load_cases: LoadCases) -> tuple[Axes, ...]:
    """The axes in which a cause may live: world, arm plane, forearm, tool."""
    count = load_cases.count
    world = np.broadcast_to(np.eye(3), (count, 3, 3))
    out = [Axes("world", ("x of the base", "y of the base", "z of the base"), world)]
    plane = _arm_plane(load_cases)
    if plane is not None:
        out.append(Axes("arm plane", ("outwards", "sideways", "along the first axis"), plane))
    joints = arm_joints(load_cases.robot)
    longest = max((joint.length for joint in joints), default=0.0)
    long = [joint for joint in joints if joint.length > SHARE_OF_LONGEST * longest]
    if len(long) > 1:
        out.append(Axes("forearm", _words(long[-1]), _frames(load_cases, long[-1])))
    tool = load_cases.robot.tool_frame
    words = (f"x of {tool}", f"y of {tool}", f"z of {tool}")
    out.append(Axes("tool", words, load_cases.rotation))
    return tuple(out)


def _words(joint: ArmJoint) -> tuple[str, str, str]:
    link = joint.link
    return (
        f"along {link}",
        f"across {link} in the plane in which {joint.name} turns",
        f"across {link} along the axis of {joint.name}",
    )


def suspects_of(model: Model, load_cases: LoadCases, predicted: Array) -> tuple[Suspect, ...]:
    """Everything that the gap of a model may go with.

    Args:
        model: The model whose gap is looked at.
        load_cases: Its N readings.
        predicted: (N, 3) what it predicts, base axes [m].
    """
    places = yielding(load_cases, model.catalogue)
    ends = {each.name: each for each in places if each.name in ENDS}
    return (
        *places,
        *_places_without_a_name(load_cases, ends.get(TIPS)),
        *drives(load_cases),
        *laws(load_cases),
        *map(_bent, ends.values()),
        *angles(model, load_cases),
        *waves(load_cases),
        *_loads_in_axes(load_cases),
        *_instruments(model, load_cases, predicted),
        *_series(load_cases),
        *changes(
            load_cases, [ends[name] for name in (TIPS, TURNS) if name in ends],
            [*drives(load_cases)],
        ),
    )  # fmt: skip


def suspect_named(name: str | None, model: Model, load_cases: LoadCases) -> Suspect | None:
    """The suspect of that name; None where these readings do not tell of it."""
    every = suspects_of(model, load_cases, model.predict(load_cases)) if name else ()
    return next((each for each in every if each.name == name), None)


def _places_without_a_name(load_cases: LoadCases, tips: Suspect | None) -> Iterator[Suspect]:
    """Where the arm may yield as no effect has it.

    Args:
        load_cases: The N readings.
        tips: The base that tips, if any moment tips it.
    """
    robot, count = load_cases.robot, load_cases.count
    if tips is not None:
        yield _floor(tips)
    base = np.broadcast_to(robot.foundation, (count, 3))
    up = np.broadcast_to(np.eye(3)[:, 2:], (count, 3, 1))
    yield _turning("the moment that turns the base about z", load_cases, base, up)
    for joint in arm_joints(robot):
        behind = (f"tool_compliance:{robot.tool_frame}",) if joint.link == last_link(robot) else ()
        frames = _frames(load_cases, joint)
        pulled = _pushing(f"the force that {joint.link} carries", load_cases, frames)
        yield replace(pulled, frees=behind)


def _floor(tips: Suspect) -> Suspect:
    """The floor tips, as far about x as about y, and a tracker that stands on it moves with it.

    A turn about an axis through any point is one through the base and a shift across the axis.
    """
    moment = np.pad(tips.carried, ((0, 0), (0, 1)))
    shifts = np.swapaxes(np.cross(moment[:, None, :], np.eye(3)), 1, 2)
    columns = np.concatenate([tips.columns.sum(axis=2, keepdims=True), shifts], axis=2)
    name = "the moment that tips the floor under base and tracker"
    return replace(tips, name=name, columns=columns, carried=np.zeros((0, 0)), frees=())


def _bent(straight: Suspect) -> Suspect:
    """Base and tool yield, but not in proportion: more and more, less and less, or one way only."""
    load = straight.carried
    largest = np.maximum(np.abs(load).max(axis=0), 1e-300)
    sign = np.sign(load)[:, None, :]
    curved = straight.columns * (np.abs(load) / largest)[:, None, :]
    columns = np.concatenate([straight.columns * sign, curved], axis=2)
    name = f"{straight.name}, not in proportion to it"
    return replace(straight, family="law", name=name, columns=columns)


def _loads_in_axes(load_cases: LoadCases) -> Iterator[Suspect]:
    """The gap in proportion to the load, by a matrix that is constant in some axes."""
    force = load_cases.wrench[:, :3]
    size = np.linalg.norm(force, axis=1)
    for axes in axes_of(load_cases):
        load = np.einsum("nij,ni->nj", axes.directions, force)
        columns = np.einsum("nij,nk->nijk", axes.directions, load).reshape(len(force), 3, 9)
        where = {"world": "the base", "arm plane": "the arm's plane", "tool": "the tool"}.get(
            axes.name, axes.words[0].removeprefix("along ")
        )
        yield Suspect("axes", f"the load in axes of {where}", columns, size, "load [N]")


def _instruments(model: Model, load_cases: LoadCases, predicted: Array) -> Iterator[Suspect]:
    """A load or a displacement that was misread, in the axes of the instrument."""
    J = load_cases.nominal.jacobian
    soft = model.joint_stiffness()
    C = (J[:, :3] / soft) @ np.swapaxes(J[:, :3], 1, 2)  # infinite where rigid: no part
    R = load_cases.rotation
    force = np.einsum("nij,ni->nj", R, load_cases.wrench[:, :3])
    size = np.linalg.norm(force, axis=1)
    wrong = np.einsum("nij,nk->nijk", R, force).reshape(len(force), 3, 9)
    yield Suspect("instrument", "a misread load in tool axes", C @ wrong, size, "load [N]")
    bias = C @ R
    constant, own = "a constant error of the load in tool axes", ("force_bias",)
    yield Suspect("instrument", constant, bias, size, "load [N]", frees=own)
    length = np.linalg.norm(predicted, axis=1, keepdims=True)
    against = np.stack([predicted, predicted / np.maximum(length, 1e-300)], axis=-1)
    holds = "something that holds the tool against its motion, a hose or a cable"
    yield Suspect("instrument", holds, C @ against, 1e6 * length[:, 0], "displacement [µm]")
    axes = load_cases.reading_axes
    d = np.einsum("nij,ni->nj", axes, predicted)
    columns = np.einsum("nij,nk->nijk", axes, d).reshape(len(d), 3, 9)
    moved = 1e6 * np.linalg.norm(d, axis=1)
    label = "displacement [µm]"
    yield Suspect("instrument", "a misread displacement in reading axes", columns, moved, label)


def _series(load_cases: LoadCases) -> Iterator[Suspect]:
    """What goes on whatever the load is: a constant, the order, the time, the branch."""
    axes = load_cases.reading_axes
    size = np.linalg.norm(load_cases.wrench[:, :3], axis=1)
    yield Suspect("series", "a constant that no load changes", axes, size, "load [N]")
    clocks = (
        (load_cases.order, CLOCKS[0], "readings since the zero"),
        (load_cases.time, CLOCKS[1], "time since the zero [s]"),
    )
    for clock, name, label in clocks:
        if clock is not None and np.ptp(clock) > 0.0:
            yield Suspect("series", name, axes * clock[:, None, None], clock, label)
    yield from _comings_and_goings(load_cases)
    if len(np.unique(load_cases.branch)) > 1:
        columns = axes * load_cases.branch[:, None, None]
        name, label = "the branch, loading or unloading", "branch (+1 loading, −1 unloading)"
        yield Suspect("series", name, columns, load_cases.branch, label)


def _comings_and_goings(load_cases: LoadCases) -> Iterator[Suspect]:
    """Readings that wander to and fro as the hours go by: air conditioning, sun, people.

    Waves that fit a whole or a half number of times into the series, slower than two readings.
    """
    timed = load_cases.time is not None
    since, zero = (
        (load_cases.time, load_cases.time_at_zero)
        if timed
        else (load_cases.order, load_cases.order_at_zero)
    )
    if since is None or zero is None:
        return
    clock = np.unique(np.concatenate([zero, zero + since]))
    whole = float(np.ptp(clock))
    most = min(len(clock) // WAVE, MOST_HALF_WAVES)
    for count in range(1, most + 1 if whole > 0.0 else 0):
        pace = np.pi * count / whole
        to_and_fro = np.stack(
            [f(pace * (zero + since)) - f(pace * zero) for f in (np.cos, np.sin)], axis=-1
        )
        columns = np.einsum("nij,nk->nijk", load_cases.reading_axes, to_and_fro)
        period = 2.0 * whole / count
        every = f"{two_digits(period / 60.0)} min" if timed else f"{two_digits(period)} readings"
        name = f"the {'time' if timed else 'order'} of the readings{TO_AND_FRO}{every}"
        label = "time [s]" if timed else "reading"
        columns = columns.reshape(load_cases.count, 3, 6)
        yield Suspect("series", name, columns, zero + since, label, alike=most)


def _turning(name: str, at: LoadCases, origin: Array, about: Array) -> Suspect:
    """A turn about the directions `about` (N, 3, k) through `origin`, under the moment there."""
    screws = at.nominal
    pull = screws.at(at.force_point).position
    moment = np.cross(pull - origin, at.wrench[:, :3]) + at.wrench[:, 3:]
    lever = screws.position - origin
    carried = np.einsum("nik,ni->nk", about, moment)
    columns = np.cross(about, lever[:, :, None], axis=1) * carried[:, None, :]
    return Suspect("place", name, columns, np.linalg.norm(carried, axis=1), "moment there [N·m]")


def _pushing(name: str, at: LoadCases, along: Array) -> Suspect:
    """A shift along the directions `along` (N, 3, k) under the force."""
    carried = np.einsum("nik,ni->nk", along, at.wrench[:, :3])
    columns = along * carried[:, None, :]
    return Suspect("place", name, columns, np.linalg.norm(carried, axis=1), "force there [N]")


def _rotation(load_cases: LoadCases, joint: ArmJoint) -> Array:
    """(N, 3, 3) frame of the link that a joint moves, in base axes."""
    _, first, back = np.unique(load_cases.pose, return_index=True, return_inverse=True)
    placed = load_cases.robot.placement(load_cases.a[first], joint.link)
    return np.asarray(placed[back, :3, :3])


def _frames(load_cases: LoadCases, joint: ArmJoint) -> Array:
    """(N, 3, 3) along the link and two directions across it, as columns, base axes."""
    along, across, other = joint.directions
    return _rotation(load_cases, joint) @ np.stack([along, across, other], axis=-1)


def reach_of(load_cases: LoadCases) -> Array:
    """(N,) distance of the point from the first turning axis, else from the base [m]."""
    out, _ = _from_first_axis(load_cases)
    return np.asarray(np.linalg.norm(out, axis=1))


def _from_first_axis(load_cases: LoadCases) -> tuple[Array, Array | None]:
    """(N, 3) from the first turning axis to the point, square to it; and the axis (N, 3)."""
    screws = load_cases.nominal
    turning = np.flatnonzero(screws.revolute)
    if not len(turning):
        return screws.position, None
    up = screws.axes[:, turning[0]]
    out = screws.position - screws.origins[:, turning[0]]
    return out - up * np.einsum("ni,ni->n", up, out)[:, None], up


def _arm_plane(load_cases: LoadCases) -> Array | None:
    """(N, 3, 3) outwards, sideways and along the first axis; None where there is no such plane."""
    out, up = _from_first_axis(load_cases)
    length = np.linalg.norm(out, axis=1, keepdims=True)
    if up is None or (length < 1e-3).any():
        return None
    out = out / length
    return np.stack([out, np.cross(up, out), up], axis=-1)
