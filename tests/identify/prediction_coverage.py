"""Do 95 % intervals of predicted deflections hold the truth at poses that were not fitted?

Campaigns come from the generator in `tests/hidden/generator`, which shares no physics with the
product: readings of 20 poses are fitted, the model goes through its file, and deflections at ten
new poses, new loads, are predicted and held against the generator's own, free of noise.
"""

from __future__ import annotations

import csv
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import yaml

from sk120stiff.effects import load_cases_of
from sk120stiff.errors import ToolkitWarning
from sk120stiff.identify import Fit, fit, known_model
from sk120stiff.measurements import Measurements, read_measurements
from sk120stiff.model import (
    Model,
    joint_spring_model,
    predict_with_uncertainty,
    read_model,
    write_model,
)
from sk120stiff.robot import load_robot
from tests.corpus.robots import example
from tests.hidden.generator.arm import Arm, Typical
from tests.hidden.generator.case import Case
from tests.hidden.generator.causes_elastic import BaseRocking, JointTilt, WristSpring
from tests.hidden.generator.equilibrium import NoEquilibrium
from tests.hidden.generator.levels import setting
from tests.hidden.generator.rows import Rows
from tests.hidden.generator.sk120 import sk120
from tests.hidden.generator.urdf_arm import read_urdf_arm
from tests.hidden.generator.world import Cause
from tests.hidden.generator.writing import description, measurement_table

Rng = np.random.Generator
Array = np.ndarray[tuple[int, ...], np.dtype[np.float64]]


def ur5() -> Arm:
    """Universal Robots' UR5 as its URDF has it, weight included."""
    path = example("ur5_robot.urdf")
    joints = [f"{name}_joint" for name in ("shoulder_pan", "shoulder_lift", "elbow")]
    joints += [f"wrist_{k}_joint" for k in (1, 2, 3)]
    springs = dict(zip(joints, [2.5e4, 2.5e4, 1.8e4, 6e3, 6e3, 6e3], strict=True))
    return read_urdf_arm(
        path,
        name="ur5",
        reference=str(path),
        base="base_link",
        tool="tool0",
        typical=Typical(joint=springs, force=60.0),
    )


@dataclass(frozen=True)
class Kind:
    """An arm, the springs that are fitted, and what is hidden beside them."""

    label: str
    arm: Callable[[], Arm]
    springs: Sequence[float]
    hide: Callable[[Rng], list[Cause]]


def _around(rng: Rng, size: float) -> float:
    return float(size * np.exp(rng.normal(0.0, 0.3)))


def _nothing(rng: Rng) -> list[Cause]:
    del rng
    return []


def _lacking_sk120(rng: Rng, fainter: float = 1.0) -> list[Cause]:
    every: list[Cause] = [
        BaseRocking("base_link", _compliances(rng, "xy", fainter * 1e7)),
        JointTilt("joint_2_l", _compliances(rng, ("first", "second"), fainter * 8e6)),
        WristSpring("joint_5_b", _compliances(rng, ("compliance",), fainter * 3e5)),
    ]
    return [every[int(rng.integers(3))]]


def _lacking_ur5(rng: Rng, fainter: float = 1.0) -> list[Cause]:
    every: list[Cause] = [
        BaseRocking("base_link", _compliances(rng, "xy", fainter * 2e5)),
        JointTilt("elbow_joint", _compliances(rng, ("first", "second"), fainter * 1e5)),
        JointTilt("wrist_1_joint", _compliances(rng, ("first", "second"), fainter * 3e4)),
    ]
    return [every[int(rng.integers(3))]]


def _compliances(rng: Rng, keys: Sequence[str], stiffness: float) -> dict[str, float]:
    return {key: 1.0 / _around(rng, stiffness) for key in keys}


Fitted = Callable[[Model, Measurements], Fit]
FAINTER = 6.0  # times: seldom seen in the readings, and yet as large as what they tell
SK120 = (1e6, 1e6, 1e6, np.inf, np.inf, np.inf)
UR5 = (2e4,) * 6
KINDS = (
    Kind("SK120", sk120, SK120, _nothing),
    Kind("UR5", ur5, UR5, _nothing),
    Kind("SK120, structure missing", sk120, SK120, _lacking_sk120),
    Kind("UR5, structure missing", ur5, UR5, _lacking_ur5),
    Kind("SK120, too faint to be seen", sk120, SK120, partial(_lacking_sk120, fainter=FAINTER)),
    Kind("UR5, too faint to be seen", ur5, UR5, partial(_lacking_ur5, fainter=FAINTER)),
)


@dataclass(frozen=True, eq=False)
class Campaign:
    """One campaign: how far predictions are off at new poses, over what they say of themselves.

    Attributes
    ----------
    label
        The kind.
    miss
        (N, 3) predicted minus true deflection [m].
    std_parameters, std_remainder
        (N, 3) as predicted [m].
    reach
        Half width of a 95 % interval in standard deviations.
    significant
        Was a remainder found?
    noise
        Of one reading [m].
    """

    label: str
    miss: Array
    std_parameters: Array
    std_remainder: Array
    reach: float
    significant: bool
    noise: float

    def inside(self, *, remainder: bool = True, narrower: float = 1.0) -> Array:
        """(N, 3) does the interval hold the truth?"""
        std = np.hypot(self.std_parameters, self.std_remainder if remainder else 0.0)
        return np.abs(self.miss) <= self.reach * std / narrower


def campaigns(
    kind: Kind, count: int, seed: int, folder: Path, fitted: Fitted = fit
) -> Iterator[Campaign]:
    """Draw, fit, write, read, predict; noise is stated."""
    for number in range(count):
        yield _campaign(kind, (seed, number), folder, fitted)


def _campaign(kind: Kind, key: tuple[int, int], folder: Path, fitted: Fitted) -> Campaign:
    for attempt in range(20):
        rng = np.random.default_rng((*key, attempt))
        at = setting("L0", (*key, attempt), rng, arm=kind.arm(), positions=False)
        case = at.case(kind.hide(rng))
        case.noise.declared.clear()
        try:
            truth = case.world.displacement(case.sealed)
            data = _written(case, case.train, folder / "train.csv")
            asked = _written(case, case.sealed, folder / "sealed.csv")
        except NoEquilibrium:
            continue
        return _predicted(kind, data, asked, truth, folder / "model.yaml", fitted)
    raise RuntimeError(f"no campaign for {kind.label}, {key}")


def _written(case: Case, rows: Rows, path: Path) -> Path:
    rng = np.random.default_rng((*case.seed, rows.count, int(rows.pose[0])))
    header, table = measurement_table(case, rows, False, {"angle": "deg", "length": "mm"}, rng)
    with path.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream)
        writer.writerow(header)
        writer.writerows(table)
    settings = yaml.safe_dump(description(case, rows, False), sort_keys=False)
    path.with_suffix(".yaml").write_text(settings, encoding="utf-8")
    return path


def _predicted(
    kind: Kind, data: Path, asked: Path, truth: Array, file: Path, fitted: Fitted
) -> Campaign:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ToolkitWarning)
        settings = yaml.safe_load(data.with_suffix(".yaml").read_text(encoding="utf-8"))
        frames = {"base": settings["base_frame"], "tool": settings["tool_frame"]}
        robot = load_robot(settings["robot"], **frames)
        readings = read_measurements(data, robot.actuated)
        found = fitted(joint_spring_model(robot, kind.springs), readings)
        write_model(known_model(found), file)
        model = read_model(file)
        load_cases = load_cases_of(robot, read_measurements(asked, robot.actuated))
        predicted = predict_with_uncertainty(model, load_cases)
    known = model.uncertainty
    assert known is not None and predicted.std_parameters is not None
    left = np.zeros((1, 3)) if predicted.std_remainder is None else predicted.std_remainder
    return Campaign(
        kind.label,
        predicted.displacement - truth,
        predicted.std_parameters,
        np.broadcast_to(left, truth.shape),
        known.reach(),
        known.remainder is not None and known.remainder.significant,
        known.noise or np.nan,
    )


def share_inside(found: Sequence[Campaign], **how: float) -> tuple[float, float]:
    """Share of intervals that hold the truth, and its standard error from campaign to campaign."""
    shares = np.array([campaign.inside(**how).mean() for campaign in found])  # type: ignore[arg-type]
    return float(shares.mean()), float(shares.std(ddof=1) / np.sqrt(len(shares)))
