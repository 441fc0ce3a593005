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
    CATALOGUE,
    Catalogue,
    Effect,
    LoadCases,
    LoadError,
    ReadingError,
    load_case,
)
from sk120stiff.errors import InputError, MissingPart
from sk120stiff.model.assembly import Assembly, assembled
from sk120stiff.model.parameter import Parameter, parameter_frame
from sk120stiff.model.sensitivities import reading_sensitivities
from sk120stiff.model.standing import Solution
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
        uncertainty: How well the parameters are known, where a fit said so; any change ends it.
        catalogue: Effects that there are, in the model or not.

    Examples:
        >>> import sk120stiff as sk
        >>> model = sk.base_model(sk.load_robot("motoman_sk120"))
        >>> model + sk.effect(model.robot, "base_rocking")
        <Model of motoman_sk120: joint_springs at ...; base_rocking at base_link>
    """

    robot: Robot
    parameters: tuple[Parameter, ...] = ()
    provenance: Mapping[str, str] = field(default_factory=dict)
    uncertainty: Uncertainty | None = None
    catalogue: Catalogue = CATALOGUE

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
        """One row per parameter in its public unit: name, value, std, unit, free, note.

        Examples:
            >>> import sk120stiff as sk
            >>> model = sk.base_model(sk.load_robot("motoman_sk120"))
            >>> model.to_frame()["value"].round().tolist()
            [1409800.0, 400760.0, 935280.0]
        """
        return parameter_frame(self.parameters)

    @cached_property
    def effects(self) -> tuple[Effect, ...]:
        """The effects, in order."""
        return tuple(dict.fromkeys(parameter.effect for parameter in self.parameters))

    @cached_property
    def assembly(self) -> Assembly:
        """The mechanism that the effects make of the robot."""
        return assembled(self.robot, self.effects)

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

        Examples:
            >>> import sk120stiff as sk
            >>> model = sk.base_model(sk.load_robot("motoman_sk120"))
            >>> model.parameter("joint_springs:joint_1_s.stiffness").value
            1409800.0
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

    def under(self, gravity: Array | None) -> Model:
        """The model where weight accelerates so, (3,) in base axes [m/s²]; see `Robot.under`.

        Examples:
            >>> import sk120stiff as sk
            >>> model = sk.base_model(sk.load_robot("motoman_sk120"))
            >>> hanging = model.under(-model.robot.gravity_in_base)
            >>> hanging.robot.gravity_in_base.tolist()
            [0.0, 0.0, 9.80665]
        """
        return self if gravity is None else replace(self, robot=self.robot.under(gravity))

    def without(self, effect_id: str) -> Model:
        """The model without one effect (``name:where``).

        Raises:
            InputError: It is not in the model.

        Examples:
            >>> import sk120stiff as sk
            >>> model = sk.base_model(sk.load_robot("motoman_sk120"))
            >>> model.without("joint_springs:joint_1_s").names
            ('joint_springs:joint_2_l.stiffness', 'joint_springs:joint_3_u.stiffness')
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
        """The model with other internal values (P,), their errors, and where they came from.

        Examples:
            >>> import sk120stiff as sk
            >>> model = sk.base_model(sk.load_robot("motoman_sk120"))
            >>> softer = model.with_values(1.1 * model.values)  # compliances [rad/(N·m)]
            >>> print(f"{softer.parameters[0].value:.4g}")
            1.282e+06
        """
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

    def with_public(self, values: Mapping[str, float] | None = None, /, **named: float) -> Model:
        """The model with public values, in public units, by the full names of the parameters.

        Raises:
            InputError: There is no parameter of that name.

        Examples:
            >>> import sk120stiff as sk
            >>> model = sk.base_model(sk.load_robot("motoman_sk120"))
            >>> model = model.with_public({"joint_springs:joint_1_s.stiffness": 1.2e6})
            >>> model.joint_stiffness()[0].item()
            1200000.0
        """
        new = self.values.copy()
        for name, value in {**(values or {}), **named}.items():
            spec = self.parameter(name).spec
            new[self.names.index(name)] = spec.internal(value)
        return self.with_values(new)

    def known(self, uncertainty: Uncertainty) -> Model:
        """The model with what is known of its parameters.

        Raises:
            InputError: It is about a parameter that the model does not have.

        Examples:
            >>> import sk120stiff as sk
            >>> data = sk.bundled_robots()["motoman_sk120"] / "data"
            >>> readings = sk.read(data / "table2_measured.csv")
            >>> found = sk.fit(sk.base_model(sk.load_robot("motoman_sk120")), readings)
            >>> from sk120stiff.identify import known_model
            >>> model = known_model(found)  # the model with what its fit knows
            >>> found.model.known(model.uncertainty).uncertainty is model.uncertainty
            True
        """
        for name in uncertainty.names:
            self.parameter(name)
        return replace(self, uncertainty=uncertainty)

    def solve(self, load_cases: LoadCases, values: Array | None = None) -> Solution:
        """Equilibrium of all readings at once; see `predict` for many.

        Examples:
            >>> import sk120stiff as sk
            >>> model = sk.base_model(sk.load_robot("motoman_sk120"))
            >>> from sk120stiff.effects import load_case
            >>> one = load_case(model.robot, [0.0] * 6, [0, 0, -490, 0, 0, 0])
            >>> model.solve(one).displacement.shape  # m
            (1, 3)
        """
        return self.assembly.solve(load_cases, self.values if values is None else values)

    def predict(self, load_cases: LoadCases, values: Array | None = None) -> Array:
        """(N, 3) predicted readings in the axes of the measurements [m].

        Raises:
            Refusal: The springs cannot hold a load.

        Examples:
            >>> import sk120stiff as sk
            >>> model = sk.base_model(sk.load_robot("motoman_sk120"))
            >>> from sk120stiff.effects import load_case
            >>> one = load_case(model.robot, [0.0] * 6, [0, 0, -490, 0, 0, 0])
            >>> model.predict(one).shape  # m
            (1, 3)
        """
        given = self.values if values is None else values
        known = load_cases.latest.get(self.effects, given)
        if known is not None:
            return known[0].copy()
        return np.concatenate(
            [self.assembly.solve(part, given).displacement for part in self._blocks(load_cases)]
        )

    def predict_with_sensitivities(
        self, load_cases: LoadCases, values: Array | None = None
    ) -> tuple[Array, Array]:
        """(N, 3) predicted readings [m] and (N, 3, P) derivatives by the internal values.

        Examples:
            >>> import sk120stiff as sk
            >>> model = sk.base_model(sk.load_robot("motoman_sk120"))
            >>> from sk120stiff.effects import load_case
            >>> one = load_case(model.robot, [0.0] * 6, [0, 0, -490, 0, 0, 0])
            >>> model.predict_with_sensitivities(one)[1].shape
            (1, 3, 3)
        """
        given = self.values if values is None else values
        known = load_cases.latest.get(self.effects, given)
        if known is None:
            displacement, derivative = [], []
            for part in self._blocks(load_cases):
                solution = self.assembly.solve(part, given)
                displacement.append(solution.displacement)
                derivative.append(reading_sensitivities(self.assembly, solution, given))
            known = np.concatenate(displacement), np.concatenate(derivative)
            if not load_cases.latest.keep(self.effects, given, known):
                return known
        return known[0].copy(), known[1].copy()

    def _blocks(self, load_cases: LoadCases) -> tuple[LoadCases, ...]:
        """Readings in stretches that bound the memory, whatever the number of coordinates."""
        return load_cases.blocks(min(BLOCK, max(1, SQUARES // self.assembly.mechanism.n**2)))

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

        Examples:
            >>> import sk120stiff as sk
            >>> model = sk.base_model(sk.load_robot("motoman_sk120"))
            >>> moved = model.deflect([0, 0.2, -0.3, 0, -1, 0], [0, 0, -490, 0, 0, 0])  # m
            >>> print(f"{1e3 * moved[0, 2]:.3f} mm")
            -1.052 mm
        """
        load_cases = load_case(self.robot, a, wrench, point=point, force_point=force_point)
        return self.physical().predict(load_cases)

    def physical(self) -> Model:
        """The arm alone: the model without load and reading errors.

        Examples:
            >>> import sk120stiff as sk
            >>> model = sk.base_model(sk.load_robot("motoman_sk120"))
            >>> sensor = model + sk.effect(model.robot, "force_bias")
            >>> len(sensor.parameters), len(sensor.physical().parameters)
            (6, 3)
        """
        instrument = LoadError | ReadingError
        kept = tuple(p for p in self.parameters if not isinstance(p.effect, instrument))
        return replace(self, parameters=kept)

    def joint_stiffness(self) -> Array:
        """(n,) springs of the actuated joints [N·m/rad or N/m]; infinite where rigid.

        Examples:
            >>> import sk120stiff as sk
            >>> model = sk.base_model(sk.load_robot("motoman_sk120"))
            >>> model.joint_stiffness().round().tolist()  # N·m/rad; the wrist is rigid
            [1409800.0, 400760.0, 935280.0, inf, inf, inf]
        """
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
