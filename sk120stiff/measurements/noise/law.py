"""The noise of displacement readings: its law, and what data and their repeats say of it.

The law, per axis and in the axes of the readings: a displacement is a loaded reading minus the mean
of `zero_count` zero readings. The loaded reading has the variance σ² + (growth·|d|)², or s² where
the row states its own, plus (growth·|d|)². The zero reading has σ²/zero_count, or as much as the
loaded readings that subtract it state on average. Rows that subtract the same zero reading share
its error, whatever the number of rows. Forces that were read by hand add what their errors move
(`forces.py`).

An instrument that is sharper along its ray than across it makes the errors of one reading's axes go
together; such readings are whitened along the ray and across it (`line_of_sight.py`).

What was stated is the yardstick: no scatter overrules it. Noise that grows with the displacement
was stated, or shows in true repeats, or within poses (`identify/noise/growing.py`): nothing else
tells it from a cause that grows with the load.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from sk120stiff.arrays import Array, Integers
from sk120stiff.errors import InputError, short, two_digits
from sk120stiff.measurements.data import Measurements
from sk120stiff.measurements.directions import read_apart
from sk120stiff.measurements.noise.forces import ForceWhitener, by_force_of
from sk120stiff.measurements.noise.line_of_sight import SEEN, in_axes_of_sight
from sk120stiff.measurements.noise.model_form import EXACT, FormWhitener, ModelForm
from sk120stiff.measurements.noise.repeats import ENOUGH, Repeated, repeated
from sk120stiff.measurements.noise.whitening import Whitener, Whitens
from sk120stiff.measurements.table.branches import TOLD

# Where nothing says how large the noise is, a model needs a scale to start from: a laser tracker's.
_START = 10e-6  # m
WITHIN = "Readings of single poses, about all that is smooth in their loads,"
FINEST = 1e-9  # m; what is smaller is that of copied rows or computed data, of no instrument


@dataclass(frozen=True)
class NoiseModel:
    """What one reading is worth.

    Args:
        sigma: Standard uncertainty of one reading per axis, m.
        growth: Standard uncertainty per metre of displacement, added in squares to the loaded
            reading.
        zero: ``"shared"``: rows of equal `Measurements.zero_group` share the error of their zero
            reading; ``"separate"``: each row has a zero reading of its own.
        freedom: Degrees of freedom behind sigma: infinite where it was stated, those of the repeats
            that tell it, 0 where it is only a scale to start from and the fit has to tell.
        form: Model-form error beside the noise of the instrument.
        force: Standard uncertainty of every component of a force, as a share of the whole force.

    Raises:
        InputError: A sigma that is not positive, a growth or an error of forces below zero or from
            1 up, an unknown zero.

    Examples:
        >>> import sk120stiff as sk
        >>> data = sk.bundled_robots()["motoman_sk120"] / "data"
        >>> readings = sk.read(data / "table2_measured.csv")
        >>> found = sk.fit(sk.base_model(sk.load_robot("motoman_sk120")), readings)
        >>> known = sk.fit(found.model, readings, noise=sk.NoiseModel(20e-6))  # m, stated
        >>> known.sigma_known, found.sigma_known
        (True, False)
    """

    sigma: float
    growth: float = 0.0
    zero: Literal["shared", "separate"] = "shared"
    freedom: float = np.inf
    form: ModelForm = EXACT
    force: float = 0.0

    def __post_init__(self) -> None:
        if not 0 < self.sigma < np.inf:
            raise InputError(f"a noise sigma of {self.sigma} m is not positive")
        if not 0 <= self.growth < 1:
            raise InputError(f"a noise growth of {self.growth} is not between 0 and 1")
        if not 0 <= self.force < 1:
            raise InputError(f"an error of forces of {self.force} is not between 0 and 1")
        if self.zero not in ("shared", "separate"):
            raise InputError(f"a zero reading that is {self.zero!r} has no covariance")
        if not self.freedom >= 0:
            raise InputError(f"{self.freedom} degrees of freedom are no number of them")

    @property
    def stated(self) -> bool:
        """Sigma was stated."""
        return bool(np.isinf(self.freedom))

    @property
    def known(self) -> bool:
        """Sigma was stated, or repeats tell it well enough; else a fit has to."""
        return self.freedom >= ENOUGH

    def scaled(self, factor: float) -> NoiseModel:
        """The same model with sigma, growth and errors of forces times `factor`.

        V is multiplied by factor², except for what rows state of their own (sx, sy, sz).

        Examples:
            >>> import sk120stiff as sk
            >>> sk.NoiseModel(10e-6).scaled(2.0).sigma
            2e-05
        """
        return dataclasses.replace(
            self,
            sigma=self.sigma * factor,
            growth=self.growth * factor,
            force=self.force * factor,
            form=self.form.scaled(factor),
        )

    def variances(
        self, measurements: Measurements, sizes: ArrayLike | None = None
    ) -> tuple[Array, Array]:
        """Variance of the loaded reading (N, 3) and of its zero reading (N, 3), m².

        That of an axis that was not read is infinite.

        Args:
            measurements: The N readings.
            sizes: Size of each displacement, m, that the growth applies to: (N,), or (N, 3) per
                axis. None takes the length of the measured displacement.

        Raises:
            InputError: A growth without sizes in a plan, or sizes of another shape.

        Examples:
            >>> import sk120stiff as sk
            >>> data = sk.bundled_robots()["motoman_sk120"] / "data"
            >>> readings = sk.read(data / "table2_measured.csv")
            >>> loaded, zero = sk.NoiseModel(10e-6).variances(readings)  # m²
            >>> print(loaded.shape, f"{1e6 * (loaded + zero).max() ** 0.5:.1f} µm")
            (15, 3) 14.1 µm
        """
        stated = None if measurements.sigma is None else measurements.sigma**2
        own, zero = self._variances(measurements, sizes, stated)
        if self.force > 0:
            own = own + ((self.force * by_force_of(measurements)) ** 2).sum(axis=2)
        return own, zero

    def _variances(
        self, measurements: Measurements, sizes: ArrayLike | None, stated: Array | None
    ) -> tuple[Array, Array]:
        """See `variances`, without forces; `stated` (N, 3) are those of rows, along any axes."""
        count = measurements.n_readings
        own = zero = np.full((count, 3), self.sigma**2)
        if stated is not None:
            own = stated
            group = np.arange(count) if self.zero == "separate" else measurements.zero_group
            zero = _mean_of_groups(own, group, instead=self.sigma**2)
        if self.growth > 0:
            own = own + (self.growth * _sizes(measurements, sizes)) ** 2
        if not measurements.read.all():
            own = np.where(measurements.read, own, np.inf)
        return own, zero / measurements.zero_count[:, None]

    def whitener(
        self,
        measurements: Measurements,
        sizes: ArrayLike | None = None,
        weights: Array | None = None,
    ) -> Whitens:
        """The whitener of these readings; parameters and errors as in `variances`.

        `weights` (N,) is the share of its information that each reading keeps; None: all of it.

        Examples:
            >>> import sk120stiff as sk
            >>> data = sk.bundled_robots()["motoman_sk120"] / "data"
            >>> readings = sk.read(data / "table2_measured.csv")
            >>> whitener = sk.NoiseModel(10e-6).whitener(readings)
            >>> whitener.apply(readings.displacement).shape
            (45,)
        """
        stated = axes = None
        if measurements.sigma is not None:
            stated = measurements.sigma**2
            if measurements.along is not None and np.isfinite(measurements.along).any():
                stated, axes = in_axes_of_sight(measurements.along, measurements.sigma)
        own, zero = self._variances(measurements, sizes, stated)
        group = read_apart(measurements.directions, measurements.zero_group)
        if self.zero == "separate":
            own, zero, group = own + zero, np.zeros_like(own), np.arange(len(own))
        if weights is not None:
            own = own / weights[:, None]
        noise: Whitens
        if self.force > 0:
            moved = self.force * by_force_of(measurements)
            if weights is not None:
                moved = moved / np.sqrt(weights)[:, None, None]
            noise = ForceWhitener(own, zero, group, axes, moved)
        else:
            noise = Whitener(own, zero, group, axes)
        return FormWhitener(noise, self.form, measurements) if self.form else noise

    def covariance(self, measurements: Measurements, sizes: ArrayLike | None = None) -> Array:
        """Dense covariance (3, N, N) per axis, m²: for a look at few readings, not for fits.

        What an instrument's ray or a force's error makes the axes of one reading have in common is
        not in it.

        Examples:
            >>> import sk120stiff as sk
            >>> data = sk.bundled_robots()["motoman_sk120"] / "data"
            >>> readings = sk.read(data / "table2_measured.csv")
            >>> V = sk.NoiseModel(10e-6).covariance(readings)[0]  # m², along x
            >>> print(f"{V[0, 1] / V[0, 0]:.2f}")  # two rows of a pose share their zero reading
            0.50
        """
        own, zero = self.variances(measurements, sizes)
        same = np.eye(len(own), dtype=bool)
        if self.zero == "shared":
            group = read_apart(measurements.directions, measurements.zero_group)
            same = group[:, None] == group[None, :]
        full: Array = np.where(same, zero.T[:, :, None], 0.0)
        each = np.arange(len(own))
        full[:, each, each] += own.T
        return full

    def of_growth_and_zero(self, measurements: Measurements | None = None) -> str:
        """What the model holds beside the size of sigma, in plain words.

        Args:
            measurements: Those that it is of; no two rows may subtract one zero reading there.

        Examples:
            >>> import sk120stiff as sk
            >>> sk.NoiseModel(10e-6).of_growth_and_zero()
            'Rows that subtract the same zero reading share its error.'
        """
        said = ""
        if self.growth > 0:
            said = f"The loaded one has {self.growth * 100:.3g} % of its displacement besides. "
        if self.force > 0:
            said += f"Every component of a force is off by {self.force * 100:.3g} % of the force. "
        group = np.zeros(2) if measurements is None else measurements.zero_group
        if self.zero == "shared" and len(np.unique(group)) < len(group):
            return f"{said}Rows that subtract the same zero reading share its error."
        return f"{said}Each row subtracts a zero reading of its own, so rows err independently."


def candidates(measurements: Measurements) -> list[NoiseModel]:
    """The noise models that the data leave open: more than one where nobody described the zero.

    Sigma is the stated one, else the median of the rows' own, else from repeats, else a scale to
    start from (``freedom=0``). A growth that is neither stated nor part of the rows' own
    uncertainties is taken from repeats, and is zero without them.
    """
    usable = measurements.masked()
    zeros: list[Literal["shared", "separate"]] = ["shared", "separate"]
    if usable.zero != "unknown":
        zeros = [usable.zero]
    elif len(np.unique(usable.zero_group)) == usable.n_readings:
        zeros = ["separate"]
    return [_described(usable, zero) for zero in zeros]


def decided(noise: NoiseModel, measurements: Measurements) -> tuple[str, ...]:
    """What was taken for noise beyond the data's own description, in sentences."""
    said = [note for note in measurements.notes if TOLD in note or SEEN in note]
    if measurements.zero == "unknown" and len(candidates(measurements)) > 1:
        said.append(
            f"Nobody said how zero readings were shared; {noise.zero} ones explain the readings "
            "best. Write 'displacement: {zero: shared}' or 'separate' if you know."
        )
    if 0 < noise.freedom < np.inf and noise.known:
        said.append(
            f"No uncertainty is stated; repeats give {short(noise.sigma * 1e6)} µm for one reading "
            f"({noise.freedom:.0f} degrees of freedom)."
        )
    if noise.growth > 0 and measurements.noise.growth is None:
        said.append(
            f"{_witness(measurements)} scatter the more the larger the displacement: "
            f"{two_digits(noise.growth * 100)} % of it is added to the uncertainty, in squares."
        )
    if noise.force > 0 and measurements.noise.force is None:
        said.append(
            f"{WITHIN} scatter as where every component of a force is off by "
            f"{two_digits(noise.force * 100)} % of the force, as with a gauge held by hand, and "
            "that is added to the uncertainty. If you know better, write 'noise: {force: ...}' "
            "(a share: 0.01 for 1 %)."
        )
    return tuple(said)


def _witness(measurements: Measurements) -> str:
    """Who tells that noise grows."""
    return "Repeats" if any(each.growth for each in candidates(measurements)) else WITHIN


def _described(measurements: Measurements, zero: Literal["shared", "separate"]) -> NoiseModel:
    stated, growth = measurements.noise.sigma, measurements.noise.growth
    of_rows = measurements.sigma is not None
    force = measurements.noise.force or 0.0
    found = None  # repeats scatter by errors of forces too, and are counted once
    if not of_rows and not force and (stated is None or growth is None):
        found = repeated(measurements, zero, grows=growth is None)
    if growth is None:
        growth = found.growth if found is not None else 0.0
    if stated is not None:
        return NoiseModel(stated, growth, zero, force=force)
    if measurements.sigma is not None:
        return NoiseModel(float(np.nanmedian(measurements.sigma)), growth, zero, force=force)
    sigma, freedom = _from_repeats(found)
    return NoiseModel(sigma, growth, zero, freedom, force=force)


def _from_repeats(found: Repeated | None) -> tuple[float, float]:
    if found is None or found.sigma <= FINEST:
        return _START, 0
    return found.sigma, found.freedom


def _mean_of_groups(values: Array, group: Integers, *, instead: float) -> Array:
    """(N, 3) mean of the values (N, 3) of each row's group; `instead` where none is known."""
    known = np.isfinite(values)
    _, index = np.unique(group, return_inverse=True)
    sums, counts = np.zeros((2, int(index.max()) + 1, 3))
    np.add.at(sums, index, np.where(known, values, 0.0))
    np.add.at(counts, index, known)
    return np.where(counts > 0, sums / np.maximum(counts, 1.0), instead)[index]


def _sizes(measurements: Measurements, sizes: ArrayLike | None) -> Array:
    if sizes is None:
        if measurements.displacement is None:
            raise InputError(
                "noise that grows with the displacement needs displacements, and a plan has none",
                remedy="Give their predicted sizes.",
            )
        sizes = np.linalg.norm(measurements.moved, axis=1)
    array = np.abs(np.asarray(sizes, dtype=np.float64))
    if array.shape not in ((measurements.n_readings,), (measurements.n_readings, 3)):
        raise InputError(
            f"displacement sizes have shape {array.shape}",
            remedy=f"Give ({measurements.n_readings},) or ({measurements.n_readings}, 3).",
        )
    return array[:, None] if array.ndim == 1 else array
