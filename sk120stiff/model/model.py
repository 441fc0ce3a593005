"""Robot + effects with values: what is believed about an arm, and what it predicts."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property
from html import escape
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from sk120stiff.arrays import Array, Index
from sk120stiff.effects import (
    Effect,
    LoadError,
    ReadingError,
    Situation,
    situation_of_load,
)
from sk120stiff.errors import InputError, MissingPart
from sk120stiff.model.assembly import Assembly, Solution
from sk120stiff.model.parameter import Parameter, parameter_frame
from sk120stiff.model.uncertainty import Uncertainty
from sk120stiff.robot import Robot

if TYPE_CHECKING:
    import pandas as pd

BLOCK = 2048  # readings solved together: large enough for array work, small enough for the cache
SQUARES = 1_000_000  # numbers in one square matrix for each of them: 8 MB, of which ten are alive


@dataclass(frozen=True, eq=False)
class Model:
    """A robot with named effects; immutable, every change makes a new one.

    Attributes:
        robot: The rigid robot.
        parameters: All parameters, effect by effect.
        provenance: Where the whole came from: data hash, command, date.
        uncertainty: How well the parameters are known, where a fit said so; a change of a value, or
            of what is in the model, ends it.
    """

    robot: Robot
    parameters: tuple[Parameter, ...] = ()
    provenance: Mapping[str, str] = field(default_factory=dict)
    uncertainty: Uncertainty | None = None

    def __repr__(self) -> str:
        places: dict[str, list[str]] = {}
        for effect in self.effects:
            places.setdefault(effect.name, []).append(effect.where)
        held = "; ".join(f"{name} at {', '.join(where)}" for name, where in places.items())
        return f"<Model of {self.robot.name}: {held or 'rigid'}>"

    def _repr_html_(self) -> str | None:
        """What a notebook shows; without pandas it is the line of `repr`."""
        with suppress(MissingPart):
            table = self.to_frame().to_html(index=False, float_format="{:.4g}".format, na_rep="")
            return f"<div><p>Model of {escape(self.robot.name)}</p>{table}</div>"
        return None

    def to_frame(self) -> pd.DataFrame:
        """One row per parameter in its public unit: name, value, std, unit, free, note."""
        return parameter_frame(self.parameters)

    @cached_property
    def effects(self) -> tuple[Effect, ...]:
        """The effects, in order."""
        return tuple(dict.fromkeys(parameter.effect for parameter in self.parameters))

    @cached_property
    def assembly(self) -> Assembly:
        """The mechanism that the effects make of the robot."""
        return Assembly(self.robot, self.effects)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Full names of the parameters."""
        return tuple(parameter.name for parameter in self.parameters)

    @cached_property
    def values(self) -> Array:
        """(P,) internal values."""
        return np.array([parameter.internal for parameter in self.parameters])

    @property
    def untrusted(self) -> tuple[Parameter, ...]:
        """Parameters whose values no readings stand behind."""
        return tuple(parameter for parameter in self.parameters if not parameter.trusted)

    @cached_property
    def free(self) -> Index:
        """Indices of the free parameters."""
        return np.flatnonzero([parameter.free for parameter in self.parameters])

    def parameter(self, name: str) -> Parameter:
        """The parameter of that full name.

        Raises:
            InputError: There is none.
        """
        if name not in self.names:
            raise InputError(
                f"the model has no parameter {name!r}",
                remedy=f"Parameters are: {', '.join(self.names)}.",
            )
        return self.parameters[self.names.index(name)]

    def __add__(self, other: Effect | Iterable[Parameter]) -> Model:
        """The model with one effect more, absent yet (all its parameters internally zero).

        Raises:
            InputError: The effect is already in the model at that place.
        """
        if isinstance(other, Effect):
            added = tuple(Parameter(other, spec) for spec in other.parameters)
        else:
            added = tuple(other)
        present = {effect.id for effect in self.effects}
        for effect in dict.fromkeys(parameter.effect for parameter in added):
            if effect.id in present:
                raise InputError(
                    f"the effect {effect.id!r} is already in the model",
                    remedy="Change its values instead of adding it twice.",
                )
        return replace(self, parameters=self.parameters + added, uncertainty=None)

    def without(self, effect_id: str) -> Model:
        """The model without one effect (``name:where``).

        Raises:
            InputError: It is not in the model.
        """
        kept = tuple(p for p in self.parameters if p.effect.id != effect_id)
        if len(kept) == len(self.parameters):
            raise InputError(
                f"the effect {effect_id!r} is not in the model",
                remedy=f"Effects are: {', '.join(effect.id for effect in self.effects)}.",
            )
        return replace(self, parameters=kept, uncertainty=None)

    def with_values(
        self, values: Array, std: Sequence[float | None] | None = None, origin: str | None = None
    ) -> Model:
        """The model with other internal values (P,), their errors, and where they came from."""
        if len(values) != len(self.parameters):
            raise ValueError(f"{len(values)} values for {len(self.parameters)} parameters")
        errors = [p.internal_std for p in self.parameters] if std is None else list(std)
        changed = tuple(
            replace(
                parameter,
                internal=float(value),
                internal_std=None if error is None else float(error),
                origin=parameter.origin if origin is None or not parameter.free else origin,
            )
            for parameter, value, error in zip(self.parameters, values, errors, strict=True)
        )
        return replace(self, parameters=changed, uncertainty=None)

    def with_public(self, **values: float) -> Model:
        """The model with public values by full name (use ``**{"a:b.c": 1.0}``)."""
        new = self.values.copy()
        for name, value in values.items():
            new[self.names.index(self.parameter(name).name)] = self.parameter(name).spec.internal(
                value
            )
        return self.with_values(new)

    def known(self, uncertainty: Uncertainty) -> Model:
        """The model with what is known of its parameters.

        Raises:
            InputError: It is about a parameter that the model does not have.
        """
        for name in uncertainty.names:
            self.parameter(name)
        return replace(self, uncertainty=uncertainty)

    def solve(self, situation: Situation, values: Array | None = None) -> Solution:
        """Equilibrium of all readings at once; see `predict` for many."""
        return self.assembly.solve(situation, self.values if values is None else values)

    def predict(self, situation: Situation, values: Array | None = None) -> Array:
        """(N, 3) predicted readings in the axes of the measurements [m].

        Raises:
            Refusal: The springs cannot hold a load.
        """
        given = self.values if values is None else values
        return np.concatenate(
            [self.assembly.solve(part, given).displacement for part in self._blocks(situation)]
            or [np.zeros((0, 3))]
        )

    def predict_with_sensitivities(
        self, situation: Situation, values: Array | None = None
    ) -> tuple[Array, Array]:
        """(N, 3) predicted readings [m] and (N, 3, P) derivatives by the internal values."""
        given = self.values if values is None else values
        displacement, derivative = [], []
        for part in self._blocks(situation):
            solution = self.assembly.solve(part, given)
            displacement.append(solution.displacement)
            derivative.append(self.assembly.sensitivities(solution, given))
        return np.concatenate(displacement), np.concatenate(derivative)

    def _blocks(self, situation: Situation) -> list[Situation]:
        """Readings in stretches that bound the memory, whatever the number of coordinates."""
        block = min(BLOCK, max(1, SQUARES // self.assembly.mechanism.n**2))
        if situation.count <= block:
            return [situation]
        return [situation.rows(slice(k, k + block)) for k in range(0, situation.count, block)]

    def deflect(
        self,
        a: ArrayLike,
        wrench: ArrayLike,
        *,
        point: ArrayLike | None = None,
        force_point: ArrayLike | None = None,
    ) -> Array:
        """(N, 3) true displacement of a point under base-axes wrenches (N, 6) [m].

        Instruments have no say here: the model's load and reading errors are left out.
        """
        situation = situation_of_load(self.robot, a, wrench, point=point, force_point=force_point)
        return self.physical().predict(situation)

    def physical(self) -> Model:
        """The arm alone: the model without load and reading errors."""
        return replace(
            self,
            parameters=tuple(
                p for p in self.parameters if not isinstance(p.effect, LoadError | ReadingError)
            ),
        )

    def joint_stiffness(self) -> Array:
        """(n,) springs of the actuated joints [N·m/rad or N/m]; infinite where rigid."""
        springs = np.full(self.robot.n, np.inf)
        for parameter in self.parameters:
            if parameter.effect.joint_spring:
                springs[self.robot.actuated.index(parameter.effect.where)] = parameter.value
        return springs


def joint_spring_model(robot: Robot, stiffness: ArrayLike | None = None) -> Model:
    """The base model: one linear spring in every actuated joint.

    Args:
        robot: The rigid robot.
        stiffness: (n,) [N·m/rad or N/m]; an infinite one is left out. Default: all joints, at a
            stiffness that is typical of large arms and only a start for identification.

    Examples:
        >>> import sk120stiff as sk
        >>> model = sk.joint_spring_model(sk.load_robot("motoman_sk120"))
        >>> len(model.parameters), model.parameters[0].spec.unit
        (6, 'N*m/rad')
    """
    from sk120stiff.effects import effect

    model = Model(robot)
    for k, joint in enumerate(robot.actuated):
        spring = effect(robot, "joint_springs", joint)
        spec = spring.parameters[0]
        value = (
            spec.typical if stiffness is None else spec.internal(float(np.asarray(stiffness)[k]))
        )
        if value != 0.0:
            origin = "starting value" if stiffness is None else "given"
            model = model + [Parameter(spring, spec, value, origin=origin)]
    return model
