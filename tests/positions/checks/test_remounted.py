"""A marker that took another place on the tool when a payload was hung there."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import sk120stiff as sk
from sk120stiff.effects import CATALOGUE
from sk120stiff.errors import InputError
from sk120stiff.explain.positions.run import explain_positions
from sk120stiff.identify.positions.calibrate import calibrate
from sk120stiff.identify.positions.checks.remounted import refuse_remounted
from sk120stiff.identify.positions.omitted.selection import Blocks
from sk120stiff.measurements import Measurements
from tests.positions.shared import campaign


def told(m: Measurements) -> tuple[str, ...]:
    robot = sk.load_robot(m.robot, base="base", tool="tool")
    found = calibrate(sk.base_model(robot), m)
    try:
        return refuse_remounted(found, m, *Blocks.of(found, CATALOGUE).beside_loads(found.unit))
    except InputError as stopped:
        return (str(stopped),)


@pytest.mark.parametrize("seed", [3, 7])
def test_another_place_under_the_payload_is_told(tmp_path: Path, seed: int) -> None:
    m = campaign(tmp_path, seed, 24, loads=(0.0, 30.0), markers="A", moved=(1e-3, 0.0, -5e-4))
    (said,) = told(m)
    assert "by 1.1 mm from 30 kg on" in said and "column series" in said


def test_a_second_payload_under_which_it_stayed_is_not_told(tmp_path: Path) -> None:
    m = campaign(tmp_path, 3, 24, loads=(0.0, 15.0, 30.0), markers="A", moved=(1e-3, 0.0, -5e-4))
    (said,) = told(m)
    assert "mm from 15 kg on:" in said


def test_the_order_of_the_rows_does_not_matter(tmp_path: Path) -> None:
    """Every pose with and without the payload, one after the other."""
    m = campaign(tmp_path, 3, 24, loads=(0.0, 30.0), markers="A", moved=(1e-3, 0.0, -5e-4))
    (said,) = told(m.select(np.arange(48).reshape(2, 24).T.ravel()))
    assert "by 1.1 mm from 30 kg on" in said


@pytest.mark.parametrize("seed", [3, 7])
def test_explain_tells_it_before_a_name_stands_for_it(tmp_path: Path, seed: int) -> None:
    m = campaign(tmp_path, seed, 24, loads=(0.0, 30.0), markers="AB", moved=(3e-4, 0.0, -2e-4))
    model = sk.Model(sk.load_robot(m.robot, base="base", tool="tool"))
    try:
        said = explain_positions(model, m).final.notes
    except InputError as stopped:
        said = (str(stopped),)
    assert any("arker looks moved" in note for note in said)


@pytest.mark.parametrize("seed", [3, 7, 11])
def test_what_a_payload_does_to_the_arm_is_no_other_place(tmp_path: Path, seed: int) -> None:
    assert not told(campaign(tmp_path, seed, 24, loads=(0.0, 30.0), markers="A"))
    assert not told(campaign(tmp_path, seed, 12, loads=(0.0, 15.0, 30.0), markers="AB"))
