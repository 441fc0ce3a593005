"""From positions and a model to geometry and springs, known as well as the positions tell them."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any

import numpy as np

from sk120stiff.arrays import Array, Mask, rms
from sk120stiff.effects import CATALOGUE, Catalogue, Effect, Elastic, references_of
from sk120stiff.errors import InputError, short
from sk120stiff.identify.fit import Fit
from sk120stiff.identify.positions.noise.model_form import ModelForm, model_form, widened
from sk120stiff.identify.positions.noise.sizes import (
    START,
    alike,
    common_of,
    learned,
    of_poses,
    wild_beside,
)
from sk120stiff.identify.positions.omitted.nuisances import doubted
from sk120stiff.identify.positions.omitted.waves import beside_waves, doubtful, waves_that_show
from sk120stiff.identify.positions.refusals import (
    nowhere,
    refuse_a_wrong_end,
    refuse_another_robot,
)
from sk120stiff.identify.positions.solve.gauss_newton import gauss_newton
from sk120stiff.identify.positions.solve.minimal_parameters import Frozen, least_set
from sk120stiff.identify.positions.solve.pose_problem import PoseProblem, absolute_of
from sk120stiff.identify.positions.solve.start import loaded, started
from sk120stiff.identify.solving import as_fit
from sk120stiff.measurements import Measurements, NoiseModel
from sk120stiff.measurements.placing.levels import refuse_other_levels
from sk120stiff.measurements.placing.placing import Placing, place
from sk120stiff.measurements.placing.turned import targets_on_tool
from sk120stiff.measurements.stated_sizes import doubtful_sizes
from sk120stiff.model import Model, counted_from
from sk120stiff.robot.rotations import rotation_of

ROUNDS = 3  # of fitting, setting wild rows aside, and learning how large the noise is
MORE_ROUNDS = 3  # where other rows are still set aside


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Calibration(Fit):
    """A `Fit` of positions: geometry and springs.

    Attributes:
        problem: What was fitted, number by number.
        placed: The closed-form placing that came before; None where positions were not whole.
        frozen: Small errors of geometry that these readings cannot tell.
        still: Actuated joints that never move.
        wild: (N,) rows of the readings given that were set aside.
        waves: Transmission errors that show beyond doubt and so are in the model.
        notes: What is to be said, in sentences.
        form: The smooth error of the model in what is left, where it was looked for and is there;
            it is in the standard errors.
        lacks: Causes that what is left asks for beyond doubt, where they were looked for; what they
            would move the values by is in the standard errors.
    """

    problem: PoseProblem
    placed: Placing | None
    frozen: tuple[Frozen, ...]
    still: tuple[str, ...]
    wild: Mask
    waves: tuple[str, ...]
    notes: tuple[str, ...]
    form: ModelForm | None = None
    lacks: tuple[str, ...] = ()

    @classmethod
    def of(cls, found: Fit, **told: Any) -> Calibration:
        """A fit of poses, with what is told beside it."""
        return cls(**{own.name: getattr(found, own.name) for own in fields(Fit)}, **told)

    @cached_property
    def judged(self) -> tuple[float, int]:
        """See `Fit.judged`: against the noise alone, without what a pose's readings share."""
        white = self.problem.of_channels
        return self._held_against(white.undo(self.residual) / white.sigma)

    @cached_property
    def chance_of_common(self) -> float:
        """Probability that noise alone lets the readings of a pose err together as much."""
        return common_of(self, anew=False).chance

    @property
    def unit(self) -> float:
        """See `Fit.unit`; what a pose's readings share is in the whitened derivative already."""
        if self.problem.common == 0.0:
            return super().unit
        square, freedom = self._held_against(self.residual)
        if freedom < 1:
            return float(np.inf)
        factor = square / freedom
        return float(np.sqrt(self.inflation * (max(factor, 1.0) if self.sigma_known else factor)))

    @property
    def size(self) -> str:
        """See `Fit.size`: of lengths, or of angles where nothing else was read."""
        gap = self.problem.of_channels.undo(self.residual)[self.problem.counted]
        return f"{short(1e6 * rms(gap))} {self.problem.unit} rms"

    @property
    def per_axis(self) -> str:
        """See `Fit.per_axis`."""
        return self.problem.rms_unit.partition(" rms")[2]

    @property
    def distances(self) -> Array:
        """(K,) length of the gap at every row with a whole position [m]."""
        problem = self.problem
        length = problem.distances(problem.channel_gap(problem.values(self.x))[0])
        return np.asarray(length[np.isfinite(length)])


def calibrate(
    model: Model,
    readings: Measurements,
    *,
    geometry: bool = True,
    waves: bool = True,
    shared: bool = True,
    freedom: Sequence[str] = (),
    catalogue: Catalogue = CATALOGUE,
) -> Calibration:
    """Register the tracker, and estimate geometry, the marker's place and springs together.

    Args:
        model: Starting values; its free parameters are estimated beside the geometry.
        readings: Rows of where markers stand.
        geometry: Estimate six small errors of every joint's frame, as far as they can be told.
        waves: Let transmission errors in where the readings show them beyond doubt: what they leave
            out would be taken for springs.
        shared: Look for what all readings of a pose have in common, see `pose_errors.py`; without
            geometry that would be its errors.
        freedom: Full names of parameters to keep at their values.
        catalogue: Where effects come from.

    Raises:
        InputError: No such robot gave these positions, or there are too few of them.
        Refusal: The fit did not converge.
    """
    said = absolute_of(readings)
    model = model.under(readings.gravity)
    sizes = doubtful_sizes(model.robot, readings)
    placed = place(model.robot, readings)
    refuse_other_levels(model.robot, readings)
    mounted, turns = None, tuple[str, ...]()
    if placed is not None or said.frame == "base":
        turn = np.zeros((1, 3)) if placed is None or said.frame == "base" else placed.turn
        seen = rotation_of(turn)[said.stood[1]]
        mounted, turns = targets_on_tool(model.robot, readings, seen)
    if placed is None and said.frame == "unknown" and set(said.channels.present) != {"inclination"}:
        raise nowhere(readings)
    wild = np.zeros(readings.n_readings, dtype=bool) if placed is None else placed.wild
    geometry = geometry and not said.channels.displacements_alone
    start = started(
        model, readings, placed, geometry=geometry, mounted=mounted, catalogue=catalogue
    )
    start, unloaded = loaded(counted_from(start, references_of(readings.masked())), readings)
    kept_back = {start.parameter(name).name for name in freedom}
    start = replace(
        start,
        parameters=tuple(
            replace(p, free=False) if p.name in kept_back else p for p in start.parameters
        ),
    )
    found, frozen, wild = _fitted(start, readings, wild, shared=shared)
    if placed is None:
        refuse_another_robot(found, readings)
    else:
        refuse_a_wrong_end(found, placed, readings)
    chosen: tuple[str, ...] = ()
    if waves:
        found, chosen = _with_waves(found, catalogue)
    a = readings.joints[readings.use]
    still = tuple(
        name for name, reach in zip(readings.joint_names, np.ptp(a, axis=0), strict=True)
        if reach < 1e-6
    )  # fmt: skip
    notes = [*sizes, *(placed.notes if placed is not None else ()), *turns, *unloaded]
    found = doubted(found, catalogue)
    found = beside_waves(found, catalogue) if waves else found
    return Calibration.of(
        found,
        placed=placed,
        frozen=frozen,
        still=still,
        wild=wild,
        waves=chosen,
        notes=tuple(notes),
    )


def _fitted(
    start: Model,
    readings: Measurements,
    wild: Mask,
    *,
    shared: bool = True,
    near: Model | None = None,
) -> tuple[Fit, tuple[Frozen, ...], Mask]:
    """Fit, learn the noise, set wild rows aside, until nothing changes.

    What is called wild in the end took no part in the fit. What is frozen stays as it was stated:
    a round that took the noise for smaller may have found it anywhere.
    """
    sigma, common, turning = dict(START), 0.0, 1.0
    model = start if near is None else with_values_of(start, near)
    for turn in range(1, ROUNDS + MORE_ROUNDS + 1):
        used = readings.select(np.flatnonzero(readings.use & ~wild))
        wide = _problem(model, used, sigma, common, turning)
        _refuse_too_few(wide)
        small, frozen = least_set(model, rigid_columns(wide, start), wide.span)
        small = with_values_of(small, start, {each.name for each in frozen})
        problem = _problem(small, used, sigma, common, turning)
        _refuse_no_rest(problem)
        found = fitted(problem)
        before, sigma = (sigma, common, turning), learned(found)
        if shared:
            told = common_of(found)
            if told.size and not common:  # what was all noise is parted into two
                sigma = {k: told.noise * before[0][k] for k in START}
            common, turning = told.size, told.turning
        again = wild_beside(found, readings, wild)
        own = alike(common, before[1]) and alike(turning, before[2])
        same = own and all(alike(sigma[k], before[0][k]) for k in wide.channels.present)
        settled = bool((again == wild).all()) and (same or turn >= ROUNDS)
        if settled or turn == ROUNDS + MORE_ROUNDS:
            break
        wild, model = again, with_values_of(start, found.model)
    return found, frozen, wild


def fitted(problem: PoseProblem) -> Fit:
    """Least squares from the problem's start."""
    found = gauss_newton(
        problem.evaluate, problem.start, problem.bounds, problem.prior, problem.centre
    )
    return as_fit(problem, found)


def extended(found: Fit, effects: Sequence[Effect]) -> Fit:
    """The same readings fitted with further effects; what was frozen stays so."""
    model = found.model
    for effect in effects:
        model = model + effect
    first = fitted(replace(of_poses(found), model=model))
    problem = replace(of_poses(first), model=first.model, sigma=learned(first))
    told = common_of(first) if problem.common else None
    common, turning = (0.0, 1.0) if told is None else (told.size, told.turning)
    return fitted(replace(problem, common=common, turning=turning))


def _with_waves(found: Fit, catalogue: Catalogue) -> tuple[Fit, tuple[str, ...]]:
    """The fit with those waves of gears that show, each clear of zero beside the others."""
    shown = waves_that_show(found, catalogue)
    while shown:
        wider = extended(found, shown)
        gone = doubtful(wider, shown)
        if gone is None:
            return wider, tuple(effect.id for effect in shown)
        shown = tuple(effect for effect in shown if effect != gone)
    return found, ()


def _problem(
    model: Model,
    used: Measurements,
    sigma: dict[str, float],
    common: float = 0.0,
    turning: float = 1.0,
) -> PoseProblem:
    channels = None if used.absolute is None else used.absolute.channels
    stated = channels is not None and any(channels.stated(kind) for kind in channels.present)
    noise = NoiseModel(START["position"], zero="separate", freedom=np.inf if stated else 0)
    problem = PoseProblem(model, used, noise, sigma=sigma, common=common, turning=turning)
    own = problem.sigma_of_channels[problem.counted]  # rows may state their own
    return replace(problem, noise=replace(noise, sigma=rms(own)))


def rigid_columns(problem: PoseProblem, start: Model) -> Array:
    """(M, P_free) whitened derivative of the rigid arm as it was stated.

    Through sag and through second order nearly everything shows a little; nobody means that when
    he says that an error of geometry can be told.
    """
    stiff = [p.internal * (not isinstance(p.effect, Elastic)) for p in start.parameters]
    slope = problem.channel_gap(np.array(stiff), derivative=True)[1]
    return problem.of_channels.apply(slope[:, problem.free] * problem.scale)


def _refuse_too_few(problem: PoseProblem) -> None:
    placing = ("tracker_frame", "tool_offset", "target_rotation")
    frame = [k for k in problem.free if problem.model.parameters[k].effect.name in placing]
    if len(problem.rows) <= len(frame):
        raise InputError(
            f"{len(problem.rows)} numbers cannot tell the {len(frame)} of the tracker's frame and "
            "of how the marker sits",
            where=problem.measurements.place,
            remedy="Measure more poses.",
        )


def _refuse_no_rest(problem: PoseProblem) -> None:
    """As many values as numbers, and no noise stated: what is left says nothing of errors.

    Raises:
        InputError: Nothing is left over.
    """
    if problem.noise.stated:
        return
    slope = problem.channel_gap(problem.values(problem.start), derivative=True)[1][:, problem.free]
    told = int(np.linalg.matrix_rank(slope * problem.scale / problem.of_channels.sigma[:, None]))
    if told < len(problem.rows):
        return
    measured = problem.measurements
    raise InputError(
        f"{len(problem.rows)} numbers at {len(measured.poses)} poses, and as many values to "
        "estimate: nothing is left that could tell how sure they are",
        where=measured.place,
        remedy="Measure more poses, or state the noise: noise: {sigma: 30, unit: um}.",
    )


def with_values_of(model: Model, other: Model, names: Collection[str] | None = None) -> Model:
    """The model with the values that another one has for the same parameters, or for these."""
    known = {p.name: p.internal for p in other.parameters if names is None or p.name in names}
    return replace(
        model,
        parameters=tuple(
            replace(p, internal=known.get(p.name, p.internal)) for p in model.parameters
        ),
    )


def refined(
    base: Calibration,
    effects: Sequence[Effect],
    readings: Measurements,
    near: Model | None = None,
    catalogue: Catalogue = CATALOGUE,
) -> Calibration:
    """A calibration with further effects, fitted exactly; what cannot be told of them is frozen.

    Without any, and nothing that yields, what the readings of a pose have in common is not looked
    for: it is the errors of the arm that was registered alone. `near`: a model with much the same
    effects, from whose values to start.
    """
    model = base.model
    shared = bool(effects) or any(isinstance(effect, Elastic) for effect in model.effects)
    for effect in effects:
        model = model + effect
    found, frozen, wild = _fitted(model, readings, base.wild, shared=shared, near=near)
    return Calibration.of(
        doubted(found, catalogue), placed=base.placed, frozen=frozen, still=base.still, wild=wild,
        waves=base.waves, notes=base.notes,
    )  # fmt: skip


def with_model_form(found: Calibration) -> Calibration:
    """The calibration with the smooth error of the model, if any, in its standard errors."""
    form = model_form(found)
    return replace(widened(found, form), form=form)
