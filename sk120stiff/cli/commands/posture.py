"""`sk120stiff posture MODEL PATH --out CSV`."""

from __future__ import annotations

from dataclasses import replace
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from sk120stiff.arrays import Array
from sk120stiff.cli.cell import CellOption, assumed_at_work, at_work, height_words, opened_cell
from sk120stiff.cli.frame import Answer
from sk120stiff.cli.opening import direction_of, frame_at, open_model
from sk120stiff.cli.options import AtOption, ModelArgument, SeedOption
from sk120stiff.cli.outputs import will_draw, will_show
from sk120stiff.cli.tables import progress_bar, table
from sk120stiff.errors import InputError
from sk120stiff.files import will_write
from sk120stiff.measurements.table.columns import FORCES, MOMENTS
from sk120stiff.model import Model, seen_from
from sk120stiff.plan import Verdict, feasible, lowest_points
from sk120stiff.programs.orientation import fixed_xyz
from sk120stiff.programs.placing import ANYWHERE, PLACES
from sk120stiff.robot import Robot
from sk120stiff.units import from_si, parse_values
from sk120stiff.workspace import (
    BestPosture,
    Landscape,
    PathTask,
    Placement,
    best_posture,
    elastic_arm,
    parse_axes,
    posture_landscape,
    read_path,
    write_joints,
)


class Minimise(StrEnum):
    """What is to be small."""

    compliance = "compliance"
    deflection = "deflection"


def command(
    model: ModelArgument,
    path: Path,
    out: Annotated[Path, typer.Option("--out")],
    minimise: Minimise = Minimise.compliance,
    direction: str | None = None,
    axis: Annotated[str | None, typer.Option("--tool-axis")] = None,
    place: str | None = None,
    limit_margin: str | None = None,
    singularity_margin: Annotated[float, typer.Option(min=0.0, max=1.0)] = 0.02,
    picture: Path | None = None,
    page: Path | None = None,
    cell: CellOption = None,
    at: AtOption = None,
    seed: SeedOption = 0,
) -> Answer:
    """The stiffest or least deflected posture for a tool path.

    Searches through what the task leaves free: other branches of the arm, rotation about the tool's
    axis, the place of the part. The worst point of the path counts. The arm does not run into
    itself or what --cell says stands around it, and its motors hold the load.

    Example: sk120stiff posture model.yaml path.csv --tool-axis 0,0,-1 --minimise deflection
    --out best.csv --picture best.svg

    Args:
        path (PATH): A CSV file of tool placements and wrenches as for 'compensate': x[mm], y, z,
            orientation or none, fx[N], fy, fz.
        out (CSV): Where to write the path by joints.
        minimise: Compliance (so the stiffness is largest), or deflection by the wrench.
        direction (X,Y,Z): Direction that matters, base axes. [default: all]
        axis (X,Y,Z): Direction of the tool's z axis, rotation about it free; instead of an
            orientation in the file.
        place (RANGES): How the part, and the path with it, may be moved about its middle:
            'x=-300:300 mm; yaw=-30:30 deg'. [default: not at all]
        limit_margin (ANGLE): Distance from joint limits: '5 deg'. [default: none]
        singularity_margin: Smallest allowed ratio of the position Jacobian's singular values.
        picture (FILE): Draw the choice (.svg, .png or .pdf): the worst point over the tool's
            orientation with the posture that was chosen, and the values along the path. [default:
            none]
        page (HTML): Write a page too: the arm in 3-D at every point of the path. [default: none]
    """
    if picture is not None and picture.suffix.lower() not in (".svg", ".png", ".pdf"):
        raise InputError(
            f"a picture cannot be written as {picture.suffix or 'a name without an ending'}",
            where="--picture",
            remedy="Choose a name that ends in .svg, .png or .pdf.",
        )
    will_write(out)
    will_write(picture, "--picture")
    will_show(page)
    will_draw(picture, page)
    believed = open_model(model)
    robot = believed.robot
    given = read_path(path, robot)
    if given.position is None:
        raise InputError(
            "the path is given by joints, which leaves nothing to choose",
            where=str(path),
            remedy="Give x[mm], y[mm], z[mm].",
        )
    task = PathTask(
        given.position,
        axis=None if axis is None else direction_of(axis, "--tool-axis"),
        rotation=given.rotation if axis is None else None,
        wrench=given.wrench,
        direction=None if direction is None else direction_of(direction, "--direction"),
    )
    margin = 0.0
    if limit_margin is not None:
        (margin,) = parse_values(limit_margin, "angle", where="--limit-margin", like="5 deg")
        _refuse_margin(robot, float(margin))
    at = frame_at(robot, at)
    arm = elastic_arm(believed, frame=at)
    freedom = None if place is None else _placement(place, given.position)
    around = at_work(opened_cell(robot, cell, path))

    seen = seen_from(believed, at)
    at_tool = seen[0].robot.tool_frame == robot.tool_frame

    def admits(a: Array, load: Array) -> Verdict:
        return feasible(robot, around, a, load if at_tool else None, force_point=seen[1])

    with progress_bar("Searching") as report:
        found = best_posture(
            arm,
            task,
            minimise=minimise.value,
            placement=freedom,
            limit_margin=float(margin),
            singularity_margin=singularity_margin,
            seed=seed,
            admits=admits,
            progress=report,
        )
    notes = {
        f"{minimise.value}[{'um/N' if minimise == Minimise.compliance else 'um'}]": [
            f"{value * 1e6:.6g}" for value in found.per_point
        ]
    }
    # The path as it was placed and turned, not as it came.
    stands = robot.placement(found.a, at)
    loads = found.judge.loads(found.placement)
    columns: list[tuple[str, str, Array]] = []
    if found.placement[3:].any():
        kinds = {**dict.fromkeys(FORCES, "force"), **dict.fromkeys(MOMENTS, "moment")}
        has = [(name, kind, loads[:, k]) for k, (name, kind) in enumerate(kinds.items())]
        columns = [column for column in has if column[0] in given.table.headers]
    if found.placement.any():
        columns += [(name, "length", stands[:, k, 3]) for k, name in enumerate("xyz")]
    if given.rotation is not None:
        angles = np.deg2rad(fixed_xyz(stands[:, :3, :3]))
        columns += [(name, "angle", angles[:, k]) for k, name in enumerate(PLACES[3:])]
    for name, kind, si in columns:
        values = np.asarray(from_si(si, given.table.column_units[name], kind))
        notes[given.table.headers[name]] = [f"{value:.10g}" for value in values]
    write_joints(out, given, robot, found.a, notes)
    if picture is not None:
        turned = posture_landscape(found) if task.rotation is None else None
        _draw(picture, found, turned, minimise)
    if page is not None:
        _write_page(
            page, *seen, found, task, freedom, loads,
            compliance=minimise == Minimise.compliance,
        )  # fmt: skip
    kept = replace(around, angle_margin=max(around.angle_margin, float(margin)))
    heights = lowest_points(robot, found.a, np.zeros(3), around)
    lines = [f"line {line}" for line in given.table.lines]
    low = height_words(heights, lines, around.floor, give="floor: in cell.yaml")
    assumed = (low, *assumed_at_work(robot, kept))
    if not at_tool:
        assumed += (f"The load acts at {at}: that the motors hold it was not asked.",)
    document = {
        "robot": robot.name,
        "rows": given.count,
        "minimised": minimise.value,
        "unit": "m/N" if minimise == Minimise.compliance else "m",
        "worst": found.objective,
        "per_point": found.per_point,
        "joints": robot.actuated,
        "a": found.a,
        "placement": dict(zip(PLACES, found.placement.tolist(), strict=True)),
        "condition": float(found.condition.min()),
        "limit_margin": found.limit_margin,
        "blind_choice": {
            "postures": len(found.admissible),
            "best": float(found.admissible[0]),
            "median": float(np.median(found.admissible)),
            "worst": float(found.admissible[-1]),
        },
        "out": str(out),
        "cell": around.source or None,
        "lowest_m": float(heights.min()),
        "assumed": assumed,
        "picture": picture,
        "page": page,
    }
    files = [str(file) for file in (out, picture, page) if file is not None]
    said = _parts(found, minimise, files, any(robot.prismatic))
    return Answer(document, [*said, *assumed])


def _refuse_margin(robot: Robot, margin: float) -> None:
    """Raise an `InputError` where a margin from the limits is negative or leaves nothing."""
    room = 0.5 * float(np.min(robot.upper - robot.lower))
    if 0.0 <= margin < room:
        return
    raise InputError(
        f"{np.degrees(margin):g} deg is no distance from the joint limits",
        where="--limit-margin",
        remedy=f"Give zero or more, below {np.degrees(room):.4g} deg: then the narrowest range has "
        "nothing left.",
    )


def _draw(file: Path, found: BestPosture, turned: Landscape | None, minimise: Minimise) -> None:
    from sk120stiff.show import save_figure
    from sk120stiff.show.figures import posture_choice

    figure = posture_choice(
        found.per_point,
        compliance=minimise == Minimise.compliance,
        landscape=None if turned is None else (turned.angle, turned.objective),
        chosen=None if turned is None else turned.chosen,
        tilt=turned is not None and turned.tilt,
        blind=found.admissible,
    )
    save_figure(figure, file)


def _write_page(
    file: Path,
    model: Model,
    point: Array,
    found: BestPosture,
    task: PathTask,
    place: Placement | None,
    loads: Array,
    *,
    compliance: bool,
) -> None:
    """The arm at every point, in the posture that was found and in one chosen blindly."""
    from sk120stiff.show import ScenePose, scene_of_model, static_scene
    from sk120stiff.show.scene.scene import ScenePath
    from sk120stiff.show.wording import um

    worst = int(np.argmax(found.per_point))
    best, blind = (
        f"{1e-6 / value:#.3g} N/µm" if compliance else f"{um(value)} µm"
        for value in (found.objective, float(np.median(found.admissible)))
    )
    what = "Stiffness" if compliance else "Deflection"
    scene = scene_of_model(
        model,
        title=f"{model.robot.name}: best posture",
        subtitle=f"{what} at the weakest point: {best}; with a posture chosen blindly {blind} "
        f"(median of {len(found.admissible)})",
        a=found.a[worst],
        wrench=loads[worst],
    )
    poses = [ScenePose(f"point {k + 1}", a) for k, a in enumerate(found.a)]
    poses += [ScenePose(f"chosen blindly, point {k + 1}", a) for k, a in enumerate(found.usual)]
    path = ScenePath(
        before=np.asarray(task.position, dtype=float),
        after=model.robot.screws(found.a, point=point).position,
        worst=worst,
        said=f"weakest: {best}",
        freedom=_freedom(task, place),
        middle=None if place is None else place.origin + 0.5 * (place.lower + place.upper)[:3],
        reach=None if place is None else 0.5 * (place.upper - place.lower)[:3],
        turns=task.axis is not None,
    )
    static_scene(file, replace(scene, poses=tuple(poses), point=point, path=path))


def _freedom(task: PathTask, place: Placement | None) -> str:
    """What was free to be chosen, in words."""
    free = ["free: branch of the arm"]
    if task.rotation is None:
        free.append("orientation" if task.axis is None else "turn about the tool's axis")
    if place is not None:
        span = place.upper - place.lower
        free += [
            f"{name} of the part over {1e3 * width:.0f} mm"
            if name in "xyz"
            else f"{name} of the part over {np.degrees(width):.0f}°"
            for name, width in zip(PLACES, span, strict=True)
            if width
        ]
    return ", ".join(free)


def _placement(text: str, position: Array) -> Placement:
    """Ranges like ``x=-300:300 mm`` about the middle of the path."""
    lower, upper = np.zeros(6), np.zeros(6)
    for axis in parse_axes([text], ANYWHERE, where="--place", ranges=True):
        k = PLACES.index(axis.name)
        lower[k], upper[k] = axis.values[0], axis.values[-1]
    return Placement(position.mean(axis=0), lower, upper)


def _parts(found: BestPosture, minimise: Minimise, files: list[str], slides: bool) -> list[object]:
    compliance = minimise == Minimise.compliance
    scale, unit = (1e-6, "N/µm") if compliance else (1e6, "µm")

    def shown(value: float) -> float:
        return scale / value if compliance else scale * value

    title = "Smallest stiffness along the path" if compliance else "Largest deflection"
    blind = found.admissible
    rows = [
        ("best posture found", shown(found.objective)),
        (f"best of {len(blind)} blind choices", shown(float(blind[0]))),
        ("their median", shown(float(np.median(blind)))),
        ("the worst of them", shown(float(blind[-1]))),
    ]
    or_length = f" (or {1e3 * found.limit_margin:.0f} mm)" if slides else ""
    parts: list[object] = [
        table(f"{title} [{unit}]", ("", unit), rows),
        f"Closest to a joint limit: {np.degrees(found.limit_margin):.1f}°{or_length}. "
        f"Smallest singular-value ratio: {found.condition.min():.3f}.",
    ]
    if found.placement.any():
        moved = [
            f"{name} {value * 1e3:.1f} mm" if name in "xyz" else f"{name} {np.degrees(value):.2f}°"
            for name, value in zip(PLACES, found.placement, strict=True)
            if value
        ]
        parts.append(f"The part is moved by {', '.join(moved)}.")
    return [*parts, f"Written: {', '.join(files)}"]
