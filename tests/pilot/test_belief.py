"""Evidence against densities, expected information against Monte Carlo, and campaigns that end."""

from collections.abc import Sequence
from functools import cache
from itertools import product

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from sk120stiff.explain.candidates.sums import sums_of
from sk120stiff.model import base_model
from sk120stiff.pilot.belief import NOTHING, SIZES, TWO, Belief
from sk120stiff.pilot.campaign import Campaign
from sk120stiff.pilot.choosing import best, expected
from sk120stiff.plan import Cell, Rig, feasible_pool
from sk120stiff.robot import load_robot
from tests.pilot.simulated import SIGMA, Bench, campaigns


@cache
def bench() -> Bench:
    return Bench.of("motoman_sk120", poses=40, directions=4)


def index(made: Campaign, name: str) -> int:
    """Position of a candidate ``name:where``."""
    return [effect.id for effect in made.linear.effects].index(name)


def belief_after(
    rows: int, seed: int = 0, truth: str = "link_bending:link_2_l", size: float = 2.0
) -> Belief:
    """Readings drawn from the linear map itself, whitened."""
    made = bench().campaign
    rng = np.random.default_rng(seed)
    X = made.X[rng.choice(len(made.X), rows, replace=False)].reshape(-1, made.X.shape[2])
    own = made.linear.columns[index(made, truth)]
    y = X[:, own] @ np.full(len(own), size) + rng.normal(size=len(X))
    return Belief(made.linear, sums_of(X, y))


def test_the_evidence_is_the_density_of_the_readings() -> None:
    """Of hypotheses without compliances, whose densities are Gaussian mixtures."""
    made = bench().campaign
    rng = np.random.default_rng(3)
    X = made.X[rng.choice(len(made.X), 6, replace=False)].reshape(-1, made.X.shape[2])
    y = rng.normal(size=len(X))
    belief = Belief(made.linear, sums_of(X, y))
    near, wide = (X[:, made.linear.base] * spread for spread in made.linear.spread)

    def density(columns: np.ndarray, sizes: Sequence[float] = SIZES) -> float:
        each = []
        for B, size in product((near, wide), sizes):
            S = np.eye(len(y)) + B @ B.T + size**2 * X[:, columns] @ X[:, columns].T
            each.append(-0.5 * float(y @ np.linalg.solve(S, y) + np.linalg.slogdet(S)[1]))
        return float(np.logaddexp.reduce(each) - np.log(len(each)))

    nothing = density(np.zeros(0, dtype=int), (1.0,)) + np.log(NOTHING)
    found = {h.members: h.log_weight for h in belief.hypotheses}
    count = len(made.linear.effects)
    for name in ("force_rotation:sensor", "force_crosstalk:sensor"):
        e = index(made, name)
        prior = np.log((1 - NOTHING) * (1 - TWO))
        share = prior - np.log(count)  # but for effects that are met less often
        ours = found[(e,)] - found[()]
        theirs = density(made.linear.columns[e]) + share - nothing
        assert ours == pytest.approx(theirs, abs=0.2)  # what joint_tilt leaves to the others
    pair = [index(made, n) for n in ("force_rotation:sensor", "force_crosstalk:sensor")]
    difference = found[(pair[0],)] - found[(pair[1],)]
    exact = density(made.linear.columns[pair[0]]) - density(made.linear.columns[pair[1]])
    assert difference == pytest.approx(exact, abs=1e-4)


def test_expected_information_is_a_lower_bound_that_comes_near() -> None:
    """Of what a reading says about names, against draws from the predictions."""
    belief = belief_after(5)
    made = bench().campaign
    X = made.X[::37]
    bound = expected(belief, X).names
    rows = belief.likely(14)
    rng = np.random.default_rng(0)
    p = np.array([w for w, _ in rows])
    for k in np.argsort(bound)[-3:]:
        densities = []
        for _, h in rows:
            own = X[k][:, h.columns]
            S = np.eye(3) + own @ h.covariance @ own.T
            densities.append(multivariate_normal(own @ h.mean, S))
        information = 0.0
        for weight, own in zip(p, densities, strict=True):
            y = own.rvs(4000, random_state=rng)
            mixture = sum(w * d.pdf(y) for w, d in zip(p, densities, strict=True))
            information += weight * float(np.mean(np.log(own.pdf(y) / mixture)))
        assert 0.2 * information < bound[k] < information + 0.02


def test_between_two_names_that_are_left_a_reading_tells_names_not_sizes() -> None:
    """Where one reading tells little, those that tell springs a little better are not taken."""
    made = bench().campaign
    belief = belief_after(8, truth="joint_tilt:joint_2_l", size=1.0)
    first, second = list(belief.probabilities.values())[:2]
    assert 0.05 < second < first < 0.95
    row, found = best(belief, made.X, np.ones(len(made.X), dtype=bool)), expected(belief, made.X)
    assert found.names[row] > 0.9 * found.names.max()
    assert found.sizes[row] < found.sizes.max()


def test_springs_of_a_model_count_and_may_be_wrong_all_the_same() -> None:
    """One number says whether the model is a good one; where it is not, its springs are free."""
    made = bench().campaign
    base = made.linear.base
    values = made.linear.model.values[base] / made.linear.scale[base]
    rng, shown = np.random.default_rng(1), np.abs(made.X[:, 0, base] @ values)
    for times, near in ((1.2, True), (30.0, False)):
        X = made.X[np.argmax(shown), :1]
        y = X[:, base] @ ((times - 1.0) * values) + rng.normal(size=len(X))
        belief = Belief(made.linear, sums_of(X, y))
        (nothing,) = (h for h in belief.hypotheses if not h.members)
        std = np.sqrt(np.diag(nothing.covariance))
        assert bool(std.max() < 0.05 * made.linear.spread[-1].max()) is near


def test_probabilities_gather_on_the_truth() -> None:
    before, after = belief_after(3).probabilities, belief_after(25).probabilities
    assert after["link_bending:link_2_l"] > 0.95 > before.get("link_bending:link_2_l", 0.0)
    assert after["none"] < 0.01


def test_a_campaign_finds_a_hidden_cause_sooner_than_chance() -> None:
    """The truth is the exact nonlinear model."""
    pilot, random = campaigns(bench(), 2, ask=False, policies=("pilot", "random"))
    assert pilot.truth != "none" and pilot.right and pilot.reason == "named"
    assert pilot.count <= random.count


def test_what_no_reading_separates_is_called_hopeless() -> None:
    """Loaded straight down alone, a base that rocks is not told from what sags like it."""
    made = bench().campaign
    robot, point = made.model.robot, made.pool.load_cases.point
    down = Cell(rig=Rig("a weight", directions=np.array([[0.0, 0.0, -1.0]])))
    pool = feasible_pool(robot, poses=30, directions=1, force=400.0, point=point, cell=down)
    campaign = Campaign.of(made.model, pool, SIGMA, most=40)
    names = [effect.id for effect in campaign.linear.effects]
    e = names.index("base_rocking:base_link")
    X = campaign.X.reshape(-1, campaign.X.shape[2])
    own = campaign.linear.columns[e]
    y = X[:, own] @ np.full(len(own), 3.0) + np.random.default_rng(0).normal(size=len(X))
    belief = Belief(campaign.linear, sums_of(X, y))
    stop = campaign._stop(belief, None)
    assert stop is not None
    meant = {part for name in stop.names for part in name.split(" with ")}
    assert "base_rocking:base_link" in meant
    if stop.reason == "class":
        assert "would" in stop.sentence


def test_all_sizes_count_before_anything_is_known() -> None:
    """What a reading could show of an effect is not that of its smallest size alone."""
    made = bench().campaign
    belief = Belief(made.linear, sums_of(np.zeros((0, made.X.shape[2])), np.zeros(0)))
    k = len(made.linear.base)
    for h in belief.hypotheses:
        if len(h.members) == 1:
            own = np.diag(h.covariance)[k:]
            np.testing.assert_allclose(own, np.mean(np.square(SIZES)))


def test_the_bench_remembers_what_a_campaign_works_out() -> None:
    made = bench().campaign
    plain = Campaign.of(made.model, made.pool, SIGMA)
    exact = made.model.predict(made.pool.load_cases)
    readings = bench().read(exact, np.full_like(exact, 1e-5), [3, 4, 50])
    ours, theirs = made.state(readings), plain.state(readings)
    assert ours.row == theirs.row
    np.testing.assert_allclose(ours.belief.sums.gram, theirs.belief.sums.gram, rtol=1e-9)


@pytest.mark.parametrize(("cause", "readings"), [("closure_rod", 3), ("tool_compliance", 4)])
def test_a_name_waits_until_a_misfit_could_speak_against_it(cause: str, readings: int) -> None:
    """Three numbers beyond three springs and what the cause has: one parameter here, six there."""
    made = bench().campaign
    model, name, _ = bench().truth(cause, np.random.default_rng(0))
    exact = model.predict(made.pool.load_cases)
    rows: list[int] = []
    state = made.state(None)
    while state.stop is None and state.row is not None and len(rows) < 9:
        rows.append(state.row)
        state = made.state(bench().read(exact, np.zeros_like(exact), rows))
    assert state.stop is not None and state.stop.names == (name,)
    assert len(rows) == readings
    assert 3 * readings - len(state.belief.leader.columns) >= 3


def test_no_rounding_leaves_less_than_nothing() -> None:
    """Few readings that are fitted exactly, large beside the noise."""
    made = bench().campaign
    for row in range(10):
        X = made.X[row]
        y = X[:, made.linear.base] @ np.array([300.0, -20.0, 1.0])
        belief = Belief(made.linear, sums_of(X, y))
        assert min(h.misfit for h in belief.hypotheses) >= 0.0


def test_a_rig_that_shows_nothing_is_called_hopeless_before_the_first_reading() -> None:
    """One newton and two millimetres: neither a name nor a spring comes of it."""
    made = bench().campaign
    robot, point = made.model.robot, made.pool.load_cases.point
    pool = feasible_pool(robot, poses=20, directions=3, force=1.0, point=point)
    for target, told in ((None, "would show."), (0.01, "nor would all springs")):
        campaign = Campaign.of(made.model, pool, 2e-3, target=target)
        assert not campaign.linear.effects
        stop = campaign.state(None).stop
        assert stop is not None and stop.reason == "hopeless"
        assert told in stop.sentence and "2 mm" in stop.sentence
    assert Campaign.of(made.model, pool, 2e-3, target=1e4).state(None).stop is None


def test_what_a_spring_was_taken_to_be_is_no_standard_error() -> None:
    """On the tool's own axis the last joint's spring shows in no reading."""
    robot = load_robot("ur5e")
    pool = feasible_pool(robot, poses=30, directions=4, force=80.0, point=np.zeros(3))
    campaign = Campaign.of(base_model(robot), pool, SIGMA, target=0.05)
    X = campaign.X[:40].reshape(-1, campaign.X.shape[2])
    y = np.random.default_rng(2).normal(size=len(X))
    belief = Belief(campaign.linear, sums_of(X, y))
    *known, last = campaign._springs(belief)
    assert last[0].startswith("joint_springs:wrist_3_joint") and np.isinf(last[2])
    assert all(np.isfinite(std) for _, _, std, _ in known)
    assert "wrist_3_joint.stiffness (unknown)" in campaign._open_words(belief)
