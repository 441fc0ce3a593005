"""The verb `fit`: displacements or positions become a `Fit`, and that a model to be kept."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from sk120stiff.arrays import on_one_thread
from sk120stiff.effects import Elastic
from sk120stiff.errors import InputError, listed
from sk120stiff.identify.estimate import fit_displacements
from sk120stiff.identify.fit import Fit
from sk120stiff.identify.noise.growing import growing
from sk120stiff.identify.positions.calibrate import Calibration, calibrate, with_model_form
from sk120stiff.identify.positions.checks.beside_frames import without_springs
from sk120stiff.identify.positions.checks.computed import computed
from sk120stiff.identify.positions.checks.drift import creeping
from sk120stiff.identify.positions.checks.force_axes import refuse_other_forces
from sk120stiff.identify.positions.checks.gravity_direction import refuse_another_gravity
from sk120stiff.identify.positions.checks.payload_unit import pounds
from sk120stiff.identify.positions.checks.remounted import refuse_remounted
from sk120stiff.identify.positions.checks.slips import refuse_pushed
from sk120stiff.identify.positions.omitted.selection import Blocks
from sk120stiff.identify.positions.uncertainty.compliant_parts import beside_parts
from sk120stiff.identify.positions.uncertainty.omitted_bias import beside_lacking
from sk120stiff.identify.positions.words import known_calibration
from sk120stiff.identify.solve.solvers import Method
from sk120stiff.identify.uncertainty.errors_of_poses import beside_errors_of_poses
from sk120stiff.identify.uncertainty.known_model import known_of_displacements
from sk120stiff.identify.uncertainty.left_over import LeftOver
from sk120stiff.measurements import Measurements, NoiseModel, as_displacements, taken_as_moved
from sk120stiff.model import Model


@on_one_thread
def fit(
    model: Model,
    measurements: Measurements,
    *,
    noise: NoiseModel | None = None,
    method: Method = "trf",
    robust: bool = False,
    fix: Sequence[str] = (),
    waves: bool = True,
) -> Fit:
    """Estimate a model's free parameters from readings, at exact equilibrium.

    Of absolute readings the instrument's frame, the marker's place and errors of geometry are
    estimated too, as far as they can be told; the result is a `Calibration`, which is a `Fit`.

    Args:
        model: Starting values, and which parameters are free (`Parameter.free`).
        measurements: Readings; masked rows are left out.
        noise: Covariance of displacements. Default: what the data say of themselves (`candidates`).
            A zero that nobody described is decided by the likelihood of the fits, and in doubt
            shared; a σ that neither the data nor repeats tell is estimated with the fit.
        method: ``"trf"`` (trust region, bounds) or ``"lm"`` (Levenberg–Marquardt); both reach the
            same. Of displacements.
        robust: Trust displacements less that lie far from all others (Huber's loss on whole
            readings).
        fix: Full names of parameters to keep at their values.
        waves: Of positions: let transmission errors in where they show. Without them the geometry
            fits best alone, and springs take the blame.

    Raises:
        InputError: No readings, no loads, nothing free, too few readings for the parameters, or a
            choice that does nothing for such readings.
        Refusal: The fit did not converge, no equilibrium exists, or the readings show none of the
            parameters.

    Examples:
        >>> import sk120stiff as sk
        >>> folder = sk.bundled_robots()["motoman_sk120"] / "data"
        >>> readings = sk.read(folder / "table2_measured.csv")
        >>> found = sk.fit(sk.base_model(sk.load_robot("motoman_sk120")), readings)
        >>> print(f"{1e6 * found.rms:.1f} µm rms")
        17.2 µm rms
    """
    measurements = gauges_as_displacements(model, measurements)
    if measurements.absolute is not None:
        refuse_plan(measurements)
        refuse_for_positions(
            measurements, noise=noise is not None, method=method != "trf", robust=robust
        )
        readings = measurements.with_joints(model.robot.actuated, model.robot.kinds)
        found, moved = taken_as_moved(
            readings, lambda taken: _fit_positions(model, taken, fix, waves=waves)
        )
        return replace(found, notes=(*moved, *found.notes))
    if not waves:
        raise InputError(
            "only positions show waves of a gear, and these readings are displacements",
            where=measurements.place,
            remedy="Leave the choice of waves out.",
        )
    kept = {model.parameter(name).name for name in fix}
    parameters = (replace(p, free=p.free and p.name not in kept) for p in model.parameters)
    start = replace(model, parameters=tuple(parameters)) if kept else model
    alone = fit_displacements(start, measurements, noise=noise, method=method, robust=robust)
    if robust or noise is not None:
        return alone
    beside = beside_errors_of_poses(alone)
    told = beside is not alone and growing(alone) is not None  # that is of single readings
    return alone if told else beside


def _fit_positions(
    model: Model, readings: Measurements, fix: Sequence[str], *, waves: bool
) -> Calibration:
    """Positions, or what loads move of several points.

    Raises:
        MovedBetween: Something moved among them.
    """
    placed = _rigid(model, readings)
    refuse_other_forces(placed, readings)
    told = refuse_another_gravity(placed, readings)
    calibrated = calibrate(model, readings, freedom=fix, waves=waves)
    blocks = Blocks.of(calibrated, model.catalogue)
    every = blocks.beside_all(calibrated.unit)  # as `explain` does
    pushed = refuse_pushed(calibrated, readings, *every)
    loads = blocks.beside_loads(calibrated.unit)
    pushed = pushed or refuse_pushed(calibrated, readings, *loads)
    pushed = pushed or refuse_remounted(calibrated, readings, *loads)
    lacking = beside_lacking(with_model_form(calibrated), model.catalogue)
    found = beside_parts(lacking, model.catalogue)
    by_row = pushed or creeping(found, readings)
    return replace(found, notes=(*told, *found.notes, *pounds(found), *computed(found), *by_row))


def gauges_as_displacements(model: Model, measurements: Measurements) -> Measurements:
    """What gauges alone read of one point, as the displacements that a model with springs is of.

    Of a model in which nothing yields, and other readings, they come back as they are.

    Raises:
        InputError: The forces seem meant in another way than stated.
    """
    moved = as_moved(model, measurements)
    if moved is measurements:
        return measurements
    readings = measurements.with_joints(model.robot.actuated, model.robot.kinds)
    refuse_other_forces(_rigid(model, readings), readings)
    return moved


def as_moved(model: Model, measurements: Measurements) -> Measurements:
    """The same, whatever the forces may be meant as."""
    yields = any(isinstance(effect, Elastic) for effect in model.effects)
    return as_displacements(measurements) if yields else measurements


def _rigid(model: Model, readings: Measurements) -> Calibration:
    """Positions of the arm without springs, its instrument placed."""
    rigid = without_springs(model)
    return calibrate(rigid, readings, geometry=False, waves=False, shared=False)


def known_model(fit: Fit, left: LeftOver | None = None) -> Model:
    """The fitted model with its uncertainty, as it is written to a file.

    Args:
        fit: The fitted model.
        left: The remainder of displacements, where that is known already.
    """
    if isinstance(fit, Calibration):
        return known_calibration(fit)
    return known_of_displacements(fit, left)


def refuse_plan(measurements: Measurements) -> None:
    """Refuse rows of where a marker is to be read.

    Raises:
        InputError: No row holds a reading.
    """
    if measurements.is_plan:
        raise InputError(
            "no row holds a reading: these are poses to go to",
            where=measurements.place,
            remedy="Measure there, and fill the blank cells in.",
        )


def refuse_for_positions(measurements: Measurements, **given: object) -> None:
    """Refuse what does nothing for positions, rather than pass it over.

    Raises:
        InputError: One of them was given.
    """
    unused = [name for name, value in given.items() if value]
    if unused:
        said = measurements.absolute
        moved = said is not None and said.channels.displacement is not None
        what = "of several, or have turns" if moved else "positions"
        raise InputError(
            f"{listed(unused)} {'is' if len(unused) == 1 else 'are'} for displacements of one "
            f"point, and these readings are {what}",
            where=measurements.place,
            remedy="Leave it out." if len(unused) == 1 else "Leave them out.",
        )
