"""Model-form error: what every real arm has beyond any model of it, as a covariance.

No arm follows a law to the micrometre. What is left behaves, pose by pose, like an error of the
compliance matrix (in proportion to the load) and like a displacement that the pose has of its own
(constant in the load). Both count as random effects with one size each (Kennedy & O'Hagan 2001;
Searle, Casella & McCulloch, *Variance Components*):

    d = model + D_p f + b_p + noise,   D_p ~ N(0, (τ₁ c_p)²),   b_p ~ N(0, τ₀²)

with f the load and c_p the measured displacement per unit of load at pose p. So V = V_noise + Z Zᵀ
with a handful of columns Z for every pose; whitening by it costs a small matrix per pose.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.errors import InputError
from sk120stiff.measurements.data import Measurements
from sk120stiff.measurements.directions import turns_onto
from sk120stiff.measurements.noise.whitening import Shortening, Whitens
from sk120stiff.measurements.poses import rows_by_label


@dataclass(frozen=True)
class ModelForm:
    """Sizes of the model-form error.

    Attributes:
        proportional: Standard deviation τ₁ of the compliance error, relative to the pose's own
            compliance.
        constant: Standard deviation τ₀ of what a pose has of its own, per axis [m].
        of_poses: Names of poses and the factor s_p on the variance that each one has of its own; 1
            for the others.

    Raises:
        InputError: A size that is negative or not finite.
    """

    proportional: float = 0.0
    constant: float = 0.0
    of_poses: tuple[tuple[str, float], ...] = ()

    def __post_init__(self) -> None:
        for size in (self.proportional, self.constant):
            if not 0.0 <= size < np.inf:
                raise InputError(f"a model-form error of size {size} is not zero or positive")

    def __bool__(self) -> bool:
        return bool(self.proportional > 0.0 or self.constant > 0.0)

    def scaled(self, factor: float) -> ModelForm:
        """Both sizes times a factor."""
        return replace(
            self, proportional=self.proportional * factor, constant=self.constant * factor
        )

    def factors(self, measurements: Measurements) -> Array:
        """(N,) factor s_p of each row's pose."""
        own = dict(self.of_poses)
        return np.array([own.get(pose, 1.0) for pose in measurements.pose])

    def rms(self, measurements: Measurements) -> float:
        """Root mean square over readings and axes of what such an error brings [m]."""
        proportional, constant = form_columns(measurements)
        square = (self.proportional * proportional) ** 2
        offsets = (self.constant * constant) ** 2
        read = measurements.read
        whole = square[read].sum() + offsets[read].sum()
        return float(np.sqrt(whole / max(int(read.sum()), 1)))


EXACT = ModelForm()


def form_columns(measurements: Measurements) -> tuple[Array, Array]:
    """Columns of the two random effects at every pose, for sizes of one.

    Returns:
        tuple: Proportional (N, 3, 3k) [m], k the kinds of load that occur, and constant (N, 3, 3)
            [1]. Every pose has columns of its own: these, in its rows alone.

    Raises:
        InputError: There are no displacements.
    """
    if measurements.displacement is None:
        raise InputError("model-form error needs displacements, and a plan has none")
    pose = measurements.pose_index
    kinds = [measurements.wrench[:, :3], measurements.wrench[:, 3:]]
    size = _rms_of_pose(measurements.moved, pose, measurements.read)
    features = []
    for load in kinds:
        strength = _rms_of_pose(load, pose, np.ones_like(load, dtype=np.bool_))
        if strength.any():
            features.append(load * (size / np.where(strength > 0.0, strength, np.inf))[:, None])
    load = np.concatenate(features, axis=1) if features else np.zeros((len(pose), 0))
    constant: Array = np.broadcast_to(np.eye(3), (len(pose), 3, 3))
    if measurements.directions is not None:  # what a pose has of its own has no axes of its rows
        constant = np.swapaxes(turns_onto(measurements.directions), 1, 2)
    proportional = np.einsum("nij,nk->nijk", constant, load).reshape(len(pose), 3, -1)
    return proportional, constant


def _rms_of_pose(vectors: Array, pose: Index, known: Mask) -> Array:
    """(N,) root mean square length of the vectors (N, 3) at each row's pose.

    An axis that is not known (N, 3), and zero, counts as the others do on average.
    """
    square = (vectors**2).sum(axis=1)
    count = np.bincount(pose, known.sum(axis=1) / 3.0)
    return np.asarray(np.sqrt(np.bincount(pose, square) / np.maximum(count, 1e-300))[pose])


class FormWhitener:
    """V^(-1/2) for V = V_noise + Z Zᵀ: the noise's whitener, then a shrinkage along few directions.

    Args:
        noise: Whitener of the noise alone.
        form: Sizes of the model-form error.
        measurements: The readings, with displacements.
    """

    def __init__(self, noise: Whitens, form: ModelForm, measurements: Measurements) -> None:
        self._noise = noise
        self.n_readings, self.reading = noise.n_readings, noise.reading
        proportional, constant = form_columns(measurements)
        columns = [form.proportional * proportional, form.constant * constant]
        own = np.sqrt(form.factors(measurements))[:, None, None]
        white = noise.apply(own * np.concatenate(columns, axis=2))
        rows = rows_of_poses(measurements)
        self._of_poses = Shortening(rows, [white[each] for each in rows])
        directions = self._of_poses.directions
        self.strengths = [(r, U, s**2) for r, (U, s) in zip(rows, directions, strict=True)]
        """For each pose its whitened rows (r,), the directions (r, k) of its random effects, and
        their variance (k,) over the noise's."""
        self._outweighing = [(r, U[:, s > 1.0]) for r, (U, s) in zip(rows, directions, strict=True)]
        noise_left = [1.0 / (1.0 + s[s > 1.0] ** 2) for _, s in directions]
        self.logdet = noise.logdet + self._of_poses.logdet
        """Natural logarithm of det V, over all numbers that were read; V in m²."""
        shares = np.concatenate([*noise_left, np.zeros(0)])
        self.noise_share = float(shares.mean()) if len(shares) else 1.0
        """Mean share of the noise in the variance along the directions of `outweighing`."""

    def outweighing(self, white: Array) -> tuple[Array, Index]:
        """What lies along the directions in which model-form error outweighs the noise.

        Args:
            white: (R, ...) whitened by `apply`.

        Returns:
            tuple: Components (M, ...) along these orthonormal directions, and (M,) the first
                whitened row of each one's pose.
        """
        parts = [U.T @ white[rows] for rows, U in self._outweighing]
        first = [np.full(U.shape[1], rows[0]) for rows, U in self._outweighing]
        return np.concatenate(parts), np.concatenate(first)

    def apply(self, x: ArrayLike) -> Array:
        """As `Whitener.apply`."""
        return self._of_poses.apply(self._noise.apply(x))


def rows_of_poses(measurements: Measurements) -> list[Index]:
    """Of each pose its rows among the R whitened numbers; a zero reading belongs to one pose."""
    return rows_by_label(measurements.pose_index[measurements.row_of_number])
