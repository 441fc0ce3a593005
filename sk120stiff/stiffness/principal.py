"""Principal stiffness, and what definiteness says about stability."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from sk120stiff.arrays import Array, Index
from sk120stiff.stiffness.cartesian import symmetric_part


class Definiteness(StrEnum):
    """The paper's five classes (section V)."""

    POSITIVE_DEFINITE = "positive definite"
    POSITIVE_SEMIDEFINITE = "positive semi-definite"
    NEGATIVE_DEFINITE = "negative definite"
    NEGATIVE_SEMIDEFINITE = "negative semi-definite"
    INDEFINITE = "indefinite"

    @property
    def short(self) -> str:
        """The column head of the paper's Table IV."""
        return {"positive definite": "PD", "positive semi-definite": "PSD"}.get(
            self.value,
            {"negative definite": "ND", "negative semi-definite": "NSD"}.get(self.value, "ID"),
        )


CLASSES = tuple(Definiteness)


@dataclass(frozen=True, eq=False)
class Principal:
    """Eigenvalues and directions of a 3×3 stiffness, softest first.

    Attributes:
        values: (..., 3) principal stiffness [N/m] (or compliance, where it says so); a negative one
            is an unstable direction, an infinite one a direction in which the arm cannot move at
            all.
        directions: (..., 3, 3) unit directions in base axes, one per row.
    """

    values: Array
    directions: Array


def principal_compliance(compliance: Array) -> Principal:
    """Principal compliances (..., 3) of a compliance (..., 3, 3), largest first, as `values`.

    The load's moment part can make the compliance unsymmetric; its symmetric part is taken, which
    is the one that stores energy. Negative ones (unstable directions) come last. NaN stays NaN.
    """
    lost = np.asarray(np.isnan(compliance).any(axis=(-2, -1)))[..., None]
    values, vectors = np.linalg.eigh(
        symmetric_part(np.where(lost[..., None], np.eye(compliance.shape[-1]), compliance))
    )
    directions = np.swapaxes(vectors[..., ::-1], -1, -2)
    return Principal(
        np.where(lost, np.nan, values[..., ::-1]), np.where(lost[..., None], np.nan, directions)
    )


def principal_stiffness(compliance: Array) -> Principal:
    """Principal stiffness from a compliance (..., 3, 3) [m/N], safe at singular poses.

    See `principal_compliance` for the order; a direction that does not yield is infinitely stiff.
    """
    found = principal_compliance(compliance)
    size = np.max(np.abs(found.values), axis=-1, keepdims=True)
    rigid = np.abs(found.values) <= 1e-12 * size
    with np.errstate(divide="ignore"):
        values = np.where(rigid, np.inf, 1.0 / np.where(rigid, 1.0, found.values))
    return Principal(values, found.directions)


def definiteness(matrix: Array, *, tolerance: float = 1e-12) -> Index:
    """Class of each symmetric part of (..., n, n), as indices into `CLASSES`.

    An eigenvalue counts as zero below `tolerance` times the largest magnitude among them; the zero
    matrix is positive semi-definite.
    """
    values = np.linalg.eigvalsh(symmetric_part(matrix))
    threshold = tolerance * np.max(np.abs(values), axis=-1, keepdims=True)
    positive = (values > threshold).any(axis=-1)
    negative = (values < -threshold).any(axis=-1)
    zero = (np.abs(values) <= threshold).any(axis=-1)
    return np.select(
        [positive & negative, negative & zero, negative, positive & zero | ~positive],
        [4, 3, 2, 1],
        default=0,
    ).astype(np.intp)
