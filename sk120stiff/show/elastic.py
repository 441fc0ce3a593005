"""What yields in a scene: a mechanism and the tangent compliance of its coordinates."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from sk120stiff.arrays import Array
from sk120stiff.errors import InputError
from sk120stiff.robot import Mechanism, Robot
from sk120stiff.stiffness import ElasticLaw, equilibrium

if TYPE_CHECKING:
    from sk120stiff.model import Model


ASSUMED = "springs assumed: typical of an arm of this size, not measured"


@dataclass(frozen=True, eq=False)
class Elastic:
    """An elastic arm, as far as a picture needs it.

    Attributes
    ----------
    mechanism
        Chain and coupling from the base frame to the frame of the point; its coordinates are
        z = [actuated; virtual].
    compliance
        (n, n) symmetric tangent compliance of z [rad/(N·m)]; a rigid coordinate has zeros. Where
        it is indefinite the arm is unstable before any load, and the page says so.
    label
        Where the values come from, in a few words.
    assumed
        True if the values are only assumed: every page then says so.
    offset
        (n,) what a wrong rigid geometry adds to the unloaded z [rad or m].
    model
        The model behind it where its compliance changes with pose or load, else None. Python then
        asks the model; a page without Python uses `compliance`, and says so.
    """

    mechanism: Mechanism
    compliance: Array
    label: str
    assumed: bool = False
    offset: Array = field(default_factory=lambda: np.zeros(0))
    model: Model | None = None

    def __post_init__(self) -> None:
        n = self.mechanism.n
        if not self.offset.size:
            object.__setattr__(self, "offset", np.zeros(n))
        if self.compliance.shape != (n, n):
            raise InputError(f"the compliance is {self.compliance.shape}, not ({n}, {n})")
        if not np.isfinite(self.compliance).all():
            raise InputError("a compliance is not a finite number", where=self.label)

    @classmethod
    def of_springs(
        cls,
        robot: Robot,
        springs: ArrayLike | Mapping[str, float],
        *,
        frame: str | None = None,
        label: str = "joint springs",
    ) -> Elastic:
        """Independent springs at the actuated joints.

        Parameters
        ----------
        springs
            (n,) stiffness [N·m/rad or N/m], infinite where a joint is rigid; or joint name →
            stiffness, every other joint rigid.
        frame
            Frame that carries the point; the tool frame else.

        Raises
        ------
        InputError
            Another number of springs, an unknown joint, or a stiffness that is not above zero.
        """
        if isinstance(springs, Mapping):
            unknown = sorted(set(springs) - set(robot.actuated))
            if unknown:
                raise InputError(
                    f"there is no actuated joint {unknown[0]!r}",
                    remedy=f"Actuated joints are: {', '.join(robot.actuated)}.",
                )
            values = np.array([springs.get(name, np.inf) for name in robot.actuated])
        else:
            values = np.asarray(springs, dtype=float)
        if values.shape != (robot.n,):
            raise InputError(f"{values.size} springs given for {robot.n} actuated joints")
        if not (values > 0.0).all():
            raise InputError("a joint spring must be above zero", where=label)
        return cls(robot.mechanism(frame), np.diag(1.0 / values), label)

    @classmethod
    def of_model(cls, model: Model, *, at: ArrayLike | None = None, label: str = "") -> Elastic:
        """A model's arm, without its instruments.

        Parameters
        ----------
        at
            (n,) pose whose compliance stands for a model that changes with the pose.
        label
            Where the values come from; the effects' names by default.

        Raises
        ------
        InputError
            Nothing in the model yields.
        """
        from sk120stiff.model import typical_parameters

        arm = model.physical()
        pose = arm.robot.rest if at is None else np.asarray(at, dtype=float)
        offset, compliance = _unloaded(arm, pose)
        if not compliance.any():
            raise InputError(
                "nothing in this model yields under load",
                where=arm.robot.name,
                remedy="Give a model with joint_springs or another elastic effect.",
            )
        assumed = bool(typical_parameters(arm))
        names = ", ".join(dict.fromkeys(effect.name for effect in arm.effects))
        return cls(
            mechanism=arm.assembly.mechanism,
            compliance=compliance,
            label=label or (ASSUMED if assumed else f"model of {names}"),
            assumed=assumed,
            offset=offset,
            model=None if _is_constant(arm) else arm,
        )

    @property
    def n_virtual(self) -> int:
        """Number of coordinates that no motor drives."""
        return len(self.mechanism.virtual)

    def coordinates(self, a: ArrayLike) -> Array:
        """(..., n) unloaded z for actuated coordinates `a`."""
        actuated = np.asarray(a, dtype=float)
        rest = np.zeros((*actuated.shape[:-1], self.n_virtual))
        return np.asarray(np.concatenate([actuated, rest], axis=-1) + self.offset)

    def joint_vector(self, z: Array) -> Array:
        """(m + v,) values of all joints of the robot, then of the virtual ones, for z (n,)."""
        n_a = self.mechanism.coupling.n
        q = np.array(self.mechanism.coupling.motion(z[:n_a]).q, dtype=float)
        for joint, value in zip(self.mechanism.virtual, z[n_a:], strict=True):
            for index, multiplier in joint.followers:  # a linkage turns with a bent link
                q[index] += multiplier * value
        return np.concatenate([q, z[n_a:]])

    def tangent(self, a: Array) -> Array:
        """(n, n) tangent compliance of the unloaded arm at a pose [rad/(N·m)]."""
        return self.compliance if self.model is None else _unloaded(self.model, a)[1]

    def rest(self, a: Array, wrench: Array, point: Array) -> tuple[Array, Array]:
        """Exact equilibrium under a wrench at the point: z (n,) and the point's position (3,) [m].

        Raises
        ------
        Refusal
            The springs cannot hold the load.
        """
        if self.model is None:
            found = equilibrium(self.mechanism, self.coordinates(a), wrench, self._law, point=point)
            return found.z, found.screws.position
        from sk120stiff.effects import situation_of_load

        situation = situation_of_load(self.model.robot, a, wrench, point=point)
        loaded = self.model.solve(situation).rest
        return loaded.z[0], loaded.screws.position[0]

    @property
    def _law(self) -> ElasticLaw:
        def law(torques: Array) -> tuple[Array, Array]:
            return torques @ self.compliance, self.compliance

        return law


def _unloaded(model: Model, a: Array) -> tuple[Array, Array]:
    """(n,) offset of the unloaded coordinates and (n, n) tangent compliance at a pose."""
    from sk120stiff.effects import situation_of_load

    rest = model.solve(situation_of_load(model.robot, a, np.zeros(6))).rest
    offset = rest.z[0].copy()
    offset[: model.robot.n] -= a
    compliance = np.broadcast_to(rest.compliance, (1, *rest.compliance.shape[-2:]))[0]
    return offset, 0.5 * (compliance + compliance.T)


def _is_constant(model: Model) -> bool:
    """Is the compliance the same at every pose and load?"""
    from sk120stiff.effects import Elastic as ElasticEffect
    from sk120stiff.effects import LinearElastic, situation_of_load

    situation = situation_of_load(model.robot, model.robot.rest, np.zeros(6))
    return all(
        isinstance(effect, LinearElastic) and effect.patterns(situation).ndim == 3
        for effect in model.effects
        if isinstance(effect, ElasticEffect)
    )
