"""A robot with effects as one mechanism, and what it predicts.

Coordinates are z = [a; v], actuated and virtual. A reading is made in five steps:

1. the load errors turn the reported wrench into the true one, in sensor axes (`true_load.py`);
2. the geometric effects shift the unloaded coordinates z₀;
3. the imposed movements s go on top, and the elastic effects find their common equilibrium
   z = z₀ + s + e(J(z)ᵀ W(z)), where what a sensor on the tool has read turns with the tool;
4. the displacement is x(z) − x(z₀);
5. the reading errors turn it into what the instrument says.

Its exact derivatives are in `sensitivities.py`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
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
from sk120stiff.effects.base import Misreading, Moving
from sk120stiff.effects.switching import Switching
from sk120stiff.model.misread import misread
from sk120stiff.model.standing import Solution, Standing
from sk120stiff.model.true_load import true_load
from sk120stiff.robot import Mechanism, Robot
from sk120stiff.stiffness import ElasticLaw, Equilibrium, Weight, equilibrium

KEPT = 32  # sets of effects that stay put together


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
            if isinstance(effect, Moving)
            for joint in effect.virtual_joints(self.robot)
        }
        rigid = self.robot.mechanism()
        return rigid.with_virtual_joints(list(virtual.values())) if virtual else rigid

    @cached_property
    def _coordinate(self) -> dict[str, int]:
        names = [*self.robot.actuated, *(joint.name for joint in self.mechanism.virtual)]
        return {name: k for k, name in enumerate(names)}

    @cached_property
    def elastic(self) -> tuple[tuple[Elastic, slice, Index], ...]:
        """What yields, each with its part of the values and the indices of its coordinates."""
        return tuple((e, part, k) for e, part, k in self._moving if isinstance(e, Elastic))

    @cached_property
    def geometric(self) -> tuple[tuple[Geometric, slice, Index], ...]:
        """What shifts the unloaded coordinates, likewise."""
        return tuple((e, part, k) for e, part, k in self._moving if isinstance(e, Geometric))

    @cached_property
    def imposed(self) -> tuple[tuple[Imposed, slice, Index], ...]:
        """What moves coordinates between zero and reading, likewise."""
        return tuple((e, part, k) for e, part, k in self._moving if isinstance(e, Imposed))

    @cached_property
    def _moving(self) -> tuple[tuple[Moving, slice, Index], ...]:
        return tuple(
            (effect, part, self._indices(effect.coordinates(self.robot)))
            for effect, part in zip(self.effects, self.slices, strict=True)
            if isinstance(effect, Moving)
        )

    def _indices(self, names: Sequence[str]) -> Index:
        return np.array([self._coordinate[name] for name in names], dtype=np.intp)

    def start(self, load_cases: LoadCases, values: Array) -> Array:
        """(N, n_z) unloaded coordinates z₀ [rad or m]."""
        z_0 = np.zeros((load_cases.count, self.mechanism.n))
        z_0[:, : self.robot.n] = load_cases.a
        for effect, part, index in self.geometric:
            if values[part].any() and not effect.marks(load_cases):
                z_0[:, index] += effect.shifts(load_cases) @ values[part]
        return z_0

    def _moved(self, z_0: Array, load_cases: LoadCases, values: Array) -> Array:
        """(N, n_z) where the coordinates have gone by themselves since the zero reading."""
        if not self.imposed:
            return z_0
        moved = z_0.copy()
        for effect, part, index in self.imposed:
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
        load = true_load(self.of(LoadError), load_cases, values)
        z_0 = self.start(load_cases, values)
        onset, begun = np.zeros_like(z_0), None
        if any(isinstance(effect, Switching) for effect in self.effects):
            begun = self.mechanism.screws(z_0, load_cases.force_point)
            onset = begun.torques(load.at(begun.rotation))
        law, springs = self.law(load_cases, values, onset)
        rest = equilibrium(
            self.mechanism,
            self._moved(z_0, load_cases, values),
            load.steady,
            law,
            point=self._marker(load_cases, values),
            force_point=load_cases.force_point,
            follower=load.follower,
            soft=self.soft(values),
            weight=self.weight(springs, values),
            near=near,
        )
        return Standing(load_cases, load, onset, begun, rest)

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
        unloaded, begin = self._sagging(z_0, load_cases, values, stood.rest.weight, bare)
        displacement = stood.rest.screws.position - unloaded.screws.position[begin]
        readings = misread(self.of(ReadingError), load_cases, values, displacement)
        return Solution(
            load_cases, stood.load, stood.onset, stood.begun, stood.rest,
            unloaded=unloaded, begin=begin, readings=readings,
        )  # fmt: skip

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
        loaded[:, index], bare[:, index] = found.rest.z, found.unloaded.z[found.begin]
        return loaded, bare

    def _marker(self, load_cases: LoadCases, values: Array) -> Array:
        """(3,) or (N, 3) measured point in the tool frame [m]."""
        point = load_cases.point
        for effect, part, _ in self.geometric:
            if effect.marks(load_cases) and values[part].any():
                point = point + effect.shifts(load_cases) @ values[part]
        return point

    def weight(self, springs: Array, values: Array) -> Weight | None:
        """The arm's own weight on the linear springs; None where no masses are stated."""
        if not self.mechanism.chain.weighs:
            return None
        return Weight(self.heavier(values) * self.robot.gravity_in_base, springs)

    @cached_property
    def weighing(self) -> Index:
        """Places of the parameters that change the arm's own weight, among the values."""
        own = [isinstance(e, Weighing) for e in self.effects for _ in e.parameters]
        return np.flatnonzero(own)

    def heavier(self, values: Array) -> float:
        """True over stated weight of the arm's links."""
        return 1.0 + float(values[self.weighing].sum())

    def _sagging(
        self,
        z_0: Array,
        load_cases: LoadCases,
        values: Array,
        weight: Weight | None,
        near: Array | None,
    ) -> tuple[Equilibrium, Index | slice]:
        """The arm before the load comes, bent by its own weight only; see `Solution.begin`.

        Under one load after the other it begins alike: where it rests is worked out once.
        """
        points = self._marker(load_cases, values)
        apart = z_0 if points.ndim == 1 else np.hstack([z_0, points])
        fresh = np.append(True, (apart[1:] != apart[:-1]).any(axis=1))
        rows: Mask | slice = slice(None)
        begin: Index | slice = slice(None)
        if not fresh.all() and (weight is None or weight.compliance.ndim == 2):
            rows, begin = fresh, np.cumsum(fresh) - 1
        start = z_0[rows]
        rest = equilibrium(
            self.mechanism,
            start,
            np.zeros((len(start), 6)),
            lambda torques: (np.zeros_like(torques), np.zeros((start.shape[1],) * 2)),
            point=points if points.ndim == 1 else points[rows],
            soft=self.soft(values) if weight is not None else np.zeros(0, dtype=np.intp),
            weight=weight,
            near=None if near is None else near[rows],
        )
        return rest, begin

    def of(self, kind: type[LoadError] | type[ReadingError]) -> list[tuple[Misreading, slice]]:
        """The misreadings of a kind, each with its part of the vector of values."""
        pairs = zip(self.effects, self.slices, strict=True)
        return [(effect, part) for effect, part in pairs if isinstance(effect, kind)]

    def soft(self, values: Array) -> Index:
        """Coordinates that yield at all: the equilibrium is sought in these alone."""
        found = [index for _, part, index in self.elastic if values[part].any()]
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
        for effect, part, index in self.elastic:
            if not values[part].any():
                continue
            if isinstance(effect, Switching):
                found = effect.elongation(onset[:, index], load_cases, values[part])
                jumps[:, index] += found.value
                continue
            if not isinstance(effect, LinearElastic):
                nonlinear.append((effect, part, index))
                continue
            patterns = effect.patterns_at(load_cases)
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


@lru_cache(maxsize=KEPT)
def assembled(robot: Robot, effects: tuple[Effect, ...]) -> Assembly:
    """These effects put together on a robot; the last few sets of them are still put together.

    A search linearises and fits the same sets again and again, at other values.
    """
    return Assembly(robot, effects)
