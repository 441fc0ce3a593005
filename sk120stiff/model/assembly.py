"""A robot with effects as one mechanism: prediction and its exact derivatives.

Coordinates are z = [a; v], actuated and virtual. A reading is made in five steps:

1. the load errors turn the reported wrench into the true one, in sensor axes;
2. the geometric effects shift the unloaded coordinates z₀;
3. the imposed movements s go on top, and the elastic effects find their common equilibrium
   z = z₀ + s + e(J(z)ᵀ W);
4. the displacement is x(z) − x(z₀);
5. the reading errors turn it into what the instrument says.

Derivatives follow from one adjoint solve per reading: with N = I − C K_C at the equilibrium,
∂x/∂p = (J N⁻¹) ∂(s + e)/∂p.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.effects import (
    Effect,
    Elastic,
    Geometric,
    Imposed,
    LinearElastic,
    LoadCases,
    LoadError,
    ReadingError,
    Weighing,
)
from sk120stiff.effects.base import Misreading, Switching
from sk120stiff.model.misread import misread, rotate, to_sensor
from sk120stiff.model.standing import Solution, Standing
from sk120stiff.robot import Mechanism, Robot
from sk120stiff.stiffness import ElasticLaw, Equilibrium, Weight, equilibrium


@dataclass(frozen=True, eq=False)
class Assembly:
    """Effects put together on a robot; values of their parameters are given at each call.

    Attributes:
        robot: The rigid robot.
        effects: The effects, in the order of their parameters in the vector of values.
    """

    robot: Robot
    effects: tuple[Effect, ...]

    @cached_property
    def slices(self) -> tuple[slice, ...]:
        """Each effect's part of the vector of values."""
        ends = np.cumsum([0, *(len(effect.parameters) for effect in self.effects)])
        return tuple(slice(int(a), int(b)) for a, b in pairwise(ends))

    @cached_property
    def mechanism(self) -> Mechanism:
        """The robot with all virtual joints; laws of one effect may share some."""
        virtual = {
            joint.name: joint
            for effect in self.effects
            if isinstance(effect, Elastic | Geometric | Imposed)
            for joint in effect.virtual_joints(self.robot)
        }
        rigid = self.robot.mechanism()
        return rigid.with_virtual_joints(list(virtual.values())) if virtual else rigid

    @cached_property
    def _coordinate(self) -> dict[str, int]:
        names = [*self.robot.actuated, *(joint.name for joint in self.mechanism.virtual)]
        return {name: k for k, name in enumerate(names)}

    @cached_property
    def _elastic(self) -> tuple[tuple[Elastic, slice, Index], ...]:
        return tuple(
            (effect, part, self._indices(effect.coordinates(self.robot)))
            for effect, part in zip(self.effects, self.slices, strict=True)
            if isinstance(effect, Elastic)
        )

    @cached_property
    def _geometric(self) -> tuple[tuple[Geometric, slice, Index], ...]:
        return tuple(
            (effect, part, self._indices(effect.coordinates(self.robot)))
            for effect, part in zip(self.effects, self.slices, strict=True)
            if isinstance(effect, Geometric)
        )

    @cached_property
    def _imposed(self) -> tuple[tuple[Imposed, slice, Index], ...]:
        return tuple(
            (effect, part, self._indices(effect.coordinates(self.robot)))
            for effect, part in zip(self.effects, self.slices, strict=True)
            if isinstance(effect, Imposed)
        )

    def _indices(self, names: Sequence[str]) -> Index:
        return np.array([self._coordinate[name] for name in names], dtype=np.intp)

    def start(self, load_cases: LoadCases, values: Array) -> Array:
        """(N, n_z) unloaded coordinates z₀ [rad or m]."""
        z_0 = np.zeros((load_cases.count, self.mechanism.n))
        z_0[:, : self.robot.n] = load_cases.a
        for effect, part, index in self._geometric:
            if values[part].any() and not _marks(effect, load_cases):
                z_0[:, index] += effect.shifts(load_cases) @ values[part]
        return z_0

    def _moved(self, z_0: Array, load_cases: LoadCases, values: Array) -> Array:
        """(N, n_z) where the coordinates have gone by themselves since the zero reading."""
        if not self._imposed:
            return z_0
        moved = z_0.copy()
        for effect, part, index in self._imposed:
            moved[:, index] += effect.shifts(load_cases) @ values[part]
        return moved

    @cached_property
    def _parts(self) -> dict[bytes, tuple[Assembly, Array, Index]]:
        return {}

    def _at_work(self, values: Array) -> tuple[Assembly, Array, Index] | None:
        """The effects that do anything, their part of the values, and their coordinates here.

        None where most of the coordinates are at work anyway.
        """
        works = np.array([values[part].any() for part in self.slices], dtype=bool)
        if works.all():
            return None
        key = works.tobytes()
        if key not in self._parts:
            effects = tuple(e for e, own in zip(self.effects, works, strict=True) if own)
            few = Assembly(self.robot, effects)
            lengths = [part.stop - part.start for part in self.slices]
            index = self._indices(list(few._coordinate))
            self._parts[key] = few, np.repeat(works, lengths), index
        few, chosen, index = self._parts[key]
        return (few, chosen, index) if 2 * few.mechanism.n < self.mechanism.n else None

    def stand(self, load_cases: LoadCases, values: Array, near: Array | None = None) -> Standing:
        """Equilibrium under load and weight for N readings and parameter values (P,).

        `near` (N, n_z): the coordinates at which the arm is known to come to rest.

        Raises:
            Refusal: The springs cannot hold the load.
        """
        loads = misread(self.of(LoadError), load_cases, values, to_sensor(load_cases))
        wrench = rotate(load_cases.rotation, loads.value)
        z_0 = self.start(load_cases, values)
        onset = np.zeros_like(z_0)
        if any(isinstance(effect, Switching) for effect in self.effects):
            onset = self.mechanism.screws(z_0, load_cases.force_point).torques(wrench)
        law, springs = self.law(load_cases, values, onset)
        rest = equilibrium(
            self.mechanism,
            self._moved(z_0, load_cases, values),
            wrench,
            law,
            point=self._marker(load_cases, values),
            force_point=load_cases.force_point,
            soft=self.soft(values),
            weight=self.weight(springs, values),
            near=near,
        )
        return Standing(load_cases, wrench, loads, onset, rest)

    def solve(self, load_cases: LoadCases, values: Array) -> Solution:
        """Equilibrium and displacement for N readings and parameter values (P,).

        Raises:
            Refusal: The springs cannot hold the load.
        """
        loaded, bare = self._found_by_few(load_cases, values)
        stood = self.stand(load_cases, values, loaded)
        z_0 = self.start(load_cases, values)
        if load_cases.zero_a is not None:  # encoders read a little otherwise without load
            z_0[:, : self.robot.n] += load_cases.zero_a - load_cases.a
        unloaded = self._sagging(z_0, load_cases, stood.rest.weight, self.soft(values), bare)
        displacement = stood.rest.screws.position - unloaded.screws.position
        readings = misread(self.of(ReadingError), load_cases, values, displacement)
        return Solution(
            load_cases, stood.wrench, stood.loads, stood.onset, stood.rest, unloaded, readings
        )

    def _found_by_few(
        self, load_cases: LoadCases, values: Array
    ) -> tuple[Array, Array] | tuple[None, None]:
        """(N, n_z) where the arm rests with and without load, by what is at work alone.

        Every virtual joint costs in each of Newton's steps, and most of a catalogue's are rigid.
        """
        part = self._at_work(values)
        if part is None:
            return None, None
        few, chosen, index = part
        found = few.solve(load_cases, values[chosen])
        loaded, bare = (np.zeros((load_cases.count, self.mechanism.n)) for _ in range(2))
        loaded[:, index], bare[:, index] = found.rest.z, found.unloaded.z
        return loaded, bare

    def _marker(self, load_cases: LoadCases, values: Array) -> Array:
        """(3,) or (N, 3) measured point in the tool frame [m]."""
        point = load_cases.point
        for effect, part, _ in self._geometric:
            if _marks(effect, load_cases) and values[part].any():
                point = point + effect.shifts(load_cases) @ values[part]
        return point

    def weight(self, springs: Array, values: Array) -> Weight | None:
        """The arm's own weight on the linear springs; None where no masses are stated."""
        if not self.mechanism.chain.weighs:
            return None
        return Weight(self.heavier(values) * self.robot.gravity_in_base, springs)

    @cached_property
    def _weighing(self) -> Index:
        own = [isinstance(e, Weighing) for e in self.effects for _ in e.parameters]
        return np.flatnonzero(own)

    def heavier(self, values: Array) -> float:
        """True over stated weight of the arm's links."""
        return 1.0 + float(values[self._weighing].sum())

    def _sagging(
        self,
        z_0: Array,
        load_cases: LoadCases,
        weight: Weight | None,
        soft: Index,
        near: Array | None,
    ) -> Equilibrium:
        """The arm before the load comes, bent by its own weight only.

        Under one load after the other it begins alike: where it rests is sought once.
        """
        points = load_cases.point

        def hanging(rows: slice | Mask, near: Array | None) -> Equilibrium:
            return equilibrium(
                self.mechanism,
                z_0[rows],
                np.zeros((len(z_0[rows]), 6)),
                lambda torques: (np.zeros_like(torques), np.zeros((z_0.shape[1],) * 2)),
                point=points if points.ndim == 1 else points[rows],
                soft=soft if weight is not None else np.zeros(0, dtype=np.intp),
                weight=weight,
                near=near,
            )

        fresh = np.append(True, (z_0[1:] != z_0[:-1]).any(axis=1))
        if weight is not None and near is None and weight.compliance.ndim == 2 and not fresh.all():
            near = hanging(fresh, None).z[np.cumsum(fresh) - 1]
        return hanging(slice(None), near)

    def of(self, kind: type[LoadError] | type[ReadingError]) -> list[tuple[Misreading, slice]]:
        """The misreadings of a kind, each with its part of the vector of values."""
        pairs = zip(self.effects, self.slices, strict=True)
        return [(effect, part) for effect, part in pairs if isinstance(effect, kind)]

    def soft(self, values: Array) -> Index:
        """Coordinates that yield at all: the equilibrium is sought in these alone."""
        found = [index for _, part, index in self._elastic if values[part].any()]
        return np.unique(np.concatenate(found)) if found else np.zeros(0, dtype=np.intp)

    def law(self, load_cases: LoadCases, values: Array, onset: Array) -> tuple[ElasticLaw, Array]:
        """Elongation of all coordinates under the load, and the compliance of what is linear.

        What does not change with the coordinates is evaluated only once.
        """
        n = self.mechanism.n
        constant = np.zeros((n, n))
        varying: Array | None = None
        jumps = np.zeros((load_cases.count, n))
        nonlinear: list[tuple[Elastic, slice, Index]] = []
        for effect, part, index in self._elastic:
            if not values[part].any():
                continue
            if isinstance(effect, Switching):
                found = effect.elongation(onset[:, index], load_cases, values[part])
                jumps[:, index] += found.value
                continue
            if not isinstance(effect, LinearElastic):
                nonlinear.append((effect, part, index))
                continue
            patterns = effect.patterns(load_cases)
            block = np.tensordot(values[part], patterns, axes=1)
            if patterns.ndim == 3:
                constant[np.ix_(index, index)] += block
            else:
                if varying is None:
                    varying = np.zeros((load_cases.count, n, n))
                varying[:, index[:, None], index] += block
        linear = constant if varying is None else constant + varying

        def law(torques: Array) -> tuple[Array, Array]:
            elongation = jumps + (linear @ torques[..., None])[..., 0]
            if not nonlinear:
                return elongation, linear
            tangent = np.broadcast_to(linear, (load_cases.count, n, n)).copy()
            for effect, part, index in nonlinear:
                found = effect.elongation(torques[:, index], load_cases, values[part])
                elongation[:, index] += found.value
                tangent[:, index[:, None], index] += found.by_torque
            return elongation, tangent

        return law, linear

    def standing_sensitivities(self, solution: Solution, values: Array) -> Array:
        """(N, 3, P) exact derivative of where the loaded point stands, base axes.

        By the parameters of the arm itself: those of load and reading errors have no part in it.
        """
        rest = solution.rest
        adjoint = rest.adjoint(rest.screws.linear_jacobian, self.soft(values))
        return self._standing(solution, values, adjoint)

    def _standing(self, solution: Standing, values: Array, adjoint: Array) -> Array:
        load_cases, rest = solution.load_cases, solution.rest
        P = int(self.slices[-1].stop) if self.slices else 0
        out = np.zeros((load_cases.count, adjoint.shape[1], P))
        for effect, part, index in self._elastic:
            torques = solution.onset if isinstance(effect, Switching) else rest.torques
            if isinstance(effect, LinearElastic):
                torques = torques + rest.weights
            found = effect.elongation(torques[:, index], load_cases, values[part])
            out[:, :, part] += adjoint[:, :, index] @ found.by_parameter
        for shifted, part, index in self._geometric:
            if _marks(shifted, load_cases):
                out[:, :3, part] += rest.screws.rotation @ shifted.shifts(load_cases)
                continue
            out[:, :, part] += adjoint[:, :, index] @ shifted.shifts(load_cases)
        for moving, part, index in self._imposed:
            out[:, :, part] += adjoint[:, :, index] @ moving.shifts(load_cases)
        if len(self._weighing):
            out[:, :, self._weighing] += self._by_weight(rest, adjoint)
        return out

    def pose_sensitivities(self, stood: Standing, values: Array) -> Array:
        """(N, 6, P) exact derivative of where the point stands and how it is turned, base axes."""
        adjoint = stood.rest.adjoint(stood.rest.screws.jacobian, self.soft(values))
        out = self._standing(stood, values, adjoint)
        self._add_loads(out, stood, adjoint)
        return out

    def sensitivities(self, solution: Solution, values: Array) -> Array:
        """(N, 3, P) exact derivative of the readings by the internal parameter values."""
        load_cases, rest, before = solution.load_cases, solution.rest, solution.unloaded
        soft = self.soft(values)
        adjoint = rest.adjoint(rest.screws.linear_jacobian, soft)  # (N, 3, n_z)
        weighs = self.mechanism.chain.weighs
        J_0 = before.screws.linear_jacobian
        adjoint_0 = before.adjoint(J_0, soft) if weighs else J_0
        out = self._standing(solution, values, adjoint)
        for effect, part, index in self._elastic:
            if isinstance(effect, LinearElastic) and weighs:
                found = effect.elongation(before.weights[:, index], load_cases, values[part])
                out[:, :, part] -= adjoint_0[:, :, index] @ found.by_parameter
        for shifted, part, index in self._geometric:
            out[:, :, part] -= adjoint_0[:, :, index] @ shifted.shifts(load_cases)
        if len(self._weighing):
            out[:, :, self._weighing] -= self._by_weight(before, adjoint_0)
        self._add_loads(out, solution, adjoint)
        out = solution.readings.matrix @ out
        for part, columns in solution.readings.columns:
            out[:, :, part] += columns
        return np.swapaxes(load_cases.reading_axes, -1, -2) @ out

    def _by_weight(self, rest: Equilibrium, adjoint: Array) -> Array:
        """(N, k, 1) derivative by the arm's true weight over the stated one."""
        if rest.weight is None:
            return np.zeros((*adjoint.shape[:-1], 1))
        stated = rest.screws.gravity_torques(self.robot.gravity_in_base)
        return np.asarray(adjoint @ (rest.weight.compliance @ stated[..., None]))

    def _add_loads(self, out: Array, solution: Standing, adjoint: Array) -> None:
        """Add the derivatives (N, k, P) by the parameters of the load errors."""
        load_cases, rest = solution.load_cases, solution.rest
        if not solution.loads.columns:
            return
        loaded = rest.screws.at(load_cases.force_point)
        per_wrench = adjoint @ rest.compliance @ np.swapaxes(loaded.jacobian, -1, -2)  # (N, k, 6)
        for part, columns in solution.loads.columns:
            halves = columns.reshape(len(columns), 2, 3, -1)  # forces, moments
            turned = np.einsum("nij,nhjp->nhip", load_cases.rotation, halves).reshape(columns.shape)
            out[:, :, part] += per_wrench @ turned


def _marks(effect: Geometric, load_cases: LoadCases) -> bool:
    """Does it move the marker, and nothing of the arm?"""
    return effect.of_marker and load_cases.absolute
