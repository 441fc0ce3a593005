"""The best posture against exhaustive search, and the promises about limits and margins."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from sk120stiff.arrays import Mask
from sk120stiff.errors import InputError, Refusal
from sk120stiff.plan import Verdict
from sk120stiff.stiffness import (
    cartesian_compliance,
    complementary_stiffness,
    spring_matrix,
)
from sk120stiff.workspace import (
    ElasticArm,
    PathTask,
    Placement,
    Task,
    best_posture,
    solve_inverse,
    starting_poses,
)
from tests.oracles.numpy_kinematics import rotation
from tests.workspace.arms import sk120

SPRINGS = np.array([1.4e6, 4e5, 9.3e5, 1.2e5, 2.0e5, 8e4])
DOWN = np.array([0.0, 0.0, -1.0])


@cache
def soft_wrist() -> ElasticArm:
    """An SK120 whose wrist yields, measured beside its axis: rotation about it matters."""
    rigid = sk120()
    return replace(
        rigid,
        elastic=replace(
            rigid.elastic,
            compliance=np.diag(1.0 / SPRINGS),
            point=np.array([0.15, 0.0, 0.2]),
        ),
    )


def compliances(arm: ElasticArm, a: np.ndarray, wrench: np.ndarray) -> np.ndarray:
    screws = arm.elastic.mechanism.screws(a, arm.elastic.point)
    K = spring_matrix(SPRINGS) - complementary_stiffness(screws, wrench)
    return cartesian_compliance(screws.jacobian, K)


def all_postures(arm: ElasticArm, position: np.ndarray, steps: int) -> np.ndarray:
    """Postures with the tool down at a position, for many angles about it and all branches."""
    found = []
    base = rotation([1, 0, 0], np.pi)
    for angle in np.linspace(-np.pi, np.pi, steps, endpoint=False):
        goal = rotation([0, 0, 1], angle) @ base
        starts = starting_poses(arm, 24, np.zeros(arm.n))
        task = Task(np.tile(position, (len(starts), 1)), rotation=goal)
        tried = solve_inverse(arm, task, starts)
        found.append(tried.a[tried.found])
    return np.concatenate(found)


@pytest.mark.parametrize("kind", ["direction", "softest", "deflection"])
def test_no_exhaustive_search_finds_a_better_one(kind: str) -> None:
    arm, position = soft_wrist(), np.array([1.5, 0.3, 0.2])
    wrench = np.array([200.0, -300.0, 400.0, 30.0, 10.0, -20.0])
    direction = np.array([0.6, 0.8, 0.0])
    grid = all_postures(arm, position, 48)
    C = compliances(arm, grid, wrench)
    objective = {
        "direction": np.einsum("i,kij,j->k", direction, C[:, :3, :3], direction),
        "softest": np.linalg.eigvalsh(0.5 * (C + np.swapaxes(C, 1, 2))[:, :3, :3])[:, -1],
        "deflection": np.linalg.norm((C @ wrench)[:, :3], axis=1),
    }[kind]
    condition = np.array(
        [c[-1] / c[0] for c in np.linalg.svd(_linear(arm, grid), compute_uv=False)]
    )
    allowed = condition >= 0.02
    best = best_posture(
        arm,
        PathTask(
            position[None],
            axis=DOWN,
            wrench=wrench,
            direction=direction if kind == "direction" else None,
        ),
        minimise="deflection" if kind == "deflection" else "compliance",
    )
    assert objective[allowed].max() > 1.1 * best.objective  # there is something to gain
    assert best.objective <= objective[allowed].min() * (1.0 + 1e-9)
    assert best.objective >= objective[allowed].min() * 0.97  # and the grid comes near
    there = arm.kinematics(best.a)
    np.testing.assert_allclose(there.position[0], position, atol=1e-8)
    np.testing.assert_allclose(there.rotation[0, :, 2], DOWN, atol=1e-8)
    assert arm.within_limits(best.a).all()
    assert best.condition[0] >= 0.02
    assert best.admissible[0] >= best.objective
    again = compliances(arm, best.a, wrench)[0]
    expected = {
        "direction": direction @ again[:3, :3] @ direction,
        "softest": np.linalg.eigvalsh(0.5 * (again + again.T)[:3, :3])[-1],
        "deflection": np.linalg.norm((again @ wrench)[:3]),
    }[kind]
    assert best.objective == pytest.approx(expected, rel=1e-9)


def _linear(arm: ElasticArm, a: np.ndarray) -> np.ndarray:
    return arm.elastic.mechanism.screws(a, arm.elastic.point).linear_jacobian


def test_the_part_is_put_where_it_serves_best() -> None:
    arm = soft_wrist()
    path = PathTask(
        np.linspace([1.5, -0.2, 0.2], [1.5, 0.2, 0.2], 5),
        axis=DOWN,
        wrench=np.array([0.0, 0.0, 500.0, 0.0, 0.0, 0.0]),
    )
    fixed = best_posture(arm, path, minimise="deflection", rounds=30)
    placement = Placement(
        np.array([1.5, 0.0, 0.2]),
        np.array([-0.4, 0.0, -0.3, 0.0, 0.0, 0.0]),
        np.array([0.4, 0.0, 0.3, 0.0, 0.0, 0.0]),
    )
    moved = best_posture(arm, path, minimise="deflection", placement=placement)
    assert moved.objective < 0.9 * fixed.objective
    assert (moved.placement >= placement.lower).all()
    assert (moved.placement <= placement.upper).all()
    there = arm.kinematics(moved.a)
    np.testing.assert_allclose(
        there.position, path.position + moved.placement[:3], atol=1e-8
    )  # nothing else was free
    # a grid over the placement, with the postures' own freedom searched at each point of it
    best = min(
        best_posture(
            arm,
            replace(path, position=path.position + np.array([x, 0.0, z])),
            minimise="deflection",
            starts=64,
            rounds=15,
        ).objective
        for x in (-0.4, -0.2)
        for z in (-0.3, -0.1, 0.1, 0.3)
    )
    assert moved.objective <= best * (1.0 + 1e-6)


def test_a_path_stays_in_one_branch_and_keeps_its_margins() -> None:
    arm = soft_wrist()
    path = PathTask(np.linspace([1.4, -0.5, 0.3], [1.4, 0.5, 0.3], 15), axis=DOWN)
    best = best_posture(
        arm, path, limit_margin=0.2, singularity_margin=0.1, largest_step=0.3, rounds=20
    )
    assert np.abs(np.diff(best.a, axis=0)).max() <= 0.3
    assert best.limit_margin >= -1e-12
    assert (best.a >= arm.lower + 0.2).all()
    assert (best.a <= arm.upper - 0.2).all()
    assert best.condition.min() >= 0.1
    assert best.objective == pytest.approx(best.per_point.max(), rel=1e-9)


@pytest.mark.filterwarnings("error")
def test_a_joint_without_limits_turns_on_past_half_a_turn() -> None:
    """Behind the arm, where joint 1 passes 180°, the path goes on as it does in front."""
    given = soft_wrist()
    free = np.array([np.inf, *5 * [0.0]])
    arm = replace(given, lower=given.lower - free, upper=given.upper + free)
    line = np.linspace([1.4, -0.2, 0.3], [1.4, 0.2, 0.3], 5)
    front, back = (
        best_posture(arm, PathTask(side * line, axis=DOWN), starts=32, rounds=3)
        for side in (1.0, np.array([-1.0, 1.0, 1.0]))
    )
    assert np.abs(np.diff(back.a, axis=0)).max() < 0.2
    assert back.objective == pytest.approx(front.objective, rel=0.2)


def test_of_whole_turns_the_one_farthest_from_the_limits_is_given() -> None:
    given = soft_wrist()
    wide = 2.0 * np.pi
    arm = replace(given, lower=np.full(6, -wide), upper=np.full(6, wide))
    path = PathTask(np.linspace([1.4, -0.2, 0.3], [1.4, 0.2, 0.3], 3), axis=DOWN)
    for seed in range(3):
        best = best_posture(arm, path, starts=32, rounds=3, seed=seed)
        middle = 0.5 * (best.a.min(axis=0) + best.a.max(axis=0))
        assert np.abs(middle).max() <= np.pi + 1e-9
        there = arm.kinematics(best.a)
        np.testing.assert_allclose(there.position, path.position, atol=1e-8)


def test_seeds_decide_everything() -> None:
    path = PathTask(np.array([[1.5, 0.1, 0.2]]), axis=DOWN)
    one, two = (best_posture(soft_wrist(), path, rounds=5, seed=4) for _ in range(2))
    np.testing.assert_array_equal(one.a, two.a)


def test_what_cannot_be_is_refused() -> None:
    arm = soft_wrist()
    with pytest.raises(Refusal, match="point 1 cannot be reached: no posture"):
        best_posture(arm, PathTask(np.array([[9.0, 0.0, 0.0]])), rounds=1)
    with pytest.raises(Refusal, match="singular"):
        best_posture(arm, PathTask(np.array([[1.5, 0.0, 0.2]])), singularity_margin=0.99, rounds=1)
    with pytest.raises(InputError, match="without a load"):
        best_posture(arm, PathTask(np.array([[1.5, 0.0, 0.2]])), minimise="deflection")
    with pytest.raises(InputError, match="cannot be minimised"):
        best_posture(arm, PathTask(np.array([[1.5, 0.0, 0.2]])), minimise="weight")


def test_a_posture_that_is_not_admitted_is_not_chosen() -> None:
    """What cannot stand is left, whatever it would gain; where nothing can, that is said."""
    arm, path = soft_wrist(), PathTask(np.array([[1.5, 0.3, 0.2]]), axis=DOWN)
    free = best_posture(arm, path, rounds=5, starts=64)
    first = float(free.a[0, 5])

    def only(ok: Mask) -> Verdict:
        return Verdict(ok, ((~ok, lambda _: "it hits the crate"),))

    kept = best_posture(
        arm, path, rounds=5, starts=64, admits=lambda a, _: only(np.abs(a[:, 5] - first) > 0.3)
    )
    assert np.abs(kept.a[:, 5] - first).min() > 0.3 and kept.objective >= 0.999 * free.objective
    with pytest.raises(Refusal, match="hits the crate"):
        best_posture(arm, path, starts=32, admits=lambda a, _: only(np.zeros(len(a), dtype=bool)))
