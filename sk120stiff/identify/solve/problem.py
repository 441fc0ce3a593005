"""The least-squares problem: whitened gap and its derivative, as functions of scaled parameters."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.effects import LoadCases, load_cases_of
from sk120stiff.errors import InputError
from sk120stiff.identify.solve.forces import with_by_force
from sk120stiff.identify.solve.polish import FAINTEST
from sk120stiff.measurements import Measurements, NoiseModel, Whitens
from sk120stiff.model import Model


@dataclass(frozen=True, eq=False)
class Problem:
    """A model, readings and their noise.

    Attributes:
        model: Gives the starting values and says which parameters are free.
        measurements: N readings in use, with displacements; where forces err, with what they move,
            which the model's values tell of readings that do not know it yet.
        noise: Covariance of the readings.
        weights: (N,) share of its information that each reading keeps, in (0, 1]; None: all of it.
    """

    model: Model
    measurements: Measurements
    noise: NoiseModel
    weights: Array | None = None

    def __post_init__(self) -> None:
        where = str(self.measurements.path or "measurements")
        if self.measurements.absolute is not None:
            raise InputError(
                "these readings say where a marker stands, not how far a load moved it",
                where=where,
                remedy="sk.fit and sk.explain take them, 'sk120stiff identify' and 'explain' too.",
            )
        if self.measurements.displacement is None:
            raise InputError(
                "there are no measured displacements",
                where=f"{where}, line 1",
                remedy="Add the columns dx, dy, dz (or x, y, z) with their unit.",
            )
        if not self.measurements.wrench.any():
            raise InputError(
                "no reading has a load, so nothing about stiffness was measured",
                where=f"{where}, columns fx, fy, fz",
                remedy="Add readings under load; rows with fx = fy = fz = 0 are zero readings.",
            )
        if self.noise.force > 0 and self.measurements.by_force is None:
            known = with_by_force(self.model, self.measurements)
            object.__setattr__(self, "measurements", known)

    @cached_property
    def load_cases(self) -> LoadCases:
        """The readings as the model sees them."""
        return load_cases_of(self.model.robot, self.measurements)

    @cached_property
    def measured(self) -> Array:
        """(N, 3) displacements [m]; NaN in an axis that was not read."""
        found = self.measurements.displacement
        return np.zeros((0, 3)) if found is None else found

    @property
    def read(self) -> Mask:
        """(N, 3) axes that were read, R of them; every whitened array has R rows."""
        return self.measurements.read

    @cached_property
    def pose(self) -> Index:
        """(R,) pose of each number that was read."""
        return self.load_cases.pose[self.measurements.row_of_number]

    @cached_property
    def sizes(self) -> Array:
        """(N,) lengths of the displacements, to which growing noise applies [m]."""
        return np.asarray(np.linalg.norm(self.measurements.moved, axis=1))

    @cached_property
    def whitener(self) -> Whitens:
        """V^(-1/2), with V from the noise, the measured sizes and the weights."""
        return self.noise.whitener(self.measurements, self.sizes, self.weights)

    @cached_property
    def free(self) -> Index:
        """Indices of the estimated parameters."""
        return self.model.free

    @cached_property
    def scale(self) -> Array:
        """(P_free,) typical sizes; the solvers work with values in these units."""
        return np.array([self.model.parameters[k].spec.typical for k in self.free])

    @cached_property
    def plausible(self) -> Array:
        """(P_free,) sizes in scaled units beyond which a value is implausible."""
        return np.array([self.model.parameters[k].spec.plausible for k in self.free]) / self.scale

    @cached_property
    def span(self) -> Array:
        """(P_free,) sizes in scaled units over which a change has to show, see `seen_directions`.

        What is plausible. Of a joint's spring that no load turns, to first order, it is so little
        that nothing shows: however soft it was, it would move nothing by as much as the noise, and
        what a floor that tips lets such a load tell of it is no measurement. Where nobody knows the
        noise it is no yardstick of that.
        """
        out = self.plausible.copy()
        if not self.noise.known:
            return out
        cases, robot = self.load_cases, self.model.robot
        torque = cases.nominal.at(cases.force_point).torques(cases.wrench)
        columns = cases.nominal.linear_jacobian * torque[:, None, :]  # (N, 3, n), base axes
        along = np.swapaxes(cases.reading_axes, 1, 2) @ columns
        shows = np.linalg.norm(self.whitener.apply(along), axis=0)
        for place, k in enumerate(self.free):
            parameter = self.model.parameters[k]
            if parameter.effect.joint_spring:
                turned = shows[robot.actuated.index(parameter.effect.where)]
                if turned * parameter.spec.plausible < 1.0:
                    out[place] = FAINTEST * parameter.spec.usual / self.scale[place]
        return out

    @cached_property
    def usual(self) -> Array:
        """(P_free,) usual errors of calibrated instruments in scaled units, elsewhere infinite."""
        free = [self.model.parameters[k] for k in self.free]
        usual = [p.spec.usual if p.effect.calibrated else np.inf for p in free]
        return np.array(usual) / self.scale

    @cached_property
    def draws(self) -> tuple[Index, ...]:
        """Which estimated parameters are draws of one size, by effect."""
        drawn = [p.effect.id if p.effect.random_effects else "" for p in self.model.parameters]
        names = np.array([drawn[k] for k in self.free], dtype=object)
        return tuple(np.flatnonzero(names == name) for name in dict.fromkeys(names) if name)

    @cached_property
    def bounds(self) -> tuple[Array, Array]:
        """(P_free,) physical bounds in scaled units."""
        specs = [self.model.parameters[k].spec for k in self.free]
        lower = np.array([spec.lower for spec in specs]) / self.scale
        upper = np.array([spec.upper for spec in specs]) / self.scale
        return lower, upper

    @cached_property
    def couplings(self) -> tuple[tuple[int, int, int], ...]:
        """Places i, j and k among the free parameters of which k couples i and j, see `Effect`."""
        place = {int(k): n for n, k in enumerate(self.free)}
        first: dict[str, int] = {}
        for number, parameter in enumerate(self.model.parameters):
            first.setdefault(parameter.effect.id, number)
        found = (
            tuple(first[effect.id] + k for k in own)
            for effect in self.model.effects
            for own in effect.couplings
        )
        return tuple(
            (place[i], place[j], place[k]) for i, j, k in found if {i, j, k} <= place.keys()
        )

    @cached_property
    def start(self) -> Array:
        """(P_free,) starting values in scaled units, none beyond what is plausible.

        Only parameters that the readings do not show keep them.
        """
        return np.clip(self.model.values[self.free] / self.scale, -self.plausible, self.plausible)

    @property
    def judged(self) -> Mask | None:
        """(M,) readings whose noise is known, of which alone the misfit is judged; None: of all."""
        return None

    @property
    def freedom_of_form(self) -> float:
        """Degrees of freedom behind the size of model-form error; infinite where there is none.

        A pose tells it by three axes, whatever the number of its loads.
        """
        if not self.noise.form:
            return np.inf
        return float(max(3 * len(self.measurements.poses) - len(self.free), 1))

    def values(self, x: Array) -> Array:
        """(P,) internal values for scaled free parameters `x`."""
        full = self.model.values.copy()
        full[self.free] = x * self.scale
        return full

    def gap(self, x: Array) -> Array:
        """(N, 3) measured minus predicted [m]; NaN in an axis that was not read."""
        return self.measured - self.model.predict(self.load_cases, self.values(x))

    def evaluate(self, x: Array) -> tuple[Array, Array]:
        """Whitened gap (R,) and its derivative (R, P_free) by `x`, at exact equilibrium."""
        predicted, derivative = self.model.predict_with_sensitivities(
            self.load_cases, self.values(x)
        )
        residual = self.whitener.apply(self.measured - predicted)
        return residual, -self.whitener.apply(derivative[:, :, self.free] * self.scale)

    @cached_property
    def first_order(self) -> tuple[Array, Array]:
        """Whitened gap and derivative of the model without its free effects.

        To first order in load every prediction is linear in these parameters, from any start; this
        carries the solvers from wild starting values to where the exact equilibrium exists.
        """
        nothing = np.zeros(len(self.free))
        return self.evaluate(nothing)

    def with_weights(self, weights: Array) -> Problem:
        """The same readings, each keeping a share (N,) of its information."""
        return replace(self, weights=weights)
