"""What the own weight of an arm whose URDF states no masses may do to positions.

The mass of each link, and its first moment (mass times centre), bend every joint below it by their
torque times the joint's compliance. What nobody stated is of the size of what the arm lifts: a
payload at full reach turns the joints of an arm about as much as its links do.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.identify.positions.solve.pose_problem import PoseProblem
from sk120stiff.robot.rotations import cross_product

ALONG = 0.1  # sine between a joint's axis and the next one, below which they are as good as one


def heaviest_payload(problem: PoseProblem) -> float:
    """Of these readings [kg]; 0 where nothing hangs on the tool."""
    return float(np.abs(problem.said.payload).max(initial=0.0))


def own_weight(problem: PoseProblem, heaviest: float | None = None) -> Array:
    """(M, 4 m) change of each number by the masses of m links and their moments along three
    directions.

    A mass is that of the heaviest payload [kg], by default that of the readings; a moment is that
    mass at the reach beyond the link's joint, stretched out. No columns where the arm's masses are
    stated, nothing hangs on it, or what a load does alone was read.
    """
    robot = problem.model.robot
    none = np.zeros((len(problem.rows), 0))
    heaviest = heaviest_payload(problem) if heaviest is None else heaviest
    weighs = robot.mechanism().chain.weighs
    if weighs or not heaviest or problem.channels.displacements_alone:
        return none
    springs = {
        robot.actuated.index(p.effect.where): p.internal
        for p in problem.model.parameters
        if p.effect.joint_spring
    }
    turned = list(_torques(problem, heaviest))
    if not springs or not turned:
        return none
    joints, c = list(springs), np.array(list(springs.values()))
    slope = problem.by_joints[:, joints] * c  # (M, springs)
    torques = np.stack(turned, axis=-1)[problem.rows][:, joints]  # (M, springs, 4 m)
    return np.asarray(np.einsum("ms,msk->mk", slope, torques))


def _torques(problem: PoseProblem, heaviest: float) -> Iterator[Array]:
    """(N, n) torques on the coordinates by each mass and each moment of each link [N·m or N]."""
    robot, cases = problem.model.robot, problem.load_cases
    screws, weight = robot.screws(cases.a), heaviest * robot.gravity_in_base
    lengths = np.linalg.norm(robot.mechanism().chain.placements[:, :3, 3], axis=1)

    def on_coordinates(on_joints: Array, j: int) -> Array:
        return np.asarray((on_joints[:, None] @ screws.first[..., : j + 1, :])[:, 0])

    for j in range(screws.axes.shape[-2]):
        origins, angular = screws.origins[:, : j + 1], screws.angular[:, : j + 1]
        lever = origins[:, j : j + 1] - origins
        along = np.where(screws.revolute[: j + 1, None], 0.0, screws.axes[:, : j + 1]) @ weight
        about = cross_product(lever, np.broadcast_to(weight, lever.shape))
        yield on_coordinates(along + (angular * about).sum(-1), j)
        reach = float(lengths[j + 1 :].sum())
        for way in _of_link(screws.axes, screws.origins, screws.rotation, j):
            moment = reach * cross_product(way, np.broadcast_to(weight, way.shape))
            yield on_coordinates((angular * moment[:, None]).sum(-1), j)


def _of_link(axes: Array, origins: Array, tool: Array, j: int) -> tuple[Array, Array, Array]:
    """Three unit directions (N, 3) that turn with the link behind joint `j` of a chain."""
    one = axes[:, j]
    if j + 1 < axes.shape[1]:
        others = [axes[:, j + 1], origins[:, j + 1] - origins[:, j]]
    else:
        others = [tool[:, :, k] for k in range(3)]
    across = [other - (other * one).sum(-1, keepdims=True) * one for other in others]
    sizes = [float(np.linalg.norm(each, axis=1).min()) for each in across]
    told = next((k for k, size in enumerate(sizes) if size > ALONG), int(np.argmax(sizes)))
    two = across[told] / np.maximum(np.linalg.norm(across[told], axis=1, keepdims=True), 1e-300)
    return one, two, cross_product(one, two)
