"""An arm, its springs and the causes hidden in it: what a tracker would see without noise."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import ClassVar

import numpy as np

from .arm import Arm
from .equilibrium import Law, Load, Rest, Springs, settle
from .mechanism import Insert, Mechanism, Standing
from .rotations import Array
from .rows import Rows


@dataclass(frozen=True)
class Scene:
    """What a cause may look at: the rows, the mechanism, and the arm before the load came."""

    rows: Rows
    arm: Arm
    mechanism: Mechanism
    springs: Mapping[str, float]  # base compliances
    before: Rest | None  # None while the unloaded arm itself is settled
    before_point: Array | None  # (N, 3) measured point before the load

    @property
    def loaded(self) -> bool:
        return self.before is not None


@dataclass(frozen=True)
class Cause:
    """One physical cause. Its effect is nothing at sizes 0 and grows with them.

    The hooks are looked at in the order in which they stand here; a cause overrides its own.
    """

    where: str
    sizes: Mapping[str, float]
    options: Mapping[str, object] = field(default_factory=dict)
    name: ClassVar[str] = ""
    exact: ClassVar[bool] = False  # sizes mean what the product's parameters mean

    def scaled(self, factor: float) -> Cause:
        return replace(self, sizes={key: factor * value for key, value in self.sizes.items()})

    def parts(self) -> list[Cause]:
        """The same cause with one size at a time."""
        return [replace(self, sizes={key: value}) for key, value in self.sizes.items()]

    def size(self, key: str) -> float:
        return float(self.sizes.get(key, 0.0))

    def geometry(self, arm: Arm) -> Arm:
        return arm

    def coordinates(self, values: Mapping[str, Array]) -> Mapping[str, Array]:
        return values

    def point(self, local: Array) -> Array:
        return local

    def wrench(
        self, force: Array, moment: Array, tool_rotation: Array, scene: Scene
    ) -> tuple[Array, Array]:
        """True wrench from the reported one, base axes."""
        return force, moment

    def inserts(self, arm: Arm) -> list[Insert]:
        return []

    def compliances(self, scene: Scene) -> Mapping[str, Array | float]:
        """Added to the compliance of named coordinates."""
        return {}

    def couplings(self) -> list[tuple[str, str, float]]:
        return []

    def laws(self, scene: Scene) -> list[Law]:
        return []

    def pull(self, standing: Standing, point: Array, scene: Scene) -> Array | float:
        """Force added at the tool (N, 3), base axes."""
        return 0.0

    def reading(self, displacement: Array, scene: Scene, after: Rest) -> Array:
        return displacement


@dataclass(frozen=True)
class World:
    """The truth of one case."""

    arm: Arm
    springs: Mapping[str, float]  # compliances of the base model, rad/(N m) or m/N
    causes: Sequence[Cause] = ()
    pulley: float | None = None  # loads come over a pulley at this distance [m]

    def with_causes(self, *causes: Cause) -> World:
        return replace(self, causes=causes)

    def with_spring(self, name: str, compliance: float) -> World:
        return replace(self, springs={**self.springs, name: compliance})

    def displacement(self, rows: Rows, *, iterations: int = 60) -> Array:
        """Reported displacements (N, 3) [m], base axes, free of noise.

        `iterations=1` keeps only the first order in the loads (fast, for comparing signatures).
        """
        return self.observe(rows, iterations=iterations)[0]

    def observe(self, rows: Rows, *, iterations: int = 60) -> tuple[Array, Array, Rest]:
        """Displacement, unloaded position of the point, and the loaded arm at rest."""
        arm = self.arm
        values: Mapping[str, Array] = rows.coordinates
        point, force_point = rows.point, rows.force_point
        inserts: list[Insert] = []
        for cause in self.causes:
            arm = cause.geometry(arm)
            values = cause.coordinates(values)
            point, force_point = cause.point(point), cause.point(force_point)
            inserts += cause.inserts(self.arm)
        mechanism = Mechanism(arm, inserts)
        commanded = mechanism.commanded(values)
        crank = None if arm.loop is None else values[arm.loop.driver]

        nothing = np.zeros((rows.count, 3))
        scene = Scene(rows, arm, mechanism, self.springs, None, None)
        free = self._settle(
            scene, commanded, crank, inserts, _dead(force_point, nothing), iterations
        )
        start = free.standing.point(point)
        scene = replace(scene, before=free, before_point=start)

        rigid = free.standing.tool_rotation  # the sensor reports in the axes that the tool has now
        force, moment = rows.force, rows.moment
        for cause in self.causes:
            force, moment = cause.wrench(force, moment, rigid, scene)
        load = self._load(scene, force_point, force, moment, free.standing.point(force_point))
        held = self._settle(scene, commanded, crank, inserts, load, iterations)
        if iterations == 1:
            # first order: the screws of the rigid pose carry the tool, no finite motion
            displacement = _first_order(mechanism, free, held, point)
        else:
            displacement = held.standing.point(point) - start
        for cause in self.causes:
            displacement = cause.reading(displacement, scene, held)
        return displacement, start, held

    def _settle(
        self,
        scene: Scene,
        commanded: Array,
        crank: Array | None,
        inserts: Sequence[Insert],
        load: Load,
        iterations: int,
    ) -> Rest:
        mechanism = scene.mechanism
        compliance = np.zeros((len(mechanism.labels), scene.rows.count))
        for name, value in self.springs.items():
            compliance[mechanism.column[name]] += value
        for insert in inserts:
            compliance[mechanism.column[insert.label]] += insert.compliance
        couplings, laws = [], []
        for cause in self.causes:
            for name, extra in cause.compliances(scene).items():
                compliance[mechanism.column[name]] += extra
            couplings += [
                (mechanism.column[a], mechanism.column[b], c) for a, b, c in cause.couplings()
            ]
            laws += cause.laws(scene)
        springs = Springs(compliance, couplings, laws)
        return settle(mechanism, commanded, crank, springs, load, iterations=iterations)

    def _load(
        self, scene: Scene, force_point: Array, force: Array, moment: Array, start: Array
    ) -> Load:
        size = np.linalg.norm(force, axis=1, keepdims=True)
        direction = force / np.where(size > 0.0, size, 1.0)

        def load(standing: Standing) -> tuple[Array, Array, Array]:
            at = standing.point(force_point)
            pull = force
            if self.pulley is not None:
                rope = start + self.pulley * direction - at
                pull = size * rope / np.linalg.norm(rope, axis=1, keepdims=True)
            for cause in self.causes:
                pull = pull + cause.pull(standing, at - start, scene)
            return at, pull, moment

        return load


def _dead(force_point: Array, nothing: Array) -> Load:
    def load(standing: Standing) -> tuple[Array, Array, Array]:
        return standing.point(force_point), nothing, nothing

    return load


def _first_order(mechanism: Mechanism, free: Rest, held: Rest, point: Array) -> Array:
    standing = free.standing
    change = held.x - free.x
    if mechanism.arm.loop is not None:
        follower = mechanism.joint_element[mechanism.arm.loop.follower]
        follow = np.einsum("kn,kn->n", standing.follow, change)
        change = change.copy()
        change[follower] = follow
        change = change[:-2]
    lever = standing.point(point) - standing.origins
    slides = np.array([element.slides for element in mechanism.elements])
    move = np.where(slides[:, None, None], standing.axes, np.cross(standing.axes, lever))
    return np.einsum("kn,kni->ni", change, move)
