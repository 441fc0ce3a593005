"""What `map` says of the postures it chose over positions: elbows, and joints below the base."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from sk120stiff.errors import warn
from sk120stiff.robot import Robot
from sk120stiff.workspace import elbow_sides, joint_heights, open_map


def postures(robot: Robot, store: Path, *, led: bool) -> tuple[dict[str, object], str]:
    """How many points have the elbow up or down, and the lowest joint; the same in a sentence.

    Args:
        robot: The robot.
        store: A finished map over positions.
        led: Was the arm led from a start pose?

    Warns:
        ToolkitWarning: At some points a joint lies below the base plane and below the point itself.
    """
    dataset = open_map(store)
    joints = np.asarray(dataset["joints"].values).reshape(-1, robot.n)
    order = [str(name) for name in dataset["joints"].dims[:-1]]
    z = np.asarray(dataset["z"].values)
    heights = np.moveaxis(
        np.broadcast_to(z, [*(dataset.sizes[n] for n in order if n != "z"), len(z)]),
        -1,
        order.index("z"),
    ).ravel()
    reached = np.isfinite(joints).all(axis=1)
    if not reached.any():
        return {"elbow_up": 0, "elbow_down": 0}, "No point was reached."
    sides = elbow_sides(robot, joints[reached])
    low = joint_heights(robot, joints[reached])
    deepest = low.min(axis=1)
    sunk = int((deepest < np.minimum(0.0, heights[reached]) - 1e-9).sum())
    names = robot.mechanism().chain.names[1:]
    name = names[int(np.unravel_index(int(np.argmin(low)), low.shape)[1])]
    found: dict[str, object] = {
        "elbow_up": int((sides > 0).sum()),
        "elbow_down": int((sides < 0).sum()),
        "lowest_joint": name,
        "lowest_m": float(low.min()),
        "below_base_and_point": sunk,
    }
    if sunk:
        warn(
            f"at {sunk} points a joint lies below the base plane and below the point itself "
            f"({name} down to {1e3 * low.min():.0f} mm): choose the branch with --start"
        )
    how = "the branch of the start pose" if led else "at each point the stiffest branch found"
    text = (
        f"Postures, {how}: elbow up at {found['elbow_up']} points, down at "
        f"{found['elbow_down']}; lowest joint {name}, {1e3 * low.min():.0f} mm."
    )
    return found, text
