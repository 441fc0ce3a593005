"""Classes of definiteness for matrices whose eigenvalues are known because they were put in."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import ortho_group

from sk120stiff.stiffness import (
    CLASSES,
    Definiteness,
    definiteness,
    principal_stiffness,
)

PD, PSD, ND, NSD, ID = CLASSES
sizes = st.floats(1e-3, 1e3)
scales = st.sampled_from([1e-9, 1.0, 1e9])
signs = {PD: (1, 1, 1), PSD: (1, 0, 1), ND: (-1, -1, -1), NSD: (-1, 0, 0), ID: (1, 0, -1)}


def definiteness_of(matrix) -> Definiteness:
    return CLASSES[int(definiteness(matrix))]


def with_eigenvalues(values, seed):
    Q = ortho_group.rvs(len(values), random_state=seed)
    return Q @ np.diag(values) @ Q.T


def expected(values) -> Definiteness:
    """The paper's classes by the definition, from the eigenvalues that were put in."""
    up, down, flat = (any(f(v) for v in values) for f in
                      (lambda v: v > 0, lambda v: v < 0, lambda v: v == 0))  # fmt: skip
    if up and down:
        return ID
    if down:
        return NSD if flat else ND
    return PSD if flat else PD


def test_the_classes_are_the_papers():
    assert [c.short for c in CLASSES] == ["PD", "PSD", "ND", "NSD", "ID"]
    assert [c.value for c in CLASSES] == [
        "positive definite",
        "positive semi-definite",
        "negative definite",
        "negative semi-definite",
        "indefinite",
    ]


@pytest.mark.parametrize("found", CLASSES)
@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10_000), size=st.tuples(sizes, sizes, sizes), scale=scales)
def test_every_class_is_found(found, seed, size, scale):
    values = scale * np.array(size) * signs[found]
    assert definiteness_of(with_eigenvalues(values, seed)) is found


@settings(max_examples=200, deadline=None)
@given(
    signs=st.lists(st.sampled_from([-1, 0, 1]), min_size=2, max_size=6),
    seed=st.integers(0, 10_000),
    scale=scales,
)
def test_any_signs_of_eigenvalues(signs, seed, scale):
    rng = np.random.default_rng(seed)
    values = scale * rng.uniform(1e-3, 1e3, len(signs)) * np.array(signs)
    matrix = with_eigenvalues(values, seed)
    assert definiteness_of(matrix) is expected(values)
    turned = {PD: ND, ND: PD, PSD: NSD, NSD: PSD, ID: ID}
    if any(signs):  # the zero matrix is called positive semi-definite either way
        assert definiteness_of(-matrix) is turned[expected(values)]


def test_what_counts_as_zero_is_relative_to_the_largest():
    for scale in (1e-6, 1.0, 1e9):
        tiny = np.diag([1.0, -1e-13, 1.0]) * scale
        assert definiteness_of(tiny) is PSD
        assert definiteness_of(np.diag([1.0, -1e-11, 1.0]) * scale) is ID
        assert CLASSES[definiteness(tiny, tolerance=1e-14)] is ID
        assert CLASSES[definiteness(np.diag([1.0, 1e-3, 1.0]) * scale, tolerance=1e-2)] is PSD
    assert definiteness_of(np.zeros((3, 3))) is PSD


def test_only_the_symmetric_part_counts():
    skew = np.array([[0, 5, -3], [-5, 0, 7], [3, -7, 0.0]])
    assert definiteness_of(np.eye(3) + skew) is PD


def test_a_positive_determinant_is_no_positive_definite_matrix():
    two_negative = np.diag([-1.0, -2.0, 3.0])
    assert np.linalg.det(two_negative) > 0 and definiteness_of(two_negative) is ID


def test_batch_is_the_loop():
    rng = np.random.default_rng(0)
    values = rng.uniform(1, 2, (4, 5, 3)) * np.array([signs[c] for c in CLASSES])
    matrices = np.array([[with_eigenvalues(v, k) for k, v in enumerate(row)] for row in values])
    found = definiteness(matrices)
    assert np.array_equal(found, np.broadcast_to(np.arange(5), (4, 5)))
    for index in np.ndindex(4, 5):
        assert CLASSES[found[index]] is definiteness_of(matrices[index])


@settings(max_examples=50, deadline=None)
@given(seed=st.integers(0, 10_000), size=st.tuples(sizes, sizes, sizes))
def test_principal_values_and_directions(seed, size):
    compliance = 1e-6 * with_eigenvalues(np.array(size), seed)
    principal = principal_stiffness(compliance)
    assert np.allclose(principal.values, np.sort(1e6 / np.array(size)), rtol=1e-6)
    assert np.allclose(principal.directions @ principal.directions.T, np.eye(3), atol=1e-12)
    for value, direction in zip(principal.values, principal.directions, strict=True):
        force = compliance @ (value * direction)
        assert np.allclose(force, direction, rtol=0, atol=1e-6)


def test_rigid_and_unstable_directions():
    principal = principal_stiffness(np.diag([2e-6, 0.0, -1e-6]))
    assert np.allclose(principal.values, [5e5, np.inf, -1e6])
    assert np.allclose(np.abs(principal.directions), np.eye(3))
    assert np.isinf(principal_stiffness(np.zeros((2, 3, 3))).values).all()
