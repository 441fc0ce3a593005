"""The quantities of a map at a stretch of a grid's points."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError
from sk120stiff.stiffness import CLASSES
from sk120stiff.workspace.arm import BENDING, ElasticArm
from sk120stiff.workspace.bending import Bending
from sk120stiff.workspace.grid import Grid
from sk120stiff.workspace.inverse import Task, lead_straight, solve_inverse, starting_poses

Numbers = NDArray[Any]

#: Why a point has values or not.
STATUS = (
    "reached",
    "out of reach",
    "within reach, but not with this orientation",
    "only beyond the joint limits",
    "a closed loop cannot be closed",
    "not on the straight way from the start pose",
)
REACHED, OUT_OF_REACH, WRONG_ORIENTATION, BEYOND_LIMITS, OPEN_LOOP, NOT_FROM_START = range(6)
UNKNOWN_CLASS = 255  # class of a point that was not reached


@dataclass(frozen=True)
class Variable:
    """One variable of a map.

    Attributes:
        name, unit, meaning: For people.
        per_load: One value for every load.
        kind: NumPy type as it is stored.
        extra: Further dimension and its labels.
        labels: Meaning of the values of a whole number.
    """

    name: str
    unit: str
    meaning: str
    per_load: bool = True
    kind: str = "f4"
    extra: tuple[str, tuple[str, ...]] | None = None
    labels: tuple[str, ...] = ()


_AXES = ("axis", ("x", "y", "z"))
STIFFNESS = (
    Variable("minimum_stiffness", "N/m", "smallest principal stiffness; negative: unstable"),
    Variable("maximum_stiffness", "N/m", "largest principal stiffness; infinite: rigid"),
    Variable("mean_stiffness", "N/m", "3 over the trace of the compliance"),
    Variable("critical_load_factor", "1", "factor on the load at which stability is lost"),
    Variable("stability", "", "definiteness of K_theta - K_C", kind="u1", labels=CLASSES),
    Variable("K_C_definiteness", "", "definiteness of K_C", kind="u1", labels=CLASSES),
)
CONDITIONING = Variable(
    "conditioning", "1", "smallest over largest singular value of the position Jacobian", False
)
DIRECTIONS = (
    Variable("softest_direction", "1", "unit vector, base axes", extra=_AXES),
    Variable("stiffest_direction", "1", "unit vector, base axes", extra=_AXES),
)
DEFLECTION = (
    Variable(
        "deflection", "m", "under the load, base axes: one step with the enhanced stiffness",
        extra=_AXES,
    ),
    Variable("deflection_length", "m", "length of the deflection"),
)  # fmt: skip
STD_PARAMETERS = Variable(
    "deflection_std_parameters",
    "m",
    "standard uncertainty of the length from that of the parameters; infinite: unknown",
)
STD_REMAINDER = Variable(
    "deflection_std_remainder", "m", "standard size of what the model leaves unexplained, along it"
)
STATUS_VARIABLE = Variable("status", "", "was the point reached", False, "u1", labels=STATUS)


@dataclass(frozen=True, eq=False)
class JointGrid:
    """A grid whose axes are joints.

    Attributes:
        grid: Its axes are named as the joints.
        rest: (n,) coordinates of the joints that are no axis [rad or m].
    """

    grid: Grid
    rest: Array
    cartesian: bool = field(default=False, init=False)

    def poses(self, arm: ElasticArm, begin: int, end: int) -> tuple[Array, NDArray[np.uint8]]:
        """(N, n) joint coordinates of a stretch of points, and (N,) status of each."""
        a = np.tile(self.rest, (end - begin, 1))
        columns = [arm.joints.index(axis.name) for axis in self.grid.axes]
        a[:, columns] = self.grid.points(begin, end)
        closes = arm.closes(a)
        a[~closes] = a[closes][:1] if closes.any() else 0.0  # not looked at, but it must close
        return a, np.where(closes, REACHED, OPEN_LOOP).astype(np.uint8)


@dataclass(frozen=True, eq=False)
class PositionGrid:
    """A grid whose axes are x, y and z of the point, in base axes.

    Of the postures that reach a point, the one with the largest minimum stiffness counts: another
    branch of the arm from point to point. With a start, the one to which it leads along a straight
    line counts.

    Attributes:
        grid: Axes x, y, z.
        rest: (n,) first start of the search [rad or m].
        axis, rotation: Wanted orientation of the tool, see `Task`.
        starts: Number of poses from which postures are searched.
        start: (n,) coordinates whose branch the arm stays in [rad or m].
    """

    grid: Grid
    rest: Array
    axis: Array | None = None
    rotation: Array | None = None
    starts: int = 12
    start: Array | None = None
    cartesian: bool = field(default=True, init=False)

    def poses(self, arm: ElasticArm, begin: int, end: int) -> tuple[Array, NDArray[np.uint8]]:
        """(N, n) joint coordinates of a stretch of points, and (N,) status of each."""
        if arm.has_loops:
            raise InputError(
                "postures of an arm with closed loops are not searched",
                where=arm.name,
                remedy="Give a grid over joints.",
            )
        task = Task(self._positions(begin, end), self.axis, self.rotation)
        if self.start is not None:
            led = lead_straight(arm, task, self.start)
            return led.a, np.where(led.found, REACHED, NOT_FROM_START).astype(np.uint8)
        starts = starting_poses(arm, self.starts, self.rest)
        best = np.tile(self.rest, (task.count, 1))
        stiffest = np.full(task.count, -np.inf)
        found = np.zeros(task.count, dtype=bool)
        for start in starts:
            tried = solve_inverse(arm, task, np.tile(start, (task.count, 1)))
            met = np.flatnonzero(tried.found)
            if not len(met):
                continue
            values = arm.batch(tried.a[met], np.zeros(6), ("values",)).of("values")
            softest = values.min(axis=1)
            better = ~found[met] | (softest > stiffest[met])
            best[met[better]], stiffest[met[better]] = tried.a[met[better]], softest[better]
            found[met] = True
        status = np.where(found, REACHED, OUT_OF_REACH).astype(np.uint8)
        missing = np.flatnonzero(~found)
        if len(missing):
            status[missing] = self._reason(arm, task.rows(missing), starts[:4])
        return best, status

    def _positions(self, begin: int, end: int) -> Array:
        order = [[axis.name for axis in self.grid.axes].index(name) for name in ("x", "y", "z")]
        return self.grid.points(begin, end)[:, order]

    def _reason(self, arm: ElasticArm, task: Task, starts: Array) -> NDArray[np.uint8]:
        """Why targets were not met: without limits, without orientation, or not at all."""
        status = np.full(task.count, OUT_OF_REACH, dtype=np.uint8)
        anywhere = np.zeros(task.count, dtype=bool)
        turned = np.zeros(task.count, dtype=bool)
        for start in starts:
            many = np.tile(start, (task.count, 1))
            anywhere |= solve_inverse(arm, task, many, limits=False).found
            if task.axis is not None or task.rotation is not None:
                turned |= solve_inverse(arm, Task(task.position), many).found
        status[turned] = WRONG_ORIENTATION
        status[anywhere & ~turned] = BEYOND_LIMITS
        if task.axis is not None or task.rotation is not None:
            status[anywhere & turned] = BEYOND_LIMITS
        return status


@dataclass(frozen=True, eq=False)
class MapJob:
    """Everything that defines a map; it can be sent to another process.

    Attributes:
        arm: The arm and its stiffness.
        points: Grid, and how its points become joint coordinates.
        loads: (Q, 6) forces [N] and moments [N·m] at the point, base axes.
        with_directions: Store principal directions.
    """

    arm: ElasticArm
    points: JointGrid | PositionGrid
    loads: Array
    with_directions: bool = False

    @property
    def bends(self) -> bool:
        """Is there a load to bend the arm?"""
        return bool(np.any(self.loads))

    @property
    def variables(self) -> tuple[Variable, ...]:
        """What is stored."""
        chosen = [*STIFFNESS, CONDITIONING]
        chosen += DIRECTIONS if self.with_directions else ()
        if self.bends:
            uncertainty = self.arm.uncertainty
            chosen += DEFLECTION
            chosen += [] if uncertainty is None else [STD_PARAMETERS]
            chosen += (
                [] if uncertainty is None or uncertainty.remainder is None else [STD_REMAINDER]
            )
        if self.points.cartesian:
            joints = Variable(
                "joints", "rad", "coordinates (m where the joint slides)", False, "f8",
                ("joint", self.arm.joints),
            )  # fmt: skip
            chosen += [STATUS_VARIABLE, joints]
        else:
            chosen += [STATUS_VARIABLE] if self.arm.has_loops else []
        return tuple(chosen)

    @property
    def bytes_per_point(self) -> int:
        """Size of one point in the store, before compression."""
        total = 0
        for variable in self.variables:
            count = len(self.loads) if variable.per_load else 1
            count *= len(variable.extra[1]) if variable.extra else 1
            total += count * np.dtype(variable.kind).itemsize
        return total

    def compute(self, begin: int, end: int, *, threads: int | None = None) -> dict[str, Numbers]:
        """All variables at a stretch of points: (Q, N, …) or (N, …) each."""
        a, status = self.points.poses(self.arm, begin, end)
        want = ["values", "critical", "stiffness_class", "complementary_class", "condition"]
        want += ["directions"] if self.with_directions else []
        want += BENDING if self.bends else []
        found = self.arm.batch(a, self.loads[:, None, :], want, threads=threads)
        values = found.of("values")
        with np.errstate(divide="ignore"):
            mean = 3.0 / (1.0 / values).sum(axis=-1)
        answers: dict[str, Numbers] = {
            "minimum_stiffness": values.min(axis=-1),
            "maximum_stiffness": values.max(axis=-1),
            "mean_stiffness": mean,
            "critical_load_factor": found.of("critical"),
            "stability": found.of("stiffness_class"),
            "K_C_definiteness": found.of("complementary_class"),
            "conditioning": found.of("condition"),
        }
        if self.with_directions:
            answers["softest_direction"] = _along(values.argmin(axis=-1), found.of("directions"))
            answers["stiffest_direction"] = _along(values.argmax(axis=-1), found.of("directions"))
        if self.bends:
            answers |= _deflections(self.arm.bending(a, found, self.loads))
        answers |= {"status": status, "joints": a}
        lost = status != REACHED
        for variable in self.variables:
            array = answers[variable.name].astype(variable.kind, copy=False)
            if lost.any() and variable.name != "status":
                array = array.copy()
                array[(slice(None), lost) if variable.per_load else lost] = (
                    UNKNOWN_CLASS if variable.kind == "u1" else np.nan
                )
            answers[variable.name] = array
        return answers


def _deflections(found: tuple[Bending, ...]) -> dict[str, Numbers]:
    """(Q, N, …) deflections under Q loads, their lengths and ±."""
    every = np.stack([one.deflection for one in found])
    answers: dict[str, Numbers] = {
        "deflection": every,
        "deflection_length": np.linalg.norm(every, axis=-1),
    }
    for name in ("std_parameters", "std_remainder"):
        parts = [getattr(one, name) for one in found]
        if parts[0] is not None:
            answers[f"deflection_{name}"] = np.stack(parts)
    return answers


def _along(which: Numbers, directions: Array) -> Array:
    """(..., 3) the directions (..., 3, 3) of the given number (...)."""
    return np.take_along_axis(directions, which[..., None, None], axis=-2)[..., 0, :]
