"""What each named cause takes off the gap, fitted and at poses left out."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.effects import Geometric, LoadError, Weighing
from sk120stiff.errors import listed, micro
from sk120stiff.explain.findings import Contender, Step
from sk120stiff.explain.judge.borne_out import BorneOut, name_of, shown
from sk120stiff.explain.positions.select.candidates import COMPLIANCE, family
from sk120stiff.explain.positions.select.choose import Chosen, lengths
from sk120stiff.explain.positions.select.linear import Linear
from sk120stiff.identify.positions.calibrate import Calibration
from sk120stiff.identify.positions.checks.reregistration import placed_anew
from sk120stiff.identify.positions.noise.sizes import wild_beside
from sk120stiff.identify.positions.solve.pose_errors import PoseWhitening
from sk120stiff.identify.positions.solve.pose_problem import PoseProblem
from sk120stiff.measurements import Measurements
from sk120stiff.model import warn_of_references

LISTED = 6  # rows of a held-out file that are told one by one
NEARER = 0.9  # of the gap at poses left out, below which a calibration of everything is told
RIGID = "rigid"  # the model that has no effect


@dataclass(frozen=True)
class GapStep(Step):
    """The gap with one cause more, and the mean distance at poses left out [m]."""

    heldout_distance: float


@dataclass(frozen=True, eq=False)
class HeldOutFile:
    """The gap at readings that no fit saw.

    Attributes:
        rms, distance: Rms of what is counted and mean distance of whole positions, without the rows
            set aside [m]; NaN where there are none.
        set_aside: (N,) rows that lie far off all others of their file.
        rms_of_all: Rms with these rows [m].
        readings: All N readings.
        registered: Rms that the arm leaves there which was only registered [m].
        borne_out: What these readings show of what was named; None: nothing.
        anew: What was found anew because the tracker stands elsewhere, in words; None: nothing.
    """

    rms: float
    distance: float
    set_aside: Mask
    rms_of_all: float
    readings: Measurements
    registered: float
    borne_out: BorneOut | None = None
    anew: str | None = None

    def unit(self, problem: PoseProblem) -> str:
        """µm or µrad, as these readings are counted by a problem of the model."""
        return replace(problem, measurements=self.readings.masked()).unit

    def sentence(self, problem: PoseProblem) -> str:
        """How far they are off, and which rows are not counted."""
        problem = replace(problem, measurements=self.readings.masked())
        readings, rows = self.readings, np.flatnonzero(self.set_aside)
        said = f"Held-out file: {micro(self.rms)} {problem.rms_unit}"
        if np.isfinite(self.distance):
            said += f", {micro(self.distance)} µm mean distance"
        said += f"; the registered arm alone: {micro(self.registered, 4)} {problem.unit}"
        if len(rows):
            lines = [f"line {readings.line[k]} (pose {readings.pose[k]})" for k in rows]
            lie = "1 row that lies" if len(rows) == 1 else f"{len(rows)} rows that lie"
            said += f". Not counted: {lie} far off all others, {listed(lines, most=LISTED)}; with "
            said += f"{'it' if len(rows) == 1 else 'them'} {micro(self.rms_of_all)} "
            said += problem.unit
        parts = [f"{said}."]
        if self.borne_out is not None and self.borne_out.contradicted:
            parts.append(self.borne_out.sentence(problem.rms_unit))
        if self.anew:
            parts.append(self.anew)
        return " ".join(parts)


def numbers_told(seen: Calibration, final: Calibration, readings: Measurements) -> Index:
    """Numbers at which `seen` is linearised that count, without rows that `final` set aside."""
    rows = readings.use & ~seen.wild  # those of `seen`
    counted = seen.problem.counted
    return np.asarray(counted[~final.wild[rows][seen.problem.rows[counted]]])


@dataclass(frozen=True, eq=False)
class Account:
    """The gap [m] with named causes and without some of them.

    The model with all is taken as it is fitted: beside what the readings of a pose have in common.
    Another one nobody fits so, since something else would be in common beside it; it counts as it
    foretells other poses better, so weighted or with every reading alike. The registered arm is
    placed by plain least squares.

    Attributes:
        linear: The positions linearised.
        found: The names.
        seen: The calibration about which they are linearised.
        inside: Numbers that count.
    """

    linear: Linear
    found: Chosen
    seen: Calibration
    inside: Index

    @cached_property
    def _ways(self) -> tuple[tuple[Linear, PoseWhitening], ...]:
        """The linear problem in units of the noise: as fitted, and with every reading alike."""
        white = self.seen.problem.of_channels
        alike = replace(white, common=0.0)
        as_fitted = self.linear, white
        if white.common == 0.0:
            return (as_fitted,)
        return as_fitted, (self.linear.whitened(white, alike), alike)

    def gaps(self, chosen: tuple[int, ...], *, as_fitted: bool = False) -> tuple[Array, Array]:
        """(M,) what some causes leave, fitted and at poses left out [m]."""
        ways = self._ways if chosen else self._ways[-1:]
        found = []
        for linear, white in ways[:1] if as_fitted else ways:
            noise = linear.noise(chosen)
            held, fitted = (
                white.undo(linear.gap(chosen, noise, held_out=each)) for each in (True, False)
            )
            found.append((fitted, held))
        return min(found, key=lambda pair: rms(pair[1][self.inside]))

    def held_out(self, chosen: tuple[int, ...], *, as_fitted: bool = False) -> float:
        """Rms that some causes leave at poses left out."""
        return rms(self.gaps(chosen, as_fitted=as_fitted)[1][self.inside])

    @cached_property
    def left(self) -> float:
        """Rms that all names leave at poses left out."""
        return self.held_out(self.found.order, as_fitted=True)

    def taken(self, e: int) -> float:
        """What one of the names takes off that rms beside the others."""
        return self.held_out(self.linear.less(self.found.order, e)) - self.left

    def share(self, e: int) -> float:
        """The same as a share of what is left without it."""
        taken = self.taken(e)
        return taken / max(self.left + taken, 1e-300)

    def steps(self, base: Calibration) -> tuple[GapStep, ...]:
        """The gap as one named cause after the other joins."""
        order, whole = self.found.order, _whole(self.linear, self.seen)
        whole = whole & np.isin(np.arange(len(whole)), self.inside)
        first = " + ".join(base_labels(base)) or RIGID
        labels = [first, *(f"+ {self.linear.candidates[e].id}" for e in order)]
        steps = []
        for k, label in enumerate(labels):
            fitted, held = self.gaps(order[:k], as_fitted=k == len(order))
            distance = lengths(held, self.linear, whole)
            away = float(distance.mean()) if len(distance) else np.nan
            steps.append(GapStep(label, rms(fitted[self.inside]), rms(held[self.inside]), away))
        return tuple(steps)

    def families(self) -> dict[str, float]:
        """Family → rms that its causes take off the held-out gap together.

        A load that is misread shows by what yields alone: without that it is left out as well.
        """
        order, candidates = self.found.order, self.linear.candidates
        groups: dict[str, list[int]] = {}
        for e in order:
            groups.setdefault(family(candidates[e]), []).append(e)
        out = {}
        for name, members in groups.items():
            gone = set(members)
            if name == COMPLIANCE:
                gone |= {e for e in order if isinstance(candidates[e], LoadError | Weighing)}
            out[name] = self.held_out(tuple(e for e in order if e not in gone)) - self.left
        return out

    def springs(self) -> float | None:
        """Share of the held-out gap that springs in all joints take off; None: some are named."""
        candidates = self.linear.candidates
        springs = [e for e, effect in enumerate(candidates) if effect.joint_spring]
        if not springs or set(springs) & set(self.found.order):
            return None
        beside = self.held_out((*self.found.order, *springs), as_fitted=True)
        return 1.0 - beside / max(self.left, 1e-300)

    def nearer_as_a_whole(self) -> float | None:
        """Rms at poses left out of all errors of geometry and all springs together.

        That is what `identify` fits, without a name for any. None where the names leave no more, or
        nearly so, and where only what loads do was read.
        """
        if self.seen.problem.channels.displacements_alone:
            return None
        whole = tuple(
            e
            for e, effect in enumerate(self.linear.candidates)
            if isinstance(effect, Geometric) or effect.joint_spring
        )
        if not set(whole) - set(self.found.order):
            return None
        left = self.held_out(whole, as_fitted=True)
        return left if left < NEARER * self.left else None

    def suspects(self) -> tuple[Contender, ...]:
        """Names that fit, and what each takes off the held-out rms."""
        return tuple(
            Contender(self.linear.candidates[e].id, self.taken(e)) for e in self.found.order
        )


def base_labels(base: Calibration) -> list[str]:
    """What the base model holds: an effect by its id, several of one name by that name alone."""
    effects = base.model.effects
    count = Counter(effect.name for effect in effects)
    return list(dict.fromkeys(e.id if count[e.name] == 1 else e.name for e in effects))


def _whole(linear: Linear, seen: Calibration) -> Mask:
    """(M,) numbers that are coordinates of positions."""
    part = np.zeros(len(linear.residual), dtype=bool)
    for kind, own in zip(seen.problem.channels.present, seen.problem.channels.kinds, strict=True):
        part[own] = kind == "position"
    return part


def rms(x: Array) -> float:
    """Root of the mean square; 0 of nothing."""
    return float(np.sqrt(np.mean(x**2))) if len(x) else 0.0


def heldout_on(final: Calibration, base: Calibration, others: Measurements) -> HeldOutFile:
    """How far a calibration is off at readings it never saw; rows far off all others are told.

    Where the tracker stands elsewhere by then, its frame is that of these readings, as it is for
    the `base`, which is the arm that was only registered.
    """
    warn_of_references(final.model, others)
    moved = placed_anew(final.model, others)
    if moved is not None:
        final, others = replace(final, model=moved.model), moved.readings
    wild = wild_beside(final, others, np.zeros(others.n_readings, dtype=bool))
    kept = ~wild[others.use]
    problem, gap = _gap_of(final, others)
    counted = problem.counted
    inside = counted[kept[problem.rows[counted]]]
    length = problem.distances(gap)[kept]
    length = length[np.isfinite(length)]
    rigid = placed_anew(base.model, others)
    base = base if rigid is None else replace(base, model=rigid.model)
    alone = _gap_of(base, others if rigid is None else rigid.readings)[1]
    poses = [problem.measurements.pose[row] for row in problem.rows[inside]]
    return HeldOutFile(
        rms=rms(gap[inside]),
        distance=float(length.mean()) if len(length) else np.nan,
        set_aside=wild,
        rms_of_all=rms(gap[counted]),
        readings=others,
        registered=rms(alone[inside]),
        borne_out=shown(alone[inside], gap[inside], poses, name_of(others)),
        anew=None if moved is None else moved.sentence(),
    )


def _gap_of(found: Calibration, others: Measurements) -> tuple[PoseProblem, Array]:
    """Other readings as a problem of a calibration's model, and (M,) what it leaves of them."""
    problem = replace(found.problem, measurements=others.masked(), model=found.model)
    return problem, problem.channel_gap(found.model.values)[0]
