"""The last digits: against non-negative least squares, closed forms and a stubborn misfit."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import nnls

from sk120stiff.errors import Refusal
from sk120stiff.identify.solve.polish import polish, seen_directions
from sk120stiff.identify.solve.solvers import minimise

FREE = np.inf


def linear(A: np.ndarray, b: np.ndarray):
    return lambda x: (A @ x - b, A)


@given(st.integers(0, 10_000))
def test_bounds_as_in_non_negative_least_squares(seed: int) -> None:
    rng = np.random.default_rng(seed)
    P = int(rng.integers(1, 7))
    A = rng.normal(size=(P + int(rng.integers(0, 12)), P)) * 10.0 ** rng.uniform(-1, 1, P)
    b = rng.normal(size=len(A))
    start = np.abs(rng.normal(size=P))
    found = polish(linear(A, b), start, (np.zeros(P), np.full(P, FREE)), np.full(P, 1e6))
    expected, norm = nnls(A, b)
    assert np.linalg.norm(found.residual) == pytest.approx(norm, rel=1e-9, abs=1e-9)
    np.testing.assert_allclose(found.x, expected, rtol=1e-7, atol=1e-9)
    np.testing.assert_array_equal(found.x[found.at_bound], 0.0)


@pytest.mark.parametrize("method", ["trf", "lm"])
def test_both_algorithms_find_the_corner(method: str) -> None:
    rng = np.random.default_rng(5)
    A, b = rng.normal(size=(20, 4)), rng.normal(size=20)
    bounds = (np.zeros(4), np.full(4, FREE))
    found = minimise(linear(A, b), np.ones(4), bounds, np.full(4, 1e3), method)
    np.testing.assert_allclose(found.x, nnls(A, b)[0], atol=1e-12)


def test_a_misfit_at_which_gauss_and_newton_diverge() -> None:
    """Fletcher's example: at the minimum x = 0 the error of plain Gauss-Newton grows by -1.5."""
    factor = -1.5

    def evaluate(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        residual = np.array([x[0] + 1.0, factor * x[0] ** 2 + x[0] - 1.0])
        return residual, np.array([[1.0], [2.0 * factor * x[0] + 1.0]])

    residual, jacobian = evaluate(np.array([1e-3]))
    plain = 1e-3 - float(jacobian[:, 0] @ residual / (jacobian[:, 0] @ jacobian[:, 0]))
    assert plain == pytest.approx(factor * 1e-3, rel=0.05)  # the example is what it claims to be
    everywhere = (np.array([-FREE]), np.array([FREE]))
    found = polish(evaluate, np.array([0.3]), everywhere, np.array([9.0]))
    assert found.x[0] == pytest.approx(0.0, abs=1e-9)
    assert found.iterations < 40


def test_unseen_directions_stay_where_they_were() -> None:
    """Only the sum of the first two shows; their difference is that of the start."""
    A = np.zeros((6, 3))
    A[:3, :2], A[3:, 2] = 1.0, 2.0
    b = np.array([4.0, 5.0, 6.0, 1.0, 1.0, 1.0])
    bounds = (np.full(3, -FREE), np.full(3, FREE))
    for method in ("trf", "lm"):
        found = minimise(linear(A, b), np.array([3.0, 1.0, 9.0]), bounds, np.full(3, 10.0), method)
        assert found.x[0] + found.x[1] == pytest.approx(5.0, abs=1e-12)
        assert found.x[2] == pytest.approx(0.5, abs=1e-12)
    found = polish(linear(A, b), np.array([3.0, 1.0, 9.0]), bounds, np.full(3, 10.0))
    assert found.x[0] - found.x[1] == pytest.approx(2.0, abs=1e-12)
    _, singular, _, null = seen_directions(A, np.full(3, 10.0))
    assert len(singular) == 2
    np.testing.assert_allclose(np.abs(null[:, 0]), [np.sqrt(0.5), np.sqrt(0.5), 0.0], atol=1e-12)


def test_what_no_plausible_value_would_show_is_unseen() -> None:
    A = np.diag([1.0, 1e-4])
    assert len(seen_directions(A, np.array([10.0, 100.0]))[1]) == 1  # 0.01 of the noise
    assert len(seen_directions(A, np.array([10.0, 1e5]))[1]) == 2  # 10 times the noise


def test_a_region_without_an_answer_is_stepped_around() -> None:
    def evaluate(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        if x[0] > 2.0:
            raise Refusal("nothing there")
        return np.array([np.exp(x[0]) - np.exp(1.5), 0.1]), np.array([[np.exp(x[0])], [0.0]])

    bounds = (np.array([-FREE]), np.array([FREE]))
    for method in ("trf", "lm"):
        found = minimise(evaluate, np.array([-1.0]), bounds, np.array([10.0]), method)
        assert found.x[0] == pytest.approx(1.5, abs=1e-12)


def test_no_convergence_is_said() -> None:
    """The derivative points the wrong way: no step makes the misfit smaller."""

    def evaluate(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return np.array([x[0] - 3.0]), np.array([[-1.0]])

    with pytest.raises(Refusal, match="did not converge"):
        polish(evaluate, np.zeros(1), (np.array([-FREE]), np.array([FREE])), np.array([10.0]))


@pytest.mark.parametrize(("edge", "near"), [(0.97, True), (0.5, False)])
def test_a_minimum_at_a_jump_counts_where_the_rest_hardly_matters(edge: float, near: bool) -> None:
    """Play jumps; beyond the edge the misfit is larger by 25, before it a standard error is 1."""
    noise = np.tile([1.0, -1.0], 50)

    def evaluate(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        residual = np.concatenate([noise, [x[0] - 1.0, 5.0 * (x[0] > edge)]])
        return residual, np.concatenate([np.zeros(100), [1.0, 0.0]])[:, None]

    task = evaluate, np.zeros(1), (np.array([-FREE]), np.array([FREE])), np.array([10.0])
    if near:
        assert polish(*task).x[0] == pytest.approx(edge, abs=0.01)
    else:
        with pytest.raises(Refusal, match="did not converge"):
            polish(*task)


def test_nothing_to_estimate() -> None:
    found = minimise(
        lambda x: (np.ones(3), np.zeros((3, 0))), np.zeros(0), (np.zeros(0),) * 2, np.zeros(0), "lm"
    )
    assert len(found.x) == 0
