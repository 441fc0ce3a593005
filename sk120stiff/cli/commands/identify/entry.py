"""`sk120stiff identify DATA`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from sk120stiff.cli.commands.identify.calibration import calibration_answer
from sk120stiff.cli.frame import Answer
from sk120stiff.cli.identify_rows import Interval, parameter_rows
from sk120stiff.cli.opening import model_for, open_data, provenance, start_model
from sk120stiff.cli.options import DataArgument, ModelOption, OutOption
from sk120stiff.cli.tables import progress_bar, table
from sk120stiff.data_checks import (
    look,
    refuse_unbelievable,
    without_copies,
    without_stuck,
    without_wild,
)
from sk120stiff.effects import CATALOGUE
from sk120stiff.errors import InputError, short, two_digits, warn
from sk120stiff.files import will_write
from sk120stiff.identify import (
    Calibration,
    Compared,
    Fit,
    HeldOut,
    axes_of_joint_angles,
    compare,
    contradiction,
    fit,
    fit_report,
    gauges_as_displacements,
    held_out,
    known_model,
    lack_of_fit,
    profile_intervals,
    refitted,
    refuse_for_positions,
    weak_directions,
    yardstick,
)
from sk120stiff.identify.positions.solve.start import options_of
from sk120stiff.identify.report import noise_sentence, place_of
from sk120stiff.identify.uncertainty.compliant_parts import if_parts_yield
from sk120stiff.measurements import Measurements
from sk120stiff.model import Model, write_model


class Method(StrEnum):
    """The two least-squares algorithms."""

    trf = "trf"
    lm = "lm"


def command(
    data: DataArgument,
    model: ModelOption = None,
    method: Method = Method.trf,
    effects: Annotated[list[str] | None, typer.Option("--with")] = None,
    fix: list[str] | None = None,
    free: list[str] | None = None,
    robust: bool = False,
    profile: bool = False,
    leave_out: Annotated[bool, typer.Option("--held-out")] = False,
    others: Annotated[list[str] | None, typer.Option("--compare")] = None,
    waves: Annotated[bool, typer.Option("--waves/--no-waves")] = True,
    out: OutOption = None,
) -> Answer:
    """Spring values and their uncertainty from measured deflections.

    Says how well each value is known, what these readings cannot tell apart, and whether model and
    readings agree. Slips of the pen (signs, units, frames, rows) are looked for first; readings
    that no arm can have given are refused.

    Example: sk120stiff identify robots/motoman_sk120/data/table2_measured.csv --out model.yaml

    Args:
        method: Trust-region-reflective, or Levenberg-Marquardt.
        effects (EFFECT): Identify this too: 'name' or 'name:where'.
        fix (PARAM): Keep this parameter, 'effect:where.parameter'.
        free (PARAM): Estimate only the parameters named so.
        robust: Trust readings less that lie far from all others.
        profile: Profile-likelihood intervals: exact, and slower.
        leave_out: The error at poses left out of the fit.
        others (MODEL): Compare with this: a model file, or effects to add,
            'base_rocking+joint_tilt:..'
        waves: Of positions: let transmission errors in where they show. Without them the geometry
            fits best alone, as a calibrated URDF has it, and springs take the blame.
    """
    will_write(out)
    readings, robot = open_data(data)
    readings, stuck = without_stuck(readings)
    plain = start_model(robot, model)
    readings = gauges_as_displacements(plain, readings)
    readings, wild = without_wild(robot, readings)
    for told in (stuck, wild):
        if told:
            warn(told)
    start = plain
    for name in effects or ():
        start = with_effect(start, name, readings)
    if readings.absolute is not None:
        refuse_for_positions(readings, **{
            "--method": method is not Method.trf, "--free": free, "--robust": robust,
            "--profile": profile, "--held-out": leave_out, "--compare": others,
        })  # fmt: skip
    if readings.absolute is None or readings.absolute.channels.displacement is not None:
        doubts = look(plain, readings)
        refuse_unbelievable(doubts, plain, readings)
        for said in doubts.sentences:
            warn(said)
    if readings.absolute is None:
        start = with_freedom(start, fix or (), free)
    readings, told = without_copies(readings)
    if told:
        warn(told)
    with progress_bar("identify"):
        found = fit(start, readings, method=method.value, robust=robust, fix=fix or (), waves=waves)
    if isinstance(found, Calibration):
        return calibration_answer(found, readings, data, out)
    for doubt in (contradiction(found), axes_of_joint_angles(found)):
        if doubt is not None:
            warn(doubt)
    parts = if_parts_yield(found, start.catalogue)
    intervals: Sequence[Interval] | None = None
    if profile:
        with progress_bar("profile") as report:
            intervals = profile_intervals(found, progress=report)
    error: HeldOut | None = None
    if leave_out:
        with progress_bar("held out") as report:
            (error,) = held_out(
                readings, refitted(start, method=method.value, robust=robust), progress=report
            )
    lines: tuple[Compared, ...] = ()
    if others:
        models = {"model": start}
        models.update({name: _other(plain, name, readings) for name in others})
        with progress_bar("compare") as report:
            lines = compare(models, readings, progress=report)
    if out is not None:
        write_model(replace(known_model(found), provenance=provenance(data, readings)), out)
    noise = yardstick(found)
    document = {
        "robot": robot.name,
        "parameters": parameter_rows(found, intervals),
        "rms_um": found.rms * 1e6,
        "sigma_um": None if noise.sigma is None else noise.sigma * 1e6,
        "sigma_from": noise.source,
        "sigma_stated": noise.source == "stated",
        "noise_growth": found.problem.noise.growth,
        "noise_force": found.problem.noise.force,
        "noise_floor_um": None if noise.floor is None else noise.floor * 1e6,
        "chi_square": found.chi_square,
        "degrees_of_freedom": found.degrees_of_freedom,
        "lack_of_fit": lack_of_fit(found),
        "inflated": found.noise_factor if found.exceeds else None,
        "aic": found.aic,
        "bic": found.bic,
        "condition": found.condition,
        "correlation": found.correlation,
        "weak_directions": list(weak_directions(found)),
        "if_parts_yield": list(parts),
        "noise": noise_sentence(found),
        "noise_reasons": found.reasons,
        "down_weighted": _down_weighted(found),
        "held_out": None if error is None else _held_out(error),
        "comparison": [_compared(line) for line in lines],
        "iterations": found.iterations,
        "method": method.value,
        "model": out,
    }
    return Answer(document, _parts(found, intervals, error, lines, parts, out))


def with_effect(model: Model, text: str, readings: Measurements) -> Model:
    """The model with an effect more, given as ``name`` or ``name:where``.

    Raises:
        InputError: No such effect, it cannot act there, or the readings lack what its law needs.
    """
    from sk120stiff.effects import load_cases_of

    name, _, where = text.partition(":")
    found = CATALOGUE.effect(model.robot, name, where or None, options_of(readings))
    if not found.applies_to(load_cases_of(model.robot, readings)):
        raise InputError(
            f"these readings lack what the effect {found.id!r} needs",
            where=readings.place,
            remedy="See what its law takes: an order, branches, several readings of a pose, a "
            "weight.",
        )
    return model + found


def with_freedom(model: Model, fix: Sequence[str], free: Sequence[str] | None) -> Model:
    """The model with the named parameters fixed, or only the named ones free.

    Raises:
        InputError: The model has no such parameter.
    """
    for name in (*fix, *(free or ())):
        model.parameter(name)  # refuses unknown names
    return replace(
        model,
        parameters=tuple(
            replace(p, free=(p.free if free is None else p.name in free) and p.name not in fix)
            for p in model.parameters
        ),
    )


def _other(base: Model, text: str, readings: Measurements) -> Model:
    if Path(text).suffix in (".yaml", ".yml") or Path(text).is_file():
        return model_for(base.robot, text)
    for name in text.strip("+ ").split("+"):
        base = with_effect(base, name.strip(), readings)
    return base


def _down_weighted(found: Fit) -> list[dict[str, object]]:
    weights, measurements = found.problem.weights, found.problem.measurements
    if weights is None:
        return []
    return [
        {
            "reading": int(row),
            "pose": measurements.pose[row],
            "where": place_of(measurements, int(row)),
            "weight": float(weights[row]),
        }
        for row in sorted(found.down_weighted, key=lambda k: float(weights[k]))
    ]


def _held_out(error: HeldOut) -> dict[str, object]:
    return {"rms_um": error.rms * 1e6, "std_um": error.std * 1e6, "folds": error.folds}


def _compared(line: Compared) -> dict[str, object]:
    return {
        "name": line.name,
        "parameters": line.fit.estimated,
        "rms_um": line.fit.rms * 1e6,
        "held_out": None if line.held_out is None else _held_out(line.held_out),
        "loss_um": None if line.loss is None else line.loss * 1e6,
        "loss_std_um": None if line.loss_std is None else line.loss_std * 1e6,
        "aic": line.aic,
        "bic": line.bic,
        "note": line.note,
    }


def _parts(
    found: Fit,
    intervals: Sequence[Interval] | None,
    error: HeldOut | None,
    lines: Sequence[Compared],
    rigid: Sequence[str],
    out: Path | None,
) -> list[object]:
    parts: list[object] = [fit_report(found, profile=intervals)]
    if error is not None:
        parts.append(
            f"At poses left out of the fit: {short(error.rms * 1e6)} ± "
            f"{two_digits(error.std * 1e6)} µm rms per axis ({error.folds} parts)."
        )
    if lines:
        columns = ["model", "values", "fitted", "held out", "±", "loss", "±", "ΔAIC", "ΔBIC", ""]
        parts.append(table("Models [µm rms per axis]", columns, [_cells(x) for x in lines]))
    if found.exceeds or yardstick(found).sigma is None:  # its errors rest on the model
        parts.append("Whether something is missing is what 'sk120stiff explain' looks for.")
    parts += rigid
    if out is not None:
        parts.append(f"Written to {out}.")
    return parts


def _cells(line: Compared) -> tuple[object, ...]:
    error = line.held_out
    held: tuple[object, ...] = ("", "", "", "")
    if error is not None and line.loss is not None and line.loss_std is not None:
        held = tuple(1e6 * x for x in (error.rms, error.std, line.loss, line.loss_std))
    fitted = line.fit.rms * 1e6
    return (line.name, line.fit.estimated, fitted, *held, line.aic, line.bic, line.note)
