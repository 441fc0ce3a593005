"""How well a model's parameters are known, and what that makes of anything computed from them.

A fit leaves three doubts. Its readings scatter, so the parameters have a covariance Σ. Some
combinations of parameters do not show in the readings at all, so a plausible change B along them
goes unseen. And the model may lack something: what is left of the gap beyond the noise is its
remainder. With S the derivative of a quantity by the parameters, the first gives the variance
S Σ Sᵀ (exact where the quantity is linear), the second S B Bᵀ Sᵀ, which may be anything up to all
that is plausible; the third is a size, told apart from the others. Noise that explains the whole
misfit hides some of it, which counts by its probability: no arm follows its model exactly.

All of it is in internal values: compliances where people write stiffnesses, because deflections
are linear in those, and an interval of a compliance is symmetric where that of a stiffness is not.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from scipy import stats

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError

SMALL = 1e-6  # m; what nobody asks about where only angles were read
HIDDEN = 0.1  # variance that an unseen change may bring, over what is known of it, before it counts
LEAST = 1e-300  # probability; below it the logarithm ends
ROUNDED = 1e-8  # least eigenvalue of a correlation matrix that rounding may have made of zero


@dataclass(frozen=True, eq=False)
class Remainder:
    """What a model leaves unexplained at poses that it was not fitted to, beyond the noise.

    Attributes:
        rms: (3,) per axis of the base, over readings like those of the fit [m].
        upper: (3,) the same with one standard error of its square, as it came out from pose to
            pose: what predictions use, because a few poses hardly show how large it may be at
            others [m].
        freedom: (3,) degrees of freedom of the readings that it rests on.
        load: Rms size of the loads at which it was found, see `load_size` [N].
        length: Lever at which a moment counts as a force [m].
        grows: It goes with the load; else it is as large at all loads.
        probability: Of as large a misfit if the noise were all.
        significant: The misfit is more than the noise makes.
    """

    rms: Array
    upper: Array
    freedom: Array
    load: float
    length: float
    grows: bool
    probability: float
    significant: bool

    def __post_init__(self) -> None:
        for axes in (self.rms, self.upper, self.freedom):
            if axes.shape != (3,) or not np.isfinite(axes).all() or (axes < 0.0).any():
                raise InputError("the remainder has an axis that is no positive number")
        if (self.upper < self.rms * (1.0 - ROUNDED)).any():
            raise InputError("the remainder's upper size is below its size")
        if not (0.0 < self.load < np.inf and 0.0 < self.length < np.inf):
            raise InputError("the remainder's load or length is not a positive number")
        if not 0.0 <= self.probability <= 1.0:
            raise InputError(f"the remainder's probability {self.probability} is none")

    @property
    def share(self) -> float:
        """Probability that the model's form is off at all, beforehand as likely as not.

        A misfit that noise alone makes with probability p speaks for it by 1 / (-e p ln p) at most
        (Sellke, Bayarri & Berger 2001), and from p = 1/e on neither for nor against it.
        """
        p = min(max(self.probability, LEAST), np.exp(-1.0))
        return float(1.0 / (1.0 - np.e * p * np.log(p)))

    def std(self, wrench: Array) -> Array:
        """(..., 3) its standard size under wrenches (..., 6), axes of the base [m].

        That of nothing, and of as much as may be there, each as likely as it is.
        """
        size = load_size(wrench, self.length)[..., None] / self.load
        goes = size if self.grows else np.ones_like(size)
        return np.asarray(goes * np.sqrt(self.share) * self.upper)


def load_size(wrench: Array, length: float) -> Array:
    """(...,) size of wrenches (..., 6), a moment as a force at the end of `length` [N]."""
    force, moment = wrench[..., :3], wrench[..., 3:]
    return np.asarray(np.sqrt((force**2).sum(axis=-1) + (moment**2).sum(axis=-1) / length**2))


@dataclass(frozen=True, eq=False)
class Uncertainty:
    """What is known of P estimated parameters; the others of a model count as exact.

    Attributes:
        names: Full names of the parameters.
        values: (P,) internal values that this belongs to.
        covariance: (P, P) of the internal values, of what the readings show.
        unseen: (b, P) plausible changes of the internal values that the readings do not show.
        noise: Standard uncertainty of one reading per axis [m]; None where no reading was a length.
        freedom: Degrees of freedom of the noise, where it was estimated; None: stated.
        remainder: What the model leaves unexplained; None where that could not be told from noise.
        source: Which readings all of this comes from, in words.
    """

    names: tuple[str, ...]
    values: Array
    covariance: Array
    unseen: Array
    noise: float | None
    freedom: float | None = None
    remainder: Remainder | None = None
    source: str = field(default="")

    def __post_init__(self) -> None:
        P = len(self.names)
        if len(set(self.names)) != P:
            raise InputError("a parameter stands twice in the uncertainty")
        if self.values.shape != (P,) or self.covariance.shape != (P, P):
            raise InputError(f"{P} parameters with a covariance of shape {self.covariance.shape}")
        if self.unseen.ndim != 2 or self.unseen.shape[1] != P:
            raise InputError(f"unseen changes of shape {self.unseen.shape} for {P} parameters")
        for array in (self.values, self.covariance, self.unseen):
            if not np.isfinite(array).all():
                raise InputError("the uncertainty holds something that is not a finite number")
        if not np.allclose(self.covariance, self.covariance.T, rtol=1e-9, atol=0.0):
            raise InputError("the covariance is not symmetric")
        if (np.diag(self.covariance) < 0.0).any() or self._eigen[0].min(initial=0.0) < -ROUNDED * P:
            raise InputError("the covariance is not positive semi-definite: no such readings exist")
        if self.noise is not None and not 0.0 < self.noise < np.inf:
            raise InputError(f"a noise of {self.noise} m is not positive")

    @property
    def floor(self) -> float:
        """Size of a displacement that nobody asks about [m]: the noise of a reading."""
        return SMALL if self.noise is None else self.noise

    @cached_property
    def std(self) -> Array:
        """(P,) standard errors of the internal values, of what the readings show."""
        return np.asarray(np.sqrt(np.diag(self.covariance)))

    @cached_property
    def correlation(self) -> Array:
        """(P, P) correlations."""
        safe = np.where(self.std > 0.0, self.std, 1.0)
        found = self.covariance / np.outer(safe, safe)
        np.fill_diagonal(found, 1.0)
        return np.asarray(np.clip(found, -1.0, 1.0))

    @cached_property
    def _eigen(self) -> tuple[Array, Array]:
        values, vectors = np.linalg.eigh(self.correlation)
        return values, vectors

    def factors(self, names: Sequence[str]) -> tuple[Array, Array]:
        """L (p, r) with Σ = L Lᵀ and B (p, b), for parameters in the order of `names`.

        Parameters that nothing is known of here count as exact; those that are not asked for are
        left out, which is right for marginals of a normal distribution.
        """
        values, vectors = self._eigen
        L = self.std[:, None] * vectors * np.sqrt(np.clip(values, 0.0, None))
        place = {name: k for k, name in enumerate(self.names)}
        rows = [place.get(name, -1) for name in names]
        known = np.array([row >= 0 for row in rows], dtype=bool)[:, None]
        return np.where(known, L[rows], 0.0), np.where(known, self.unseen.T[rows], 0.0)

    def reach(self, level: float = 0.95) -> float:
        """Half width of an interval in standard deviations: normal, or Student."""
        upper = 0.5 * (1.0 + level)
        if self.freedom is None:
            return float(stats.norm.ppf(upper))
        return float(stats.t.ppf(upper, self.freedom))


def spread(seen: Array, unseen: Array, floor: Array | float) -> Array:
    """(...,) standard deviation of a quantity from its parts along Σ and along what is unseen.

    Args:
        seen: (..., r) derivative times L of `Uncertainty.factors`.
        unseen: (..., b) derivative times B.
        floor: Size of the quantity that nobody asks about, the noise of a reading say.

    Returns:
        Infinite where plausible changes that no reading shows would move the quantity by a third or
        more of what is known of it; where they move it by less, that is added.
    """
    known, hidden = (seen**2).sum(axis=-1), (unseen**2).sum(axis=-1)
    lost = hidden > HIDDEN * (known + np.asarray(floor) ** 2)
    return np.asarray(np.where(lost, np.inf, np.sqrt(known + hidden)))
