"""In which steps the loads of a plan are hung on, and when zero readings are taken."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

import numpy as np

from sk120stiff.errors import InputError
from sk120stiff.measurements import Measurements

Kind = Literal["as-given", "ascending", "up-down"]
Zero = Literal["shared", "separate"]


@dataclass(frozen=True)
class Schedule:
    """How each load of a plan becomes a series of readings.

    Attributes:
        kind: ``"as-given"``: the load alone; ``"ascending"``: in equal steps up to it;
            ``"up-down"``: up to it and back, the way back on the branch ``unload``.
        levels: Number of steps up to the full load.
        repeats: How often each reading is taken.
        zero: ``"shared"``: one zero reading before the loads of a pose; ``"separate"``: one before
            each reading.

    Raises:
        InputError: A number below one, or an unknown word.

    Examples:
        >>> import sk120stiff as sk
        >>> model = sk.base_model(sk.load_robot("motoman_sk120"))
        >>> steps = sk.Schedule("up-down", levels=3)
        >>> made = sk.simulate(model, sk.plan(model, 4), schedule=steps).measurements
        >>> made.n_readings, made.branch[:6]
        (20, ('load', 'load', 'load', 'unload', 'unload', 'load'))
    """

    kind: Kind = "as-given"
    levels: int = 5
    repeats: int = 1
    zero: Zero = "shared"

    def __post_init__(self) -> None:
        if self.kind not in ("as-given", "ascending", "up-down"):
            raise InputError(
                f"there is no schedule {self.kind!r}",
                remedy="It is one of as-given, ascending, up-down.",
            )
        if self.zero not in ("shared", "separate"):
            raise InputError(
                f"a zero reading cannot be {self.zero!r}", remedy="It is shared or separate."
            )
        if self.levels < 1 or self.repeats < 1:
            raise InputError("levels and repeats are counted from 1")


class _Step(NamedTuple):
    row: int
    share: float
    branch: str
    repeat: int
    zero_group: int
    order: float
    zero_order: float


def scheduled(plan: Measurements, schedule: Schedule) -> Measurements:
    """The readings that a plan and a schedule ask for, in the order in which they are taken.

    Masked rows of the plan and rows without load (zero readings are added by themselves) are left
    out, displacements too if there are any.

    Raises:
        InputError: No row has a load, or the plan has branches of its own and the schedule makes
            others.
    """
    kept = plan.use & plan.wrench.any(axis=1)
    if not kept.any():
        raise InputError(
            "no row of the plan has a load",
            where=str(plan.path or "plan"),
            remedy="Write the forces to be applied into fx, fy, fz.",
        )
    if plan.branch is not None and schedule.kind == "up-down":
        raise InputError(
            "the plan has branches of its own, an up-down schedule would make others",
            where=str(plan.path or "plan"),
            remedy="Use the schedule as-given, or drop the column branch.",
        )
    steps = list(_steps(plan, np.flatnonzero(kept), schedule))
    readings = plan.select(np.array([step.row for step in steps]))
    branch = readings.branch
    if schedule.kind == "up-down":
        branch = tuple(step.branch for step in steps)
    repeat = readings.repeat
    if schedule.repeats > 1:
        repeat = np.array([step.repeat for step in steps], dtype=np.int64)
    return replace(
        readings,
        wrench=readings.wrench * np.array([step.share for step in steps])[:, None],
        displacement=None,
        zero=schedule.zero,
        zero_group=np.array([step.zero_group for step in steps], dtype=np.int64),
        zero_count=np.ones(len(steps), dtype=np.int64),
        order=np.array([step.order for step in steps]),
        zero_order=np.array([step.zero_order for step in steps]),
        time=None,
        zero_time=None,
        branch=branch,
        repeat=repeat,
        line=np.zeros(len(steps), dtype=np.int64),
    )


def _steps(plan: Measurements, rows: np.ndarray, schedule: Schedule) -> Iterator[_Step]:
    clock, group, zero_order = 0.0, -1, 0.0
    for pose in dict.fromkeys(plan.pose_index[rows].tolist()):
        first = True
        for row in rows[plan.pose_index[rows] == pose]:
            for share, branch in _levels(schedule):
                for repeat in range(1, schedule.repeats + 1):
                    if first or schedule.zero == "separate":
                        zero_order, first = clock, False
                        clock += 1.0
                        group += 1
                    yield _Step(int(row), share, branch, repeat, group, clock, zero_order)
                    clock += 1.0


def _levels(schedule: Schedule) -> list[tuple[float, str]]:
    if schedule.kind == "as-given":
        return [(1.0, "load")]
    count = schedule.levels
    up = [(k / count, "load") for k in range(1, count + 1)]
    if schedule.kind == "ascending":
        return up
    return up + [(k / count, "unload") for k in range(count - 1, 0, -1)]
