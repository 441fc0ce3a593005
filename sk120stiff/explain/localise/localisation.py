"""Where a gap lives, as frozen data: what `localise` finds, words and figures show."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from sk120stiff.arrays import Array
from sk120stiff.identify.checks.yardstick import Source

Whole = Literal["excess", "gap"]

LEVEL = 0.01  # family-wise probability below which something counts as seen
MOSTLY_NOISE = 0.25  # share of the gap's square beyond the noise below which shares are of the gap


@dataclass(frozen=True)
class PoseShare:
    """The gap of one pose.

    Attributes:
        label: The pose.
        rms, noise: Rms gap per axis, and what the noise would leave [m]; None where nothing tells
            the noise.
        share: Its part of the whole, see `Localisation.whole`; below zero where the gap is less
            than the noise.
        probability: That chance makes such a gap at any of the poses. Where nothing tells the
            noise: such a gap beside those of the other poses.
    """

    label: str
    rms: float
    noise: float | None
    share: float
    probability: float


@dataclass(frozen=True)
class LoadLevel:
    """The gap over loads from `low` to `high` [N]: rms per axis and what noise would leave [m].

    `noise` is None where nothing tells it.
    """

    low: float
    high: float
    count: int
    rms: float
    noise: float | None


@dataclass(frozen=True)
class DirectionShare:
    """Share of the whole that points along one axis."""

    axes: str
    word: str
    share: float


@dataclass(frozen=True)
class OrderShare:
    """One order of the gap in the load.

    Attributes:
        name: ``linear``, ``constant`` or ``curved``.
        share: Its part of what exceeds the noise.
        excess: By how much it exceeds the noise, as a sum of squares [noise variances].
        probability: That chance makes it, corrected for three looks; None where the readings do not
            allow it.
    """

    name: Literal["linear", "constant", "curved"]
    share: float
    excess: float
    probability: float | None


@dataclass(frozen=True)
class OwnAtPoses:
    """Something of its own at every pose, beside the model: is it more than noise?

    Attributes:
        name: ``constant``, ``drift``, ``proportional`` to the load, ``branches``: other when
            unloading.
        statistic, freedom: What it takes away of the misfit [noise variances], and its degrees of
            freedom.
        probability: That chance makes it.
    """

    name: Literal["constant", "drift", "proportional", "branches"]
    statistic: float
    freedom: int
    probability: float


@dataclass(frozen=True)
class PostureTrend:
    """How the gap of poses goes with their posture.

    Attributes:
        name: ``the reach``, ``the height``, ``the position of joint_2_l``.
        correlation, probability: Rank correlation, and that of chance, corrected for the number of
            postures.
        low, high: Rms gaps of the lower and of the upper half of the poses [m].
    """

    name: str
    correlation: float
    probability: float
    low: float
    high: float


@dataclass(frozen=True, eq=False)
class Suspicion:
    """How closely the gap goes with one suspect.

    Attributes:
        family, name, label: See `Suspect`.
        statistic, freedom: T and its degrees of freedom.
        probability: That chance makes a T as large in any of the looks.
        explained: Share of the whole that it takes away, beyond what its freedom takes of mere
            noise.
        evidence: Decides the order: what is left of T when every degree of freedom has been paid
            for, and which of several alike it is.
        abscissa, partial: (N,) the variable, and the gap along the suspect's direction [m], freed
            of what the model's own parameters had covered up; empty far down the list.
    """

    family: str
    name: str
    label: str
    statistic: float
    freedom: int
    probability: float
    explained: float
    evidence: float
    abscissa: Array = field(default_factory=lambda: np.zeros(0))
    partial: Array = field(default_factory=lambda: np.zeros(0))

    @property
    def seen(self) -> bool:
        """It is more than chance."""
        return self.probability < LEVEL


@dataclass(frozen=True, eq=False)
class Localisation:
    """Where a gap lives.

    Attributes:
        rms, noise: Rms gap per axis, and what the noise alone would leave [m]; None where nothing
            tells it.
        noise_from: Where the size of the noise comes from: it was ``stated``, ``repeats`` tell it,
            or the ``scatter`` within poses; ``unknown``: nothing tells, but the gap itself.
        whole: What shares are shares of: the ``excess`` of the gap's square over the noise, or the
            square of the ``gap`` itself, where the noise is unknown or makes most of it.
        beyond: Share of the whole that noise does not make; 1 where nothing tells.
        probability: That noise alone makes such a gap (`lack_of_fit`); None where nothing tells.
        poses, levels, directions, orders, postures: By pose, by size of the load, by direction in
            several axes, by order in the load, by posture.
        own: What poses may have of their own.
        suspects: All that it may go with, the strongest first.
        beside: The same for what remains once the strongest has been allowed for, shares still of
            the whole; empty without a strongest one.
    """

    rms: float
    noise: float | None
    noise_from: Source
    whole: Whole
    beyond: float
    probability: float | None
    poses: tuple[PoseShare, ...]
    levels: tuple[LoadLevel, ...]
    directions: tuple[DirectionShare, ...]
    orders: tuple[OrderShare, ...]
    postures: tuple[PostureTrend, ...]
    own: tuple[OwnAtPoses, ...]
    suspects: tuple[Suspicion, ...]
    beside: tuple[Suspicion, ...]

    @property
    def real(self) -> bool:
        """The gap is more than noise, or goes with something more closely than chance would."""
        beyond = self.probability is not None and self.probability < LEVEL
        return beyond or self.strongest is not None

    @property
    def strongest(self) -> Suspicion | None:
        """The suspect that the gap goes with most closely, if that is more than chance."""
        return self.suspects[0] if self.suspects and self.suspects[0].seen else None

    def best_of(self, *families: str) -> Suspicion | None:
        """The strongest suspect of some families, more than chance or not."""
        return next((s for s in self.suspects if s.family in families), None)
