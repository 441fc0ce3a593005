"""Readings of where markers stand that could be taken: poses, with what hangs on the tool there.

What is told of a model by them is told as a fit does: small errors of every joint's frame beside
what the model holds, the instrument's frame and the markers' places unknown, and what no candidates
tell apart counted in other parameters (`identify.positions.solve.minimal_parameters`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from sk120stiff.arrays import Array, Index, rms
from sk120stiff.effects import Effect, Mounting, Viewpoint
from sk120stiff.effects.geometry import ToolOffset
from sk120stiff.effects.marker_shift import MarkerShift
from sk120stiff.errors import InputError
from sk120stiff.identify.positions.calibrate import Calibration, calibrate, rigid_columns
from sk120stiff.identify.positions.noise.sizes import START
from sk120stiff.identify.positions.omitted.own_weight import heaviest_payload, own_weight
from sk120stiff.identify.positions.solve.minimal_parameters import least_set
from sk120stiff.identify.positions.solve.pose_problem import PoseProblem, absolute_of
from sk120stiff.identify.positions.solve.start import loaded, started
from sk120stiff.measurements import Channels, Measurements, NoiseModel
from sk120stiff.measurements.absolute import Absolute
from sk120stiff.measurements.channels import ANGLES
from sk120stiff.measurements.noise.rays import anywhere
from sk120stiff.measurements.placing.placing import Placing
from sk120stiff.measurements.poses import labels_to_come
from sk120stiff.model import Model
from sk120stiff.plan.discriminate import Rivalry, over_ranges, with_both
from sk120stiff.plan.planned import LITTLE, USUAL
from sk120stiff.plan.pool import Pool
from sk120stiff.robot import Robot

PLACING = (Mounting, Viewpoint, ToolOffset, MarkerShift)  # of the rig, not of the arm


@dataclass(frozen=True, eq=False)
class PositionsPool:
    """M candidates.

    Attributes:
        problem: Their R readings, and the model whose P free parameters are to be known.
        candidate: (R,) which candidate each reading belongs to: all markers at a pose, under one
            payload, are one.
        pool: Poses and loads of the candidates.
        known: Readings that were taken already, or None.
        untold: Parameter → why these candidates do not tell it by itself.
        remarks: What is to be said of springs that nothing bends, in sentences.
    """

    problem: PoseProblem
    candidate: Index
    pool: Pool
    known: Measurements | None
    untold: Mapping[str, str]
    remarks: tuple[str, ...]

    @cached_property
    def span(self) -> Array:
        """(P,) plausible sizes of the free parameters, internal."""
        model = self.problem.model
        return np.array([self.problem.reach(model.parameters[k]) for k in model.free])

    @property
    def of_the_arm(self) -> tuple[str, ...]:
        """Free parameters that are not where the instrument stands or how a marker sits."""
        parameters = [self.problem.model.parameters[k] for k in self.problem.model.free]
        return tuple(p.name for p in parameters if not isinstance(p.effect, PLACING))

    @property
    def standard(self) -> float:
        """Standard uncertainty of one number, rms over lengths where there are any [m or rad]."""
        own = self.problem.sigma_of_channels[self.problem.counted]
        return rms(own)

    def numbers(self, count: int) -> int:
        """How many are read at so many candidates, those of readings taken already among them."""
        channels = (
            None if self.known is None or self.known.absolute is None else self.known.absolute
        )
        before = 0 if channels is None else len(channels.channels.rows)
        return before + count * len(self.problem.rows) // self.pool.count

    def rows_of(self, chosen: Index) -> Index:
        """Readings of some candidates."""
        return np.flatnonzero(np.isin(self.candidate, chosen))

    @cached_property
    def information(self) -> tuple[Array, Array]:
        """(M, P, P) of each candidate over the spans, and (P, P) before, plausible ranges in it.

        Behind the free parameters stand moments of the links of an arm without masses: what its
        weight may do is no part of a fit, and makes springs less certain all the same.
        """

        def columns(problem: PoseProblem) -> Array:
            slope = problem.channel_gap(problem.model.values, derivative=True)[1]
            own = slope[:, problem.model.free] * self.span
            return problem.of_channels.apply(np.column_stack([own, own_weight(problem, heaviest)]))

        known = None if self.known is None else replace(self.problem, measurements=self.known)
        here = self.problem if known is None else known
        heaviest = max(heaviest_payload(each) for each in (self.problem, here))
        A = columns(self.problem)
        before = np.eye(A.shape[1])
        if known is not None:
            B = columns(known)
            before += B.T @ B
        return self._by_candidate(A), before

    def rivalry(self, effect: Effect, rival: Effect) -> Rivalry:
        """What they would say between two effects; what was read already is known."""
        return rivalry_of(
            self.problem, self.known, effect, rival, self.candidate[self.problem.rows]
        )

    def _by_candidate(self, columns: Array) -> Array:
        return summed(columns, self.candidate[self.problem.rows], self.pool.count)


def rivalry_of(
    problem: PoseProblem,
    known: Measurements | None,
    effect: Effect,
    rival: Effect,
    candidate: Index,
) -> Rivalry:
    """What candidates would say between two effects, see `discriminate.rivalry`.

    Args:
        problem: Their readings, and the base model.
        known: Readings that were taken already.
        effect, rival: What is to be told apart.
        candidate: (L,) that each of the problem's numbers belongs to.
    """
    gains, before = [], []
    for pair in ((effect, rival), (rival, effect)):
        gains.append(summed(_columns(problem, *pair), candidate, int(candidate.max()) + 1))
        before.append(np.zeros(gains[-1].shape[1:]))
        if known is not None:
            A = _columns(replace(problem, measurements=known), *pair)
            before[-1] = A.T @ A
    return Rivalry.of(gains, before)


def _columns(problem: PoseProblem, effect: Effect, rival: Effect) -> Array:
    """(L, k) columns of L numbers in units of the noise, see `over_ranges`."""
    model = with_both(problem.model, effect, rival)
    here = replace(problem, model=model)
    slope = here.of_channels.apply(here.channel_gap(model.values, derivative=True)[1])
    return over_ranges(model, slope, effect)


def summed(columns: Array, owner: Index, count: int) -> Array:
    """(count, k, k) AᵀA of the rows of columns (L, k) that have the same owner (L,)."""
    out = np.zeros((count, columns.shape[1], columns.shape[1]))
    np.add.at(out, owner, columns[:, :, None] * columns[:, None, :])
    return out


def positions_pool(
    model: Model,
    like: Measurements,
    a: Array,
    *,
    known: Measurements | None = None,
    sigma: float | None = None,
) -> PositionsPool:
    """The candidates at poses (K, n), each as `like` in turn, see `readings_like`.

    Args:
        model: Its free parameters are to be known, beside the geometry; fitted to `known` first.
        like: Rows of what is read at a pose.
        a: Poses [rad or m].
        known: Readings that were taken already.
        sigma: Standard uncertainty of one length [m]; as stated or found, else 10 µm, by default.
    """
    S, K = like.n_readings, len(a)
    there = replace(
        like.select(np.tile(np.arange(S), K)),
        joints=np.repeat(a, S, axis=0),
        pose=tuple(f"pool_{k + 1}" for k in range(K) for _ in range(S)),
        zero_group=np.arange(S * K),
        zero_joints=None,
    )
    loads = _situations(like)
    candidate = (np.arange(K)[:, None] * (loads.max() + 1) + loads).ravel()
    remarks: list[str] = []
    if known is None:
        start, remarks = loaded(started(model, there, _here(there), geometry=True), there)
        sizes = {**START, **{kind: USUAL for kind in START if kind not in ANGLES}}
    else:
        found = calibrate(model, known)
        start = _started_from(found, model)
        sizes = {**START, **found.problem.sigma}
    if sigma is not None:
        sizes |= {kind: sigma for kind in sizes if kind not in ANGLES}
        there, known = _unstated(there), None if known is None else _unstated(known)
    noise = NoiseModel(sizes["position"], zero="separate")
    wide = PoseProblem(start, there, noise, sigma=sizes)
    small, frozen = least_set(start, rigid_columns(wide, start), wide.span)
    problem = replace(wide, model=small)
    first = np.unique(candidate, return_index=True)[1]
    return PositionsPool(
        problem,
        candidate,
        Pool(problem.load_cases.rows(first)),
        known,
        {each.name: each.sentence() for each in frozen},
        tuple(remarks),
    )


def _started_from(found: Calibration, model: Model) -> Model:
    """The fitted model; what it had to leave open is free again, at the value that was stated."""
    frozen = {each.name for each in found.frozen}
    free = [found.model.parameters[k] for k in found.model.free]
    variances = zip(free, np.diag(found.covariance), strict=True)
    blind = {p.name for p, v in variances if not v < LITTLE * found.problem.reach(p) ** 2}
    stated = {p.name: p.internal for p in model.parameters if p.name in blind}
    return replace(
        found.model,
        parameters=tuple(
            replace(p, free=p.free or p.name in frozen, internal=stated.get(p.name, p.internal))
            for p in found.model.parameters
        ),
    )


def _here(readings: Measurements) -> Placing:
    """The instrument's axes as those of the base, markers where they are said to sit."""
    nothing, count = np.zeros((1, 3)), readings.n_readings
    return Placing(
        nothing, nothing, np.zeros(3), nothing, 0.0, np.zeros(count, bool), np.zeros(count)
    )


def _situations(like: Measurements) -> Index:
    """(S,) rows under the same payload and load: those of other markers at the same pose."""
    said = absolute_of(like)
    return np.unique(np.column_stack([said.payload, like.wrench]), axis=0, return_inverse=True)[
        1
    ].reshape(-1)


def _unstated(readings: Measurements) -> Measurements:
    """The same without what their file says of the uncertainty of lengths."""
    said = readings.absolute
    if said is None:
        return readings
    kept = {kind: size for kind, size in said.channels.sigma.items() if kind in ANGLES}
    channels = replace(said.channels, sigma=kept, sigma_of_rows=None, rays=None)
    return replace(readings, absolute=replace(said, channels=channels))


def readings_like(
    robot: Robot,
    known: Measurements | None,
    payloads: Sequence[float] = (),
    payload_point: ArrayLike | None = None,
    point: ArrayLike | None = None,
) -> Measurements:
    """Rows of what is read at a pose: every marker, under every payload and load.

    Args:
        robot: Whose tool carries them.
        known: Readings whose markers, loads and columns are taken over.
        payloads: Masses that hang on the tool [kg]; by default those of `known`, or none.
        payload_point, point: (3,) where they hang, and about where the marker sits, tool axes [m];
            the tool's origin, or as `known` says, by default.
    """
    for mass in payloads:
        if not 0.0 <= mass < np.inf:
            raise InputError(f"a payload of {mass:g} kg", remedy="Give 0 or more.")
    masses = np.array(sorted(set(payloads)), dtype=float)
    if known is None:
        rows = _blank_rows(robot, len(masses) or 1)
    else:
        rows = known.select(_last_of_each(known))
        if len(masses):
            rows = rows.select(np.repeat(np.arange(rows.n_readings), len(masses)))
    said = absolute_of(rows)
    said = replace(said, channels=anywhere(said.channels))
    if len(masses):
        said = replace(said, payload=np.tile(masses, rows.n_readings // len(masses)))
    if payload_point is not None:
        said = replace(
            said, payload_point=np.asarray(payload_point, dtype=float), payload_placed=True
        )
    if point is not None:
        said = replace(said, point=np.tile(np.asarray(point, dtype=float), (rows.n_readings, 1)))
    return replace(rows, absolute=said)


def _last_of_each(known: Measurements) -> Index:
    """The last reading of every marker under every payload and load."""
    said = absolute_of(known)
    keys = zip(said.markers, said.payload.tolist(), map(tuple, known.wrench), strict=True)
    return np.array(sorted({key: row for row, key in enumerate(keys)}.values()), dtype=np.intp)


def _blank_rows(robot: Robot, count: int) -> Measurements:
    """Positions of one marker whose place is known only roughly, in an instrument's own axes."""
    return Measurements(
        pose=("rest",) * count,
        joint_names=robot.actuated,
        joint_kinds=robot.kinds,
        joints=np.tile(robot.rest, (count, 1)),
        wrench=np.zeros((count, 6)),
        displacement=None,
        robot=robot.source,
        base_frame=robot.base_frame,
        tool_frame=robot.tool_frame,
        absolute=Absolute(
            channels=Channels(position=np.zeros((count, 3))),
            frame="unknown",
            point=np.zeros((count, 3)),
            fit_point=True,
            markers=("",) * count,
            payload=np.zeros(count),
            payload_placed=False,
        ),
    )


def to_be_read(picked: Measurements, source: str) -> Measurements:
    """Readings to take: joint values as people type them, nothing of when or what was read."""
    said, count = absolute_of(picked), picked.n_readings
    return replace(
        picked,
        joints=np.where(
            [kind == "angle" for kind in picked.joint_kinds],
            np.radians(np.round(np.degrees(picked.joints), 4)),
            np.round(picked.joints, 7),
        ),
        absolute=replace(
            said,
            channels=replace(
                said.channels.without(np.ones(count, bool)), sigma_of_rows=None, rays=None
            ),
            temperature=None,
        ),
        sigma=None, order=None, time=None, branch=None, repeat=None, use=np.ones(count, dtype=bool),
        line=np.zeros(count, dtype=np.int64), path=None, source=source, extra={}, notes=(),
        data_hash="",
    )  # fmt: skip


def labels_of(taken: Measurements, known: Measurements | None) -> tuple[str, ...]:
    """Labels of poses in the order of the rows, none that readings have already."""
    index = np.unique(taken.joints, axis=0, return_inverse=True)[1].reshape(-1).tolist()
    order = {pose: k for k, pose in enumerate(dict.fromkeys(index))}
    if known is None:
        return tuple(f"p{order[pose] + 1}" for pose in index)
    names = labels_to_come(known.pose, len(order))
    return tuple(names[order[pose]] for pose in index)
