"""What each parameter does to the readings, to first order and per unit: its signature.

With J and τ = J_Fᵀ W at the unloaded pose and C the compliance of the joint springs, a reading is
d = J C τ, and its derivatives are

==================  ====================================================================
elastic effects     J ∂e/∂p(τ)
load errors         J C J_Fᵀ ∂W/∂p
geometric effects   (∂J/∂z_k) C τ + J C K_C[:, k], with ∂²x/∂z² in place of ∂J/∂z
imposed movements   J s
reading errors      ∂d_read/∂p(d)
==================  ====================================================================

Nothing of second order is in them, so two effects that are one to first order come out as exactly
one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects.base import (
    Effect,
    Elastic,
    Geometric,
    Imposed,
    LoadError,
    ReadingError,
)
from sk120stiff.effects.load_cases import LoadCases
from sk120stiff.robot import Mechanism
from sk120stiff.stiffness import complementary_stiffness


class FirstOrder:
    """Signatures of effects in a set of readings, around joint springs.

    Args:
        load_cases: N readings.
        effects: Effects whose signatures will be asked for.
        springs: Compliance of each actuated joint that yields [rad/(N·m) or m/N].
    """

    def __init__(
        self, load_cases: LoadCases, effects: Sequence[Effect], springs: Mapping[str, float]
    ) -> None:
        robot = load_cases.robot
        virtual = [
            joint
            for effect in effects
            if isinstance(effect, Elastic | Geometric | Imposed)
            for joint in effect.virtual_joints(robot)
        ]
        rigid = robot.mechanism()
        self.load_cases = load_cases
        self._mechanism: Mechanism = rigid.with_virtual_joints(virtual) if virtual else rigid
        names = [*robot.actuated, *(joint.name for joint in virtual)]
        self._place = {name: k for k, name in enumerate(names)}
        z = np.zeros((load_cases.count, self._mechanism.n))
        z[:, : robot.n] = load_cases.a
        self._seen = self._mechanism.screws(z, load_cases.point)
        self._pushed = self._seen.at(load_cases.force_point)
        self._J = self._seen.linear_jacobian  # (N, 3, n_z)
        self._torques = self._pushed.torques(load_cases.wrench)  # (N, n_z)
        self._c = np.zeros(self._mechanism.n)
        for name, value in springs.items():
            self._c[self._place[name]] = value
        self._stretch = self._c * self._torques

    @property
    def displacement(self) -> Array:
        """(N, 3) what is read without the effects, base axes [m]."""
        return np.asarray(np.einsum("nij,nj->ni", self._J, self._stretch))

    def of(self, effect: Effect) -> Array:
        """(N, 3, P) derivative of the readings by the effect's internal parameter values."""
        if isinstance(effect, Elastic):
            columns = self._elastic(effect)
        elif isinstance(effect, Geometric):
            columns = self._geometric(effect)
        elif isinstance(effect, Imposed):
            index = self._index(effect.coordinates(self.load_cases.robot))
            columns = self._J[:, :, index] @ effect.shifts(self.load_cases)
        elif isinstance(effect, LoadError):
            columns = self._load_error(effect)
        elif isinstance(effect, ReadingError):
            columns = effect.columns(self.displacement, self.load_cases)
        else:
            raise TypeError(f"{effect.id} enters in no known way")
        return np.asarray(np.swapaxes(self.load_cases.reading_axes, -1, -2) @ columns)

    def of_coordinate(self, name: str) -> Array:
        """(N, 3) signature of a compliance of one coordinate alone, j (jᵀ W)."""
        k = self._place[name]
        own = self._J[:, :, k] * self._torques[:, k, None]
        axes = np.swapaxes(self.load_cases.reading_axes, -1, -2)
        return np.asarray(np.einsum("nij,nj->ni", axes, own))

    def _elastic(self, effect: Elastic) -> Array:
        index = self._index(effect.coordinates(self.load_cases.robot))
        nothing = np.zeros(len(effect.parameters))
        found = effect.elongation(self._torques[:, index], self.load_cases, nothing)
        return np.asarray(self._J[:, :, index] @ found.by_parameter)

    def _geometric(self, effect: Geometric) -> Array:
        index = self._index(effect.coordinates(self.load_cases.robot))
        return np.asarray(self._wrong_start[:, :, index] @ effect.shifts(self.load_cases))

    @cached_property
    def _wrong_start(self) -> Array:
        """(N, 3, n_z) derivative of the displacement by the unloaded coordinates."""
        K_C = complementary_stiffness(self._pushed, self.load_cases.wrench)
        bent = [
            complementary_stiffness(self._seen, unit) @ self._stretch[..., None]
            for unit in np.eye(6)[:3]
        ]
        return np.stack(bent, axis=1)[..., 0] + self._J @ (self._c[:, None] * K_C)

    def _load_error(self, effect: LoadError) -> Array:
        rotation = self.load_cases.rotation
        turn = np.zeros((len(rotation), 6, 6))
        turn[:, :3, :3] = turn[:, 3:, 3:] = rotation
        reported = np.einsum("nji,nj->ni", turn, self.load_cases.wrench)
        errors = turn @ effect.columns(reported, self.load_cases)  # (N, 6, P) base axes
        yielding = self._c[:, None] * np.swapaxes(self._pushed.jacobian, -1, -2)
        return np.asarray(self._J @ yielding @ errors)

    def _index(self, names: Sequence[str]) -> list[int]:
        return [self._place[name] for name in names]
