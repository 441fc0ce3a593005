"""A reading is a projection: single numbers, each an axis, a turn or a distance of one prediction.

A row of a file may hold a position, an orientation, a distance to a fixed point, a dial gauge along
a direction; any cell may be blank. As channels they are one flat vector of M numbers, and whatever
estimates parameters from them sees a gap (M,) and its derivative (M, P) alone.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Literal, get_args

import numpy as np

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.errors import InputError
from sk120stiff.robot.rotations import rotation_of, rotation_vector

Kind = Literal[
    "position", "rotation", "distance", "shift", "inclination", "displacement", "turn"
]  # fmt: skip
KINDS: tuple[Kind, ...] = get_args(Kind)
ANGLES = ("rotation", "inclination", "turn")  # the other kinds are lengths
OF_AXES = ("position", "rotation", "displacement", "turn")  # three numbers; the others are one
BY_LOAD = ("shift", "displacement", "turn")  # what only a load makes
_OF_ROWS = ("position", "displacement")  # whose uncertainty a row may state


@dataclass(frozen=True, eq=False)
class Moved:
    """What a load does to the tool, axes of the displacements.

    Attributes:
        displacement: (N, 3) displacement of the marker, as the instrument reads it [m].
        rotation: (N, 3, 3) from the axes of the tool without load to those with it.
        columns: (N, 6, P) derivative of both; no parameters where nobody asked.
    """

    displacement: Array
    rotation: Array
    columns: Array


@dataclass(frozen=True, eq=False)
class Channels:
    """What N rows hold; NaN where a cell is blank, None where no row has such a reading.

    All cells of a plan are blank.

    Attributes:
        position: (N, 3) where the marker stands, axes of the instrument [m].
        rotation: (N, 3, 3) axes of the tool in those of the instrument.
        distance, anchor: (N,) distance of the marker from a fixed point (N, 3), axes of the
            instrument [m].
        shift, along: (N,) displacement by the load along a direction (N, 3), axes of the
            displacements [m].
        inclination, level: (N,) angle above the horizon [rad] of a direction (N, 3) of the tool,
            axes of the tool.
        displacement, turn: (N, 3) displacement of the marker by the load [m] and rotation vector
            of the tool from its axes without load to those with it [rad], axes of the
            displacements.
        sigma: Standard uncertainty of each kind of channel as stated [m or rad].
        sigma_of_rows: (N, 3) standard uncertainty of each position or displacement [m], or None.
        rays: (N, 3, 3) unit vectors, as rows, along which the numbers of a position are told, see
            `noise/rays.py`; None: along the axes.
    """

    position: Array | None = None
    rotation: Array | None = None
    distance: Array | None = None
    anchor: Array | None = None
    shift: Array | None = None
    along: Array | None = None
    inclination: Array | None = None
    level: Array | None = None
    displacement: Array | None = None
    turn: Array | None = None
    sigma: dict[str, float] = dataclasses.field(default_factory=dict)
    sigma_of_rows: Array | None = None
    rays: Array | None = None

    def __post_init__(self) -> None:
        if all(getattr(self, kind) is None for kind in KINDS):
            raise InputError("there is no reading")
        if self.along is not None and self.shift is not None:
            length = np.linalg.norm(self.along, axis=1)
            if np.any(np.isfinite(self.shift) & ~(np.abs(length - 1.0) < 1e-6)):
                raise InputError("a direction of a reading is no unit vector", where="ux uy uz")

    @property
    def count(self) -> int:
        """Number of rows N."""
        return len(next(x for kind in KINDS if (x := getattr(self, kind)) is not None))

    @property
    def present(self) -> tuple[Kind, ...]:
        """Kinds of channels that there are."""
        return tuple(
            kind
            for kind in KINDS
            if getattr(self, kind) is not None and np.isfinite(getattr(self, kind)).any()
        )

    def held(self, kind: Kind) -> Mask:
        """(N, w) channels of a kind that were read, w of them in a row."""
        values: Array = getattr(self, kind)
        known: Mask = np.isfinite(values.reshape(len(values), -1))
        if kind == "rotation":
            known = np.broadcast_to(np.all(known, axis=1, keepdims=True), (len(values), 3))
        return known

    @property
    def rows(self) -> Index:
        """(M,) row of every channel, kind by kind."""
        parts = [np.nonzero(self.held(kind))[0] for kind in self.present]
        return np.concatenate([*parts, np.zeros(0, dtype=np.intp)])

    @property
    def kinds(self) -> tuple[slice, ...]:
        """Part of the flat vector that each of the `present` kinds takes."""
        ends = np.cumsum([0, *(int(self.held(kind).sum()) for kind in self.present)])
        return tuple(slice(int(a), int(b)) for a, b in pairwise(ends))

    def aim(self, kind: Kind) -> Array:
        """(N, 3) what makes two numbers of a kind two things: a direction, or a fixed point.

        Zero where the axes alone tell them apart.
        """
        aimed = {"distance": self.anchor, "shift": self.along, "inclination": self.level}
        found = aimed.get(kind)
        return np.zeros((self.count, 3)) if found is None else np.nan_to_num(found)

    @property
    def filled(self) -> Mask:
        """(N,) rows that hold any reading."""
        found = np.zeros(self.count, dtype=np.bool_)
        found[self.rows] = True
        return found

    def select(self, index: Index) -> Channels:
        """The channels of some rows."""
        cut: dict[str, Any] = {
            name: None if getattr(self, name) is None else getattr(self, name)[index]
            for name in (
                "position", "rotation", "distance", "anchor", "shift", "along", "inclination",
                "level", "displacement", "turn", "sigma_of_rows", "rays",
            )
        }  # fmt: skip
        return dataclasses.replace(self, **cut)

    def without(self, hidden: Mask) -> Channels:
        """The same rows, those marked (N,) blank in every channel."""
        blank: dict[str, Any] = {}
        for kind in self.present:
            values = np.array(getattr(self, kind))
            values[hidden] = np.nan
            blank[kind] = values
        return dataclasses.replace(self, **blank)

    @property
    def by_load(self) -> bool:
        """Is anything read that only a load makes?"""
        return any(getattr(self, kind) is not None for kind in BY_LOAD)

    @property
    def displacements_alone(self) -> bool:
        """Was nothing read but what a load makes?"""
        return set(self.present) <= set(BY_LOAD)

    def project(
        self,
        position: Array,
        rotation: Array,
        columns: Array,
        moved: Moved | None = None,
        tilted: tuple[Array, Array] | None = None,
    ) -> tuple[Array, Array]:
        """Gap (M,) measured minus predicted, and derivative (M, P) of the prediction.

        Args:
            position, rotation, columns: (N, 3), (N, 3, 3) predicted poses and (N, 6, P) their
                derivative, axes of the instrument.
            moved: What the load is predicted to do, where anything is read that it makes.
            tilted: (N,) predicted inclination and (N, P) its derivative, where there are any.
        """
        found: dict[Kind, tuple[Array, Array]] = {}
        if self.position is not None:
            found["position"] = self._on_rays(self.position - position, columns[:, :3])
        if self.rotation is not None:
            found["rotation"] = _turned(self.rotation, rotation, columns[:, 3:])
        if self.distance is not None and self.anchor is not None:
            away = position - self.anchor
            far = np.linalg.norm(away, axis=1)
            slope = np.einsum("ni,nip->np", away / far[:, None], columns[:, :3])
            found["distance"] = (self.distance - far)[:, None], slope[:, None]
        if moved is not None:
            found |= self._by_load(moved)
        if self.inclination is not None and tilted is not None:
            found["inclination"] = (self.inclination - tilted[0])[:, None], tilted[1][:, None]
        held = [(*found[kind], self.held(kind)) for kind in self.present]
        return (
            np.concatenate([gap[known] for gap, _, known in held]),
            np.concatenate([slope[known] for _, slope, known in held]),
        )

    def _on_rays(self, gap: Array, slope: Array) -> tuple[Array, Array]:
        """Gaps of positions (N, 3) and their derivative (N, 3, P), along what they are told."""
        if self.rays is None:
            return gap, slope
        blank = np.isnan(gap)  # of such a row the rays are the axes
        along = np.einsum("nij,nj->ni", self.rays, np.where(blank, 0.0, gap))
        return np.where(blank, np.nan, along), self.rays @ slope

    def _by_load(self, moved: Moved) -> dict[Kind, tuple[Array, Array]]:
        found: dict[Kind, tuple[Array, Array]] = {}
        if self.shift is not None and self.along is not None:
            gap = self.shift - np.einsum("ni,ni->n", self.along, moved.displacement)
            slope = np.einsum("ni,nip->np", self.along, moved.columns[:, :3])
            found["shift"] = gap[:, None], slope[:, None]
        if self.displacement is not None:
            found["displacement"] = self.displacement - moved.displacement, moved.columns[:, :3]
        if self.turn is not None:
            said = rotation_vector(moved.rotation)  # where an axis was not read
            read = rotation_of(np.where(np.isnan(self.turn), said, self.turn))
            found["turn"] = _turned(read, moved.rotation, moved.columns[:, 3:])
        return found

    def scale(self, kind: Kind) -> Array:
        """(M_kind,) relative standard uncertainty of the channels of a kind [m or rad]."""
        held = self.held(kind)
        if kind in _OF_ROWS and self.sigma_of_rows is not None:
            return self.sigma_of_rows[held]
        return np.full(int(held.sum()), self.sigma.get(kind, 1.0))

    def stated(self, kind: Kind) -> bool:
        """Does the file say how uncertain the readings of a kind are?"""
        return kind in self.sigma or (kind in _OF_ROWS and self.sigma_of_rows is not None)


def inclined(level: Array, rotation: Array, turning: Array, down: Array) -> tuple[Array, Array]:
    """Angle (N,) above the horizon of directions (N, 3) of the tool, and its derivative (N, P).

    Args:
        level: Unit vectors, axes of the tool.
        rotation, turning: (N, 3, 3) axes of the tool and (N, 3, P) how they turn, base axes.
        down: (3,) where gravity points to, base axes.
    """
    seen = np.einsum("nij,nj->ni", rotation, level)
    sine = -seen @ down
    slope = np.einsum("ni,nip->np", np.cross(down, seen), turning)
    return np.arcsin(sine), slope / np.sqrt(1.0 - sine**2)[:, None]


def _turned(measured: Array, predicted: Array, columns: Array) -> tuple[Array, Array]:
    """Rotation vector from predicted to measured axes, and minus its derivative.

    log(exp(g) exp(-d)) = g - (1 + [g]/2 + ...) d.
    """
    gap = rotation_vector(measured @ np.swapaxes(predicted, -1, -2))
    half = 0.5 * np.cross(gap[:, None], np.swapaxes(columns, 1, 2))
    return gap, columns + np.swapaxes(half, 1, 2)
