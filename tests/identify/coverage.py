"""Do 95 % intervals hold the truth? Experiments whose data share nothing with the product.

The readings come from the generator in `tests/hidden/generator` (finite rotations, exact statics,
its own robots and noise), through a CSV and a YAML file, as a user's would.
"""

from __future__ import annotations

import csv
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import yaml

from sk120stiff.effects import effect
from sk120stiff.errors import ToolkitWarning
from sk120stiff.identify import Fit, fit
from sk120stiff.measurements import read_measurements
from sk120stiff.model import Model, joint_spring_model
from sk120stiff.robot import load_robot
from tests.hidden.generator.case import Case
from tests.hidden.generator.causes_elastic import BaseRocking, JointTilt, WristSpring
from tests.hidden.generator.causes_joint import LostMotion
from tests.hidden.generator.causes_sensor import ReadingRotation
from tests.hidden.generator.equilibrium import NoEquilibrium
from tests.hidden.generator.levels import Setting, setting
from tests.hidden.generator.public import quantities
from tests.hidden.generator.sk120 import sk120
from tests.hidden.generator.world import Cause
from tests.hidden.generator.writing import description, measurement_table

Rng = np.random.Generator


@dataclass(frozen=True)
class Kind:
    """A cause to hide and its draw."""

    name: str
    where: str
    draw: Callable[[Rng], Cause]
    schedule: str | None = None


def _around(rng: Rng, size: float) -> float:
    return float(size * np.exp(rng.normal(0.0, 0.3)))


KINDS: tuple[Kind, ...] = (
    Kind(
        "base_rocking",
        "base_link",
        lambda r: BaseRocking("base_link", {key: 1.0 / _around(r, 1e7) for key in "xy"}),
    ),
    Kind(
        "joint_tilt",
        "joint_2_l",
        lambda r: JointTilt(
            "joint_2_l", {key: 1.0 / _around(r, 8e6) for key in ("first", "second")}
        ),
    ),
    Kind(
        "reading_rotation",
        "tracker",
        lambda r: ReadingRotation(
            "tracker",
            {key: float(value) for key, value in zip("xyz", 4e-3 * r.normal(size=3), strict=True)},
        ),
    ),
    Kind(
        "joint_springs",
        "joint_5_b",
        lambda r: WristSpring("joint_5_b", {"compliance": 1.0 / _around(r, 3e5)}),
    ),
    Kind(
        "lost_motion",
        "joint_1_s",
        lambda r: LostMotion("joint_1_s", {"half_width": _around(r, 1e-4)}),
        "scattered",
    ),
)


@dataclass(frozen=True)
class Outcome:
    """One estimated parameter of one experiment.

    Attributes
    ----------
    group
        ``springs``, or the hidden effect.
    inside
        Does `interval_95` hold the truth?
    inside_linear
        Does value ± 1.96 standard errors?
    miss
        Estimate minus truth over the standard error, in internal values.
    """

    group: str
    inside: bool
    inside_linear: bool
    miss: float


def experiments(count: int, seed: int, folder: Path) -> Iterator[tuple[Outcome, ...]]:
    """Run experiments: kinds in turn, robot SK120, everything else drawn."""
    for number in range(count):
        kind = KINDS[number % len(KINDS)]
        path = folder / f"experiment_{number}.csv"
        cause, at = _drawn(kind, (seed, number), path)
        yield _outcomes(kind, cause, at, _fitted(kind, path))


def _drawn(kind: Kind, key: tuple[int, int], path: Path) -> tuple[Cause, Setting]:
    """An experiment and its files; arms that find no rest (a jump at zero torque) are redrawn."""
    for attempt in range(20):
        rng = np.random.default_rng((*key, attempt))
        at = setting("L0", (*key, attempt), rng, arm=sk120(), schedule=kind.schedule)
        cause = kind.draw(rng)
        try:
            _write(at.case([cause]), path)
        except NoEquilibrium:
            continue
        return cause, at
    raise RuntimeError(f"no experiment for {kind.name}, {key}")


def _write(case: Case, path: Path) -> None:
    """The training readings as a CSV and a YAML file."""
    rng = np.random.default_rng((*case.seed, 777))
    units = {"angle": "deg", "length": "mm"}
    header, table = measurement_table(case, case.train, case.positions, units, rng)
    with path.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream)
        writer.writerow(header)
        writer.writerows(table)
    settings = yaml.safe_dump(description(case, case.train, case.positions), sort_keys=False)
    path.with_suffix(".yaml").write_text(settings, encoding="utf-8")


def _fitted(kind: Kind, path: Path) -> Fit:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ToolkitWarning)
        robot = load_robot("motoman_sk120")
        readings = read_measurements(path, robot.actuated)
    base = joint_spring_model(robot, [1e6, 1e6, 1e6, np.inf, np.inf, np.inf])
    model: Model = base + effect(robot, kind.name, kind.where)
    return fit(model, readings)


def _outcomes(kind: Kind, cause: Cause, at: Setting, found: Fit) -> tuple[Outcome, ...]:
    truth = {
        f"joint_springs:{joint}.stiffness": 1.0 / compliance
        for joint, compliance in at.world.springs.items()
    }
    effect_id = f"{kind.name}:{kind.where}"
    own = {f"{effect_id}.{k}": v for k, v in quantities(cause, at.world.springs).items()}
    out = []
    for k, parameter in enumerate(found.parameters):
        true = {**truth, **own}[parameter.name]
        low, high = found.intervals()[k]
        value, std = parameter.value, parameter.std
        internal = parameter.spec.internal(true)
        linear = std is not None and abs(true - value) <= 1.96 * std
        miss = (
            np.nan
            if not parameter.internal_std
            else (parameter.internal - internal) / parameter.internal_std
        )
        group = kind.name if parameter.effect.id == effect_id else "springs"
        if effect_id.startswith("joint_springs") and group != "springs":
            group = "wrist spring"
        out.append(Outcome(group, low <= true <= high, linear, float(miss)))
    return tuple(out)


def table_of(outcomes: Sequence[Outcome]) -> list[tuple[str, int, float, float, float]]:
    """Per group: number, coverage of `interval_95`, of value ± 1.96 std, rms of the miss."""
    rows = []
    for group in dict.fromkeys(o.group for o in outcomes):
        own = [o for o in outcomes if o.group == group]
        rows.append(
            (
                group,
                len(own),
                float(np.mean([o.inside for o in own])),
                float(np.mean([o.inside_linear for o in own])),
                float(np.sqrt(np.nanmean([o.miss**2 for o in own]))),
            )
        )
    return rows
