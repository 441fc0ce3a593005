"""`sk120stiff plan --model M --count N`."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from sk120stiff.arrays import Array
from sk120stiff.cli.cell import CellOption, as_measured, opened_cell
from sk120stiff.cli.frame import Answer
from sk120stiff.cli.opening import declare_readings, model_for, open_data, open_model
from sk120stiff.cli.options import SeedOption
from sk120stiff.cli.plan_check import checked
from sk120stiff.cli.plan_effects import named_parameters, two_effects
from sk120stiff.cli.plan_program import in_order, language_for, write_route
from sk120stiff.cli.plan_shown import as_keys, height_words, plan_table
from sk120stiff.cli.tables import progress_bar, table
from sk120stiff.effects import load_cases_of
from sk120stiff.errors import InputError
from sk120stiff.files import will_write
from sk120stiff.identify import why_unseen
from sk120stiff.measurements import Measurements, write_measurements
from sk120stiff.model import Model
from sk120stiff.plan import (
    Cell,
    Pool,
    d_optimal,
    feasible_pool,
    lowest_points,
    promised,
    random_choice,
    rivalry,
    to_be_taken,
    well_spread,
)
from sk120stiff.plan.design import refuse_count
from sk120stiff.units import parse_size, parse_values

DRAWS = 50  # random and well-spread choices that a plan is held against
MOST_CANDIDATES = 1_000_000


def command(
    model: Annotated[
        Path | None, typer.Option("--model", metavar="MODEL", help="Model file (YAML).")
    ] = None,
    count: Annotated[int | None, typer.Option(min=1, help="Number of poses.")] = None,
    loads: Annotated[int, typer.Option(min=1, help="Number of loads at each pose.")] = 1,
    check: Annotated[
        Path | None,
        typer.Option(
            metavar="CSV",
            help="Plan nothing: say row by row what is wrong with this plan, or these readings.",
        ),
    ] = None,
    between: Annotated[
        str | None,
        typer.Option(
            metavar="EFFECT,EFFECT",
            help="Tell these two apart: 'name' or 'name:where' each.",
            show_default="make the parameters well known",
        ),
    ] = None,
    wanted: Annotated[
        list[str] | None,
        typer.Option(
            "--for",
            metavar="PARAM",
            help="Make this well known: a parameter, or an effect with all it has.",
            show_default="all free ones",
        ),
    ] = None,
    data: Annotated[
        Path | None,
        typer.Option(
            metavar="CSV", help="Readings there are already; points and noise are theirs."
        ),
    ] = None,
    force: Annotated[
        str,
        typer.Option(
            metavar="FORCE", help="Size of the loads, less where the motors cannot hold it."
        ),
    ] = "400 N",
    noise: Annotated[
        str | None,
        typer.Option(
            metavar="LENGTH",
            help="Standard uncertainty of one reading.",
            show_default="the data's, else 10 um",
        ),
    ] = None,
    point: Annotated[
        str | None,
        typer.Option(
            metavar="XYZ",
            help="Measured and loaded point in the tool frame, e.g. '0,50,120 mm'.",
            show_default="the data's, else the tool frame's origin",
        ),
    ] = None,
    lowest: Annotated[
        str | None,
        typer.Option(
            "--floor",
            "--lowest",
            metavar="LENGTH",
            help="Height in the base frame below which nothing may go: '-0.3 m'.",
            show_default="as low as --data went, else none",
        ),
    ] = None,
    box: Annotated[
        str | None,
        typer.Option(
            metavar="XYZXYZ",
            help="Box in the base frame for the measured point: '0.8,-1,0, 2.2,1,1.5 m'.",
        ),
    ] = None,
    cell: CellOption = None,
    candidates: Annotated[
        int, typer.Option(min=10, max=MOST_CANDIDATES, help="Poses to choose from.")
    ] = 400,
    directions: Annotated[
        int, typer.Option(min=1, max=10_000, help="Load directions at each pose.")
    ] = 12,
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="CSV", help="Where to write them, for the measurement."),
    ] = None,
    program: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Order the poses for least driving and write the way through them, free of "
            "collisions: .src (KUKA), .mod (ABB), .ls (FANUC), .jbi (Motoman), .script (UR).",
        ),
    ] = None,
    seed: SeedOption = 0,
) -> Answer:
    """The poses and loads to measure next.

    D-optimal for the parameters that count, or T-optimal between two effects; feasible as far as
    the URDF and cell.yaml tell: limits, efforts, collisions, floor, rig, tracker. `gain` is the
    precision (or evidence) over that of random poses.

    Example: sk120stiff plan --model model.yaml --count 15 --floor '-0.8 m' --out plan.csv
    Example: sk120stiff plan --check plan.csv --cell cell.yaml
    """
    if check is not None:
        return checked(check, cell, lambda found: _stated(found, lowest, box))
    if model is None or count is None:
        raise InputError(
            "a plan needs --model and --count",
            remedy="Write --model model.yaml --count 12; --check plan.csv checks one there is.",
        )
    declare_readings(out)
    will_write(program, "--program")
    language = None if program is None else language_for(program)
    known, start = _opened(model, data)
    at, force_at = _points(known, point)
    within = _stated(opened_cell(start.robot, cell, data, model), lowest, box)
    within = as_measured(start.robot, within, known)
    pool = feasible_pool(
        start.robot,
        poses=candidates,
        directions=directions,
        force=parse_size(force, "force", where="--force", like="400 N"),
        point=at,
        force_point=force_at,
        seed=seed,
        cell=within,
    )
    sigma = _sigma(known, noise)
    before = None if known is None else Pool(load_cases_of(start.robot, known.masked()))
    with progress_bar("plan"):
        if between is None:
            chosen = _precise(start, pool, known, wanted, (count, loads), sigma, seed)
        else:
            chosen = _telling(start, pool, before, between, (count, loads), sigma, seed)
    rows, document, said = chosen
    zero = "unknown" if known is None else known.zero
    plan = to_be_taken(start.robot, pool, rows, zero=zero)
    way: dict[str, object] | None = None
    if language is not None and program is not None:
        labels = plan.poses
        with progress_bar("the way between the poses"):
            plan, route = in_order(plan, start.robot, within, seed)
        write_route(language, program, start.robot, route, labels)
        way = {
            "order": [labels[k] for k in route.order],
            "via_points": int((route.pose < 0).sum()),
            "driving_s": route.seconds,
            "minutes": route.minutes(plan.n_readings),
        }
        said.append(
            f"Driven in this order: {route.seconds:.0f} s of way with {way['via_points']} via "
            f"points; about {route.minutes(plan.n_readings):.0f} min with the readings. Written "
            f"to {program}."
        )
    heights = lowest_points(start.robot, plan.joints, at, within)
    document = {
        "poses": as_keys(plan),
        **document,
        "sigma_um": sigma * 1e6,
        "seed": seed,
        "cell": within.source or None,
        "floor_m": within.floor if np.isfinite(within.floor) else None,
        "lowest_m": float(heights.min()),
        "remarks": pool.remarks,
        "route": way,
        "program": program,
        "out": out,
    }
    said += [*pool.remarks, height_words(plan, heights, within.floor)]
    if out is not None:
        write_measurements(plan, out)
        said.append(f"Written to {out} and {out.with_suffix('.yaml')}.")
    return Answer(document, [plan_table(plan), *said])


Chosen = tuple[Sequence[int], dict[str, object], list[object]]


def _precise(
    model: Model,
    pool: Pool,
    known: Measurements | None,
    wanted: Sequence[str] | None,
    count: tuple[int, int],
    sigma: float,
    seed: int,
) -> Chosen:
    names: list[str] = []
    for text in wanted or ():
        model, found = named_parameters(model, text)
        names += found
    before = None if known is None else Pool(load_cases_of(model.robot, known.masked()))
    design = d_optimal(
        model, pool, count=count[0], loads=count[1], sigma=sigma, parameters=names or None,
        known=before,
    )  # fmt: skip
    random, spread = _held_against(design.gain_over, pool, len(design.rows), seed)
    zero = "unknown" if known is None else known.zero
    plan = to_be_taken(model.robot, pool, design.rows, zero=zero)
    every = dict(
        zip((model.names[k] for k in model.free), promised(model, plan, sigma, known), strict=True)
    )
    expected: list[dict[str, object]] = []
    rows: list[tuple[object, ...]] = []
    chosen = pool.load_cases.rows(np.array(design.rows, dtype=np.intp))
    blind: list[object] = []
    for name in design.parameters:
        std = every[name]
        p = model.parameter(name)
        public, unit = p.spec.public_std(p.internal, float(std)), p.spec.unit
        why = why_unseen(chosen, p)
        expected.append(
            {
                "name": name,
                "value": p.value,
                "std": None if why else public,
                "unit": unit,
                "internal_std": None if why else float(std),
                "internal_unit": p.spec.internal_unit,
                "reason": why,
            }
        )
        if why:
            blind.append(f"{name} cannot be seen: {why}.")
            rows.append((name, p.value, "cannot be seen", unit))
            continue
        shown = (public, unit) if np.isfinite(public) else (float(std), p.spec.internal_unit)
        rows.append((name, p.value, *shown))
    document: dict[str, object] = {
        "criterion": "D-optimal",
        "for": design.parameters,
        "gain": random,
        "gain_over_spread": spread,
        "expected": expected,
    }
    said: list[object] = [
        table("To expect", ["parameter", "value", "std. error", "unit"], rows),
        f"Standard errors {random:.2f} times smaller than with random poses, {spread:.2f} times "
        "smaller than with well-spread ones.",
        *blind,
    ]
    return design.rows, document, said


def _telling(
    model: Model,
    pool: Pool,
    before: Pool | None,
    between: str,
    count: tuple[int, int],
    sigma: float,
    seed: int,
) -> Chosen:
    first, second = two_effects(model, between)
    rivals = rivalry(model, first, second, pool, sigma=sigma, known=before)
    refuse_count(pool, *count)
    choice = rivals.best(count[0], pool.pose, count[1])

    def gain_over(rows: Sequence[int]) -> float:
        return choice.after / max(rivals.evidence_of(rows), 1e-12)

    random, spread = _held_against(gain_over, pool, len(choice.rows), seed)
    document: dict[str, object] = {
        "criterion": "T-optimal",
        "between": [first.id, second.id],
        "gain": random,
        "gain_over_spread": spread,
        "evidence": choice.after,
        "evidence_before": choice.before,
    }
    verdict = (
        "enough to tell them apart" if choice.after > 3.3 else "not enough: plan more readings"
    )
    said: list[object] = [
        f"Evidence between {first.id} and {second.id}: {choice.after:.2f} standard errors "
        f"({verdict}), {choice.before:.2f} before.",
        f"{random:.2f} times that of random poses, {spread:.2f} times that of well-spread ones.",
    ]
    return choice.rows, document, said


def _held_against(
    gain_over: Callable[[Sequence[int]], float], pool: Pool, count: int, seed: int
) -> tuple[float, float]:
    """Median gain over random and over well-spread choices."""
    rng = np.random.default_rng(seed + 1)
    random = [gain_over(random_choice(pool, count, rng)) for _ in range(DRAWS)]
    spread = [gain_over(well_spread(pool, count, rng)) for _ in range(DRAWS)]
    return float(np.median(random)), float(np.median(spread))


def _opened(model: Path, data: Path | None) -> tuple[Measurements | None, Model]:
    if data is None:
        return None, open_model(str(model))
    known, robot = open_data(data)
    return known, model_for(robot, model)


def _points(known: Measurements | None, text: str | None) -> tuple[Array, Array]:
    if text is not None:
        values = parse_values(text, "length", where="--point", like="0,50,120 mm")
        return values, values
    if known is not None:
        return known.point, known.force_point
    return np.zeros(3), np.zeros(3)


def _sigma(known: Measurements | None, text: str | None) -> float:
    if text is not None:
        return parse_size(text, "length", where="--noise", like="10 um")
    if known is not None and known.noise.sigma is not None:
        return known.noise.sigma
    return 1e-5


def _stated(cell: Cell, lowest: str | None, box: str | None) -> Cell:
    """The cell with what the command line says of floor and box."""
    if lowest is not None:
        cell = replace(
            cell, floor=float(parse_values(lowest, "length", where="--floor", like="-0.3 m")[0])
        )
    if box is not None:
        corners = parse_values(box, "length", where="--box", like="0.8,-1,0, 2.2,1,1.5 m")
        cell = replace(cell, low=corners[:3], high=corners[3:])
    return cell
