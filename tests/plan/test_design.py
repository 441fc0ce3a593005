"""Chosen readings against exhaustive search, explicit covariances and random choices."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

from sk120stiff.effects import effect, load_case
from sk120stiff.errors import InputError, Refusal
from sk120stiff.identify import fit
from sk120stiff.measurements import NoiseModel
from sk120stiff.plan import (
    Cell,
    Pool,
    d_optimal,
    plan,
    promised,
    random_choice,
    random_pool,
    readings_for_all,
    rivalry,
    signature_columns,
    simulate,
    well_spread,
)
from sk120stiff.plan.design import best_choice, determinant_worth
from tests.plan.conftest import POINT

SIGMA = 10e-6


def small(pool: Pool, count: int) -> Pool:
    return Pool(pool.load_cases.rows(np.arange(count)))


def sensitivities(model, pool: Pool) -> np.ndarray:
    return model.predict_with_sensitivities(pool.load_cases)[1][:, :, model.free]


def test_the_best_of_all_choices(springs, pool) -> None:
    """Fourteen candidates, four to choose: all 1001 choices tried."""
    few = small(pool, 14)
    S = sensitivities(springs, few) / (np.sqrt(2.0) * SIGMA)
    prior = np.diag([1.0 / p.spec.plausible**2 for p in springs.parameters])

    def precision(rows) -> float:
        A = S[list(rows)].reshape(-1, 3)
        return np.linalg.slogdet(A.T @ A + prior)[1]

    best = max(combinations(range(14), 4), key=precision)
    design = d_optimal(springs, few, count=4, sigma=SIGMA)
    assert precision(design.rows) == pytest.approx(precision(best), abs=1e-9)
    assert set(design.rows) == set(best)


def test_expected_errors_are_those_of_least_squares(springs, pool) -> None:
    design = d_optimal(springs, pool, count=6, sigma=SIGMA)
    A = sensitivities(springs, pool)[list(design.rows)].reshape(-1, 3)
    std = np.sqrt(np.diag(np.linalg.inv(A.T @ A))) * np.sqrt(2.0) * SIGMA
    np.testing.assert_allclose(design.std, std, rtol=1e-4)  # the plausible range hardly counts


def test_gain_is_a_ratio_of_errors(springs, pool) -> None:
    design = d_optimal(springs, pool, count=6, sigma=SIGMA)
    other = [0, 1, 2, 3, 4, 5]
    A = sensitivities(springs, pool)[other].reshape(-1, 3)
    covariance = np.linalg.inv(A.T @ A) * 2.0 * SIGMA**2
    B = sensitivities(springs, pool)[list(design.rows)].reshape(-1, 3)
    best = np.linalg.inv(B.T @ B) * 2.0 * SIGMA**2
    ratio = (np.linalg.det(covariance) / np.linalg.det(best)) ** (1 / 6)
    assert design.gain_over(other) == pytest.approx(ratio, rel=1e-3)
    assert design.gain_over(list(design.rows)) == pytest.approx(1.0, abs=1e-12)


def test_a_plan_for_one_parameter_serves_that_one(springs, robot, pool) -> None:
    model = springs + effect(robot, "base_rocking")
    name = "base_rocking:base_link.stiffness_x"
    own = d_optimal(model, pool, count=6, sigma=SIGMA, parameters=[name])
    all_five = d_optimal(model, pool, count=6, sigma=SIGMA)
    k = all_five.parameters.index(name)
    assert own.parameters == (name,)
    assert own.std[0] < all_five.std[k]
    assert own.gain_over(all_five.rows) == pytest.approx(all_five.std[k] / own.std[0], rel=1e-6)


def test_readings_that_exist_count(springs, pool) -> None:
    known = small(pool, 30)
    alone = d_optimal(springs, pool, count=2, sigma=SIGMA)
    with_them = d_optimal(springs, pool, count=2, sigma=SIGMA, known=known)
    assert np.all(with_them.std < alone.std)


def test_it_beats_random_and_spread_poses(springs, robot) -> None:
    candidates = random_pool(robot, poses=200, directions=10, force=400.0, point=POINT, seed=2)
    design = d_optimal(springs, candidates, count=15, sigma=SIGMA)
    rng = np.random.default_rng(0)
    random = [design.gain_over(random_choice(candidates, 15, rng)) for _ in range(30)]
    spread = [design.gain_over(well_spread(candidates, 15, rng)) for _ in range(30)]
    assert np.median(random) > 1.6
    assert np.median(spread) > 1.6
    assert min(*random, *spread) > 1.2


def test_evidence_by_explicit_projection(springs, robot, pool) -> None:
    """λ = ‖M_[B, S_f] u‖² with the plausible ranges as further readings."""
    model = springs + effect(robot, "link_bending", "link_2_l")
    model = model.with_public(**{"link_bending:link_2_l.EI": 8e6})
    bending, tilt = model.effects[-1], effect(robot, "joint_tilt", "joint_2_l")
    columns = signature_columns(model, bending, tilt, pool) / (np.sqrt(2.0) * SIGMA)
    rows, (apart,) = readings_for_all([columns], count=5)
    A = columns[list(rows)].reshape(-1, columns.shape[-1])
    others = np.vstack([A[:, :-1], np.eye(A.shape[1] - 1)])
    u = np.concatenate([A[:, -1], np.zeros(A.shape[1] - 1)])
    left = u - others @ np.linalg.lstsq(others, u, rcond=None)[0]
    assert apart == pytest.approx(np.linalg.norm(left), rel=1e-6)


def test_rivals_are_told_whichever_is_true(springs, robot, pool) -> None:
    bending, tilt = (
        effect(robot, "link_bending", "link_3_u"),
        effect(robot, "joint_tilt", "joint_2_l"),
    )
    rivals = rivalry(springs, bending, tilt, pool, sigma=SIGMA)
    swapped = rivalry(springs, tilt, bending, pool, sigma=SIGMA)
    choice = rivals.best(5)
    assert choice.after == pytest.approx(swapped.evidence_of(choice.rows), rel=1e-6)
    rng = np.random.default_rng(1)
    assert choice.after > 1.5 * np.median(
        [rivals.evidence_of(random_choice(pool, 5, rng)) for _ in range(40)]
    )
    more = rivalry(springs, bending, tilt, pool, sigma=SIGMA, known=small(pool, 60))
    assert more.evidence_of([]) > 0.0
    assert more.evidence_of(choice.rows) > choice.after


def test_what_cannot_be_chosen_is_refused(springs, robot, pool) -> None:
    with pytest.raises(InputError, match="cannot be chosen from 120 candidates"):
        d_optimal(springs, pool, count=121, sigma=SIGMA)
    with pytest.raises(InputError, match="no parameter 'x'"):
        d_optimal(springs, pool, count=3, sigma=SIGMA, parameters=["x"])
    rivals = rivalry(
        springs, effect(robot, "base_rocking"), effect(robot, "base_sliding"), pool, sigma=SIGMA
    )
    with pytest.raises(InputError, match="cannot be chosen"):
        rivals.best(0)


def test_spread_poses_lie_far_apart(robot, pool) -> None:
    rng = np.random.default_rng(0)
    place = (pool.load_cases.a - robot.lower) / (robot.upper - robot.lower)

    def nearest(rows: list[int]) -> float:
        gaps = np.linalg.norm(place[rows][:, None] - place[rows][None], axis=-1)
        return float((gaps + 9.0 * np.eye(len(rows))).min())

    spread = [nearest(well_spread(pool, 8, rng)) for _ in range(10)]
    random = [nearest(random_choice(pool, 8, rng)) for _ in range(10)]
    assert min(spread) > max(random)


def test_regions_are_kept(robot) -> None:
    cell = Cell(floor=-0.5, low=np.array([0.5, -1.0, 0.0]), high=np.array([2.5, 1.0, 1.5]))
    found = random_pool(robot, poses=50, directions=1, force=1.0, point=POINT, cell=cell, seed=4)
    a = found.load_cases.a
    T = robot.placement(a)
    at = T[:, :3, :3] @ POINT + T[:, :3, 3]
    assert np.all((at >= cell.low) & (at <= cell.high))
    for frame in robot.frames:
        assert robot.placement(a, frame)[:, 2, 3].min() >= -0.5 - 1e-9
    assert np.all((a >= robot.lower) & (a <= robot.upper))
    nowhere = Cell(low=np.full(3, 50.0), high=np.full(3, 51.0))
    with pytest.raises(Refusal, match="only 0 of"):
        random_pool(robot, poses=5, directions=1, force=1.0, point=POINT, cell=nowhere)
    with pytest.raises(InputError, match="no inside"):
        Cell(low=np.ones(3), high=np.zeros(3))


def test_coupled_joints_keep_their_limits(tmp_path) -> None:
    from sk120stiff.robot import load_robot

    (tmp_path / "arm.urdf").write_text(
        """<robot name="arm"><link name="a"/><link name="b"/><link name="c"/>
        <joint name="one" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/>
        <limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
        <joint name="two" type="revolute"><parent link="b"/><child link="c"/>
        <origin xyz="1 0 0"/><axis xyz="0 0 1"/><mimic joint="one" multiplier="-1"/>
        <limit lower="-0.5" upper="0.5" effort="1" velocity="1"/></joint></robot>""",
        encoding="utf-8",
    )
    robot = load_robot(str(tmp_path / "arm.urdf"))
    found = random_pool(robot, poses=40, directions=1, force=1.0, point=np.zeros(3), cell=Cell())
    assert np.abs(found.load_cases.a).max() <= 0.5 + 1e-9


def test_pools_hold_loads_of_one_size(robot, pool) -> None:
    np.testing.assert_allclose(np.linalg.norm(pool.load_cases.wrench[:, :3], axis=1), 400.0)
    assert pool.count == 120
    again = load_case(robot, pool.load_cases.a, pool.load_cases.wrench, point=POINT)
    np.testing.assert_array_equal(again.a, pool.load_cases.a)


def test_exchanges_mend_what_greed_took() -> None:
    """Small random problems: never worse than greedy, nearly always the best of all choices."""
    worth = determinant_worth(np.arange(2))
    better = best = 0
    for seed in range(40):
        A = np.random.default_rng(seed).normal(size=(9, 1, 2))
        gains, known = np.einsum("mik,mil->mkl", A, A), 1e-3 * np.eye(2)
        total, greedy = known.copy(), []
        for _ in range(3):
            found = worth(total + gains)
            found[greedy] = -np.inf
            greedy.append(int(np.argmax(found)))
            total = total + gains[greedy[-1]]

        def value(rows, gains=gains, known=known) -> float:
            return float(worth((known + gains[list(rows)].sum(axis=0))[None])[0])

        reached = value(best_choice(worth, gains, known, 3))
        assert reached >= value(greedy) - 1e-12
        better += reached > value(greedy) + 1e-9
        best += reached >= max(map(value, combinations(range(9), 3))) - 1e-9
    assert better >= 1
    assert best >= 36


def test_a_count_is_of_poses_and_each_has_its_loads(robot, springs) -> None:
    made = plan(springs, 5, loads=2, point=POINT, force=400.0)
    assert len(made.poses) == 5 and made.n_readings == 10
    assert len(np.unique(made.joints, axis=0)) == 5
    with pytest.raises(InputError, match="13 loads"):
        plan(springs, 2, loads=13, point=POINT)


def test_what_is_promised_is_the_error_of_the_fit(springs) -> None:
    """Rows that share a zero reading are not worth what as many are that do not."""
    made = plan(springs, 4, loads=3, point=POINT, force=400.0)
    alone = promised(springs, replace(made, zero="separate"), SIGMA)
    shared = promised(springs, made, SIGMA)
    assert (np.abs(shared / alone - 1.0) > 0.02).all()
    noise = NoiseModel(SIGMA, zero="shared")
    read = simulate(springs, made, noise=noise, seed=1).measurements
    found = fit(springs, read, noise=noise)
    errors = np.sqrt(np.diag(found.covariance)) * found.problem.scale
    np.testing.assert_allclose(shared, errors, rtol=0.02)
