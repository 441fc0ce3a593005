"""What the readings say of themselves, pose by pose, without any model of the robot.

At one pose every elastic cause, known or not, displaces the point in proportion to the load (to
first order). So a regression of displacement on load, free at every pose, leaves nothing but noise
and what is not linear in the load. It judges noise models before the catalogue comes in, and it is
the yardstick for what a fitted model has left over.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from sk120stiff.effects import Situation
from sk120stiff.measurements import Measurements, NoiseModel, candidates
from sk120stiff.measurements.poses import rows_by_label
from sk120stiff.robot.coupling import Array

STRONG = 10.0  # twice the log-likelihood by which a less simple noise model must win


def load_basis(situation: Situation, *, jump: bool = False, cubic: bool = False) -> Array:
    """(N, k) the loads of every pose in their own principal directions, sizes of order one.

    Column j of one pose has nothing to do with column j of another. Where a pose has readings
    enough, `jump` adds a constant (lost motion) and `cubic` what grows with the cube of the load
    (hardening).
    """
    scale = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])  # a moment of 1 N·m counts like 2 N
    loads = situation.wrench * scale
    size = max(float(np.abs(loads).max(initial=0.0)), 1e-300)
    parts: list[tuple[NDArray[np.intp], Array]] = []
    for rows in rows_by_label(situation.pose):
        _, singular, Vt = np.linalg.svd(loads[rows] / size, full_matrices=False)
        rank = int((singular > 0.02 * singular[0]).sum()) if singular[0] > 0.0 else 0
        basis = loads[rows] / size @ Vt[:rank].T
        along = np.linalg.norm(basis, axis=1, keepdims=True)
        if jump and len(rows) >= rank + 3:
            basis = np.hstack([basis, np.sign(along)])
        if cubic and rank and len(rows) >= rank + 4:
            basis = np.hstack([basis, basis[:, :1] * along**2])
        parts.append((rows, basis))
    width = max((basis.shape[1] for _, basis in parts), default=0)
    out = np.zeros((situation.count, width))
    for rows, basis in parts:
        out[rows, : basis.shape[1]] = basis
    return out


def pose_columns(basis: Array) -> Array:
    """(N, 3, 3k) the basis for each reading axis on its own."""
    N, k = basis.shape
    return np.asarray(np.einsum("nk,ij->nikj", basis, np.eye(3)).reshape(N, 3, 3 * k))


@dataclass(frozen=True, eq=False)
class PoseNoise:
    """What the pose-by-pose regression leaves under one noise model.

    Attributes
    ----------
    noise
        The noise model.
    rss
        Whitened sum of squares.
    freedom
        Its degrees of freedom.
    likelihood
        Twice the restricted log-likelihood, up to a constant.
    """

    noise: NoiseModel
    rss: float
    freedom: int
    likelihood: float

    @property
    def factor(self) -> float:
        """Noise seen over noise assumed."""
        return float(np.sqrt(self.rss / self.freedom)) if self.freedom else 1.0


def pose_noise(
    noise: NoiseModel, measurements: Measurements, situation: Situation, *, jump: bool
) -> PoseNoise:
    """Restricted likelihood of a noise model under the pose-by-pose regression.

    With `jump` a constant per pose is free: then lost motion does not pass for noise, but neither
    can a shared zero reading be told from separate ones.
    """
    if measurements.displacement is None:
        raise ValueError("noise cannot be judged without displacements")
    whitener = noise.whitener(measurements)
    y = whitener.apply(measurements.displacement)
    X = whitener.apply(pose_columns(load_basis(situation, jump=jump, cubic=True)))
    rss, freedom, information = 0.0, len(y), 0.0
    for rows in rows_by_label(np.repeat(situation.pose, 3)):
        U, singular, _ = np.linalg.svd(X[rows], full_matrices=False)
        seen = singular > 1e-9 * max(singular[0], 1e-300)
        along = U[:, seen].T @ y[rows]
        rss += float(y[rows] @ y[rows] - along @ along)
        freedom -= int(seen.sum())
        information += 2.0 * float(np.log(singular[seen]).sum())
    freedom = max(freedom, 0)
    fixed = -whitener.logdet - information
    if noise.stated or not freedom:
        return PoseNoise(noise, rss, freedom, fixed - rss)
    return PoseNoise(noise, rss, freedom, fixed - freedom * np.log(max(rss, 1e-300) / freedom))


def choose_noise(
    measurements: Measurements,
    situation: Situation,
    *,
    doubt: bool = True,
    grows: bool = True,
    sure: float = 4.0,
    zero: Literal["shared", "separate"] | None = None,
) -> tuple[NoiseModel, list[str]]:
    """The noise model that the data's description and the readings themselves ask for.

    Parameters
    ----------
    measurements, situation
        The readings.
    doubt
        Let the scatter overrule what was stated.
    grows
        In doubt, let it also ask for a part that grows with the displacement.
    sure
        Standard errors by which the scatter must differ from a stated σ to overrule it.
    zero
        How zero readings were shared; None takes the description's word, or the scatter's.

    Returns
    -------
    noise, reasons
        The model, and what was decided beyond the description, in sentences.
    """
    offered = [noise for noise in candidates(measurements) if zero in (None, noise.zero)]
    if not (doubt and grows):
        offered = [noise for noise in offered if noise.growth == offered[0].growth]
    reasons: list[str] = []
    if len({noise.zero for noise in offered}) > 1:
        plain = [noise for noise in offered if noise.growth == offered[0].growth]
        judged = [pose_noise(noise, measurements, situation, jump=False) for noise in plain]
        kind = max(judged, key=lambda found: found.likelihood).noise.zero
        offered = [noise for noise in offered if noise.zero == kind]
        reasons.append(f"Nobody said how zero readings were shared; the scatter says: {kind}.")
    judged = [pose_noise(noise, measurements, situation, jump=True) for noise in offered]
    best = judged[0]
    if best.freedom >= 10:
        for other in judged[1:]:
            if other.likelihood > max(best.likelihood, judged[0].likelihood + STRONG):
                best = other
    if best is not judged[0]:
        best = _finest_growth(best, measurements, situation)
        reasons.append(
            f"The scatter grows with the displacement: {best.noise.growth * 100:.2g} % of it."
        )
    if best.noise.stated and not doubt:
        return best.noise, reasons
    return _scaled(best, reasons, sure), reasons


def _finest_growth(best: PoseNoise, measurements: Measurements, situation: Situation) -> PoseNoise:
    """The likeliest growth near one that was found on a coarse grid."""

    def unlikely(logarithm: float) -> float:
        noise = replace(best.noise, growth=float(np.exp(logarithm)))
        return -pose_noise(noise, measurements, situation, jump=True).likelihood

    middle = np.log(best.noise.growth)
    found = minimize_scalar(
        unlikely, bounds=(middle - 1.0, middle + 1.0), method="bounded", options={"xatol": 0.02}
    )
    noise = replace(best.noise, growth=float(np.exp(found.x)))
    return pose_noise(noise, measurements, situation, jump=True)


def _scaled(best: PoseNoise, reasons: list[str], sure: float) -> NoiseModel:
    """The noise model with the size that the scatter within poses shows."""
    noise = best.noise
    if noise.stated:
        unsure = sure / np.sqrt(2.0 * max(best.freedom, 1))
        more = best.factor > 1.0 + max(unsure, 0.1)
        less = best.factor < 1.0 - max(unsure, 0.25) and noise.growth == 0.0
        if best.freedom < 30 or not (more or less):
            return noise
        reasons.append(
            f"Within a pose the readings scatter {best.factor:.2f} times as much as their stated "
            "uncertainty; the scatter is believed."
        )
        return noise.scaled(best.factor)
    if best.freedom >= 10:
        noise = noise.scaled(best.factor)
        reasons.append(
            f"No uncertainty is stated; the scatter within a pose gives "
            f"{noise.sigma * 1e6:.3g} µm for one reading."
        )
    return noise
