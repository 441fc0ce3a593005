"""Scenes that several tests look at."""

import itertools
from functools import cache
from pathlib import Path

import numpy as np

from sk120stiff import load_robot
from sk120stiff.measurements import read_measurements
from sk120stiff.model import Model, base_model
from sk120stiff.plan import Cell
from sk120stiff.robot import Robot
from sk120stiff.robot.solids import Solid
from sk120stiff.show import Scene, scene_of_model

ROOT = Path(__file__).resolve().parents[2]
DATA = ROOT / "robots" / "motoman_sk120" / "data" / "table2_measured.csv"
ARTEFACTS = ROOT / ".ci" / "work" / "show"
TWO_SLIDES = """
<robot name="gantry">
  <link name="base"><visual><geometry><box size="0.1 0.1 0.1"/></geometry></visual></link>
  <link name="carriage"/><link name="arm"/><link name="tip"/>
  <joint name="slide" type="prismatic"><parent link="base"/><child link="carriage"/>
    <axis xyz="1 0 0"/><limit lower="-0.5" upper="1.0" effort="1" velocity="1"/></joint>
  <joint name="swing" type="continuous"><parent link="carriage"/><child link="arm"/>
    <origin xyz="0 0 0.2" rpy="0 0.3 0"/><axis xyz="0 0 1"/></joint>
  <joint name="tip_fixed" type="fixed"><parent link="arm"/><child link="tip"/>
    <origin xyz="0.6 0 0.1"/></joint>
</robot>
"""


@cache
def sk120() -> Robot:
    return load_robot("motoman_sk120")


@cache
def springs() -> Model:
    found = base_model(sk120())
    assert found is not None
    return found


@cache
def sk120_scene() -> Scene:
    stiffer = springs().with_values(0.9 * springs().values)
    return scene_of_model(
        springs(),
        read_measurements(DATA),
        models={"paper's springs": springs(), "stiffer springs": stiffer},
        title="Motoman SK120",
        subtitle="Table II, measured deflections",
        label="springs of the 2005 paper",
    )


def random_pose(robot: Robot, generator: np.random.Generator) -> np.ndarray:
    lower = np.where(np.isfinite(robot.lower), robot.lower, -1.0)
    upper = np.where(np.isfinite(robot.upper), robot.upper, 1.0)
    return generator.uniform(lower, upper)


def walled_cell(*, hull: bool = False) -> Cell:
    """A cell with a wall of 0.1 m, 3 m and 5 m, as a box or as its corners."""
    size = np.array([0.1, 3.0, 5.0])
    place = np.eye(4)
    place[:3, 3] = (-4.0, 0.0, 1.0)
    corners = 0.5 * size * np.array(list(itertools.product((-1.0, 1.0), repeat=3)))
    wall = Solid("wall", "base_link", place, "box", tuple(size.tolist()))
    if hull:
        wall = Solid("wall", "base_link", place, "hull", points=corners)
    return Cell(obstacles=(wall,), source="cell.yaml")
