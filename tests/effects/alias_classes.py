"""Which effects are one thing under several names, whatever is measured.

Signatures at many random poses and loads are compared. What the joint springs of the base model can
imitate is projected out first: they are refitted with every candidate, so it is theirs.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.effects.base import SPRINGS, Effect, LinearElastic
from sk120stiff.effects.catalogue import CATALOGUE, Catalogue, all_effects, effect
from sk120stiff.effects.load_cases import LoadCases, load_case
from sk120stiff.errors import listed
from sk120stiff.robot import Robot
from sk120stiff.robot.anatomy import arm_length, sample_poses
from tests.effects.signatures import FirstOrder

TOLERANCE = 1e-7  # share of a signature that may differ; true aliases differ by 1e-13


@dataclass(frozen=True)
class Overlap:
    """Two effects that share some of what they can do, but neither all of the other's.

    `first` and `second` with the number of directions `shared` in the space of their parameters:
    both, for instance, where a bearing is as soft about either axis.
    """

    first: str
    second: str
    shared: int


@dataclass(frozen=True)
class AliasClasses:
    """What a set of readings cannot tell apart, noise or no noise.

    Names are ``effect:where`` and ``effect:where.parameter``; a part of a parameter is written
    ``effect:where.parameter[part]``.

    Attributes:
        twins: Groups of parameters whose signatures are one but for a factor.
        absorbed: Parameters (or parts) that joint springs imitate, and the springs that do it.
        invisible: Parameters that no reading shows.
        same: Groups of effects that do the same beside the springs.
        within: (narrow, wide): all that the narrow effect does, the wide one can do.
        overlaps: Effects that share some of what they can do.
    """

    twins: tuple[tuple[str, ...], ...]
    absorbed: Mapping[str, tuple[str, ...]]
    invisible: tuple[str, ...]
    same: tuple[tuple[str, ...], ...]
    within: tuple[tuple[str, str], ...]
    overlaps: tuple[Overlap, ...]

    def sentences(self) -> list[str]:
        """The same in words, one statement each."""
        out = [f"{name} cannot be seen: no reading changes with it." for name in self.invisible]
        out += [
            f"{name} cannot be seen beside {listed(springs)}, which can do all that it does."
            for name, springs in self.absorbed.items()
        ]
        out += [f"{listed(group)} do the same: only together." for group in self.same]
        out += [f"Whatever {narrow} does, {wide} can do." for narrow, wide in self.within]
        return out


def alias_classes(
    robot: Robot,
    *,
    effects: Sequence[Effect] | None = None,
    catalogue: Catalogue = CATALOGUE,
    base: Sequence[str] | None = None,
    load_cases: LoadCases | None = None,
    tolerance: float = TOLERANCE,
) -> AliasClasses:
    """Effects that cannot be told apart by any readings of a kind.

    Args:
        robot: The robot.
        effects: Candidates; all of the catalogue by default, offsets of single zero readings left
            out.
        catalogue: The effects that there are.
        base: Joints whose springs are in the base model; all actuated joints by default.
        load_cases: Readings to judge by. Default: `generic_readings`, pure forces at the measured
            point. Give the readings of an experiment to learn what these can tell at all.
        tolerance: Share of a signature that may differ.
    """
    readings = generic_readings(robot) if load_cases is None else load_cases
    held = tuple(robot.actuated if base is None else base)
    if effects is None:
        timed = readings.time is not None
        effects = [e for e in all_effects(robot, timed=timed, catalogue=catalogue) if e.parameters]
    candidates = [e for e in effects if not (e.name == SPRINGS and e.where in held)]
    # springs of unequal softness, lest two of them add up to something by chance
    softness = np.random.default_rng(1).uniform(0.5, 2.0, len(held))
    usual = [effect(robot, SPRINGS, name) for name in held]
    springs = {
        spring.where: spring.parameters[0].typical * float(factor)
        for spring, factor in zip(usual, softness, strict=True)
    }
    first = FirstOrder(readings, candidates, springs)
    table = _Table(first, [*usual, *candidates], tolerance)
    beside = table.beside([spring.id for spring in usual])
    ids = [e.id for e in candidates if beside[e.id].shape[1]]
    same, within, overlaps = _relations(ids, beside, tolerance)
    return AliasClasses(
        twins=table.twins(),
        absorbed=table.absorbed(usual, candidates),
        invisible=tuple(name for name, column in table.columns.items() if not column.any()),
        same=same,
        within=within,
        overlaps=overlaps,
    )


def generic_readings(
    robot: Robot,
    *,
    count: int | None = None,
    moments: bool = False,
    unloading: bool = True,
    seed: int = 0,
) -> LoadCases:
    """Readings at random poses with random loads at a point off every axis.

    Args:
        robot: The robot.
        count: Number of readings; by default enough for all parameters of the catalogue.
        moments: The load has a moment, and the force acts elsewhere than at the measured point.
        unloading: Half of the readings are taken while the load falls.
        seed: Of the random numbers.
    """
    number = 80 + 10 * robot.n if count is None else count
    rng = np.random.default_rng(seed)
    size = arm_length(robot) or 1.0
    wrench = 60.0 * size**2 * rng.normal(size=(number, 6)) * [1, 1, 1, 0.1, 0.1, 0.1]
    point = size * np.array([0.043, -0.027, 0.085])
    force_point = size * np.array([0.071, 0.018, 0.102]) if moments else point
    if not moments:
        wrench[:, 3:] = 0.0
    plain = load_case(
        robot, sample_poses(robot, number, seed), wrench, point=point, force_point=force_point
    )
    falling = rng.random(number) < 0.5
    return replace(
        plain,
        order=1.0 + rng.permutation(number).astype(float),
        time=rng.uniform(1.0, 900.0, number),
        branch=np.where(falling & unloading, -1.0, 1.0),
    )


class _Table:
    """Signature columns (3N,) by full parameter name, and what they have in common."""

    def __init__(self, first: FirstOrder, effects: Sequence[Effect], tolerance: float) -> None:
        self.tolerance = tolerance
        self.owner: dict[str, str] = {}
        self.columns: dict[str, Array] = {}
        self._first = first
        for item in effects:
            found = first.of(item)  # (N, 3, P)
            size = np.linalg.norm(found.reshape(-1, found.shape[-1]), axis=0)
            for k, spec in enumerate(item.parameters):
                name = f"{item.id}.{spec.name}"
                self.owner[name] = item.id
                column = found[..., k].reshape(-1)
                # per typical size in metres: below a femtometre it is rounding
                seen = size[k] * spec.typical > 1e-15 * np.sqrt(len(column))
                self.columns[name] = column / size[k] if seen else np.zeros_like(column)

    def of(self, effect_id: str) -> Array:
        """(3N, P) unit columns of one effect, the invisible ones left out."""
        own = [c for name, c in self.columns.items() if self.owner[name] == effect_id and c.any()]
        rows = len(next(iter(self.columns.values())))
        return np.stack(own, axis=1) if own else np.zeros((rows, 0))

    def twins(self) -> tuple[tuple[str, ...], ...]:
        """Groups of parallel columns."""
        names = [name for name, column in self.columns.items() if column.any()]
        X = np.stack([self.columns[name] for name in names], axis=1)
        cosine = np.clip(np.abs(X.T @ X), 0.0, 1.0)
        alike = np.sqrt(2.0 * (1.0 - cosine)) < 10.0 * self.tolerance
        groups: dict[int, list[str]] = {}
        for k, name in enumerate(names):
            groups.setdefault(int(np.argmax(alike[k])), []).append(name)
        return tuple(tuple(group) for group in groups.values() if len(group) > 1)

    def beside(self, base: Sequence[str]) -> dict[str, Array]:
        """(3N, r) orthonormal basis of every effect, the base springs projected out."""
        Q = _basis(np.hstack([self.of(name) for name in base]), self.tolerance)
        out = {}
        for name in dict.fromkeys(self.owner.values()):
            X = self.of(name)
            out[name] = _basis(X - Q @ (Q.T @ X), self.tolerance)
        return out

    def absorbed(
        self, springs: Sequence[Effect], candidates: Sequence[Effect]
    ) -> dict[str, tuple[str, ...]]:
        """Parameters, and single virtual joints of elastic ones, that lie in the springs' span."""
        names = [f"{spring.id}.{spring.parameters[0].name}" for spring in springs]
        shown = [name for name in names if self.columns[name].any()]
        B = np.stack([self.columns[name] for name in shown], axis=1)
        out: dict[str, tuple[str, ...]] = {}
        for item in candidates:
            for spec in item.parameters:
                name = f"{item.id}.{spec.name}"
                found = self._taken(self.columns[name], B, shown)
                if found:
                    out[name] = found
        for item in candidates:
            parts = {**self._parts(item), **self._sum(item)}
            for part, column in parts.items():
                found = self._taken(column, B, shown)
                if found and not all(f"{item.id}.{spec.name}" in out for spec in item.parameters):
                    out[part] = found
        return out

    def _sum(self, item: Effect) -> dict[str, Array]:
        """The sum of all columns of an effect with several parameters of one unit."""
        names = [spec.name for spec in item.parameters]
        if len(names) < 2 or len({spec.unit for spec in item.parameters}) > 1:
            return {}
        total = self._first.of(item).sum(axis=-1).reshape(-1)
        size = np.linalg.norm(total)
        return {f"{item.id}[{'+'.join(names)}]": total / size} if size > 0.0 else {}

    def _taken(self, column: Array, B: Array, names: Sequence[str]) -> tuple[str, ...]:
        if not column.any():
            return ()
        weights = np.linalg.lstsq(B, column, rcond=None)[0]
        if np.linalg.norm(column - B @ weights) > self.tolerance:
            return ()
        return tuple(n for n, w in zip(names, weights, strict=True) if abs(w) > self.tolerance)

    def _parts(self, item: Effect) -> dict[str, Array]:
        """Columns of the single virtual joints of an effect whose one parameter has several."""
        if not isinstance(item, LinearElastic) or len(item.parameters) != 1:
            return {}
        joints = item.virtual_joints(self._first.load_cases.robot)
        out: dict[str, Array] = {}
        for joint in joints if len(joints) > 1 else ():
            column = self._first.of_coordinate(joint.name).reshape(-1)
            size = np.linalg.norm(column)
            if size > 0.0:
                part = joint.name.removeprefix(item.id).rpartition(".")[2]
                key = f"{item.id}.{item.parameters[0].name}[{part}]"
                before = out.get(key)
                out[key] = column / size if before is None else before + column / size
        return {key: column / np.linalg.norm(column) for key, column in out.items()}


def _relations(
    ids: Sequence[str], basis: Mapping[str, Array], tolerance: float
) -> tuple[tuple[tuple[str, ...], ...], tuple[tuple[str, str], ...], tuple[Overlap, ...]]:
    """Classes of equal spans, nested spans, and spans that meet."""
    groups: dict[str, list[str]] = {}
    within: list[tuple[str, str]] = []
    overlaps: list[Overlap] = []
    leader: dict[str, str] = {}
    for k, one in enumerate(ids):
        for two in ids[:k]:
            shared = _shared(basis[one], basis[two], tolerance)
            narrow, wide = basis[one].shape[1], basis[two].shape[1]
            if shared == narrow == wide:
                leader.setdefault(one, leader.get(two, two))
            elif shared == narrow:
                within.append((one, two))
            elif shared == wide:
                within.append((two, one))
            elif shared:
                overlaps.append(Overlap(two, one, shared))
        groups.setdefault(leader.get(one, one), []).append(one)
    same = tuple(tuple(group) for group in groups.values() if len(group) > 1)
    return same, tuple(within), tuple(overlaps)


def _shared(one: Array, two: Array, tolerance: float) -> int:
    """Dimension of the intersection of two spans with orthonormal bases."""
    values = np.linalg.svd(two - one @ (one.T @ two), compute_uv=False)
    sines = np.append(values, np.zeros(max(0, two.shape[1] - len(values))))
    return int((sines < 10.0 * tolerance).sum())


def _basis(columns: Array, tolerance: float) -> Array:
    """Orthonormal basis of what is left of unit columns (3N, P)."""
    left = columns[:, np.linalg.norm(columns, axis=0) > tolerance]
    if not left.shape[1]:
        return np.zeros((len(columns), 0))
    vectors, values, _ = np.linalg.svd(left / np.linalg.norm(left, axis=0), full_matrices=False)
    return np.asarray(vectors[:, values > tolerance * values[0]])
