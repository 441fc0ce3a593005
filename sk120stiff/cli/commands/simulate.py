"""`sk120stiff simulate MODEL PLAN --out CSV`."""

from __future__ import annotations

from dataclasses import replace
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from sk120stiff.cli.frame import Answer
from sk120stiff.cli.opening import declare_readings, model_for, open_data
from sk120stiff.cli.options import ModelArgument, SeedOption
from sk120stiff.errors import InputError, short
from sk120stiff.measurements import Instrument, Measurements, NoiseModel, write_measurements
from sk120stiff.plan import Schedule, as_positions, simulate
from sk120stiff.units import parse_size


class Zero(StrEnum):
    """Who shares a zero reading."""

    shared = "shared"
    separate = "separate"


class Steps(StrEnum):
    """Load steps of each row of the plan."""

    as_given = "as-given"
    ascending = "ascending"
    up_down = "up-down"


def command(
    model: ModelArgument,
    plan: Path,
    out: Annotated[Path, typer.Option("--out")],
    noise: str | None = None,
    noise_rotation: str | None = None,
    zero: Zero = Zero.shared,
    growth: Annotated[float, typer.Option(min=0.0, max=0.5)] = 0.0,
    force_error: Annotated[float, typer.Option(min=0.0, max=0.5)] = 0.0,
    schedule: Steps = Steps.as_given,
    levels: Annotated[int, typer.Option(min=1)] = 5,
    repeats: Annotated[int, typer.Option(min=1)] = 1,
    outliers: Annotated[float, typer.Option(min=0.0, max=0.5)] = 0.0,
    positions: bool = False,
    seed: SeedOption = 0,
) -> Answer:
    """Synthetic measurements from a model: loads, noise, zeros.

    Example: sk120stiff simulate model.yaml plan.csv --noise '10 um' --out readings.csv

    Args:
        plan (PLAN): Poses and loads: measurements without displacements (others are not looked at).
            Of positions, single readings and turns each row is read as it stands there.
        out (CSV): Where to write them.
        noise (LENGTH): Standard uncertainty of one reading per axis, e.g. '10 um'; or 'stated':
            what the plan's YAML file says, an instrument's ray too. [default: none]
        noise_rotation (ANGLE): Standard uncertainty of one angle that is read, e.g. '20 urad'.
            [default: what the plan's YAML file says, else none]
        zero: One zero reading for all loads of a pose, or one for each.
        growth: Noise that grows with the displacement: its share.
        force_error: How far each component of a force is off the one written, as a share of the
            force: 0.02 with a gauge held by hand.
        schedule: Each load alone, in steps up to it, or up and down.
        levels: Steps up to the full load.
        repeats: How often each reading is taken.
        outliers: Share of readings off by 5 to 20 times the noise.
        positions: Write x, y, z with zero rows, no differences.
    """
    declare_readings(out)
    readings, robot = open_data(plan)
    if positions and readings.absolute is not None:
        raise InputError(
            "this plan says itself what is read", where="--positions", remedy="Leave it out."
        )
    believed = model_for(robot, model)
    made = simulate(
        believed,
        readings,
        noise=_noise(noise, growth, force_error, zero, readings),
        schedule=Schedule(schedule.value, levels, repeats, zero.value),
        rotation_noise=None
        if noise_rotation is None
        else parse_size(noise_rotation, "angle", where="--noise-rotation", like="20 urad"),
        outliers=outliers,
        seed=seed,
    )
    named = f"{Path(model).name} and {plan.name}"
    source = f"simulated by 'sk120stiff simulate' from {named}, seed {seed}"
    made = replace(made, measurements=replace(made.measurements, source=source))
    if positions:
        written = as_positions(believed, made)
        write_measurements(written, out, as_positions=True)
    else:
        written = made.measurements
        write_measurements(written, out)
    loaded = made.measurements
    largest = float(np.linalg.norm(made.exact, axis=1).max())
    document = {
        "rows": written.n_readings,
        "seed": seed,
        "readings": loaded.n_readings,
        "poses": len(loaded.poses),
        "zero_rows": written.n_readings - loaded.n_readings,
        "outliers": [int(k) for k in np.flatnonzero(made.outliers)],
        "largest_um": largest * 1e6,
        "out": out,
    }
    said = (
        f"{loaded.n_readings} rows at {len(loaded.poses)} poses, read as the plan has them, seed "
        f"{seed}."
        if loaded.absolute is not None
        else f"{loaded.n_readings} readings at {len(loaded.poses)} poses, displacements up to "
        f"{short(largest * 1e6, 4)} µm, seed {seed}."
    )
    return Answer(
        document, [said, *loaded.notes, f"Written to {out} and {out.with_suffix('.yaml')}."]
    )


def _noise(
    text: str | None, growth: float, force: float, zero: Zero, plan: Measurements
) -> NoiseModel | Instrument | None:
    if text is None:
        if growth or force:
            raise InputError(
                "noise that goes with the load needs its size at rest",
                where="--growth" if growth else "--force-error",
                remedy="Give --noise too, e.g. --noise '10 um'.",
            )
        return None
    if text != "stated":
        sigma = parse_size(text, "length", where="--noise", like="10 um")
        return NoiseModel(sigma, growth, zero.value, force=force)
    said = plan.noise
    for name, given in (("--growth", growth), ("--force-error", force)):
        if given:
            raise InputError(
                "what is stated goes with the load as stated",
                where=name,
                remedy=f"Leave out {name}.",
            )
    if said.instrument is not None:
        if said.growth or said.force:
            raise InputError(
                "an instrument's ray and noise that goes with the load are drawn one at a time",
                where="--noise stated",
                remedy="Write noise.sigma in the place of noise.instrument, or leave out "
                "noise.growth and noise.force.",
            )
        return said.instrument
    if plan.sigma is not None:  # rows are drawn with their own
        usual = said.sigma or float(np.nanmedian(plan.sigma))
        return NoiseModel(usual, said.growth or 0.0, zero.value, force=said.force or 0.0)
    if said.sigma is None:
        raise InputError(
            "the plan states no noise",
            where="--noise stated",
            remedy="Write noise.sigma or noise.instrument into the YAML file beside the plan, or "
            "give a length, e.g. --noise '10 um'.",
        )
    return NoiseModel(said.sigma, said.growth or 0.0, zero.value, force=said.force or 0.0)
