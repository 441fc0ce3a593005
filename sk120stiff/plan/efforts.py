"""What an arm's motors hold, beside its own weight, as far as the URDF states it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.errors import Refusal
from sk120stiff.plan.cell import Cell
from sk120stiff.robot import Robot

PLACEHOLDER = 0.5  # share of poses whose weight alone is too much: then no such motors are built in


@dataclass(frozen=True, eq=False)
class Held:
    """Loads that the motors can hold.

    Attributes:
        rows: Those of the candidates that remain.
        wrench: (K, 6) their loads, scaled down where need be [N, N·m].
        remarks: What was done, in sentences.
    """

    rows: Index
    wrench: Array
    remarks: tuple[str, ...]


def held_loads_of(robot: Robot, cell: Cell, a: Array, wrench: Array, point: Array) -> Held:
    """Scale loads (N, 6) at poses (N, n) to what the motors hold and to the steps of the rig.

    Raises:
        Refusal: The motors cannot hold the arm's weight at any of the poses.
    """
    share = _holdable_share(robot, a, wrench, point, cell.effort_share * robot.efforts)
    fallen = share == 0.0
    _refuse_placeholders(robot, fallen)
    size = np.linalg.norm(wrench[:, :3], axis=1)
    # Rounded down to three digits: a scale that is set by hand, and never above what is allowed.
    digit = 10.0 ** (np.floor(np.log10(np.maximum(share * size, 1e-300))) - 2)
    kept = np.where(share < 1.0, np.floor(share * size / digit) * digit, size)
    kept = cell.rig.step_below(kept)
    rows = np.flatnonzero(~fallen & (kept > 0.0))
    scaled = wrench[rows] * (kept[rows] / size[rows])[:, None]
    remarks = []
    largest = rows[np.isclose(size[rows], size[rows].max(initial=0.0))]
    if (share[largest] < 1.0).any():
        asked, sizes = size[largest].max(), kept[largest]
        remarks.append(
            f"Of {asked:.3g} N the motors hold {sizes.min():.3g} to {sizes.max():.3g} N, "
            f"as the pose allows: no joint gives more than {100 * cell.effort_share:.0f} % of its "
            "effort in the URDF, the arm's weight included."
        )
    return Held(rows, scaled, tuple(remarks))


def poses_held(robot: Robot, cell: Cell, a: Array, mass: Array, point: Array) -> Mask:
    """(N,) poses (N, n) at which motors hold the arm and masses (N,) [kg] at a point of the tool.

    Raises:
        Refusal: The motors cannot hold the arm's weight at most of the poses.
    """
    wrench = np.zeros((len(a), 6))
    wrench[:, :3] = mass[:, None] * robot.gravity_in_base
    share = _holdable_share(robot, a, wrench, point, cell.effort_share * robot.efforts)
    _refuse_placeholders(robot, share == 0.0)
    return np.asarray(share >= 1.0)


def _refuse_placeholders(robot: Robot, fallen: Mask) -> None:
    """Raise a `Refusal` where motors could not hold the arm itself at most of the poses."""
    if fallen.mean() > PLACEHOLDER:
        raise Refusal(
            f"at {100 * fallen.mean():.0f} % of the poses the efforts of the URDF cannot even hold "
            "the arm's own weight",
            where=robot.name,
            remedy='Correct effort or masses in the URDF; effort="0" says that it is not known.',
        )


def weight_torques(robot: Robot, a: Array) -> Array:
    """(N, n) torques of the arm's own weight at poses (N, n) [N·m or N]; zero without masses."""
    if robot.total_mass == 0.0:
        return np.zeros_like(a)
    unique, back = np.unique(a, axis=0, return_inverse=True)
    return robot.gravity_torque(unique)[back.reshape(-1)]


def _holdable_share(robot: Robot, a: Array, wrench: Array, point: Array, efforts: Array) -> Array:
    """(N,) largest factor on the loads, at most one, that the motors hold beside the arm's weight.

    Zero where the weight alone is too much.
    """
    load, weight = robot.screws(a, point=point).torques(wrench), weight_torques(robot, a)
    room = np.where(load > 0.0, efforts - weight, efforts + weight)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(np.abs(load) > 0.0, room / np.abs(load), np.inf)
    share = np.where(np.abs(weight) > efforts, 0.0, share)
    return np.asarray(np.clip(share.min(axis=1), 0.0, 1.0))


def unknown_efforts(robot: Robot) -> list[str]:
    """What of efforts and masses nobody stated, in sentences."""
    known = np.isfinite(robot.efforts)
    if not known.any():
        return ["The URDF states no efforts: that the motors can hold these loads was not checked."]
    said = []
    if not known.all():
        names = ", ".join(np.array(robot.actuated)[~known])
        said.append(f"The URDF states no effort of {names}: not checked there.")
    if robot.total_mass == 0.0:
        said.append("The URDF states no masses: the arm's own weight is not counted.")
    return said
