"""What yields in a scene: a mechanism and the tangent compliance of its coordinates."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sk120stiff.errors import InputError
from sk120stiff.robot import Mechanism, Robot
from sk120stiff.stiffness import ElasticLaw

Array = NDArray[np.float64]

ASSUMED_STIFFNESS = 1.0e5  # N·m/rad or N/m, where nothing is known: shape only, never a value


@dataclass(frozen=True, eq=False)
class Elastic:
    """An elastic arm, as far as a picture needs it.

    Attributes
    ----------
    mechanism
        Chain and coupling from the base frame to the frame of the point; its coordinates are
        z = [actuated; virtual].
    compliance
        (n, n) symmetric, positive semi-definite tangent compliance of z [rad/(N·m)]; a rigid
        coordinate has zeros.
    label
        Where the values come from, in a few words.
    assumed
        True if the values are only assumed: every page then says so.
    """

    mechanism: Mechanism
    compliance: Array
    label: str
    assumed: bool = False

    def __post_init__(self) -> None:
        n = self.mechanism.n
        if self.compliance.shape != (n, n):
            raise InputError(f"the compliance is {self.compliance.shape}, not ({n}, {n})")
        if not np.isfinite(self.compliance).all() or (np.diag(self.compliance) < 0.0).any():
            raise InputError("a spring is negative, zero or not a number", where=self.label)

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
    def assumed_for(cls, robot: Robot, *, frame: str | None = None) -> Elastic:
        """The same assumed spring at every joint, for a robot of which no stiffness is known."""
        springs = np.full(robot.n, ASSUMED_STIFFNESS)
        found = cls.of_springs(robot, springs, frame=frame)
        return cls(
            found.mechanism, found.compliance, "100 kN·m/rad assumed at every joint", assumed=True
        )

    @property
    def n_virtual(self) -> int:
        """Number of coordinates that no motor drives."""
        return len(self.mechanism.virtual)

    @property
    def soft(self) -> NDArray[np.bool_]:
        """(n,) true where a coordinate yields."""
        return np.asarray(np.diag(self.compliance) > 0.0)

    @property
    def law(self) -> ElasticLaw:
        """Elongations for given torques, as `equilibrium` wants them."""

        def law(torques: Array) -> tuple[Array, Array]:
            return torques @ self.compliance, self.compliance

        return law

    def coordinates(self, a: Sequence[float] | Array) -> Array:
        """(..., n) unloaded z for actuated coordinates `a`."""
        actuated = np.asarray(a, dtype=float)
        return np.concatenate([actuated, np.zeros((*actuated.shape[:-1], self.n_virtual))], axis=-1)
