"""A drift in a file that does not say when its rows were read."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.explain.positions.answer.explained import Explained
from sk120stiff.identify.positions.calibrate import Calibration
from sk120stiff.identify.positions.words import findings
from sk120stiff.model import Model
from tests.positions.arm import errors, poses, tracked, write

FIT = "position: {frame: unknown}\npoint: {xyz: [50, -80, 120], unit: mm, fit: true}\n"
SAID = "creeps by"


def read(folder: Path, drift: float, *, ordered: bool = False) -> tuple[sk.Robot, sk.Measurements]:
    """60 positions, the last of them `drift` [m] off along the tracker's x."""
    a = poses(60, 5)
    x = tracked(errors(2).stands(a)[0]) + 2e-5 * np.random.default_rng(1).normal(size=(60, 3))
    x[:, 0] += drift * np.linspace(0.0, 1.0, 60)
    more = {"more": ",order", "cells": [str(k) for k in range(60)]} if ordered else {}
    data = sk.read(write(folder, a, x, FIT, **more))
    return sk.load_robot(data.robot, base="base", tool="tool"), data


@pytest.mark.parametrize("drift", [3e-4, -2e-4])
def test_it_is_told_with_what_to_add(tmp_path: Path, drift: float) -> None:
    robot, data = read(tmp_path, drift)
    found = sk.fit(sk.base_model(robot), data)
    assert isinstance(found, Calibration)
    (line,) = [each for each in findings(found, data) if SAID in each]
    size = float(line.split(SAID)[1].split(" mm")[0])
    assert 0.5 < size / (1e3 * abs(drift)) < 1.5 and "column order" in line
    answer = sk.explain(Model(robot), data)
    assert isinstance(answer, Explained) and SAID in " ".join(answer.final.notes)


@pytest.mark.parametrize(("drift", "ordered"), [(0.0, False), (1e-5, False), (3e-4, True)])
def test_nothing_is_told_where_nothing_creeps_or_the_order_is_stated(
    tmp_path: Path, drift: float, ordered: bool
) -> None:
    robot, data = read(tmp_path, drift, ordered=ordered)
    found = sk.fit(sk.base_model(robot), data)
    assert isinstance(found, Calibration)
    assert not any(SAID in each for each in findings(found, data))
