"""Cases as files: measurements that the program may see, truths that only the scorer opens."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import yaml

from .case import Case
from .mechanism import Mechanism
from .rotations import Array
from .rows import Rows

ANGLE_UNITS = {"deg": np.pi / 180.0, "rad": 1.0}
LENGTH_UNITS = {"mm": 1e-3, "um": 1e-6, "m": 1.0}


def write_case(case: Case, name: str, cases: Path, truth: Path) -> None:
    """`cases/name/` for the program, `truth/name.json` and `sealed/name/` beside them.

    `sealed/` holds further held-out readings: the runner asks for predictions of them after the
    model is written.
    """
    folder, hidden = cases / name, truth.parent / "sealed" / name
    folder.mkdir(parents=True, exist_ok=True)
    hidden.mkdir(parents=True, exist_ok=True)
    truth.mkdir(parents=True, exist_ok=True)
    rng = np.random.default_rng((*case.seed, 777))
    units = {
        "angle": str(rng.choice(["deg", "rad"], p=[0.8, 0.2])),
        "length": str(rng.choice(["mm", "um", "m"], p=[0.7, 0.2, 0.1])),
    }
    if case.urdf is not None:
        for place in (folder, hidden):
            (place / case.arm.reference).write_text(case.urdf, encoding="utf-8")
    for place, stem, rows in (
        (folder, "train", case.train),
        (folder, "holdout", case.holdout),
        (hidden, "sealed", case.sealed),
    ):
        positions = case.positions and stem == "train"
        header, table = measurement_table(case, rows, positions, units, rng)
        with (place / f"{stem}.csv").open("w", newline="", encoding="utf-8") as stream:
            writer = csv.writer(stream)
            writer.writerow(header)
            writer.writerows(table)
        (place / f"{stem}.yaml").write_text(
            yaml.safe_dump(description(case, rows, positions), sort_keys=False), encoding="utf-8"
        )
    # the options that the command gets besides the data; nothing else about the case
    (folder / "command.json").write_text(json.dumps(list(case.arguments)), encoding="utf-8")
    (truth / f"{name}.json").write_text(json.dumps(case.truth(), indent=1), encoding="utf-8")


def description(case: Case, rows: Rows, positions: bool) -> dict[str, object]:
    """The YAML beside the CSV."""
    force: dict[str, object] = {"frame": case.force_frame}
    if not np.array_equal(rows.force_point, rows.point):
        force["point"] = _point(rows.force_point)
    displacement: dict[str, object] = {"frame": "base"}
    if not positions:
        displacement["zero"] = "shared" if case.noise.shared_zero else "separate"
    out: dict[str, object] = {
        "robot": case.arm.reference,
        "base_frame": case.arm.base_frame,
        "tool_frame": case.arm.tool_frame,
        "point": _point(rows.point),
        "force": force,
        "displacement": displacement,
        "noise": {"sigma": round(1e6 * case.noise.sigma, 3), "unit": "um"},
        "source": "simulated for a blind test",
    }
    if positions:
        del out["displacement"]
    for key, value in case.noise.declared.items():
        if value is None:
            out.pop(key, None)
        elif key == "zero":
            if not positions:
                displacement["zero"] = value
        elif key in {"columns"}:
            out.pop("noise", None)
        else:
            out[key] = value
    return out


def _point(local: Array) -> dict[str, object]:
    return {"xyz": [round(float(1e3 * v), 4) for v in local], "unit": "mm"}


def measurement_table(
    case: Case, rows: Rows, positions: bool, units: dict[str, str], rng: np.random.Generator
) -> tuple[list[str], list[list[object]]]:
    """Header and rows of the CSV, noise drawn."""
    displacement, start, loaded = case.world.observe(rows)
    error, zero_error = case.noise.sample(rows, displacement, start, rng)
    force, moment = rows.force, rows.moment
    if case.force_frame == "tool":
        turned = loaded.standing.tool_rotation  # as a sensor reads that is screwed to the tool
        force = np.einsum("nji,nj->ni", turned, force)
        moment = np.einsum("nji,nj->ni", turned, moment)
    with_moment = bool(np.any(moment))
    angle, length = units["angle"], units["length"]
    header = ["pose"]
    joints = []
    for name in case.arm.actuated:
        if case.arm.slides(name):
            header.append(f"{name}[mm]")
            joints.append(rows.coordinates[name] / 1e-3)
        else:
            header.append(f"{name}[{angle}]")
            joints.append(rows.coordinates[name] / ANGLE_UNITS[angle])
    header += ["fx[N]", "fy[N]", "fz[N]"]
    if with_moment:
        header += ["mx[N*m]", "my[N*m]", "mz[N*m]"]
    kind = "xyz" if positions else ("dx", "dy", "dz")
    header += [f"{key}[{length}]" for key in kind]
    spread = None
    if "columns" in case.noise.declared and not positions:
        covariance = case.noise.covariance(rows, displacement, start)
        spread = np.sqrt(np.diag(covariance).reshape(-1, 3))
        header += [f"{key}[um]" for key in ("sx", "sy", "sz")]
    falls = bool(np.any(rows.branch < 0))
    repeats = bool(np.any(rows.repeat > 1))
    header += ["order"] + ["branch"] * falls + ["repeat"] * repeats

    def line(row: int, zero: bool, value: Array) -> list[object]:
        own: list[object] = [int(rows.pose[row])]
        own += [f"{joint[row]:.9f}" for joint in joints]
        load = np.zeros(6) if zero else np.concatenate([force[row], moment[row]])
        own += [f"{v:.5f}" for v in load[: 6 if with_moment else 3]]
        own += [f"{v / LENGTH_UNITS[length]:.9f}" for v in value]
        if spread is not None:
            own += [f"{1e6 * v:.4f}" for v in spread[row]]
        own.append(int(rows.zero_order[row] if zero else rows.order[row]))
        if falls:
            own.append("load" if zero or rows.branch[row] > 0 else "unload")
        if repeats:
            own.append(1 if zero else int(rows.repeat[row]))
        return own

    table = []
    for row in range(rows.count):
        if positions:
            if row == 0 or rows.zero_order[row] != rows.zero_order[row - 1]:
                table.append(line(row, True, start[row] + zero_error[row]))
            table.append(line(row, False, start[row] + displacement[row] + error[row]))
        else:
            table.append(line(row, False, displacement[row] + error[row] - zero_error[row]))
    return header, table


def nominal_tool_rotation(case: Case, rows: Rows) -> Array:
    """Tool axes (N, 3, 3) of the rigid, unloaded arm at the commanded coordinates."""
    mechanism = Mechanism(case.arm)
    crank = None if case.arm.loop is None else rows.coordinates[case.arm.loop.driver]
    rest = np.zeros((len(mechanism.labels), rows.count))
    return mechanism.stand(mechanism.commanded(rows.coordinates), rest, crank).tool_rotation
