"""What each named cause takes off the gap, fitted and at poses left out."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace

import numpy as np

from sk120stiff.arrays import Array, Index, Mask
from sk120stiff.effects import Geometric, LoadError, Weighing
from sk120stiff.errors import listed
from sk120stiff.explain.findings import Contender, Step
from sk120stiff.explain.judge.borne_out import BorneOut, name_of, shown
from sk120stiff.explain.positions.select.candidates import COMPLIANCE, family
from sk120stiff.explain.positions.select.choose import Chosen, lengths
from sk120stiff.explain.positions.select.linear import Linear
from sk120stiff.identify.positions.calibrate import Calibration
from sk120stiff.identify.positions.checks.reregistration import placed_anew
from sk120stiff.identify.positions.noise.sizes import wild_beside
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

    def sentence(self, problem: PoseProblem) -> str:
        """How far they are off, and which rows are not counted."""
        readings, rows = self.readings, np.flatnonzero(self.set_aside)
        said = f"Held-out file: {1e6 * self.rms:.3g} {problem.rms_unit}"
        if np.isfinite(self.distance):
            said += f", {1e6 * self.distance:.3g} µm mean distance"
        said += f"; the registered arm alone: {1e6 * self.registered:.4g} {problem.unit}"
        if len(rows):
            lines = [f"line {readings.line[k]} (pose {readings.pose[k]})" for k in rows]
            lie = "1 row that lies" if len(rows) == 1 else f"{len(rows)} rows that lie"
            said += f". Not counted: {lie} far off all others, {listed(lines, most=LISTED)}; with "
            said += f"{'it' if len(rows) == 1 else 'them'} {1e6 * self.rms_of_all:.3g} "
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


def steps_of(
    linear: Linear, found: Chosen, base: Calibration, seen: Calibration, inside: Index
) -> tuple[GapStep, ...]:
    """The gap as one named cause after the other joins, over the numbers `inside`.

    The registered arm comes first as plain least squares place it: what it leaves is no draw of
    each pose, however large what the readings of a pose have in common is beside the causes.
    """
    white = seen.problem.of_channels
    whole = _whole(linear, seen) & np.isin(np.arange(len(linear.residual)), inside)
    first = " + ".join(base_labels(base)) or RIGID
    labels = [first, *(f"+ {linear.candidates[e].id}" for e in found.order)]
    steps = []
    for k, label in enumerate(labels):
        chosen = found.order[:k]
        kind = white if k else replace(white, common=0.0)
        metres, used = kind.undo, linear if k else linear.only(()).whitened(white, kind)
        noise = used.noise(chosen)
        fitted = used.gap(chosen, noise, held_out=False)
        held = used.gap(chosen, noise, held_out=True)
        distance = lengths(metres(held), linear, whole)
        steps.append(
            GapStep(
                label,
                rms(metres(fitted)[inside]),
                rms(metres(held)[inside]),
                float(distance.mean()) if len(distance) else np.nan,
            )
        )
    return tuple(steps)


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


def families_of(
    linear: Linear, found: Chosen, seen: Calibration, inside: Index
) -> dict[str, float]:
    """Family → rms that its causes take off the held-out gap together, over `inside` [m].

    A load that is misread shows by what yields alone: without that it is left out as well.
    """
    metres = seen.problem.of_channels.undo
    groups: dict[str, list[int]] = {}
    for e in found.order:
        groups.setdefault(family(linear.candidates[e]), []).append(e)
    noise = linear.noise(found.order)
    left = rms(metres(linear.gap(found.order, noise, held_out=True))[inside])
    out = {}
    for name, members in groups.items():
        gone = set(members)
        if name == COMPLIANCE:
            gone |= {
                e for e in found.order if isinstance(linear.candidates[e], LoadError | Weighing)
            }
        rest = tuple(e for e in found.order if e not in gone)
        out[name] = rms(metres(linear.gap(rest, noise, held_out=True))[inside]) - left
    return out


def springs_of(linear: Linear, found: Chosen) -> float | None:
    """Share of the held-out gap that springs in all joints would take off, where none is named."""
    springs = [e for e, effect in enumerate(linear.candidates) if effect.joint_spring]
    if not springs or set(springs) & set(found.order):
        return None
    noise = linear.noise(found.order)
    before = rms(linear.gap(found.order, noise, held_out=True))
    return 1.0 - rms(linear.gap((*found.order, *springs), noise, held_out=True)) / before


def nearer_as_a_whole(
    linear: Linear, found: Chosen, seen: Calibration, inside: Index
) -> float | None:
    """Rms at poses left out of all errors of geometry and all springs together [m].

    That is what `identify` fits, without a name for any. None where the names leave no more, or
    nearly so, and where only what loads do was read.
    """
    if seen.problem.channels.displacements_alone:
        return None
    whole = tuple(
        e
        for e, effect in enumerate(linear.candidates)
        if isinstance(effect, Geometric) or effect.joint_spring
    )
    if not set(whole) - set(found.order):
        return None
    left = held_out_rms(linear, whole, seen, inside)
    return left if left < NEARER * held_out_rms(linear, found.order, seen, inside) else None


def suspects_of(
    linear: Linear, found: Chosen, seen: Calibration, inside: Index
) -> tuple[Contender, ...]:
    """Names that fit, and what each takes off the held-out rms over `inside` by itself [m]."""
    whole = held_out_rms(linear, found.order, seen, inside)
    return tuple(
        Contender(
            linear.candidates[e].id,
            held_out_rms(linear, linear.less(found.order, e), seen, inside) - whole,
        )
        for e in found.order
    )


def held_out_rms(
    linear: Linear, chosen: tuple[int, ...], seen: Calibration, inside: Index
) -> float:
    """Rms that some causes leave at poses left out, over the numbers `inside` [m]."""
    gap = linear.gap(chosen, linear.noise(chosen), held_out=True)
    return rms(seen.problem.of_channels.undo(gap)[inside])


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
