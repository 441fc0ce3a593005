"""A scene: what is to be seen, whatever it was made from and wherever it will be shown.

It may hold a path: where it lies, what was free to be chosen, and where it is weakest.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError
from sk120stiff.robot import Robot
from sk120stiff.show.scene.elastic import Elastic
from sk120stiff.show.scene.links import LinkTree, link_tree
from sk120stiff.show.scene.shapes import Body


@dataclass(frozen=True, eq=False)
class Reading:
    """One load at a pose, with what was measured and what models say.

    Attributes:
        wrench: (6,) force [N] and moment [N·m] at the point, base axes.
        measured: (3,) displacement of the point, base axes [m], or None.
        predicted: Model name → (3,) displacement [m]; the order is before, after, ...
        label: What the reading is called; its number else.
        point: (3,) the point that was read, in the frame of the scene's point [m]; that one else.
        said: What hung there and which marker was read; None: the size of the force says enough.
    """

    wrench: Array
    measured: Array | None = None
    predicted: Mapping[str, Array] = field(default_factory=dict)
    label: str = ""
    point: Array | None = None
    said: str | None = None


@dataclass(frozen=True, eq=False)
class ScenePose:
    """A pose of the list: label, (n,) actuated coordinates [rad or m], readings taken there."""

    label: str
    a: Array
    readings: Sequence[Reading] = ()


@dataclass(frozen=True, eq=False)
class Scene:
    """A robot under load, with poses to visit.

    Attributes:
        robot: The rigid robot.
        elastic: What yields; see `Elastic.of_model`.
        poses: Poses of the list, usually those of the data.
        title, subtitle: Headings of the page; the robot's name by default.
        point: (3,) the point, in the frame that `elastic` ends in [m].
        wrench: (6,) load shown at first; that of the first reading by default, else none.
        a: (n,) pose shown at first; the first of the list by default, else all zero.
        frame: Name of the frame that carries the point; the tool frame by default.
        marks: Link → what acts there: parts of the arm that are coloured and named, such as those
            of the effects that an explanation added.
        surroundings: What stands around the arm or hangs on it, on links of `tree`.
        path: What the tool passes, drawn with the freedom that was searched; None for none.
        positions: What was measured is where the point stands, told from where the last of the
            models has it, and not how far a load moved it.
        listed: What the poses are of, in a word: data, plan.
        robot_argument, model_argument: How a command line names robot and model, for "copy as
            command".
    """

    robot: Robot
    elastic: Elastic
    poses: Sequence[ScenePose] = ()
    title: str = ""
    subtitle: str = ""
    point: Array = field(default_factory=lambda: np.zeros(3))
    wrench: Array | None = None
    a: Array | None = None
    frame: str | None = None
    marks: Mapping[str, str] = field(default_factory=dict)
    surroundings: Sequence[Body] = ()
    path: ScenePath | None = None
    positions: bool = False
    listed: str = "data"
    robot_argument: str = ""
    model_argument: str = ""

    def __post_init__(self) -> None:
        n = self.robot.n
        if self.elastic.mechanism.coupling.n != n:
            raise InputError(f"the springs belong to another robot than {self.robot.name}")
        _check("the point", self.point, 3)
        for what, values, size in (("the load", self.wrench, 6), ("the pose", self.a, n)):
            if values is not None:
                _check(what, values, size)
        unknown = sorted(set(self.marks) - set(self.tree.names))
        if unknown:
            raise InputError(f"{self.robot.name} has no link {unknown[0]!r} to mark")
        for pose in self.poses:
            _check(f"pose {pose.label!r}", pose.a, n)
            for reading in pose.readings:
                _check(f"a load of pose {pose.label!r}", reading.wrench, 6)
                if reading.point is not None:
                    _check(f"the point of pose {pose.label!r}", reading.point, 3)
                shown = [reading.measured, *reading.predicted.values()]
                for values in shown:
                    if values is not None:
                        _check(f"a displacement of pose {pose.label!r}", values, 3)

    @cached_property
    def tree(self) -> LinkTree:
        """All links of the robot."""
        return link_tree(self.robot)

    @property
    def models(self) -> tuple[str, ...]:
        """Names of all models that predict a reading, in order of appearance."""
        return tuple(
            dict.fromkeys(m for pose in self.poses for r in pose.readings for m in r.predicted)
        )

    @property
    def first_pose(self) -> Array:
        """(n,) coordinates to start with, within the limits."""
        if self.a is not None:
            return np.asarray(self.a, dtype=float)
        if self.poses:
            return np.asarray(self.poses[0].a, dtype=float)
        return np.clip(self.robot.rest, self.robot.lower, self.robot.upper)

    @property
    def first_load(self) -> Array:
        """(6,) load to start with."""
        if self.wrench is not None:
            return np.asarray(self.wrench, dtype=float)
        if self.poses and self.poses[0].readings:
            first = 0 if self.positions else -1  # the largest pull comes last
            return np.asarray(self.poses[0].readings[first].wrench, dtype=float)
        return np.zeros(6)

    def _repr_html_(self) -> str:
        from sk120stiff.show.scene.static import notebook_html

        return notebook_html(self)


def _check(what: str, values: object, size: int) -> None:
    array = np.asarray(values, dtype=float)
    if array.shape != (size,):
        raise InputError(f"{what} has shape {array.shape}, not ({size},)")
    if not np.isfinite(array).all():
        raise InputError(f"{what} holds a number that is not finite")


@dataclass(frozen=True, eq=False)
class ScenePath:
    """N points that the tool passes, base axes [m].

    Attributes:
        before, after: (N, 3) as they were given, and as they were placed.
        worst: Number of the point that counts.
        said: What is told at that point.
        mark: What that point is, in the legend.
        stops: Numbers of the points that are marked; every so many where there are none.
        freedom: What was free, in words.
        middle, reach: (3,) middle of the path as given and the half widths by which the middle may
            be moved; None where it may not.
        turns: The tool may turn about its own z axis.
    """

    before: Array
    after: Array
    worst: int
    said: str
    freedom: str
    middle: Array | None = None
    reach: Array | None = None
    turns: bool = False
    mark: str = "its weakest point"
    stops: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        shapes = np.shape(self.before), np.shape(self.after)
        if len(set(shapes)) > 1 or shapes[0][1:] != (3,) or not 0 <= self.worst < shapes[0][0]:
            raise InputError(f"a path of shapes {shapes} with the worst point {self.worst}")

    def payload(self) -> dict[str, Any]:
        """The same in plain containers."""
        box = None
        if self.middle is not None and self.reach is not None and np.any(self.reach):
            box = {"middle": self.middle.tolist(), "reach": self.reach.tolist()}
        return {
            "before": self.before.tolist(),
            "after": self.after.tolist(),
            "moved": bool(np.abs(self.after - self.before).max() > 1e-6),
            "worst": self.worst,
            "said": self.said,
            "mark": self.mark,
            "stops": list(self.stops),
            "freedom": self.freedom,
            "box": box,
            "turns": self.turns,
        }
